"""True bearings at the instants of the tracks, from truth sampled at other instants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.truth_samples import TruthSamples
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IdArray
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.time import seconds


@dataclass(frozen=True)
class TrueBearings:
    """True bearings at one instant.

    Attributes
    ----------
    id : ndarray of uint64, shape (n_targets,)
        Identifiers of the targets.
    angle, rate : ndarray, shape (n_targets,)
        rad and rad/s.
    """

    id: IdArray
    angle: FloatArray
    rate: FloatArray


class BearingTruth:
    """Truth of a run, interpolated linearly between its samples.

    Parameters
    ----------
    samples : sequence of BearingTracks
        Truth at increasing stamps.

    Attributes
    ----------
    samples : TruthSamples
        Those that are known.
    """

    def __init__(self, samples: Sequence[BearingTracks] = ()) -> None:
        self.samples = TruthSamples(samples)
        self._asked: dict[int, TrueBearings] = {}

    def add(self, sample: BearingTracks) -> None:
        """Take one more sample, the next in time."""
        self.samples.add(sample)
        self._asked.clear()

    def first_seen(self) -> dict[int, int]:
        """Return the stamp (ns) of the first appearance of each target."""
        return self.samples.first_seen()

    def at(self, stamp: int) -> TrueBearings | None:
        """Return the truth at an instant, or None if the samples do not reach it.

        Between two samples a target is there if it is in both. Beyond the last sample its rate
        carries on for as long as the last two samples are apart. What was asked for before is
        known: several runs, and several figures of each, ask for the same instants.
        """
        if (known := self._asked.get(stamp)) is not None:
            return known
        if (true := self._interpolated(stamp)) is not None:
            self._asked[stamp] = true
        return true

    def _interpolated(self, stamp: int) -> TrueBearings | None:
        around = self.samples.around(stamp)
        if around is None:
            return None
        before, after = around
        if after is not None:
            return _between(before, after, stamp)
        elapsed = seconds(stamp - before.stamp)
        angle = before.arrival_angle
        if elapsed > 0.0:
            angle = angle + elapsed * before.arrival_angle_rate
        return TrueBearings(before.id, angle, before.arrival_angle_rate)


def _between(before: BearingTracks, after: BearingTracks, stamp: int) -> TrueBearings:
    identifiers, rows, columns = np.intersect1d(before.id, after.id, return_indices=True)
    share = (stamp - before.stamp) / (after.stamp - before.stamp)
    start, start_rate = before.arrival_angle[rows], before.arrival_angle_rate[rows]
    change = wrap_angle(after.arrival_angle[columns] - start)
    rate = start_rate + share * (after.arrival_angle_rate[columns] - start_rate)
    return TrueBearings(identifiers, start + share * change, rate)
