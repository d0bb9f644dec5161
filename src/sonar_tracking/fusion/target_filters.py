"""The filters of all targets of known position, and what they tell together of the arrays."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np

from sonar_tracking.alignment.aligned_targets import (
    MOTION,
    AlignedTargets,
    MotionStrengths,
    begun,
    joined,
    predicted,
    replaced,
    with_array,
    with_arrays,
)
from sonar_tracking.alignment.bearing_errors import BearingErrors
from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.alignment.shared_alignment import (
    AlignmentInformation,
    LastSharedAlignment,
    SharedAlignment,
    ToldOfArrays,
    information_of,
    log_agreement,
    no_information,
)
from sonar_tracking.alignment.target_updates import (
    expected_azimuths,
    updated_by_bearings,
    updated_by_positions,
    updated_if_expected,
)
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.bearing_trials import GATE, BearingTrials, Trial
from sonar_tracking.fusion.exchanges import ECHOES, Exchange, Exchanges
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.lone_bearings import guarded
from sonar_tracking.fusion.sided_bearings import expected_bearings, sided_bearings
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

SMALLEST_VARIANCE = 1e-12
"""Of a misalignment that is taken to be none, rad^2."""

WILD_POSITION = 1e-8
"""Density of a measured position that is of something else: anywhere within 10 km, 1/m^2."""


class TargetFilters:
    """One filter a target, and one more for every bearing track that may be of it.

    Parameters
    ----------
    strengths : MotionStrengths
        How targets accelerate.
    alignment_variance : float
        Of an array of which nothing is known, rad^2.
    propagation_speed : float
        Of sound, m/s; inf = targets are heard where they are.
    """

    def __init__(
        self, strengths: MotionStrengths, alignment_variance: float, propagation_speed: float
    ) -> None:
        self._strengths = strengths
        self._variance = max(alignment_variance, SMALLEST_VARIANCE)
        self._speed = propagation_speed
        self._ended = no_information(0)
        self.arrays: dict[str, int] = {}
        self._errors: list[BearingErrors] = []
        self.targets: list[FusedTarget] = []
        self._aligned = begun(np.empty((0, 4)), np.empty((0, 4, 4)), strengths, np.empty(0))
        self._echoes_alone = self._aligned
        self._shared = LastSharedAlignment()
        self.trials = BearingTrials(self._aligned)
        self.exchanges = Exchanges(self._aligned)

    @property
    def prior(self) -> FloatArray:
        """Variance of each misalignment, shape (n_arrays,), rad^2."""
        return np.full(len(self.arrays), self._variance)

    def array_of(self, sensor_id: str) -> int:
        """Return the number of an array, which is new if it has not been heard of."""
        if sensor_id not in self.arrays:
            self.arrays[sensor_id] = len(self.arrays)
            self._errors.append(BearingErrors())
            self._ended = self._ended.with_array()
            self._aligned = with_array(self._aligned, self._variance)
            self.trials.add_array(self._variance)
            self.exchanges.add_array(self._variance)
        return self.arrays[sensor_id]

    def predict(self, interval: float) -> None:
        """Go on by an interval, s."""
        self._aligned = predicted(self._aligned, interval, self._strengths)
        self._echoes_alone = predicted(self._echoes_alone, interval, self._strengths)
        self.trials.predict(interval, self._strengths)
        self.exchanges.predict(interval, self._strengths)

    def begin(self, target: FusedTarget, state: FloatArray, covariance: FloatArray) -> None:
        """Follow a new target.

        Parameters
        ----------
        target : FusedTarget
            Which.
        state, covariance : ndarray, shapes (4,) and (4, 4)
            x, y, vx, vy; m and m/s; m^2, m^2/s, m^2/s^2.
        """
        new = begun(state[None], covariance[None], self._strengths, np.empty(0))
        self.targets.append(target)
        self._echoes_alone = joined(self._echoes_alone, new)
        self._aligned = joined(self._aligned, with_arrays(new, self.prior))

    def forget_bearings(self, target: FusedTarget) -> None:
        """Go on with what echoes alone have told of a target: its bearings were of another one."""
        rows = self._rows([target])
        new = with_arrays(self._echoes_alone.rows(rows), self.prior)
        self._aligned = replaced(self._aligned, rows, new)
        self.trials.end({target}, set())
        self.exchanges.end({target})

    def end(self, targets: Sequence[FusedTarget]) -> None:
        """Follow some targets no more; what they told of the arrays stays."""
        if not targets:
            return
        rows = self._rows(targets)
        mean, covariance = self._aligned.rows(rows).collapsed()
        self._ended = self._ended.plus(information_of(mean, covariance, self.prior))
        kept = np.setdiff1d(np.arange(len(self.targets)), rows)
        self.targets = [self.targets[row] for row in kept]
        self._aligned = self._aligned.rows(kept)
        self._echoes_alone = self._echoes_alone.rows(kept)
        self.trials.end(set(targets), set())
        self.exchanges.end(set(targets))

    def take_positions(
        self, targets: Sequence[FusedTarget], position: FloatArray, noise: FloatArray
    ) -> FloatArray:
        """Let targets take in a measured position each.

        Parameters
        ----------
        targets : sequence of FusedTarget
            Each once.
        position : ndarray, shape (n, 2)
            m.
        noise : ndarray, shape (n, 2, 2)
            m^2.

        Returns
        -------
        ndarray, shape (n,)
            How much likelier each position was with the bearings the target has than by the echoes
            before alone; log of a pure number.
        """
        if not targets:
            return np.empty(0)
        rows = self._rows(targets)
        updated, likelihood = updated_by_positions(self._aligned.rows(rows), position, noise)
        self._aligned = replaced(self._aligned, rows, updated)
        alone, apart = updated_by_positions(self._echoes_alone.rows(rows), position, noise)
        self._echoes_alone = replaced(self._echoes_alone, rows, alone)
        trials, owner = self._trials_of(targets)
        if trials.size:
            self.trials.take_positions(trials, position[owner], noise[owner])
        likelihood = guarded(likelihood, WILD_POSITION)

        def taking(copies: AlignedTargets, own: IndexArray) -> tuple[AlignedTargets, FloatArray]:
            taken, density = updated_by_positions(copies, position[own], noise[own])
            return taken, guarded(density, WILD_POSITION)

        self.exchanges.take(targets, ECHOES, likelihood, taking)
        return likelihood - guarded(apart, WILD_POSITION)

    def take_bearings(
        self, targets: Sequence[FusedTarget], found: Sequence[HeardBearing]
    ) -> tuple[Bearings, FloatArray]:
        """Let targets take in a bearing each, of one station.

        Parameters
        ----------
        targets : sequence of FusedTarget
            Each once.
        found : sequence of HeardBearing
            One a target.

        Returns
        -------
        bearings : Bearings
            On the sides where the targets are.
        log_likelihood : ndarray, shape (n,)
            How likely each was, log of a density, 1/rad.
        """
        rows = self._rows(targets)
        aligned = self._aligned.rows(rows)
        expected, spread = expected_bearings(found, aligned, self._speed)
        bearings = sided_bearings(found, expected, self._speed)
        as_expected = self._learn(found, bearings, bearings.innovation(expected), spread)
        updated, likelihood = updated_by_bearings(aligned, bearings)
        own = np.flatnonzero(as_expected)
        self._aligned = replaced(self._aligned, rows[own], updated.rows(own))
        trials, owner = self._trials_of([targets[row] for row in own.tolist()])
        if trials.size:
            self.trials.take_known(trials, bearings.rows(own[owner]))

        def taking(copies: AlignedTargets, own: IndexArray) -> tuple[AlignedTargets, FloatArray]:
            told = [found[place] for place in own]
            azimuth, variance = expected_bearings(told, copies, self._speed)
            sided = sided_bearings(told, azimuth, self._speed)
            innovation = sided.innovation(azimuth)
            taken, density = updated_if_expected(copies, sided, innovation, variance, GATE)
            return taken, guarded(density)

        self.exchanges.take(targets, found[0].key[0], guarded(likelihood), taking)
        return bearings, likelihood

    def widened(self, found: Sequence[HeardBearing]) -> list[HeardBearing]:
        """Return bearings of one station with variances as the innovations so far have shown."""
        if not found:
            return []
        scale = self._errors[found[0].array].scale
        return [one.with_variance(scale * one.variance) for one in found]

    def _learn(
        self,
        found: Sequence[HeardBearing],
        bearings: Bearings,
        innovation: FloatArray,
        spread: FloatArray,
    ) -> BoolArray:
        """Learn how large the errors of an array are, and return which bearings are expected.

        A bearing that is not is weighed, but drags no target along: it may be of something else.
        """
        errors, keys = self._errors[bearings.array], [one.key for one in found]
        errors.learn(keys, innovation, spread, bearings.variance / errors.scale)
        return np.asarray(innovation**2 <= GATE**2 * (spread + bearings.variance))

    def try_bearings(self, found: Sequence[HeardBearing]) -> None:
        """Let the trials of bearing tracks of one station take in what it measured."""
        if self.trials.trials:
            self.trials.take_tried(found, self._told(), self.prior, self._speed)

    def begin_trials(self, trials: Sequence[Trial]) -> None:
        """Try whether bearing tracks are of targets."""
        if trials:
            targets = [one.target for one in trials]
            self.trials.begin(trials, self._aligned.rows(self._rows(targets)))

    def consider(self, exchanges: Sequence[Exchange]) -> None:
        """Consider whether targets have exchanged tracks."""
        if exchanges:
            rows = self._rows([target for one in exchanges for target in one.pair])
            self.exchanges.begin(exchanges, self._aligned.rows(rows))

    def exchanged(self, exchange: Exchange, copies: AlignedTargets) -> None:
        """Let the targets of an exchange go on as the copies that have taken it in."""
        self._aligned = replaced(self._aligned, self._rows(exchange.pair), copies)
        if exchange.source is ECHOES:
            rows = self._rows(exchange.pair)
            crossed = self._echoes_alone.rows(rows[::-1])
            self._echoes_alone = replaced(self._echoes_alone, rows, crossed)
        self.trials.end(set(exchange.pair), set())
        self.exchanges.end(set(exchange.pair))

    def accept(self, row: int) -> Trial:
        """Let a trial have won: its target goes on with what the trial has taken in."""
        trial = self.trials.trials[row]
        won = self.trials.targets.rows(np.array([row]))
        self._aligned = replaced(self._aligned, self._rows([trial.target]), won)
        self.trials.end(set(), {trial.key})
        self.trials.drop_rivals(trial)
        rest = self.trials.rows_of(trial.target)
        self.trials.targets = replaced(
            self.trials.targets, rest, won.rows(np.zeros(len(rest), int))
        )
        return trial

    def state_of(self, target: FusedTarget) -> KalmanState:
        """Return the motion of a target, as all tell together: x, y, vx, vy, m and m/s."""
        seen, (row,) = self.picture(), self._rows([target])
        return KalmanState(seen.mean[row, :MOTION], seen.covariance[row, :MOTION, :MOTION])

    def picture(self) -> SharedAlignment:
        """Return what all targets tell together."""
        return self._shared.of(self._aligned, self._ended, self.prior)

    def alignments(self, seen: SharedAlignment, stamp: int, next_stamp: int) -> ArrayAlignments:
        """Return what is known of the alignment of each array, with a stamp and watermark, ns."""
        return ArrayAlignments(
            stamp=stamp,
            sensor_id=tuple(self.arrays),
            misalignment=seen.misalignment,
            misalignment_standard_deviation=np.sqrt(np.diagonal(seen.misalignment_covariance)),
            next_stamp=next_stamp,
        )

    def expected(self, heard: HeardBearing) -> tuple[FloatArray, FloatArray]:
        """Return the azimuths that a station will tell of all targets, and their variances.

        Parameters
        ----------
        heard : HeardBearing
            One of its bearings: tells which station, and where it is.

        Returns
        -------
        azimuth, variance : ndarray, shape (n_targets,)
            rad and rad^2.
        """
        seen, (station, array) = self.picture(), (heard.station, heard.array)
        return expected_azimuths(seen.mean, seen.covariance, station, array, self._speed, heard.lag)

    def _told(self) -> dict[FusedTarget, ToldOfArrays]:
        """Return for each target what all others tell of the misalignments."""
        mean, covariance = self._aligned.collapsed()
        each = [
            information_of(mean[row, None], covariance[row, None], self.prior)
            for row in range(len(self.targets))
        ]
        together = reduce(AlignmentInformation.plus, each, self._ended)
        told = {}
        for target, own in zip(self.targets, each, strict=True):
            others = together.without(own)
            told[target] = ToldOfArrays(others, log_agreement(own, others, self.prior))
        return told

    def _rows(self, targets: Sequence[FusedTarget]) -> IndexArray:
        place = {target: row for row, target in enumerate(self.targets)}
        return np.array([place[target] for target in targets], np.intp)

    def _trials_of(self, targets: Sequence[FusedTarget]) -> tuple[IndexArray, IndexArray]:
        """Return the rows of the trials of targets, and the place of each one's target."""
        place = {target: number for number, target in enumerate(targets)}
        found = [
            (row, place[trial.target])
            for row, trial in enumerate(self.trials.trials)
            if trial.target in place
        ]
        rows = np.array(found, np.intp).reshape(-1, 2)
        return rows[:, 0], rows[:, 1]
