"""The stage of target motion analysis: bearing tracks and lines in, positions out.

Every bearing track is followed by a solver of its own from its first usable bearing on, and ends
with it. Targets of several stations that turn out to be one go on in one solver. While the side of
a line array is open, both are rows of the list, with one bearing track. Whatever cannot be used is
left out with a notice, and the targets are predicted.
"""

from __future__ import annotations

from itertools import groupby

import numpy as np

from sonar_tracking.errors import InputError, Notice, Severity
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import UNKNOWN_STAMP, common_watermark, nanoseconds
from sonar_tracking.tma.targets.bearing_observations import (
    bare_observation,
    left_out,
    lines_of,
    observation_of,
    with_lines,
)
from sonar_tracking.tma.targets.followed_target import SILENCE, FollowedTarget, new_solver
from sonar_tracking.tma.targets.joint_observation import observe_together
from sonar_tracking.tma.targets.line_attribution import LineAttribution
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, TmaUpdate
from sonar_tracking.tma.targets.station_pairing import Pair, StationPairing
from sonar_tracking.tma.targets.station_view import (
    StationRecord,
    StationView,
    station_view,
    track_angles,
)
from sonar_tracking.tma.targets.target_notices import misled, unconfirmed
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
from sonar_tracking.tma.targets.tma_tracker_configuration import (
    TmaTrackerConfiguration,
    check_tma_tracker,
)
from sonar_tracking.tma.targets.track_rows import TrackRow, track_list, track_row

TrackKey = tuple[str, int]
"""Station and its bearing track."""

RELEASED_AFTER = 10
"""A station whose azimuths do not fit so many times in a row sees another target."""


class TmaTrackerStage:
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
        self.configuration = configuration or TmaTrackerConfiguration()
        check_tma_tracker(self.configuration)
        self._n_stations = n_stations
        self._next_id = self.configuration.first_id
        self.reset()

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""
        self._next_id = max(self._next_id, first_id)

    def reset(self) -> None:
        """Forget all targets; identifiers go on."""
        self._stamp = UNKNOWN_STAMP
        self._stations: dict[str, StationRecord] = {}
        self._target_of: dict[TrackKey, FollowedTarget] = {}
        self._doubted: dict[TrackKey, int] = {}
        self._targets: list[FollowedTarget] = []
        self._ended: list[TrackRow] = []
        self._attribution = LineAttribution(self.configuration.attribution_gate)
        self._pairing = StationPairing(self.configuration.association_odds)

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
        if frame.stamp <= self._stamp:
            raise InputError(
                f"The frame at {frame.stamp} ns is not later than the one before it, at "
                f"{self._stamp} ns; send frames in order."
            )
        self._stamp = frame.stamp
        notices: list[Notice] = []
        observed: dict[TrackKey, TargetObservation] = {}
        born: set[TrackKey] = set()
        for unusable in frame.unusable:
            station = self._stations.setdefault(
                unusable.sensor_id, StationRecord(UNKNOWN_STAMP, {})
            )
            station.next_stamp = unusable.next_stamp
        for bearings in frame.bearings:
            self._read_bearings(bearings, frame.own_ship, observed, born, notices)
        for lines in frame.lines:
            self._read_lines(lines, frame.own_ship, observed, notices)
        for _, seen in groupby(observed.items(), key=lambda one: one[0][0]):
            self._observe(list(seen), born, notices)
        self._join_stations()
        self._release_misfits()
        self._forsake_misled(notices)
        self._end_coasted()
        tracks = self.picture() if frame.bearings or frame.unusable else None
        return TmaUpdate(tracks, tuple(notices))

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
            elif self._starts(bearings, int(row), observation, view):
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

    def _observe(
        self,
        observed: list[tuple[TrackKey, TargetObservation]],
        born: set[TrackKey],
        notices: list[Notice],
    ) -> None:
        """Let the targets take in what one station observed."""
        seen = [(key, one) for key, one in observed if one.azimuths or one.line_ids]
        for key, _ in seen:
            if key in born:
                self._begin(key)
        targets = [(self._target_of[key], one) for key, one in seen]
        outcomes = observe_together(targets, self._pairing)
        for (key, observation), (target, _), outcome in zip(seen, targets, outcomes, strict=True):
            try:
                if isinstance(outcome, Exception):
                    raise outcome
                confirmed = target.confirmed
                target.compare(observation, outcome, self.configuration)
                self._replace(target, outcome)
                target.judge(self.configuration)
                if confirmed and not target.confirmed:
                    notices.append(unconfirmed(target))
            except InputError as error:
                notices.append(left_out(key[0], str(error).rstrip(".")))
            except np.linalg.LinAlgError:
                notices.append(left_out(key[0], f"track {key[1]} became numerically impossible"))
                self._pairing.end(target)
                target.solver = new_solver(self.configuration)

    def _begin(self, key: TrackKey) -> None:
        target = FollowedTarget(
            solver=new_solver(self.configuration),
            members={key[0]: key[1]},
            initiated=self._stamp,
            updated=self._stamp,
            bearing_track_id=key[1],
            doubted=self._doubted.get(key, 0),
        )
        if self.configuration.entry.weighs_hypotheses:
            self._pairing.begin(target, self._targets)
        self._targets.append(target)
        self._target_of[key] = target

    def _leave(self, key: TrackKey) -> None:
        """Take a bearing track that has ended from its target, which ends with the last one."""
        target = self._target_of.pop(key)
        del target.members[key[0]]
        if target.members:
            target.bearing_track_id = next(iter(target.members.values()))
        elif self.configuration.coast_duration == 0.0:
            self._end(target)

    def _end(self, target: FollowedTarget) -> None:
        self._targets.remove(target)
        self._pairing.end(target)
        self._replace(target, ())

    def _replace(self, target: FollowedTarget, solutions: tuple[TargetSolution, ...]) -> None:
        """Set the solutions of a target; of sides that are no more the list tells once."""
        staying = {solution.side for solution in solutions}
        for solution in target.solutions:
            if solution.side in target.row_of and solution.side not in staying:
                self._ended.append(self._row(target, solution, TrackStatus.TERMINATED))
                del target.row_of[solution.side]
        target.take(solutions, self.configuration)

    def _end_coasted(self) -> None:
        for target in [one for one in self._targets if not one.members]:
            if self._stamp - target.updated > nanoseconds(target.patience(self.configuration)):
                self._end(target)

    def _join_stations(self) -> None:
        for pair in self._pairing.decide(self._stamp):
            if pair.first in self._targets and pair.second in self._targets:
                self._join(pair)

    def _join(self, pair: Pair) -> None:
        first, second = pair.first, pair.second
        self._pairing.join(pair)
        if not first.members:
            first.bearing_track_id = second.bearing_track_id
        first.members |= second.members
        for key in second.members.items():
            self._target_of[key] = first
        first.solver = pair.solver
        self._replace(first, pair.solver.solutions())
        first.judge(self.configuration)
        self._end(second)

    def _release_misfits(self) -> None:
        """Give a station that sees another target than the rest its own again."""
        for target in self._targets:
            for sensor, count in list(target.misfits.items()):
                if count >= RELEASED_AFTER and len(target.members) > 1:
                    key = (sensor, target.members[sensor])
                    self._leave(key)
                    target.misfits = {}

    def _forsake_misled(self, notices: list[Notice]) -> None:
        """Let confirmed targets go on without bearings that are of something else by now.

        What these were taken for instead ends when they jump again: they may have come back.
        """
        self._doubted = {key: end for key, end in self._doubted.items() if end > self._stamp}
        waiting = any(one.forsaken for one in self._targets)
        for target in [one for one in self._targets if one.misled]:
            if not target.confirmed and not waiting:
                continue
            for key in target.members.items():
                del self._target_of[key]
                if target.confirmed:
                    self._doubted[key] = self._stamp + nanoseconds(SILENCE)
            if target.confirmed:
                notices.append(misled(target))
                target.forsake()
            else:
                self._end(target)

    def picture(self) -> PositionTracks:
        """Return the complete picture at the stamp of the last frame; an ended row appears once."""
        rows = []
        for target in self._targets:
            for solution in target.solutions:
                if solution.side not in target.row_of:
                    target.row_of[solution.side] = self._next_id
                    self._next_id += 1
                status = target.status(solution, self._stamp, self.configuration)
                rows.append(self._row(target, solution, status))
        rows += self._ended
        self._ended = []
        watermarks = [station.next_stamp for station in self._stations.values()]
        next_stamp = common_watermark(watermarks, self._n_stations, self._stamp)
        return track_list(rows, self._stamp, next_stamp)

    def _row(
        self, target: FollowedTarget, solution: TargetSolution, status: TrackStatus
    ) -> TrackRow:
        return track_row(target, solution, status, self._stamp, self.configuration.acceleration)
