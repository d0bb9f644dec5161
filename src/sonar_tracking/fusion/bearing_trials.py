"""Finds out which bearing track is of which target: by trying it.

A trial takes a copy of the target and gives it the bearings of one bearing track; of the two sides
of a line array, that which is nearer. The evidence that both are one is

    log p(bearings | target) - log p(bearings | anywhere, with a rate of their own),

summed innovation by innovation, and what both tell of the misalignments has to agree with what all
other targets tell of them. A trial wins once it beats chance, divided among all targets there
are, and every choice of pairs of that station without it (:mod:`.joint_decisions`)
by the stated odds.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.alignment.aligned_targets import (
    AlignedTargets,
    MotionStrengths,
    joined,
    predicted,
    replaced,
    with_array,
)
from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.alignment.shared_alignment import ToldOfArrays, information_of, log_agreement
from sonar_tracking.alignment.target_updates import updated_by_bearings, updated_by_positions
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.joint_decisions import spoken_for, sure_pairs
from sonar_tracking.fusion.lone_bearings import (
    guarded,
    heard,
    joined_bearings,
    predicted_bearings,
    unheard,
)
from sonar_tracking.fusion.sided_bearings import expected_bearings, sided_bearings
from sonar_tracking.records.arrays import FloatArray, IndexArray

GATE = 4.0
"""Standard deviations within which a bearing may be of a target."""


@dataclass(eq=False)
class Trial:
    """A target and a bearing track that may be of it.

    Attributes
    ----------
    target : FusedTarget
        The target.
    key : BearingKey
        The bearing track.
    innovations : float
        Evidence of the bearings as they were expected, logs of odds.
    agreement : float
        Evidence of what other targets tell of the misalignments, log of odds.
    """

    target: FusedTarget
    key: BearingKey
    innovations: float = 0.0
    agreement: float = 0.0

    @property
    def evidence(self) -> float:
        """That they are one; log of odds."""
        return self.innovations + self.agreement


class BearingTrials:
    """All trials under way.

    Parameters
    ----------
    targets : AlignedTargets
        None yet: tells the number of modes and arrays.
    """

    def __init__(self, targets: AlignedTargets) -> None:
        self.trials: list[Trial] = []
        self.targets = targets
        self._lone = unheard(0)

    def predict(self, interval: float, strengths: MotionStrengths) -> None:
        """Go on by an interval, s."""
        self.targets = predicted(self.targets, interval, strengths)
        self._lone = predicted_bearings(self._lone, interval)

    def add_array(self, variance: float) -> None:
        """Let there be one array more, of prior variance (rad^2)."""
        self.targets = with_array(self.targets, variance)

    def begin(self, trials: Sequence[Trial], copies: AlignedTargets) -> None:
        """Begin trials, from copies of their targets."""
        self.trials += trials
        self.targets = joined(self.targets, copies)
        self._lone = joined_bearings(self._lone, unheard(len(trials)))

    def keep(self, kept: Sequence[int]) -> None:
        """Go on with some of the trials only."""
        rows = np.array(kept, np.intp)
        self.trials = [self.trials[row] for row in rows]
        self.targets, self._lone = self.targets.rows(rows), self._lone.rows(rows)

    def end(self, targets: set[FusedTarget], keys: set[BearingKey]) -> None:
        """Forget the trials of some targets and of some bearing tracks."""
        ended = [one.target in targets or one.key in keys for one in self.trials]
        if any(ended):
            self.keep([row for row, over in enumerate(ended) if not over])

    def drop_rivals(self, winner: Trial) -> None:
        """End the trials of the target of a winner with other bearing tracks of that station."""
        ended = [one.target is winner.target and one.key[0] == winner.key[0] for one in self.trials]
        self.keep([row for row, over in enumerate(ended) if not over])

    def rows_of(self, target: FusedTarget) -> IndexArray:
        """Return the rows of the trials of a target, shape (n_trials,)."""
        return np.array([n for n, one in enumerate(self.trials) if one.target is target], np.intp)

    def take_positions(self, rows: IndexArray, position: FloatArray, noise: FloatArray) -> None:
        """Let trials take in what was measured of their targets.

        Parameters
        ----------
        rows : ndarray of int, shape (n,)
            Which trials.
        position, noise : ndarray, shapes (n, 2) and (n, 2, 2)
            m and m^2.
        """
        updated, _ = updated_by_positions(self.targets.rows(rows), position, noise)
        self.targets = replaced(self.targets, rows, updated)

    def take_known(self, rows: IndexArray, bearings: Bearings) -> None:
        """Let trials, by their rows, shape (n,), take in bearings known to be of their targets."""
        updated, _ = updated_by_bearings(self.targets.rows(rows), bearings)
        self.targets = replaced(self.targets, rows, updated)

    def take_tried(
        self,
        found: Sequence[HeardBearing],
        told: Mapping[FusedTarget, ToldOfArrays],
        prior: FloatArray,
        propagation_speed: float,
    ) -> None:
        """Let trials take in the bearings that are tried, and weigh them.

        Parameters
        ----------
        found : sequence of HeardBearing
            What one station measured at one instant.
        told : mapping of FusedTarget to ToldOfArrays
            What all other targets tell of the misalignments, for each target.
        prior : ndarray, shape (n_arrays,)
            Variances of the misalignments before any measurement, rad^2.
        propagation_speed : float
            Of sound, m/s.
        """
        by_key = {one.key: one for one in found}
        rows = np.array([n for n, one in enumerate(self.trials) if one.key in by_key], np.intp)
        if not rows.size:
            return
        tried = [self.trials[row] for row in rows]
        own = [by_key[one.key] for one in tried]
        targets = self.targets.rows(rows)
        expected, _ = expected_bearings(own, targets, propagation_speed)
        bearings = sided_bearings(own, expected, propagation_speed)
        lone, apart = heard(self._lone.rows(rows), bearings)
        self._lone.mean[rows], self._lone.covariance[rows] = lone.mean, lone.covariance
        updated, together = updated_by_bearings(targets, bearings)
        self.targets = replaced(self.targets, rows, updated)
        gained = guarded(together) - guarded(apart)
        mean, covariance = updated.collapsed()
        for place, (trial, gain) in enumerate(zip(tried, gained.tolist(), strict=True)):
            trial.innovations += gain
            known = told[trial.target]
            tells = information_of(mean[place, None], covariance[place, None], prior)
            trial.agreement = log_agreement(tells, known.others, prior) - known.agreement

    def winners(self, odds: float, n_targets: int) -> list[int]:
        """Return the rows of the trials that have won."""
        least, margin = np.log(odds * max(n_targets, 1)), np.log(odds)
        place = {(one.target, one.key): row for row, one in enumerate(self.trials)}
        return [
            place[targets[row], keys[column]]
            for targets, keys, evidence in self._stations()
            for row, column in sure_pairs(evidence, least, margin)
        ]

    def spoken_for(self, odds: float, n_targets: int) -> set[BearingKey]:
        """Return the bearing tracks that are surely of one of the targets, whichever."""
        margin = np.log(odds * max(n_targets, 1))
        return {
            keys[column]
            for _, keys, evidence in self._stations()
            for column in spoken_for(evidence, margin)
        }

    def _stations(self) -> Iterator[tuple[list[FusedTarget], list[BearingKey], FloatArray]]:
        """Yield the targets, bearing tracks and evidence, (n_targets, n_tracks), by station."""
        by_station: dict[str, list[Trial]] = defaultdict(list)
        for trial in self.trials:
            by_station[trial.key[0]].append(trial)
        for own in by_station.values():
            targets = list(dict.fromkeys(one.target for one in own))
            keys = list(dict.fromkeys(one.key for one in own))
            evidence = np.full((len(targets), len(keys)), -np.inf)
            for one in own:
                evidence[targets.index(one.target), keys.index(one.key)] = one.evidence
            yield targets, keys, evidence

    def give_up(self, odds: float) -> list[Trial]:
        """End the trials that have fallen behind, and return them."""
        lost = [one.evidence < -np.log(odds) for one in self.trials]
        ended = [one for one, behind in zip(self.trials, lost, strict=True) if behind]
        if ended:
            self.keep([row for row, behind in enumerate(lost) if not behind])
        return ended
