"""The stage of target motion analysis: bearing tracks and lines in, positions out.

Every bearing track is followed by a solver of its own from its first usable bearing on, and ends
with it. Targets of several stations that turn out to be one go on in one solver. While the side of
a line array is open, both are rows of the list, with one bearing track. Whatever cannot be used is
left out with a notice, and the targets are predicted.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.errors import InputError, Notice, Severity
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.commands import OwnShipLine
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.time import UNKNOWN_STAMP
from sonar_tracking.tma.targets.bearing_observations import (
    bare_observation,
    left_out,
    lines_of,
    observation_of,
    with_lines,
)
from sonar_tracking.tma.targets.followed_target import new_solver
from sonar_tracking.tma.targets.line_attribution import LineAttribution
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, TmaUpdate
from sonar_tracking.tma.targets.station_view import (
    StationRecord,
    StationView,
    station_view,
    track_angles,
)
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.tma_tracker_configuration import (
    TmaTrackerConfiguration,
    check_tma_tracker,
)
from sonar_tracking.tma.tracker.frame_reading import FrameReading, Observed, SeenTarget
from sonar_tracking.tma.tracker.joint_observation import Outcome, observe_together
from sonar_tracking.tma.tracker.target_list import TargetList, TrackKey
from sonar_tracking.tma.tracker.target_notices import turned, unconfirmed


class TmaTrackerStage(TargetList):
    """Keeps one target per bearing track, or per bearing tracks of several stations.

    Parameters
    ----------
    configuration : TmaTrackerConfiguration
        Its parameters; those declared changeable may differ in another put in its place later.
    n_stations : int
        Stations that report bearing tracks.

    Raises
    ------
    ConfigurationError
        If parameters do not fit together.
    """

    def __init__(
        self, configuration: TmaTrackerConfiguration | None = None, n_stations: int = 1
    ) -> None:
        configuration = configuration or TmaTrackerConfiguration()
        check_tma_tracker(configuration)
        super().__init__(configuration, n_stations)

    def reset(self) -> None:
        """Forget all targets; identifiers go on."""
        super().reset()
        self._attribution = LineAttribution(self.configuration.attribution_gate)
        self._own_ship_lines: tuple[OwnShipLine, ...] = ()

    def mark_own_ship_line(self, line: OwnShipLine) -> None:
        """Use lines no longer that an operator takes for one of own ship."""
        self._own_ship_lines = (*self._own_ship_lines, line)

    def unmark_own_ship_line(self, line: OwnShipLine) -> None:
        """Use lines again that an operator took for one of own ship.

        Parameters
        ----------
        line : OwnShipLine
            Its frequency lies in the marked band.

        Raises
        ------
        InputError
            If there is no mark.
        """
        left = tuple(
            one
            for one in self._own_ship_lines
            if not one.holds(line.frequency, line.sensor_id or one.sensor_id)
        )
        if len(left) == len(self._own_ship_lines):
            marked = ", ".join(f"{one.frequency:g}" for one in self._own_ship_lines) or "none"
            raise InputError(
                f"no line of own ship is marked at {line.frequency:g} Hz; marked are {marked}."
            )
        self._own_ship_lines = left

    def update(self, frame: PassiveFrame) -> TmaUpdate:
        """Take everything of one instant in.

        Parameters
        ----------
        frame : PassiveFrame
            Later than the one before.

        Returns
        -------
        TmaUpdate
            With a list if there were bearing tracks, usable or not.

        Raises
        ------
        InputError
            If the frame is not later; nothing has changed then.
        """
        return update_together([self], [frame])[0]

    def _check_order(self, frame: PassiveFrame) -> None:
        if frame.stamp <= self._stamp:
            raise InputError(
                f"The frame at {frame.stamp} ns is not later than the one before it, at "
                f"{self._stamp} ns; send frames in order."
            )

    def _read(self, frame: PassiveFrame) -> FrameReading:
        """Return what a frame tells of each target, station by station."""
        self._stamp = frame.stamp
        read = FrameReading()
        for unusable in frame.unusable:
            station = self._stations.setdefault(
                unusable.sensor_id, StationRecord(UNKNOWN_STAMP, {})
            )
            station.next_stamp = unusable.next_stamp
        for bearings in frame.bearings:
            self._read_bearings(bearings, frame.own_ship, read.observed, read.born, read.notices)
        for lines in frame.lines:
            self._read_lines(lines, frame.own_ship, read.observed, read.notices)
        return read

    def _finish(self, frame: PassiveFrame, notices: list[Notice]) -> TmaUpdate:
        """Decide what follows from a frame once all targets have taken it in."""
        self._join_stations()
        self._release_misfits()
        self._forsake_misled(notices)
        self._end_coasted()
        alignments = self._aligned(notices)
        tracks = self.picture() if frame.bearings or frame.unusable else None
        return TmaUpdate(tracks, tuple(notices), alignments)

    def _aligned(self, notices: list[Notice]) -> ArrayAlignments | None:
        """Return how stations are turned, and say of which it is certain; None = not estimated."""
        if self.configuration.alignment_deviation == 0.0:
            return None
        found = self._use_alignment()
        stations = tuple(self._alignment.stations)
        alignments = ArrayAlignments(self._stamp, stations, found.mean, found.deviation)
        if found.found:
            notices += turned(alignments)
        return alignments

    def _read_bearings(
        self,
        bearings: BearingTracks,
        own_ship: KinematicState | None,
        observed: dict[TrackKey, TargetObservation],
        born: set[TrackKey],
        notices: list[Notice],
    ) -> None:
        sensor = bearings.sensor.sensor_id
        station = self._stations.setdefault(sensor, StationRecord(UNKNOWN_STAMP, {}))
        station.next_stamp = bearings.next_stamp
        running = bearings.status != TrackStatus.TERMINATED
        alive = {int(number) for number in bearings.id[running]}
        for key in [key for key in self._target_of if key[0] == sensor and key[1] not in alive]:
            self._leave(key)
        try:
            view = station_view(bearings.sensor, own_ship, self.configuration)
        except InputError as error:
            notices.append(Notice(Severity.ERROR, f"data of {sensor}", str(error)))
            station.angles = {}
            return
        station.angles = track_angles(bearings, view)
        for row in np.flatnonzero(running):
            key = (sensor, int(bearings.id[row]))
            observation, problem = observation_of(bearings, int(row), view, self.configuration)
            if problem:
                notices.append(left_out(sensor, problem))
            if key in observed:
                notices.append(left_out(sensor, f"track {key[1]} appears twice"))
                continue
            if key in self._target_of:
                self._target_of[key].existence_probability = float(
                    bearings.existence_probability[row]
                )
                observed[key] = observation
            elif key not in self._dismissed and self._starts(bearings, int(row), observation, view):
                observed[key] = observation
                born.add(key)

    def _starts(
        self, bearings: BearingTracks, row: int, observation: TargetObservation, view: StationView
    ) -> bool:
        """Return whether a bearing track gets a target now."""
        extra = abs(view.turn_rate) * self.configuration.array_lag
        if not observation.azimuths or extra > self.configuration.minimum_azimuth_deviation:
            return False
        return bool(bearings.status[row] == TrackStatus.CONFIRMED)

    def _read_lines(
        self,
        lines: FrequencyLines,
        own_ship: KinematicState | None,
        observed: dict[TrackKey, TargetObservation],
        notices: list[Notice],
    ) -> None:
        sensor = lines.sensor.sensor_id
        if self._own_ship_lines:
            lines = lines.without([self._is_own_ships(sensor, one) for one in lines.frequency])
        angles = self._stations[sensor].angles if sensor in self._stations else {}
        heard, problem = lines_of(lines, self._attribution.update(lines, angles))
        if problem:
            notices.append(left_out(sensor, problem))
        for track, own in heard.items():
            key = (sensor, track)
            if key in observed:
                observed[key] = with_lines(observed[key], own)
            elif key in self._target_of:
                try:
                    view = station_view(lines.sensor, own_ship, self.configuration)
                except InputError as error:
                    notices.append(Notice(Severity.ERROR, f"lines of {sensor}", str(error)))
                    return
                bare = bare_observation(lines.stamp, view, self.configuration)
                observed[key] = with_lines(bare, own)

    def _is_own_ships(self, sensor: str, frequency: float) -> bool:
        return any(one.holds(float(frequency), sensor) for one in self._own_ship_lines)

    def _seen(self, observed: Observed, born: set[TrackKey]) -> list[SeenTarget]:
        """Return the targets of what one station observed, new ones begun."""
        seen = [(key, one) for key, one in observed if one.azimuths or one.line_ids]
        for key, _ in seen:
            if key in born:
                self._begin(key)
        targets = [self._target_of[key] for key, _ in seen]
        heard = [
            (key, target, self._known_before.heard(target, one))
            for (key, one), target in zip(seen, targets, strict=True)
        ]
        return [
            SeenTarget(key, target, one, self._used.corrected(one))
            for key, target, one in heard
            if one.azimuths or one.line_ids
        ]

    def _conclude(
        self, seen: Sequence[SeenTarget], outcomes: Sequence[Outcome], notices: list[Notice]
    ) -> None:
        """Go on with what the targets made of what one station observed."""
        for one, outcome in zip(seen, outcomes, strict=True):
            target = one.target
            try:
                if isinstance(outcome, Exception):
                    raise outcome
                confirmed = target.confirmed
                target.compare(one.corrected, outcome, self.configuration)
                self._replace(target, outcome)
                target.judge(self.configuration)
                if confirmed and not target.confirmed:
                    notices.append(unconfirmed(target))
            except InputError as error:
                notices.append(left_out(one.key[0], str(error).rstrip(".")))
            except np.linalg.LinAlgError:
                text = f"track {one.key[1]} became numerically impossible"
                notices.append(left_out(one.key[0], text))
                self._pairing.end(target)
                target.solver = new_solver(self.configuration, self._n_stations)
        usable = zip(seen, outcomes, strict=True)
        known = [
            (one.target, one.told) for one, found in usable if not isinstance(found, Exception)
        ]
        self._alignment.take(known, self._used)


def update_together(
    stages: Sequence[TmaTrackerStage], frames: Sequence[PassiveFrame]
) -> list[TmaUpdate]:
    """Let several independent stages take a frame each in, as each of them would.

    Parameters
    ----------
    stages : sequence of TmaTrackerStage
        Those of one and the same configuration object are computed at once.
    frames : sequence of PassiveFrame
        One a stage, later than the one before.

    Raises
    ------
    InputError
        If a frame is not later; nothing has changed then.
    """
    for stage, frame in zip(stages, frames, strict=True):
        stage._check_order(frame)
    readings = [stage._read(frame) for stage, frame in zip(stages, frames, strict=True)]
    of_stations = [reading.stations() for reading in readings]
    for number in range(max(map(len, of_stations), default=0)):
        own = [row for row, observed in enumerate(of_stations) if number < len(observed)]
        seen = [stages[row]._seen(of_stations[row][number], readings[row].born) for row in own]
        scenes = [
            ([(one.target, one.corrected) for one in each], stages[row]._pairing)
            for row, each in zip(own, seen, strict=True)
        ]
        for row, each, outcomes in zip(own, seen, observe_together(scenes), strict=True):
            stages[row]._conclude(each, outcomes, readings[row].notices)
    finished = zip(stages, frames, readings, strict=True)
    return [stage._finish(frame, reading.notices) for stage, frame, reading in finished]
