"""Where on the Earth the map of a recording lies."""

from __future__ import annotations

from typing import Any

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.message_reading.datum_reading import datum_from_message
from sonar_tracking.records.datum import Datum, datum_of

DATUM_TYPE = "sensor_msgs/msg/NavSatFix"
_NAME = "map/datum"


def bag_datum(bag: Bag) -> Datum | None:
    """Return the datum of the scenario in a bag, or of ``map/datum``; None = it has none.

    Parameters
    ----------
    bag : Bag
        The bag.

    Raises
    ------
    ConfigurationError
        If the scenario has one that cannot be used.
    """
    told = datum_of(bag.recording.scenario if bag.recording else {}, str(bag.path))
    topics = [
        name
        for name, topic in bag.topics.items()
        if topic.type_name == DATUM_TYPE and f"/{name}".endswith(f"/{_NAME}")
    ]
    if told is not None or not topics:
        return told
    store = installed_typestore(DATUM_TYPE)
    for message in bag.messages(topics):
        fix: Any = store.deserialize_cdr(message.data, DATUM_TYPE)
        try:
            return datum_from_message(fix, f"{bag.path}: {message.topic}")
        except ConfigurationError:
            continue
    return None
