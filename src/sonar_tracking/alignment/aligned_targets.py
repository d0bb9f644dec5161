"""Targets with the misalignment of the arrays that hear them: one Gaussian mixture a target.

A target's state is x, y, vx, vy and one angle for each array that may be misaligned: by how much
the array is really turned anticlockwise from what its data tell. The arrays are common to all
targets, but given their misalignments the targets are independent of one another, so each target
keeps the joint distribution of its own motion and of the misalignments that its own measurements
tell (:mod:`sonar_tracking.alignment.shared_alignment` puts these together).

The motion is nearly straight, with white accelerations of one of several strengths: interacting
multiple models, in which the strength is drawn anew at a constant rate.

References
----------
Blom, Bar-Shalom (1988); Bar-Shalom, Li, Kirubarajan (2001), sections 6.2.2, 11.6.
"""

from __future__ import annotations

from collections.abc import Sequence, Sized
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from sonar_tracking.filtering.constant_velocity import in_plane, process_noise_matrix
from sonar_tracking.filtering.kalman import symmetrised
from sonar_tracking.records.arrays import FloatArray, IndexArray

MOTION = 4
"""Components of the state that are motion: x, y, vx, vy."""


@dataclass(frozen=True)
class MotionStrengths:
    """How targets accelerate.

    Attributes
    ----------
    density : ndarray, shape (n_modes,)
        Of the white acceleration in each mode, m^2/s^3.
    share : ndarray, shape (n_modes,)
        Of the time that is spent in each mode; a pure number.
    duration : float
        After which the mode is drawn anew, in the mean, s.
    """

    density: FloatArray
    share: FloatArray
    duration: float

    def transition(self, interval: float) -> FloatArray:
        """Return the probabilities of each mode an interval (s) after each other.

        Returns
        -------
        ndarray, shape (n_modes, n_modes)
            Pure numbers; row = mode before.
        """
        kept = np.exp(-interval / self.duration)
        return np.asarray(kept * np.eye(len(self.share)) + (1.0 - kept) * self.share)


STRENGTHS = MotionStrengths(
    density=np.array([3e-5, 4e-3, 0.2, 5.0]),
    share=np.array([0.45, 0.5, 0.045, 0.005]),
    duration=1000.0,
)
"""Of ships: on their courses, as the sea lets them, turning by some hundredths of m/s^2, hard."""


@dataclass(frozen=True)
class AlignedTargets:
    """Targets, one row each; d = 4 + number of arrays.

    Attributes
    ----------
    mean : ndarray, shape (n, n_modes, d)
        x, y, vx, vy and the misalignments, m, m/s and rad.
    covariance : ndarray, shape (n, n_modes, d, d)
        In these units squared.
    mode : ndarray, shape (n, n_modes)
        Probabilities.
    """

    mean: FloatArray
    covariance: FloatArray
    mode: FloatArray

    def __len__(self) -> int:
        """Return the number of targets."""
        return len(self.mean)

    def rows(self, rows: IndexArray | slice) -> AlignedTargets:
        """Return some of the targets, in the order given; shape (n_chosen,)."""
        return AlignedTargets(self.mean[rows], self.covariance[rows], self.mode[rows])

    def collapsed(self) -> tuple[FloatArray, FloatArray]:
        """Return the mean and covariance over the modes.

        Returns
        -------
        mean : ndarray, shape (n, d)
            m, m/s and rad.
        covariance : ndarray, shape (n, d, d)
            In these units squared.
        """
        return _mixed(self.mode[:, None, :], self.mean, self.covariance, first=True)


def begun(
    state: FloatArray, covariance: FloatArray, strengths: MotionStrengths, prior: FloatArray
) -> AlignedTargets:
    """Return new targets, of whose arrays nothing is known but the prior.

    Parameters
    ----------
    state : ndarray, shape (n, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (n, 4, 4)
        In these units squared.
    strengths : MotionStrengths
        How targets accelerate.
    prior : ndarray, shape (n_arrays,)
        Variance of each misalignment, rad^2.
    """
    n_modes, width = len(strengths.share), MOTION + len(prior)
    mean = np.zeros((len(state), n_modes, width))
    mean[..., :MOTION] = state[:, None]
    spread = np.zeros((len(state), n_modes, width, width))
    spread[..., :MOTION, :MOTION] = covariance[:, None]
    arrays = np.arange(MOTION, width)
    spread[..., arrays, arrays] = prior
    return AlignedTargets(mean, spread, np.tile(strengths.share, (len(state), 1)))


def joined(first: AlignedTargets, second: AlignedTargets) -> AlignedTargets:
    """Return the targets of both."""
    return stacked([first, second])


def replaced(targets: AlignedTargets, rows: IndexArray, others: AlignedTargets) -> AlignedTargets:
    """Return targets of which some, shape (n_others,), are replaced by others."""
    mean, covariance = targets.mean.copy(), targets.covariance.copy()
    mode = targets.mode.copy()
    mean[rows], covariance[rows], mode[rows] = others.mean, others.covariance, others.mode
    return AlignedTargets(mean, covariance, mode)


def with_array(targets: AlignedTargets, variance: float) -> AlignedTargets:
    """Return targets with one array more, of prior variance (rad^2) about what its data tell."""
    n, n_modes, width = targets.mean.shape
    mean = np.zeros((n, n_modes, width + 1))
    mean[..., :width] = targets.mean
    covariance = np.zeros((n, n_modes, width + 1, width + 1))
    covariance[..., :width, :width] = targets.covariance
    covariance[..., width, width] = variance
    return AlignedTargets(mean, covariance, targets.mode)


def with_arrays(targets: AlignedTargets, prior: FloatArray) -> AlignedTargets:
    """Return targets with arrays more, of prior variances (rad^2), shape (n_arrays,)."""
    for variance in prior:
        targets = with_array(targets, float(variance))
    return targets


def predicted(
    targets: AlignedTargets, interval: float, strengths: MotionStrengths
) -> AlignedTargets:
    """Return the targets an interval (s) later; arrays stay as they are."""
    return predicted_together([targets], interval, strengths)[0]


def predicted_together(
    groups: Sequence[AlignedTargets], interval: float, strengths: MotionStrengths
) -> list[AlignedTargets]:
    """Return groups of targets with the same number of arrays an interval (s) later."""
    if interval <= 0.0 or not any(map(len, groups)):
        return list(groups)
    targets, transition = stacked(groups), strengths.transition(interval)
    # Group by group: how a matrix product is rounded depends on the number of its rows.
    after = np.concatenate([group.mode @ transition for group in groups])
    mixing = (targets.mode[:, :, None] * transition / after[:, None, :]).swapaxes(1, 2)
    mean, covariance = _mixed(mixing, targets.mean, targets.covariance)
    mean[..., :2] += interval * mean[..., 2:MOTION]
    covariance[..., :2, :] += interval * covariance[..., 2:MOTION, :]
    covariance[..., :, :2] += interval * covariance[..., :, 2:MOTION]
    noise = in_plane(process_noise_matrix(1.0, interval))
    covariance[..., :MOTION, :MOTION] += strengths.density[:, None, None] * noise
    return parted(AlignedTargets(mean, symmetrised(covariance), after), groups)


def stacked(groups: Sequence[AlignedTargets]) -> AlignedTargets:
    """Return the targets of groups with the same number of arrays, one group after the other."""
    if len(groups) == 1:
        return groups[0]
    return AlignedTargets(
        np.concatenate([group.mean for group in groups]),
        np.concatenate([group.covariance for group in groups]),
        np.concatenate([group.mode for group in groups]),
    )


def parted(targets: AlignedTargets, groups: Sequence[Sized]) -> list[AlignedTargets]:
    """Return targets, as stacked, group by group."""
    return [targets.rows(rows) for rows in slices_of(groups)]


def slices_of(groups: Sequence[Sized]) -> list[slice]:
    """Return where the rows of each group are in a stack of all groups."""
    ends = list(accumulate(map(len, groups), initial=0))
    return [slice(first, last) for first, last in pairwise(ends)]


def _mixed(
    weights: FloatArray, mean: FloatArray, covariance: FloatArray, first: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return the moments of mixtures; weights have shape (n, n_mixtures, n_modes)."""
    combined = weights @ mean
    apart = mean[:, None] - combined[:, :, None]
    spread = np.einsum("nab,nbij->naij", weights, covariance)
    spread += np.einsum("nab,nabi,nabj->naij", weights, apart, apart)
    return (combined[:, 0], spread[:, 0]) if first else (combined, spread)
