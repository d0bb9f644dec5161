"""What the stations observed along each of their bearing tracks, over a whole recording."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.tma.targets.bearing_observations import (
    bare_observation,
    lines_of,
    observation_of,
    with_lines,
)
from sonar_tracking.tma.targets.line_attribution import LineAttribution, TrackAngle
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.station_view import station_view, track_angles
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

TrackKey = tuple[str, int]
"""Station and its bearing track."""

Observations = dict[TrackKey, dict[int, TargetObservation]]
"""What was observed along each bearing track, by stamp (ns)."""


class ObservationLog:
    """Collects observations, frame by frame, as target motion analysis takes them.

    Parameters
    ----------
    configuration : TmaTrackerConfiguration
        Mounting, floors, defaults.

    Attributes
    ----------
    observations : dict
        See :data:`Observations`.
    problems : dict of str to int
        Why something was left out, and how often.
    """

    def __init__(self, configuration: TmaTrackerConfiguration) -> None:
        self._configuration = configuration
        self._attribution = LineAttribution(configuration.attribution_gate)
        self._angles: dict[str, dict[int, TrackAngle]] = {}
        self.observations: Observations = {}
        self.problems: dict[str, int] = {}

    def add_all(self, frames: Iterable[PassiveFrame]) -> None:
        """Take the frames of a recording, in order of their stamps."""
        for frame in frames:
            for bearings in frame.bearings:
                self._add_bearings(bearings, frame.own_ship)
            for lines in frame.lines:
                self._add_lines(lines, frame.own_ship)

    def _add_bearings(self, bearings: BearingTracks, own_ship: KinematicState | None) -> None:
        sensor = bearings.sensor.sensor_id
        try:
            view = station_view(bearings.sensor, own_ship, self._configuration)
        except InputError as error:
            self._leave_out(str(error))
            self._angles[sensor] = {}
            return
        self._angles[sensor] = track_angles(bearings, view)
        for row in np.flatnonzero(bearings.status != TrackStatus.TERMINATED):
            observation, problem = observation_of(bearings, int(row), view, self._configuration)
            if problem:
                self._leave_out(f"{sensor}: {problem}")
            key = (sensor, int(bearings.id[row]))
            if observation.azimuths or np.isfinite(observation.elevation):
                self.observations.setdefault(key, {}).setdefault(bearings.stamp, observation)

    def _add_lines(self, lines: FrequencyLines, own_ship: KinematicState | None) -> None:
        sensor = lines.sensor.sensor_id
        tracks = self._attribution.update(lines, self._angles.get(sensor, {}))
        heard, problem = lines_of(lines, tracks)
        if problem:
            self._leave_out(f"{sensor}: {problem}")
        for track, own in heard.items():
            along = self.observations.setdefault((sensor, track), {})
            before = along.get(lines.stamp)
            if before is None:
                try:
                    view = station_view(lines.sensor, own_ship, self._configuration)
                except InputError as error:
                    self._leave_out(str(error))
                    return
                before = bare_observation(lines.stamp, view, self._configuration)
            along[lines.stamp] = with_lines(before, own)

    def _leave_out(self, problem: str) -> None:
        self.problems[problem] = self.problems.get(problem, 0) + 1
