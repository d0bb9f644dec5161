"""Which stations are turned from what their data tell, and by how much: from what bearings tell.

Most stations are aligned as well as they say. A misalignment that is estimated makes positions
worse where there is none, so it is used once bearings contradict its absence. For each choice S of
few stations that are misaligned, with prior N(0, P) each and odds against each of them, the
bearings, which tell y and Y of the misalignments b as exp(y b - b Y b / 2), are likely as

    exp(y_S C_S y_S / 2) sqrt(det(C_S / P)),   C_S = (Y_S + 1 / P)^-1,

relative to no misalignment, and b_S has mean C_S y_S and covariance C_S. What is known of all is
the mixture. Where two stations alone disagree, it says that either may be turned.

References
----------
Mitchell, Beauchamp, "Bayesian variable selection in linear regression", Journal of the American
Statistical Association 83, 1988.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np

from sonar_tracking.alignment.shared_alignment import AlignmentInformation
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.tma.targets.target_records import TargetObservation

MOST_MISALIGNED = 2
"""Stations that may be misaligned at once, of those that are compared."""

ODDS_AGAINST = 10.0
"""To one, against the misalignment of a station."""

SURE = 100.0
"""To one, at which some station is taken to be misaligned."""


@dataclass(frozen=True)
class Misalignments:
    """What is known of the misalignments.

    Attributes
    ----------
    mean : ndarray, shape (n_stations,)
        By how much each is turned anticlockwise from what its data tell, rad.
    covariance : ndarray, shape (n_stations, n_stations)
        rad^2.
    aligned : float
        Probability that all are aligned.
    """

    mean: FloatArray
    covariance: FloatArray
    aligned: float

    @property
    def found(self) -> bool:
        """Whether some station is misaligned for certain."""
        return self.aligned * SURE < 1.0

    @property
    def deviation(self) -> FloatArray:
        """Standard deviations, shape (n_stations,), rad."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True)
class UsedAlignment:
    """How stations are taken to be turned; those that are not named are aligned.

    Attributes
    ----------
    sensor_id : tuple of str
        The stations.
    mean : ndarray, shape (n_stations,)
        By how much each is turned anticlockwise from what its data tell, rad.
    covariance : ndarray, shape (n_stations, n_stations)
        rad^2.
    """

    sensor_id: tuple[str, ...] = ()
    mean: FloatArray = field(default_factory=lambda: np.zeros(0))
    covariance: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))

    def turned(self, sensor_ids: Sequence[str]) -> FloatArray:
        """Return by how much stations are turned, shape (n,), rad."""
        known = dict(zip(self.sensor_id, self.mean.tolist(), strict=True))
        return np.array([known.get(one, 0.0) for one in sensor_ids])

    def spread(self, sensor_ids: Sequence[str], lasting: float) -> FloatArray | None:
        """Return the covariance of what is left of it; None = nothing is known but the deviation.

        Parameters
        ----------
        sensor_ids : sequence of str
            Some stations.
        lasting : float
            Deviation of those that are not known, rad.

        Returns
        -------
        ndarray, shape (n, n), or None
            rad^2.
        """
        if not self.sensor_id:
            return None
        spread = lasting**2 * np.eye(len(sensor_ids))
        known = [row for row, one in enumerate(sensor_ids) if one in self.sensor_id]
        place = [self.sensor_id.index(sensor_ids[row]) for row in known]
        spread[np.ix_(known, known)] = self.covariance[np.ix_(place, place)]
        return spread

    def corrected(self, observation: TargetObservation) -> TargetObservation:
        """Return an observation with the azimuths that an aligned station would have told."""
        (turned,) = self.turned([observation.sensor_id])
        if turned == 0.0 or not observation.azimuths:
            return observation
        azimuths = wrap_angle(np.array(observation.azimuths) + turned)
        return replace(observation, azimuths=tuple(azimuths.tolist()))


ALIGNED = UsedAlignment()
"""All stations are taken to be aligned."""


def misalignments(told: AlignmentInformation, prior: float, lasting: float) -> Misalignments:
    """Return what bearings tell of the misalignments.

    Parameters
    ----------
    told : AlignmentInformation
        Of all targets together, beyond the prior.
    prior : float
        Variance of the misalignment of a station that is misaligned, rad^2.
    lasting : float
        Variance of what is left of that of one that is aligned, rad^2.
    """
    count = len(told.vector)
    choices = [
        np.isin(np.arange(count), chosen)
        for size in range(min(count, MOST_MISALIGNED) + 1)
        for chosen in combinations(range(count), size)
    ]
    weight, mean, covariance = [], [], []
    for chosen in choices:
        log_weight, own_mean, own = _if_misaligned(told, chosen, prior)
        spread = np.diag(np.where(chosen, 0.0, lasting))
        spread[np.ix_(chosen, chosen)] = own
        turned = np.zeros(count)
        turned[chosen] = own_mean
        weight.append(log_weight)
        mean.append(turned)
        covariance.append(spread)
    share = np.exp(np.array(weight) - np.max(weight))
    share /= np.sum(share)
    means = np.array(mean)
    together = share @ means
    apart = means - together
    within = np.einsum("s,sij->ij", share, np.array(covariance))
    between = np.einsum("s,si,sj->ij", share, apart, apart)
    return Misalignments(together, within + between, float(share[0]))


def _if_misaligned(
    told: AlignmentInformation, chosen: BoolArray, prior: float
) -> tuple[float, FloatArray, FloatArray]:
    """Return the log odds of a choice, shape (n_stations,), and its misalignments."""
    count = int(np.sum(chosen))
    if not count:
        return 0.0, np.empty(0), np.empty((0, 0))
    own, vector = told.matrix[np.ix_(chosen, chosen)], told.vector[chosen]
    values, vectors = np.linalg.eigh(0.5 * (own + own.T))
    variance = 1.0 / (np.maximum(values, 0.0) + 1.0 / prior)
    covariance = (vectors * variance) @ vectors.T
    mean = covariance @ vector
    evidence = 0.5 * vector @ mean + 0.5 * np.sum(np.log(variance / prior))
    return float(evidence - count * np.log(ODDS_AGAINST)), mean, covariance
