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
    replaced,
    with_array,
    with_arrays,
)
from sonar_tracking.alignment.bearing_errors import BearingErrors
from sonar_tracking.alignment.shared_alignment import (
    AlignmentInformation,
    SharedAlignment,
    ToldOfArrays,
    information_of,
    log_agreement,
    no_information,
    shared_alignment,
)
from sonar_tracking.alignment.target_updates import (
    expected_azimuths,
    updated_by_positions,
    updated_if_expected,
)
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.bearing_trials import GATE, BearingTrials, Trial
from sonar_tracking.fusion.bearing_update import BearingUpdate
from sonar_tracking.fusion.exchanges import ECHOES, Exchange, Exchanges
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.lone_bearings import guarded
from sonar_tracking.fusion.sided_bearings import expected_bearings, sided_bearings
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.arrays import FloatArray, IndexArray

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

    Attributes
    ----------
    targets : list of FusedTarget
        All of known position.
    aligned, echoes_alone : AlignedTargets
        Their filters: with all that was measured of them, and with echoes alone.
    ended : AlignmentInformation
        What targets that are no more have told.
    """

    def __init__(
        self, strengths: MotionStrengths, alignment_variance: float, propagation_speed: float
    ) -> None:
        self.strengths = strengths
        self._variance = max(alignment_variance, SMALLEST_VARIANCE)
        self.propagation_speed = propagation_speed
        self.ended = no_information(0)
        self.arrays: dict[str, int] = {}
        self._errors: list[BearingErrors] = []
        self.targets: list[FusedTarget] = []
        self.aligned = begun(np.empty((0, 4)), np.empty((0, 4, 4)), strengths, np.empty(0))
        self.echoes_alone = self.aligned
        self._seen: tuple[AlignedTargets, AlignmentInformation, SharedAlignment] | None = None
        self.trials = BearingTrials(self.aligned)
        self.exchanges = Exchanges(self.aligned)

    @property
    def prior(self) -> FloatArray:
        """Variance of each misalignment, shape (n_arrays,), rad^2."""
        return np.full(len(self.arrays), self._variance)

    def array_of(self, sensor_id: str) -> int:
        """Return the number of an array, which is new if it has not been heard of."""
        if sensor_id not in self.arrays:
            self.arrays[sensor_id] = len(self.arrays)
            self._errors.append(BearingErrors())
            self.ended = self.ended.with_array()
            self.aligned = with_array(self.aligned, self._variance)
            self.trials.add_array(self._variance)
            self.exchanges.add_array(self._variance)
        return self.arrays[sensor_id]

    def begin(self, target: FusedTarget, state: FloatArray, covariance: FloatArray) -> None:
        """Follow a new target.

        Parameters
        ----------
        target : FusedTarget
            Which.
        state, covariance : ndarray, shapes (4,) and (4, 4)
            x, y, vx, vy; m and m/s; m^2, m^2/s, m^2/s^2.
        """
        new = begun(state[None], covariance[None], self.strengths, np.empty(0))
        self.targets.append(target)
        self.echoes_alone = joined(self.echoes_alone, new)
        self.aligned = joined(self.aligned, with_arrays(new, self.prior))

    def forget_bearings(self, target: FusedTarget) -> None:
        """Go on with what echoes alone have told of a target: its bearings were of another one."""
        rows = self.rows_of([target])
        new = with_arrays(self.echoes_alone.rows(rows), self.prior)
        self.aligned = replaced(self.aligned, rows, new)
        self.trials.end({target}, set())
        self.exchanges.end({target})

    def end(self, targets: Sequence[FusedTarget]) -> None:
        """Follow some targets no more; what they told of the arrays stays."""
        if not targets:
            return
        rows = self.rows_of(targets)
        mean, covariance = self.aligned.rows(rows).collapsed()
        self.ended = self.ended.plus(information_of(mean, covariance, self.prior))
        kept = np.setdiff1d(np.arange(len(self.targets)), rows)
        self.targets = [self.targets[row] for row in kept]
        self.aligned = self.aligned.rows(kept)
        self.echoes_alone = self.echoes_alone.rows(kept)
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
        rows = self.rows_of(targets)
        updated, likelihood = updated_by_positions(self.aligned.rows(rows), position, noise)
        self.aligned = replaced(self.aligned, rows, updated)
        alone, apart = updated_by_positions(self.echoes_alone.rows(rows), position, noise)
        self.echoes_alone = replaced(self.echoes_alone, rows, alone)
        trials, owner = self._trials_of(targets)
        if trials.size:
            self.trials.take_positions(trials, position[owner], noise[owner])
        likelihood = guarded(likelihood, WILD_POSITION)

        def taking(copies: AlignedTargets, own: IndexArray) -> tuple[AlignedTargets, FloatArray]:
            taken, density = updated_by_positions(copies, position[own], noise[own])
            return taken, guarded(density, WILD_POSITION)

        self.exchanges.take(targets, ECHOES, likelihood, taking)
        return likelihood - guarded(apart, WILD_POSITION)

    def take_updated(
        self,
        targets: Sequence[FusedTarget],
        found: Sequence[HeardBearing],
        update: BearingUpdate,
    ) -> None:
        """Let targets go on as a bearing each, of one station, has updated them.

        A bearing that is not as expected is weighed, but drags no target along: it may be of
        something else.

        Parameters
        ----------
        targets : sequence of FusedTarget
            Each once.
        found : sequence of HeardBearing
            One a target.
        update : BearingUpdate
            What they do to the targets.
        """
        bearings, errors = update.bearings, self._errors[update.bearings.array]
        told = bearings.variance / errors.scale
        errors.learn([one.key for one in found], update.innovation, update.spread, told)
        own = np.flatnonzero(update.is_expected(GATE))
        rows = self.rows_of([targets[row] for row in own.tolist()])
        self.aligned = replaced(self.aligned, rows, update.updated.rows(own))
        trials, owner = self._trials_of([targets[row] for row in own.tolist()])
        if trials.size:
            self.trials.take_known(trials, bearings.rows(own[owner]))

        def taking(copies: AlignedTargets, own: IndexArray) -> tuple[AlignedTargets, FloatArray]:
            told = [found[place] for place in own]
            azimuth, variance = expected_bearings(told, copies, self.propagation_speed)
            sided = sided_bearings(told, azimuth, self.propagation_speed)
            innovation = sided.innovation(azimuth)
            taken, density = updated_if_expected(copies, sided, innovation, variance, GATE)
            return taken, guarded(density)

        self.exchanges.take(targets, found[0].key[0], update.likelihood, taking)

    def widened(self, found: Sequence[HeardBearing]) -> list[HeardBearing]:
        """Return bearings of one station with variances as the innovations so far have shown."""
        if not found:
            return []
        scale = self._errors[found[0].array].scale
        return [one.with_variance(scale * one.variance) for one in found]

    def try_bearings(self, found: Sequence[HeardBearing]) -> None:
        """Let the trials of bearing tracks of one station take in what it measured."""
        if self.trials.trials:
            self.trials.take_tried(found, self._told(), self.prior, self.propagation_speed)

    def begin_trials(self, trials: Sequence[Trial]) -> None:
        """Try whether bearing tracks are of targets."""
        if trials:
            targets = [one.target for one in trials]
            self.trials.begin(trials, self.aligned.rows(self.rows_of(targets)))

    def consider(self, exchanges: Sequence[Exchange]) -> None:
        """Consider whether targets have exchanged tracks."""
        if exchanges:
            rows = self.rows_of([target for one in exchanges for target in one.pair])
            self.exchanges.begin(exchanges, self.aligned.rows(rows))

    def exchanged(self, exchange: Exchange, copies: AlignedTargets) -> None:
        """Let the targets of an exchange go on as the copies that have taken it in."""
        self.aligned = replaced(self.aligned, self.rows_of(exchange.pair), copies)
        if exchange.source is ECHOES:
            rows = self.rows_of(exchange.pair)
            crossed = self.echoes_alone.rows(rows[::-1])
            self.echoes_alone = replaced(self.echoes_alone, rows, crossed)
        self.trials.end(set(exchange.pair), set())
        self.exchanges.end(set(exchange.pair))

    def accept(self, row: int) -> Trial:
        """Let a trial have won: its target goes on with what the trial has taken in."""
        trial = self.trials.trials[row]
        won = self.trials.targets.rows(np.array([row]))
        self.aligned = replaced(self.aligned, self.rows_of([trial.target]), won)
        self.trials.end(set(), {trial.key})
        self.trials.drop_rivals(trial)
        rest = self.trials.rows_of(trial.target)
        self.trials.targets = replaced(
            self.trials.targets, rest, won.rows(np.zeros(len(rest), int))
        )
        return trial

    def state_of(self, target: FusedTarget) -> KalmanState:
        """Return the motion of a target, as all tell together: x, y, vx, vy, m and m/s."""
        seen, (row,) = self.picture(), self.rows_of([target])
        return KalmanState(seen.mean[row, :MOTION], seen.covariance[row, :MOTION, :MOTION])

    def picture(self) -> SharedAlignment:
        """Return what all targets tell together: computed once as long as nothing changes."""
        if not self.is_seen:
            self.see(shared_alignment(self.aligned, self.ended, self.prior))
        assert self._seen is not None
        return self._seen[2]

    @property
    def is_seen(self) -> bool:
        """Whether it is known what all targets tell together."""
        seen = self._seen
        return seen is not None and seen[0] is self.aligned and seen[1] is self.ended

    def see(self, seen: SharedAlignment) -> None:
        """Remember what all targets, as they are now, tell together."""
        self._seen = self.aligned, self.ended, seen

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
        seen, speed = self.picture(), self.propagation_speed
        where = heard.station, heard.array, speed, heard.lag
        return expected_azimuths(seen.mean, seen.covariance, *where)

    def _told(self) -> dict[FusedTarget, ToldOfArrays]:
        """Return for each target what all others tell of the misalignments."""
        mean, covariance = self.aligned.collapsed()
        each = [
            information_of(mean[row, None], covariance[row, None], self.prior)
            for row in range(len(self.targets))
        ]
        together = reduce(AlignmentInformation.plus, each, self.ended)
        told = {}
        for target, own in zip(self.targets, each, strict=True):
            others = together.without(own)
            told[target] = ToldOfArrays(others, log_agreement(own, others, self.prior))
        return told

    def rows_of(self, targets: Sequence[FusedTarget]) -> IndexArray:
        """Return the rows of some targets among all, shape (n,)."""
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
