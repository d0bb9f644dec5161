"""From messages to frames: what the live page is fed with.

Messages come in any order of topics, each topic in order of time. One that cannot be read is
counted and named; nothing a message holds stops the feed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from sonar_tracking.display.page.contact_frames import ContactFrames, threshold_frame
from sonar_tracking.display.page.frame_history import FrameHistory
from sonar_tracking.display.page.health_frames import Health
from sonar_tracking.display.page.outermost_topic import outermost_topic
from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_commands import command_frame
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import Frame, text_frame
from sonar_tracking.display.page.place_frames import datum_frame
from sonar_tracking.display.page.track_frames import (
    StationPlaces,
    alignment_frame,
    bearings_frame,
    lines_frame,
    own_ship_frame,
    ship_frame,
    tracks_frame,
)
from sonar_tracking.display.page.waterfall_frames import WaterfallFrames
from sonar_tracking.errors import InputError
from sonar_tracking.message_reading.alignment_reading import alignments_from_message
from sonar_tracking.message_reading.array_reading import (
    directions_from_message,
    snapshots_from_message,
)
from sonar_tracking.message_reading.command_reading import command_from_message
from sonar_tracking.message_reading.contact_reading import (
    contacts_from_message,
    thresholds_from_message,
)
from sonar_tracking.message_reading.field_reading import type_name
from sonar_tracking.message_reading.line_reading import frequency_lines_from_message
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE, OwnShipReader
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.message_reading.sample_reading import samples_from_message
from sonar_tracking.records.datum import Datum, datum_if_told

TRUTH_PERIOD = 2.0
"""Between two lists of the truth that are shown, s of data time: it moves steadily."""


class PageFeed:
    """Makes frames of messages, and keeps those of the past.

    Parameters
    ----------
    configuration : PageConfiguration
        Parameters of the page.
    send : callable
        Takes each new frame.
    """

    def __init__(self, configuration: PageConfiguration, send: Callable[[Frame], None]) -> None:
        self._configuration = configuration
        self._send = send
        self._sources: dict[str, str] = {}
        self._ships: list[str] = []
        self.health = Health()
        self.history = FrameHistory(60.0 * configuration.history_minutes)
        self._datum = datum_if_told(configuration.datum, "datum")
        self._begin()
        self._tell_datum()
        self._takers: dict[str, Callable[[str, Any], Iterable[Frame]]] = {
            "Odometry": self._own_ship,
            "Tracks": self._tracks,
            "BearingTracks": self._bearings,
            "FrequencyLines": self._lines,
            "Contacts": self._contacts,
            "DetectionThreshold": self._thresholds,
            "ArraySnapshots": self._snapshots,
            "ArraySamples": self._samples,
            "ArrayAlignments": self._alignments,
            "OperatorCommand": self._commands,
            "DiagnosticArray": self._diagnostics,
        }

    def _begin(self) -> None:
        """Begin with the data: nothing is known yet."""
        configuration = self._configuration
        self._read_own_ship, self._read_other_ships = OwnShipReader(), OwnShipReader()
        self._log = OwnShipLog()
        self._places = StationPlaces(configuration, self._log)
        self._pings = ContactFrames(configuration, self._log)
        seconds = 60.0 * configuration.history_minutes
        self._waterfalls = WaterfallFrames(self._log, self._places, seconds)

    def take_datum(self, datum: Datum) -> None:
        """Take the datum of ``map``: from now on the page shows places."""
        self._datum = datum
        self._tell_datum()

    def _tell_datum(self) -> None:
        if self._datum is not None:
            self.emit(datum_frame(self._datum))

    def expect(self, topic: str, type_name: str) -> None:
        """Count on a topic whose messages may be late: no other ship is taken for own ship."""
        if type_name == ODOMETRY_TYPE and topic not in self._ships:
            self._ships.append(topic)

    def take(self, topic: str, message: Any, size: int = 0) -> None:
        """Take a message, and send the frames it makes.

        Parameters
        ----------
        topic : str
            Full name.
        message : message
            Received, or decoded from a bag.
        size : int
            Of the message as it was received, bytes.
        """
        kind = type_name(message) or type(message).__name__
        taker = self._takers.get(kind)
        if taker is None:
            return
        if topic not in self._sources:
            self._sources[topic] = kind
            self.emit(text_frame("sources", math.nan, sources=dict(self._sources)))
        try:
            frames = list(taker(topic, message))
        except (InputError, ValueError, OverflowError) as error:
            self.health.rejected(topic, str(error))
            return
        for frame in frames:
            self.health.heard(topic, frame.time)
            if self._is_needless(topic, frame):
                continue
            if self.history.begins_anew(frame):
                self.begin_anew(frame.time)
            self.emit(frame)

    def _is_needless(self, topic: str, frame: Frame) -> bool:
        """Return whether a frame tells of the truth, and the one before is as good."""
        before = self.history.latest.get(frame.stream)
        if before is None or "truth" not in topic.split("/"):
            return False
        return 0.0 < frame.time - before.time < TRUTH_PERIOD

    def begin_anew(self, time: float) -> None:
        """Forget the past: the clock of the data has gone back to a time, s."""
        self._forget("begin", time)
        self.health.clock_went_back()

    def begin_part(self, time: float) -> None:
        """Forget everything: another part of a recording comes, from a time on, s."""
        self._forget("part", time)

    def _forget(self, kind: str, time: float) -> None:
        self.history.clear()
        self._begin()
        self._tell_datum()
        self._send(text_frame(kind, time))  # news to who is there, and no part of the past

    def emit(self, frame: Frame) -> None:
        """Keep a frame, and send it."""
        self.history.add(frame)
        self._send(frame)

    def select(self, said: Mapping[str, Any]) -> list[Frame]:
        """Select what is sent from now on, and return what is known of it.

        Raises
        ------
        InputError
            If it makes no sense.
        """
        return list(self._waterfalls.select(said))

    def report_health(self) -> None:
        """Send the state of the graph as it is now."""
        self.emit(self.health.frame())

    def past(self) -> list[Frame]:
        """Return what a new page is sent after the greeting: the newest picture, then the past."""
        begin, end = text_frame("history", math.nan), text_frame("live", math.nan)
        return [*self.history.latest.values(), begin, *self.history, end]

    def _own_ship(self, topic: str, message: Any) -> Iterator[Frame]:
        self.expect(topic, ODOMETRY_TYPE)
        if topic != outermost_topic(self._ships):
            yield ship_frame(topic, self._read_other_ships(message))
            return
        state = self._read_own_ship(message)
        self._log.add(state)
        yield own_ship_frame(state)
        yield from self._waterfalls.own_ship(state)

    def _tracks(self, topic: str, message: Any) -> Iterator[Frame]:
        tracks = position_tracks_from_message(message)
        yield tracks_frame(topic, tracks)
        yield from self._waterfalls.tracks(topic, tracks)

    def _bearings(self, topic: str, message: Any) -> Iterator[Frame]:
        tracks = directions_from_message(message)
        view = self._places.view(tracks.sensor, tracks.stamp)
        yield bearings_frame(topic, tracks, view)
        self._waterfalls.bearings(topic, tracks, view)

    def _lines(self, topic: str, message: Any) -> Iterator[Frame]:
        lines = frequency_lines_from_message(message)
        yield lines_frame(topic, lines)
        self._waterfalls.lines(lines)

    def _snapshots(self, topic: str, message: Any) -> Iterator[Frame]:
        yield from self._waterfalls.snapshots(topic, snapshots_from_message(message))

    def _samples(self, topic: str, message: Any) -> Iterator[Frame]:
        yield from self._waterfalls.samples(topic, samples_from_message(message))

    def _contacts(self, topic: str, message: Any) -> Iterator[Frame]:
        yield self._pings.frame(topic, contacts_from_message(message))

    def _thresholds(self, topic: str, message: Any) -> Iterator[Frame]:
        yield threshold_frame(topic, thresholds_from_message(message))

    def _alignments(self, topic: str, message: Any) -> Iterator[Frame]:
        yield alignment_frame(topic, alignments_from_message(message))

    def _commands(self, topic: str, message: Any) -> Iterator[Frame]:
        yield command_frame(command_from_message(message))

    def _diagnostics(self, topic: str, message: Any) -> Iterable[Frame]:
        self.health.diagnosed(message)
        return ()
