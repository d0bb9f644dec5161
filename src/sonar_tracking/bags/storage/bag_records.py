"""Messages of a bag as the records the stages use, without ROS."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from typing import Any, TypeVar

from sonar_tracking.bags.contents.digest import decoded_message
from sonar_tracking.bags.contents.message_definitions import typestore_of
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.errors import ConfigurationError, InputError, unknown_name_text
from sonar_tracking.message_reading.array_reading import (
    bearing_tracks_from_message,
    directions_from_message,
    own_ship_from_message,
    snapshots_from_message,
    subspaces_from_message,
)
from sonar_tracking.message_reading.command_reading import command_from_message
from sonar_tracking.message_reading.contact_reading import (
    contacts_from_message,
    thresholds_from_message,
)
from sonar_tracking.message_reading.line_reading import frequency_lines_from_message
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE, OwnShipReader
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.message_reading.sample_reading import (
    lofar_rows_from_message,
    samples_from_message,
)
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.lines import FrequencyLines, LofarRows
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks

SNAPSHOTS_TYPE = "sonar_tracking_msgs/msg/ArraySnapshots"
SAMPLES_TYPE = "sonar_tracking_msgs/msg/ArraySamples"
BEARING_TRACKS_TYPE = "sonar_tracking_msgs/msg/BearingTracks"
POSITION_TRACKS_TYPE = "sonar_tracking_msgs/msg/Tracks"
CONTACTS_TYPE = "sonar_tracking_msgs/msg/Contacts"
FREQUENCY_LINES_TYPE = "sonar_tracking_msgs/msg/FrequencyLines"
IMAGE_TYPE = "sensor_msgs/msg/Image"
SUBSPACES_TYPE = "sonar_tracking_msgs/msg/SubspaceEstimates"
THRESHOLDS_TYPE = "sonar_tracking_msgs/msg/DetectionThreshold"
COMMANDS_TYPE = "sonar_tracking_msgs/msg/OperatorCommand"

Record = TypeVar("Record")

_CONVERSIONS: dict[str, Callable[[Any], Any]] = {
    SNAPSHOTS_TYPE: snapshots_from_message,
    SAMPLES_TYPE: samples_from_message,
    SUBSPACES_TYPE: subspaces_from_message,
    BEARING_TRACKS_TYPE: directions_from_message,
    POSITION_TRACKS_TYPE: position_tracks_from_message,
    CONTACTS_TYPE: contacts_from_message,
    THRESHOLDS_TYPE: thresholds_from_message,
    FREQUENCY_LINES_TYPE: frequency_lines_from_message,
    ODOMETRY_TYPE: own_ship_from_message,
    IMAGE_TYPE: lofar_rows_from_message,
    COMMANDS_TYPE: command_from_message,
}


def topics_of_type(bag: Bag, type_name: str, role: str = "") -> list[str]:
    """Return the topics of a type that hold messages; of one role if it is given."""
    return [
        name
        for name, topic in bag.topics.items()
        if topic.type_name == type_name and topic.message_count and role in ("", topic.role)
    ]


def records_of(bag: Bag, topic: str, rejected: list[str] | None = None) -> Iterator[Any]:
    """Yield the records of a topic in log order, of the kind its type carries.

    Parameters
    ----------
    bag : Bag
        The bag.
    topic : str
        Its full name, e.g. ``"/active/tracks"``.
    rejected : list of str, optional
        Takes a sentence for each message that does not hold what it says, which is then left out;
        without it such a message raises.

    Yields
    ------
    record
        One of :mod:`sonar_tracking.records`, e.g. ``Contacts`` or ``PositionTracks``.

    Raises
    ------
    ConfigurationError
        If the bag has no such topic, or its type carries no record of this package.
    InputError
        If a message does not hold what it says.
    """
    if topic not in bag.topics:
        raise ConfigurationError(unknown_name_text(f"{bag.path}: topic {topic}", topic, bag.topics))
    type_name = bag.topics[topic].type_name
    if type_name not in _CONVERSIONS:
        raise ConfigurationError(
            f"{bag.path}: {topic} is of type {type_name}, which carries no record; ask for one of "
            f"{', '.join(n for n, t in bag.topics.items() if t.type_name in _CONVERSIONS)}."
        )
    if type_name == ODOMETRY_TYPE:
        return own_ship_of(bag, topic, rejected)
    return _converted(bag, topic, _CONVERSIONS[type_name], rejected)


def records_in_order(
    bag: Bag, topics: Collection[str], rejected: list[str]
) -> Iterator[tuple[str, Any]]:
    """Yield the records of several topics in log order, each with its topic.

    Parameters
    ----------
    bag : Bag
        The bag.
    topics : collection of str
        Of types that carry records.
    rejected : list of str
        Takes a sentence for each message that does not hold what it says.

    Yields
    ------
    topic : str
        The topic.
    record : record or None
        As of :func:`records_of`; None = the message was rejected.
    """
    kinds = {topic: bag.topics[topic].type_name for topic in topics}
    stores = {topic: typestore_of(bag.topics[topic].definition) for topic in topics}
    readers = {
        topic: OwnShipReader() if kind == ODOMETRY_TYPE else _CONVERSIONS[kind]
        for topic, kind in kinds.items()
    }
    for message in bag.messages(topics):
        topic = message.topic
        try:
            decoded = decoded_message(stores[topic], kinds[topic], message.data)
            yield topic, readers[topic](decoded)
        except InputError as error:
            rejected.append(f"{topic}: {error}")
            yield topic, None


def snapshots_of(
    bag: Bag, topic: str, rejected: list[str] | None = None
) -> Iterator[ArraySnapshots]:
    """Yield the blocks of a topic in log order.

    Parameters
    ----------
    bag : Bag
        The bag.
    topic : str
        A topic of :data:`SNAPSHOTS_TYPE`.
    rejected : list of str, optional
        Takes a sentence for each message that does not hold what it says, which is then left out;
        without it such a message raises.

    Raises
    ------
    InputError
        If a message does not hold what it says.
    """
    yield from _converted(bag, topic, snapshots_from_message, rejected)


def bearing_tracks_of(
    bag: Bag, topic: str, rejected: list[str] | None = None
) -> Iterator[BearingTracks]:
    """Yield the track lists of a topic in log order; a column not reported is NaN.

    Parameters and errors are those of :func:`snapshots_of`.
    """
    yield from _converted(bag, topic, bearing_tracks_from_message, rejected)


def position_tracks_of(
    bag: Bag, topic: str, rejected: list[str] | None = None
) -> Iterator[PositionTracks]:
    """Yield the position tracks of a topic in log order; a column not reported is NaN or zero.

    Parameters and errors are those of :func:`snapshots_of`.
    """
    yield from _converted(bag, topic, position_tracks_from_message, rejected)


def directions_of(
    bag: Bag, topic: str, rejected: list[str] | None = None
) -> Iterator[BearingTracks]:
    """Yield the track lists of a topic in log order, cone angles and azimuths.

    Parameters and errors are those of :func:`snapshots_of`.
    """
    yield from _converted(bag, topic, directions_from_message, rejected)


def contacts_of(bag: Bag, topic: str, rejected: list[str] | None = None) -> Iterator[Contacts]:
    """Yield the contacts of a topic, ping by ping, in log order.

    Parameters and errors are those of :func:`snapshots_of`.
    """
    yield from _converted(bag, topic, contacts_from_message, rejected)


def own_ship_of(bag: Bag, topic: str, rejected: list[str] | None = None) -> Iterator[OwnShipState]:
    """Yield own ship's states of a topic in log order.

    Parameters and errors are those of :func:`snapshots_of`.
    """
    yield from _converted(bag, topic, OwnShipReader(), rejected)


def frequency_lines_of(
    bag: Bag, topic: str, rejected: list[str] | None = None
) -> Iterator[FrequencyLines]:
    """Yield the lines of a topic in log order.

    Parameters and errors are those of :func:`snapshots_of`.
    """
    yield from _converted(bag, topic, frequency_lines_from_message, rejected)


def lofar_rows_of(bag: Bag, topic: str, rejected: list[str] | None = None) -> Iterator[LofarRows]:
    """Yield the rows of the LOFAR picture of a topic in log order.

    Parameters and errors are those of :func:`snapshots_of`.
    """
    yield from _converted(bag, topic, lofar_rows_from_message, rejected)


def _converted(
    bag: Bag, topic: str, convert: Callable[[Any], Record], rejected: list[str] | None
) -> Iterator[Record]:
    store = typestore_of(bag.topics[topic].definition)
    for message in bag.messages([topic]):
        try:
            decoded = decoded_message(store, bag.topics[topic].type_name, message.data)
            yield convert(decoded)
        except InputError as error:
            sentence = f"{topic}: {error}"
            if rejected is None:
                raise InputError(sentence) from None
            rejected.append(sentence)
