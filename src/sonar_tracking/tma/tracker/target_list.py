"""The targets of target motion analysis: which there are, of which bearing tracks, in which rows.

A target begins with a bearing track and ends with its last one. Targets of several stations that
turn out to be one go on in one solver; while the side of a line array is open, both are rows.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import InputError, Notice
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import UNKNOWN_STAMP, common_watermark, nanoseconds
from sonar_tracking.tma.stations.station_alignment import StationAlignment
from sonar_tracking.tma.stations.station_pairing import Pair, StationPairing
from sonar_tracking.tma.targets.array_sides import LEFT, RIGHT
from sonar_tracking.tma.targets.followed_target import SILENCE, FollowedTarget, new_solver
from sonar_tracking.tma.targets.misaligned_stations import ALIGNED, Misalignments, UsedAlignment
from sonar_tracking.tma.targets.silent_targets import KnownBefore
from sonar_tracking.tma.targets.station_view import StationRecord
from sonar_tracking.tma.targets.target_records import TargetSolution
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.target_notices import misled
from sonar_tracking.tma.tracker.track_rows import TrackRow, track_list, track_row

TrackKey = tuple[str, int]
"""Station and its bearing track."""

RELEASED_AFTER = 10
"""A station whose azimuths do not fit so many times in a row sees another target."""


NOTICEABLE = 0.1
"""Standard deviations by which a misalignment changes before it is used as it is known now."""


class TargetList:
    """All targets, and the rows of the last list.

    Parameters
    ----------
    configuration : TmaTrackerConfiguration
        Its parameters; those declared changeable may differ in another put in its place later.
    n_stations : int
        Stations that report bearing tracks.
    """

    def __init__(self, configuration: TmaTrackerConfiguration, n_stations: int) -> None:
        self.configuration = configuration
        self._n_stations = n_stations
        self._next_id = configuration.first_id
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
        self._dismissed: set[TrackKey] = set()
        self._targets: list[FollowedTarget] = []
        self._ended: list[TrackRow] = []
        self._pairing = StationPairing(
            self.configuration.association_odds, self.configuration.systematic_errors.deviation
        )
        self._alignment = StationAlignment(
            self.configuration.alignment_deviation,
            self.configuration.systematic_errors.deviation,
            self.configuration.maximum_speed,
        )
        self._used = ALIGNED
        self._known_before = KnownBefore()

    def end_track(self, number: int) -> None:
        """End the target of a row since an operator says so; its bearing tracks start no other.

        Parameters
        ----------
        number : int
            Identifier of the row; both sides of a target end.

        Raises
        ------
        InputError
            If there is no such row.
        """
        target, _ = self._target_of_row(number)
        for key in list(target.members.items()):
            del self._target_of[key]
            self._dismissed.add(key)
        self._end(target)

    def choose_side(self, number: int, side: str) -> None:
        """Leave a target on one side of the line array only, since an operator knows.

        Parameters
        ----------
        number : int
            Identifier of a row of the target, on whatever side.
        side : str
            ``left`` or ``right``.

        Raises
        ------
        InputError
            If there is no such row, or the side is not open.
        """
        target, own = self._target_of_row(number)
        sides = [solution.side for solution in target.solutions]
        if side not in sides or len(sides) == 1:
            raise InputError(
                f"the side of track {number} is not open; it is {own} of the array."
                if own in (LEFT, RIGHT)
                else f"track {number} has no side: its bearings are not ambiguous."
            )
        target.solver.choose_side(side)
        self._pairing.choose_side(target, side)
        self._replace(target, target.solver.solutions())
        target.judge(self.configuration)

    def _target_of_row(self, number: int) -> tuple[FollowedTarget, str]:
        """Return the target of a row, and its side."""
        for target in self._targets:
            for side, row in target.row_of.items():
                if row == number:
                    return target, side
        rows = sorted(row for target in self._targets for row in target.row_of.values())
        raise InputError(
            f"there is no track {number}; there are {', '.join(map(str, rows)) or 'none'}."
        )

    def _begin(self, key: TrackKey) -> None:
        target = FollowedTarget(
            solver=new_solver(self.configuration, self._n_stations),
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
        if len(target.members) == 1:
            self._alignment.end(target)
        if target.members:
            target.bearing_track_id = next(iter(target.members.values()))
        elif self.configuration.coast_duration == 0.0:
            self._end(target)

    def _end(self, target: FollowedTarget) -> None:
        self._targets.remove(target)
        self._pairing.end(target)
        self._alignment.end(target)
        self._known_before.end(target)
        self._replace(target, ())

    def _replace(self, target: FollowedTarget, solutions: tuple[TargetSolution, ...]) -> None:
        """Set the solutions of a target; of sides that are no more the list tells once."""
        staying = {solution.side for solution in solutions}
        for solution in target.solutions:
            if solution.side in target.row_of and solution.side not in staying:
                self._ended.append(self._row(target, solution, TrackStatus.TERMINATED))
                del target.row_of[solution.side]
        target.take(solutions, self.configuration, self._used)

    def _end_coasted(self) -> None:
        for target in [one for one in self._targets if not one.members]:
            alone = self._stamp - max(target.updated, target.forsaken)
            if alone > nanoseconds(target.patience(self.configuration)):
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
        solutions = pair.solver.solutions()
        if len(solutions) == 1:
            self._alignment.begin(first, second, solutions[0])
        self._replace(first, solutions)
        first.judge(self.configuration)
        self._end(second)

    def _release_misfits(self) -> None:
        """Give a station that sees another target than the rest its own again."""
        for target in self._targets:
            for sensor, count in list(target.misfits.items()):
                if count >= RELEASED_AFTER and len(target.members) > 1:
                    key = (sensor, target.members[sensor])
                    self._alignment.end(target, trusted=False)
                    self._leave(key)
                    target.misfits = {}

    def _forsake_misled(self, notices: list[Notice]) -> None:
        """Let confirmed targets go on without bearings that are of something else by now.

        What these were taken for instead ends when they jump again: they may have come back.
        """
        self._doubted = {key: end for key, end in self._doubted.items() if end > self._stamp}
        waiting = any(one.forsaken > 0 for one in self._targets)
        for target in [one for one in self._targets if one.misled]:
            if not target.confirmed and not waiting:
                continue
            for key in target.members.items():
                del self._target_of[key]
                if target.confirmed:
                    self._doubted[key] = self._stamp + nanoseconds(SILENCE)
            if target.confirmed:
                notices.append(misled(target))
                target.forsake(self._stamp)
            else:
                self._end(target)

    def _use_alignment(self) -> Misalignments:
        """Return the misalignments; once some is found targets are where they make them."""
        found = self._alignment.found()
        stations, used = tuple(self._alignment.stations), self._used
        if not (found.found or used.sensor_id):
            return found
        states = self._alignment.states(found, self._stamp)
        change = UsedAlignment(stations, found.mean - used.turned(stations), found.covariance)
        if np.any(np.abs(change.mean) > NOTICEABLE * found.deviation):
            self._used = UsedAlignment(stations, found.mean, found.covariance)
            for target in self._targets:
                target.realign(change, states.get(target))
                if target.solutions:
                    self._replace(target, target.solver.solutions())
        for target, state in states.items():
            target.adopt(state, self._stamp, self.configuration)
        return found

    def unseen_turns(self) -> dict[int, float]:
        """Return by confirmed row how long a turn of its target would not be seen, s.

        So long a row may be wrong by more than its covariance tells.
        """
        sure = [one for one in self._targets if one.confirmed and len(one.solutions) == 1]
        times = [(one.row_of.get(one.best.side), one.watches.unseen(one.best)) for one in sure]
        return {row: time for row, time in times if row is not None}

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
