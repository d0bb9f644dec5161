"""What all targets together tell of the misalignment of the arrays, and of each other by it.

Given the misalignments b the targets are independent, so that with the same prior p(b) in each

    p(b | all) is proportional to p(b) prod_i p(b | data of i) / p(b),

information adds up: Y = Y_0 + sum_i (Y_i - Y_0). A target's motion follows b by its own regression
on it.

References
----------
Bar-Shalom, Li, Kirubarajan (2001), section 8.2 (fusion in information form).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.alignment.aligned_targets import MOTION, AlignedTargets, slices_of, stacked
from sonar_tracking.filtering.kalman import symmetrised
from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class AlignmentInformation:
    """What is known of the misalignments beyond their prior, which has mean zero.

    Attributes
    ----------
    matrix : ndarray, shape (n_arrays, n_arrays)
        Y - Y_0, 1/rad^2.
    vector : ndarray, shape (n_arrays,)
        Y times the mean, 1/rad.
    """

    matrix: FloatArray
    vector: FloatArray

    def plus(self, other: AlignmentInformation) -> AlignmentInformation:
        """Return what two independent sources tell together."""
        return AlignmentInformation(self.matrix + other.matrix, self.vector + other.vector)

    def without(self, other: AlignmentInformation) -> AlignmentInformation:
        """Return what is left if one of the sources is taken away."""
        return AlignmentInformation(self.matrix - other.matrix, self.vector - other.vector)

    def with_array(self) -> AlignmentInformation:
        """Return the same beside one array more, of which nothing is known yet."""
        return AlignmentInformation(np.pad(self.matrix, (0, 1)), np.pad(self.vector, (0, 1)))


def no_information(n_arrays: int) -> AlignmentInformation:
    """Return that nothing is known beyond the prior."""
    return AlignmentInformation(np.zeros((n_arrays, n_arrays)), np.zeros(n_arrays))


def information_of(
    mean: FloatArray, covariance: FloatArray, prior: FloatArray
) -> AlignmentInformation:
    """Return what some targets tell together of the misalignments.

    Parameters
    ----------
    mean : ndarray, shape (n, d)
        Of each, over its modes; m, m/s and rad.
    covariance : ndarray, shape (n, d, d)
        In these units squared.
    prior : ndarray, shape (n_arrays,)
        Variances they began with, rad^2.
    """
    own = np.asarray(np.linalg.inv(covariance[:, MOTION:, MOTION:]))
    return _sum_of(symmetrised(own) - np.diag(1.0 / prior), own, mean)


def _sum_of(gained: FloatArray, own: FloatArray, mean: FloatArray) -> AlignmentInformation:
    """Return what targets tell together that have gained and know matrices, shape (n, ...)."""
    vector = np.einsum("nij,nj->i", own, mean[:, MOTION:])
    return AlignmentInformation(np.sum(gained, axis=0), vector)


def log_agreement(
    one: AlignmentInformation, other: AlignmentInformation, prior: FloatArray
) -> float:
    """Return how much likelier two independent sources are together than each for itself.

    That is the log of the integral of p(b | one) p(b | other) / p(b) over the misalignments b.

    Parameters
    ----------
    one, other : AlignmentInformation
        What each tells.
    prior : ndarray, shape (n_arrays,)
        Variances of the misalignments before any measurement, rad^2.
    """
    first = np.diag(1.0 / prior)
    return _log_weight(one.plus(other), first) - _log_weight(one, first) - _log_weight(other, first)


def _log_weight(told: AlignmentInformation, prior: FloatArray) -> float:
    """Return the log of the integral of the likelihood told, with its maximum at none left out."""
    known = told.matrix + prior
    volume = float(np.linalg.slogdet(prior)[1] - np.linalg.slogdet(known)[1])
    return 0.5 * (volume + float(told.vector @ np.linalg.solve(known, told.vector)))


@dataclass(frozen=True)
class ToldOfArrays:
    """What all targets but one tell of the misalignments.

    Attributes
    ----------
    others : AlignmentInformation
        What they tell together.
    agreement : float
        With what that one tells, as of :func:`log_agreement`.
    """

    others: AlignmentInformation
    agreement: float


@dataclass(frozen=True)
class SharedAlignment:
    """The misalignments, and the targets as seen with them.

    Attributes
    ----------
    misalignment : ndarray, shape (n_arrays,)
        By how much each array is turned anticlockwise from what its data tell, rad.
    misalignment_covariance : ndarray, shape (n_arrays, n_arrays)
        rad^2.
    mean : ndarray, shape (n, d)
        Of each target, m, m/s and rad.
    covariance : ndarray, shape (n, d, d)
        In these units squared.
    """

    misalignment: FloatArray
    misalignment_covariance: FloatArray
    mean: FloatArray
    covariance: FloatArray


def shared_alignment(
    targets: AlignedTargets, ended: AlignmentInformation, prior: FloatArray
) -> SharedAlignment:
    """Return what all targets tell together.

    Parameters
    ----------
    targets : AlignedTargets
        No two of them with the same measurements.
    ended : AlignmentInformation
        What targets that are no more have told.
    prior : ndarray, shape (n_arrays,)
        Variances of the misalignments before any measurement, rad^2.
    """
    return shared_alignments([targets], [ended], prior)[0]


def shared_alignments(
    groups: Sequence[AlignedTargets], ended: Sequence[AlignmentInformation], prior: FloatArray
) -> list[SharedAlignment]:
    """Return what all targets of each of several groups tell together.

    Parameters
    ----------
    groups : sequence of AlignedTargets
        Groups that have nothing to do with each other.
    ended : sequence of AlignmentInformation
        What targets of each that are no more have told.
    prior : ndarray, shape (n_arrays,)
        Variances of the misalignments before any measurement, of all groups, rad^2.
    """
    mean, covariance = stacked(groups).collapsed()
    every, first = slices_of(groups), np.diag(1.0 / prior)
    own = np.asarray(np.linalg.inv(covariance[:, MOTION:, MOTION:]))
    gained = symmetrised(own) - first
    known = [
        before.plus(_sum_of(gained[rows], own[rows], mean[rows]))
        for before, rows in zip(ended, every, strict=True)
    ]
    told = np.array([one.matrix for one in known]) + first
    common = symmetrised(np.asarray(np.linalg.inv(told)))
    misalignment = np.array([a @ b.vector for a, b in zip(common, known, strict=True)])
    number = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    better, spread = told_alignment(mean, covariance, misalignment[number], common[number])
    return [
        SharedAlignment(misalignment[place], common[place], better[rows], spread[rows])
        for place, rows in enumerate(every)
    ]


def told_alignment(
    mean: FloatArray, covariance: FloatArray, misalignment: FloatArray, common: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return targets in whose joint distribution the misalignments are replaced by better ones.

    Parameters
    ----------
    mean : ndarray, shape (n, d)
        m, m/s and rad.
    covariance : ndarray, shape (n, d, d)
        In these units squared.
    misalignment : ndarray, shape (n_arrays,) or (n, n_arrays)
        rad.
    common : ndarray, shape (n_arrays, n_arrays) or (n, n_arrays, n_arrays)
        Its covariance, rad^2.

    Returns
    -------
    mean : ndarray, shape (n, d)
        m, m/s and rad.
    covariance : ndarray, shape (n, d, d)
        In these units squared.
    """
    own = covariance[:, MOTION:, MOTION:]
    regression = np.linalg.solve(own, covariance[:, MOTION:, :]).swapaxes(-1, -2)
    change = misalignment - mean[:, MOTION:]
    better = mean + np.einsum("nij,nj->ni", regression, change)
    spread = covariance + regression @ (common - own) @ regression.swapaxes(-1, -2)
    return better, symmetrised(spread)
