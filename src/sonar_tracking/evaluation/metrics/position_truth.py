"""True positions at the instants of the tracks, from truth sampled at other instants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.truth_samples import TruthSamples
from sonar_tracking.records.arrays import FloatArray, IdArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource, TruthTracks
from sonar_tracking.records.time import seconds


@dataclass(frozen=True)
class TruePositions:
    """True positions at one instant.

    Attributes
    ----------
    id : ndarray of uint64, shape (n_targets,)
        Identifiers of the targets.
    state : ndarray, shape (n_targets, 4)
        x, y, vx, vy, m and m/s; a velocity may be NaN.
    z : ndarray, shape (n_targets,)
        Height, m; NaN = not known.
    """

    id: IdArray
    state: FloatArray
    z: FloatArray


class PositionTruth:
    """Truth of a run, interpolated between its samples.

    Between two samples a position follows the cubic that has the position and the velocity of
    both (Hermite), exact for constant acceleration; the straight line where a velocity is not
    known, and for heights.

    Parameters
    ----------
    samples : sequence of PositionTracks
        Truth, at any stamps; targets whose position is not known are left out.

    Attributes
    ----------
    samples : TruthSamples
        Those that are known.
    """

    def __init__(self, samples: Sequence[PositionTracks] = ()) -> None:
        self.samples = TruthSamples([_placed(sample) for sample in samples])

    def add(self, sample: PositionTracks) -> None:
        """Take one more sample, the next in time."""
        self.samples.add(_placed(sample))

    def first_seen(self) -> dict[int, int]:
        """Return the stamp (ns) of the first appearance of each target."""
        return self.samples.first_seen()

    def at(self, stamp: int) -> TruePositions | None:
        """Return the truth at an instant, or None if the samples do not reach it.

        Between two samples a target is there if it is in both. Beyond the last sample its
        velocity carries on for as long as the last two samples are apart.
        """
        around = self.samples.around(stamp)
        if around is None:
            return None
        before, after = around
        if after is not None:
            return _between(before, after, stamp)
        elapsed = seconds(stamp - before.stamp)
        if elapsed == 0.0:
            return TruePositions(before.id, before.state, before.z)
        position, velocity = before.state[:, :2], before.state[:, 2:]
        moved = position + elapsed * np.where(np.isfinite(velocity), velocity, 0.0)
        return TruePositions(before.id, np.concatenate([moved, velocity], axis=-1), before.z)


def _placed(sample: PositionTracks) -> PositionTracks:
    """Return the targets of a sample whose position is known."""
    known = np.all(np.isfinite(sample.state[:, :2]), axis=-1)
    return sample if known.all() else sample.selected(known)


def _between(before: PositionTracks, after: PositionTracks, stamp: int) -> TruePositions:
    identifiers, rows, columns = np.intersect1d(before.id, after.id, return_indices=True)
    duration = seconds(after.stamp - before.stamp)
    share = (stamp - before.stamp) / (after.stamp - before.stamp)
    start, end = before.state[rows], after.state[columns]
    change = end[:, :2] - start[:, :2]
    # Deviations of the velocities at both ends from the mean velocity, as displacements.
    early = duration * start[:, 2:] - change
    late = duration * end[:, 2:] - change
    bend = (1.0 - share) * early - share * late
    slope = (1.0 - 3.0 * share) * (1.0 - share) * early - share * (2.0 - 3.0 * share) * late
    known = np.isfinite(bend)
    shift = share * change + np.where(known, share * (1.0 - share) * bend, 0.0)
    velocity = (change + np.where(known, slope, 0.0)) / duration
    height = (1.0 - share) * before.z[rows] + share * after.z[columns]
    state = np.concatenate([start[:, :2] + shift, velocity], axis=-1)
    return TruePositions(identifiers, state, height)


def truth_as_tracks(truth: TruthTracks) -> PositionTracks:
    """Return the truth of a simulation as position tracks.

    Parameters
    ----------
    truth : TruthTracks
        At one instant.
    """
    count = len(truth.id)
    return PositionTracks(
        stamp=truth.stamp,
        id=truth.id,
        status=np.full(count, TrackStatus.CONFIRMED, np.uint8),
        source=np.full(count, TrackSource.TRUTH, np.uint8),
        state=np.hstack([truth.position, truth.velocity]),
        next_stamp=truth.next_stamp,
    )
