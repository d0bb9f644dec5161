"""The misalignment of stations, from the targets that several of them hear.

Beside its solver each target of several stations has a filter of its motion and of the
misalignments of all stations, which takes the azimuths as they are told; what all of them tell of
the misalignments adds up (:mod:`sonar_tracking.alignment.shared_alignment`). It begins with what
each station has heard before they were found to hear the same target, about the solution, but with
a covariance so wide that this counts for nothing. One target alone tells nothing: where it moves
otherwise than it is taken to, as animals do, its bearings look as if a station was turned. So what
two stations find out has to be told by every target without the others; bearings of three must meet
wherever it goes. Near the line between two stations, and close to one, a filter may go astray; it
begins anew where the solver is somewhere else. A crossing that is off by the misalignment is a bad
place to linearise about: once it is known what is kept of the targets is filtered anew.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from typing import NamedTuple

import numpy as np

from sonar_tracking.alignment.aligned_targets import (
    MOTION,
    STRENGTHS,
    AlignedTargets,
    begun,
    joined,
    predicted,
    replaced,
    with_array,
)
from sonar_tracking.alignment.bearing_errors import BearingErrors
from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.alignment.shared_alignment import (
    AlignmentInformation,
    information_of,
    no_information,
    told_alignment,
)
from sonar_tracking.alignment.target_updates import innovations, updated_if_expected
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import NANOSECONDS, UNKNOWN_STAMP
from sonar_tracking.tma.targets.followed_target import FollowedTarget, solver_state
from sonar_tracking.tma.targets.misaligned_stations import (
    Misalignments,
    UsedAlignment,
    misalignments,
)
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution

REMEMBERED = 400
"""Azimuths of a target that are kept."""

LINEAR = 0.01
"""A filter about where misalignments make a target is good as long as these change by less, rad."""

VAGUE = 0.2
"""Standard deviation of the range of a new target, as part of it."""

WITNESSES = 2
"""Targets that must have been followed at once for what they tell to count."""

STATIONS_THAT_MEET = 3
"""So many bearings of one target meet in a point, or show that a station is turned."""

LOST = 12.5
"""Squared distance per dimension beyond which a filter and a solver are not at one place."""

GATE = 4.0
"""Standard deviations beyond which an azimuth is of something else."""


class _Heard(NamedTuple):
    """Azimuths of one target as told by a station: few numbers, since many are kept.

    The other azimuth is that of the other side, rad, NaN = none; the track is the station's.
    """

    stamp: int
    sensor_id: str
    track: int
    azimuth: float
    other: float
    variance: float
    place: tuple[float, float]
    speed: float


def _heard(observation: TargetObservation, track: int) -> _Heard:
    azimuth, other = (*observation.azimuths, np.nan)[:2]
    return _Heard(
        *(observation.stamp, observation.sensor_id, track, azimuth, other),
        *(observation.azimuth_variance, observation.position, observation.propagation_speed),
    )


class StationAlignment:
    """Estimates the misalignments of all stations.

    Parameters
    ----------
    deviation : float
        Of the misalignment of a station that is misaligned, rad; 0 = none is.
    lasting : float
        Of what is left of it where a station is aligned, rad.
    maximum_speed : float
        Of targets, per axis, m/s.
    """

    def __init__(self, deviation: float, lasting: float, maximum_speed: float) -> None:
        self._prior, self._lasting = deviation**2, lasting**2
        self._speed = maximum_speed
        self.stations: dict[str, int] = {}
        self._errors: list[BearingErrors] = []
        self._targets: list[FollowedTarget] = []
        self._aligned = begun(np.empty((0, 4)), np.empty((0, 4, 4)), STRENGTHS, np.empty(0))
        self._ended = no_information(0)
        self._most_at_once = 0
        self._linearised = np.empty(0)
        self._stamp = UNKNOWN_STAMP
        self._logs: dict[FollowedTarget, deque[_Heard]] = {}

    def take(
        self, seen: Sequence[tuple[FollowedTarget, TargetObservation]], used: UsedAlignment
    ) -> None:
        """Take in what one station observed of targets at one instant, as told.

        Parameters
        ----------
        seen : sequence of FollowedTarget and TargetObservation
            The targets, whose solvers have taken in the same.
        used : UsedAlignment
            How their solvers take stations to be turned.
        """
        heard = [one for one in seen if one[1].azimuths]
        if not heard or not self._prior:
            return
        sensor, stamp = heard[0][1].sensor_id, heard[0][1].stamp
        self._know(sensor)
        followed = []
        for target, observation in heard:
            own = _heard(observation, target.members.get(sensor, 0))
            self._logs.setdefault(target, deque(maxlen=REMEMBERED)).append(own)
            if target in self._targets:
                followed.append((self._targets.index(target), own))
        if followed:
            self._predict(stamp)
            rows = np.array([row for row, _ in followed])
            updated = self._updated(self._aligned.rows(rows), [own for _, own in followed])
            self._aligned = replaced(self._aligned, rows, updated)
            self._begin_lost_anew(rows.tolist(), used)

    def _begin_lost_anew(self, rows: Sequence[int], used: UsedAlignment) -> None:
        """Begin filters anew that are not where the solvers are, with stations turned alike.

        Near the line between two stations, and close to one, a filter that is linearised about a
        misalignment may go astray, and what it tells of the misalignment with it.
        """
        turned = used.turned(list(self.stations))
        mean, covariance = self._aligned.rows(np.array(rows, np.intp)).collapsed()
        known = np.zeros((len(turned), len(turned)))
        mean, covariance = told_alignment(mean, covariance, turned, known)
        for row, own, spread in zip(rows, mean[:, :2], covariance[:, :2, :2], strict=True):
            target = self._targets[row]
            solved = solver_state(target)
            if solved is None or len(target.members) >= STATIONS_THAT_MEET:
                continue
            apart = own - solved.mean[:2]
            if normalised_squared(apart, spread + solved.covariance[:2, :2]) > LOST:
                log = self._logs[target]
                vague = self._vague(solved.mean, log)
                self._aligned = replaced(self._aligned, np.array([row]), vague)
                log.clear()

    def _vague(self, state: FloatArray, log: Sequence[_Heard]) -> AlignedTargets:
        """Return a target about x, y, vx, vy, of which so little is known that it counts not."""
        places = np.array([one.place for one in log])
        distance = float(np.max(np.hypot(*(state[:2] - places).T)))
        spread = np.diag(np.repeat([(VAGUE * distance) ** 2, self._speed**2 / 3.0], 2))
        prior = np.full(len(self.stations), self._prior)
        return begun(state[None], spread[None], STRENGTHS, prior)

    def begin(
        self, first: FollowedTarget, second: FollowedTarget, solution: TargetSolution
    ) -> None:
        """Follow a target that two stations have been found to hear."""
        if first in self._targets:
            return
        logs = [self._logs.pop(one, deque()) for one in (first, second)]
        if not all(logs):
            return
        start = max(log[0].stamp for log in logs)
        heard = [one for log in logs for one in log if one.stamp >= start]
        heard.sort(key=lambda one: (one.stamp, one.sensor_id))
        self._logs[first] = deque(heard, maxlen=REMEMBERED)
        self._targets.append(first)
        self._most_at_once = max(self._most_at_once, len(self._targets))
        self._aligned = joined(self._aligned, self._filtered(first, solution.mean, solution.stamp))

    def _filtered(self, target: FollowedTarget, state: FloatArray, stamp: int) -> AlignedTargets:
        """Return a target after what is kept of it, about its x, y, vx, vy at a stamp, ns."""
        log = self._logs[target]
        start = log[0].stamp
        state = state.copy()
        state[:2] -= (stamp - start) / NANOSECONDS * state[2:]
        filtered = self._vague(state, log)
        for one in log:
            now = one.stamp
            filtered = predicted(filtered, (now - start) / NANOSECONDS, STRENGTHS)
            filtered, start = self._updated(filtered, [one], learns=False), now
        self._predict(max(start, self._stamp))
        return predicted(filtered, (self._stamp - start) / NANOSECONDS, STRENGTHS)

    def end(self, target: FollowedTarget, trusted: bool = True) -> None:
        """Follow a target no longer, and keep what it has told if that is trusted."""
        self._logs.pop(target, None)
        if target not in self._targets:
            return
        row = self._targets.index(target)
        if trusted:
            mean, covariance = self._aligned.rows(np.array([row])).collapsed()
            told = information_of(mean, covariance, np.full(len(self.stations), self._prior))
            self._ended = self._ended.plus(told)
        self._targets.remove(target)
        left = np.delete(np.arange(len(self._aligned)), row)
        self._aligned = self._aligned.rows(left)

    def found(self) -> Misalignments:
        """Return what is known of the misalignments of :attr:`stations`."""
        found = self._found()
        if found.found and np.any(np.abs(found.mean - self._linearised) > LINEAR):
            self._linearise(found)
            found = self._found()
        return found

    def _linearise(self, found: Misalignments) -> None:
        """Filter what is kept of the targets anew, about where misalignments found make them."""
        states = self.states(found, self._stamp)
        self._linearised = found.mean
        # What targets have told that are no more was found about wrong places, and is not kept.
        self._ended = no_information(len(self.stations))
        for row, (target, state) in enumerate(states.items()):
            if self._logs[target]:
                anew = self._filtered(target, state.mean, self._stamp)
                self._aligned = replaced(self._aligned, np.array([row]), anew)

    def _found(self) -> Misalignments:
        """Return what all targets tell, or all but the one without which most speaks for aligned.

        Two stations show by the motion of a target alone that one is turned, and what a single
        target tells may be of itself: it does not move as it is taken to. Bearings of three must
        meet wherever it goes.
        """
        nothing = no_information(len(self.stations))
        if self._most_at_once < WITNESSES:
            return misalignments(nothing, self._prior, self._lasting)
        mean, covariance = self._aligned.collapsed()
        prior = np.full(len(self.stations), self._prior)
        each = [
            information_of(mean[row, None], covariance[row, None], prior)
            for row in range(len(self._targets))
        ]
        told = [self._ended, *each]
        doubtful = [
            one
            for target, one in zip(self._targets, each, strict=True)
            if len(target.members) < STATIONS_THAT_MEET
        ]
        without = [[one for one in told if one is not left] for left in doubtful]
        choices = [
            misalignments(
                reduce(AlignmentInformation.plus, some, nothing), self._prior, self._lasting
            )
            for some in (told, *without)
        ]
        most_aligned = max(choices, key=lambda one: one.aligned)
        return choices[0] if most_aligned.aligned < 0.5 else most_aligned

    def states(self, found: Misalignments, stamp: int) -> dict[FollowedTarget, KalmanState]:
        """Return x, y, vx, vy of the targets at a stamp, ns, as misalignments found make them."""
        if not self._targets:
            return {}
        self._predict(max(stamp, self._stamp))
        mean, covariance = self._aligned.collapsed()
        mean, covariance = told_alignment(mean, covariance, found.mean, found.covariance)
        states = zip(mean[:, :MOTION], covariance[:, :MOTION, :MOTION], strict=True)
        return {
            target: KalmanState(*state) for target, state in zip(self._targets, states, strict=True)
        }

    def _know(self, sensor_id: str) -> None:
        if sensor_id not in self.stations:
            self.stations[sensor_id] = len(self.stations)
            self._errors.append(BearingErrors())
            self._linearised = np.append(self._linearised, 0.0)
            self._aligned = with_array(self._aligned, self._prior)
            self._ended = self._ended.with_array()

    def _predict(self, stamp: int) -> None:
        interval = (stamp - self._stamp) / NANOSECONDS
        self._aligned = predicted(self._aligned, interval, STRENGTHS)
        self._stamp = stamp

    def _updated(
        self, targets: AlignedTargets, heard: list[_Heard], learns: bool = True
    ) -> AlignedTargets:
        """Return targets with an azimuth each of one station, at their instant."""
        first = heard[0]
        station = self.stations[first.sensor_id]
        told = np.array([one.variance for one in heard])
        bearings = Bearings(
            azimuth=np.array([one.azimuth for one in heard]),
            variance=told,
            station=np.array(first.place),
            array=station,
            propagation_speed=first.speed,
        )
        bearings = _nearer_sides(bearings, targets, heard)
        innovation, predicted_variance = innovations(targets, bearings)
        errors = self._errors[station]
        scaled = replace(bearings, variance=errors.scale * told)
        updated, _ = updated_if_expected(targets, scaled, innovation, predicted_variance, GATE)
        if learns:
            keys = [(first.sensor_id, one.track) for one in heard]
            errors.learn(keys, innovation, predicted_variance, told)
        return updated


def _nearer_sides(bearings: Bearings, targets: AlignedTargets, heard: list[_Heard]) -> Bearings:
    """Return bearings of the sides of line arrays that are nearer to what is expected."""
    other = np.array([one.other for one in heard])
    if np.all(np.isnan(other)):
        return bearings
    innovation, _ = innovations(targets, bearings)
    there = wrap_angle(other - (bearings.azimuth - innovation))
    swapped = np.abs(there) < np.abs(innovation)
    return replace(
        bearings,
        azimuth=np.where(swapped, other, bearings.azimuth),
        other_side=np.where(swapped, bearings.azimuth, other),
    )
