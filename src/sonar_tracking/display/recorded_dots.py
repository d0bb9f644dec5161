"""Stacked dots of the solutions of a recording, message by message."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from sonar_tracking.bags.storage.bag_records import topics_of_type
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.display.page.hearing_log import HearingLog
from sonar_tracking.display.page.outermost_topic import outermost_topic
from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.solution_dots import solution_dots
from sonar_tracking.display.page.track_frames import StationPlaces
from sonar_tracking.display.stacked_dots_record import TrackDots
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks, TrackSource

MOST_TRACKS = 12
"""Tracks whose dots are drawn, those with the most."""

_MOUNTINGS = "scene_publisher"
"""Node whose recorded parameters tell where the array is on own ship."""

_SOLVED = {int(TrackSource.TMA), int(TrackSource.FUSED)}


class RecordedDots:
    """Collects what was heard, and the last solution of every track.

    Parameters
    ----------
    bag : Bag
        Whose topics tell what is truth.
    """

    def __init__(self, bag: Bag) -> None:
        self._truths = {name for name, topic in bag.topics.items() if topic.role == "truth"}
        self._own_ship = OwnShipLog()
        self._odometry = outermost_topic(topics_of_type(bag, ODOMETRY_TYPE))
        parameters = bag.recording.node_parameters if bag.recording else {}
        given = parameters.get(_MOUNTINGS, {})
        names = ("array_mounting_x", "array_mounting_y", "array_mounting_yaw_deg")
        mounting = {name: float(given[name]) for name in names if name in given}
        configuration = replace(PageConfiguration(), **mounting)  # type: ignore[arg-type]
        self._places = StationPlaces(configuration, self._own_ship)
        self._log = HearingLog()
        self._solutions: dict[str, dict[int, tuple[PositionTracks, int]]] = {}

    def take(self, topic: str, record: Any) -> None:
        """Take the record of a message."""
        if topic in self._truths:
            return
        if isinstance(record, OwnShipState):
            if topic == self._odometry:
                self._own_ship.add(record)
        elif isinstance(record, BearingTracks | FrequencyLines):
            view = self._places.view(record.sensor, record.stamp)
            if view is None:
                return
            if isinstance(record, BearingTracks):
                self._log.add_bearings(record, view)
            else:
                self._log.add_lines(record, view)
        elif isinstance(record, PositionTracks):
            solved = np.isin(record.source, list(_SOLVED)) & record.established
            last = self._solutions.setdefault(topic, {}) if solved.any() else {}
            for row in np.flatnonzero(solved):
                last[int(record.id[row])] = record, int(row)

    def dots(self) -> tuple[TrackDots, ...]:
        """Return the dots of the tracks with the most, of the fused list if there is one."""
        fused = {topic: last for topic, last in self._solutions.items() if _is_fused(last)}
        found = []
        for topic, last in (fused or self._solutions).items():
            many = len(fused or self._solutions) > 1
            for identifier, (tracks, row) in last.items():
                stacks = solution_dots(tracks, row, self._log)
                name = f"{topic.lstrip('/')} {identifier}" if many else str(identifier)
                if stacks:
                    found.append(TrackDots(name, stacks))
        found.sort(key=lambda track: -sum(len(stack.stamps) for stack in track.stacks))
        return tuple(found[:MOST_TRACKS])


def _is_fused(last: dict[int, tuple[PositionTracks, int]]) -> bool:
    return any(tracks.source[row] == TrackSource.FUSED for tracks, row in last.values())
