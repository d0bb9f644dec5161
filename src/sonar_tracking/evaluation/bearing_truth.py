"""True bearings at the instants of the tracks, from truth sampled at other instants."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.motion import wrap_angle
from sonar_tracking.passive.records import BearingTracks

FloatArray = NDArray[np.float64]


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

    id: NDArray[np.uint64]
    angle: FloatArray
    rate: FloatArray


class BearingTruth:
    """Truth of a run, interpolated linearly between its samples.

    Parameters
    ----------
    samples : sequence of BearingTracks
        Truth at increasing stamps.
    """

    def __init__(self, samples: Sequence[BearingTracks]) -> None:
        by_stamp = {sample.stamp: sample for sample in samples}
        self._stamps = sorted(by_stamp)
        self._samples = [by_stamp[stamp] for stamp in self._stamps]

    def first_seen(self) -> dict[int, int]:
        """Return the stamp (ns) of the first appearance of each target."""
        seen: dict[int, int] = {}
        for sample in self._samples:
            for identifier in sample.id:
                seen.setdefault(int(identifier), sample.stamp)
        return seen

    def at(self, stamp: int) -> TrueBearings | None:
        """Return the truth at an instant, or None if the samples do not reach it.

        Between two samples a target is there if it is in both. Beyond the last sample its rate
        carries on for as long as the last two samples are apart.
        """
        index = bisect_right(self._stamps, stamp) - 1
        if index < 0:
            return None
        before = self._samples[index]
        if before.stamp == stamp:
            return TrueBearings(before.id, before.arrival_angle, before.arrival_angle_rate)
        elapsed = (stamp - before.stamp) * 1e-9
        if index + 1 == len(self._samples):
            reach = before.stamp - self._samples[index - 1].stamp
            if stamp - before.stamp > reach:
                return None
            angle = before.arrival_angle + elapsed * before.arrival_angle_rate
            return TrueBearings(before.id, angle, before.arrival_angle_rate)
        return _between(before, self._samples[index + 1], stamp)


def _between(before: BearingTracks, after: BearingTracks, stamp: int) -> TrueBearings:
    identifiers, rows, columns = np.intersect1d(before.id, after.id, return_indices=True)
    share = (stamp - before.stamp) / (after.stamp - before.stamp)
    start, start_rate = before.arrival_angle[rows], before.arrival_angle_rate[rows]
    change = wrap_angle(after.arrival_angle[columns] - start)
    rate = start_rate + share * (after.arrival_angle_rate[columns] - start_rate)
    return TrueBearings(identifiers, start + share * change, rate)
