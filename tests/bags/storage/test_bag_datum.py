"""The datum of a recording: of its scenario, or of what a live graph told."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.storage.bag_datum import DATUM_TYPE, bag_datum
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.display_plan import with_datum
from sonar_tracking.records.datum import Datum, datum_from_text

PLACE = Datum(54.18, 7.89, 2.0)


def fix_cdr(latitude_deg: float, longitude_deg: float, height: float) -> bytes:
    store = installed_typestore(DATUM_TYPE)
    types: Any = store.types
    message = types[DATUM_TYPE](
        types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), "map"),
        types["sensor_msgs/msg/NavSatStatus"](0, 0),
        latitude_deg,
        longitude_deg,
        height,
        np.zeros(9),
        0,
    )
    return bytes(store.serialize_cdr(message, DATUM_TYPE))


def bag_of(folder: Path, scenario: dict[str, Any], *fixes: tuple[float, float, float]) -> Path:
    writer = BagWriter(folder / "bag", RecordingInformation(scenario))
    writer.add_topic("/map/datum", DATUM_TYPE)
    writer.add_topic("/truth/tracks", "sonar_tracking_msgs/msg/Tracks")
    for number, fix in enumerate(fixes):
        writer.write("/map/datum", number + 1, fix_cdr(*fix))
    writer.close()
    return folder / "bag"


def test_a_live_graph_told_it(tmp_path: Path) -> None:
    nonsense = (95.0, 7.89, 2.0)
    bag = read_bag(bag_of(tmp_path, {}, nonsense, (54.18, 7.89, 2.0)))
    assert bag_datum(bag) == PLACE


def test_the_scenario_goes_before_and_nothing_is_none(tmp_path: Path) -> None:
    other = Datum(10.0, 20.0)
    told = bag_of(tmp_path / "a", {"datum": other.to_mapping()}, (54.18, 7.89, 2.0))
    assert bag_datum(read_bag(told)) == other
    assert bag_datum(read_bag(bag_of(tmp_path / "b", {}))) is None
    wrong = bag_of(tmp_path / "c", {"datum": {"latitude_deg": 91.0, "longitude_deg": 0.0}})
    with pytest.raises(ConfigurationError, match="latitude_deg"):
        bag_datum(read_bag(wrong))


def test_chart_plotters_get_it_unless_another_one_is_given() -> None:
    assert datum_from_text(PLACE.to_text()) == PLACE
    assert with_datum({"nmea_output": {"datum": ""}}, PLACE)["nmea_output"]["datum"] == (
        PLACE.to_text()
    )
    given = {"nmea_output": {"datum": "1,2"}}
    assert with_datum(given, PLACE) == given and with_datum(given, None) == given
    assert with_datum({}, PLACE) == {}
