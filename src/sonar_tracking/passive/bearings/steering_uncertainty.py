"""What bearings are uncertain by because the array differs from its description.

Gain and phase errors of the elements are the same in every covariance: no mean over time removes
what they do to a bearing. The part of them that looks like another bearing cannot be seen in the
data; the rest can. With P the projector orthogonal to the steering vectors and their derivatives at
the tracked angles, and the signal eigenvectors e_m with the weights of weighted subspace fitting,

    chi^2 = sum_m w_m |P e_m|^2,  w_m = 2 N (lambda_m - sigma^2)^2 / (lambda_m sigma^2),

is on average the number of its degrees of freedom f = 2 R (M - 2 n) if the array is as described,
and larger by e^2 sum_m w_m (M - 2 n) / M with independent errors of relative variance e^2. From the
sums over many covariances, e^2 follows; a bearing is then uncertain by the variance

    e^2 / |a'(theta)|^2

beside that of its filter, as if all errors were of phase. It is published with the tracks; the
filters themselves, which compare bearings with the same errors, go without it.

References
----------
A. L. Swindlehurst, T. Kailath (1992) for the model of the errors; M. Viberg, B. Ottersten (1991)
for the weights.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.geometry import steering_pair, wavenumber
from sonar_tracking.passive.directions.signal_subspace import SignalSubspace, signal_subspace_of
from sonar_tracking.passive.directions.sources_at_angles import PRIOR_VARIANCE, unresolved
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates

_KEPT = 0.998
"""Weight of what was known before, per covariance without common snapshots: errors are lasting."""

_SURE = 5.0
"""Standard deviations of chi^2 in an array as described."""

_LEAST_EXCESS = 0.2
"""Of chi^2, over its degrees of freedom: noise that is whitened with a covariance found in the data
brings a tenth."""

_LEAST_ERROR = 0.005
_LARGEST_SQUARE = 0.1
"""Of e, that a covariance may show."""

_FEWEST_DIMENSIONS = 4
_TOLD_FROM = 0.02
_LARGE = 64


@dataclass(frozen=True)
class SteeringMisfit:
    """What a covariance leaves of its signal eigenvectors, of one run or of several alike.

    Attributes
    ----------
    chi : ndarray, shape (...)
        chi^2, pure numbers.
    weight : ndarray, shape (...)
        What it is over its degrees of freedom with e = 1, pure numbers.
    freedom : float
        Its degrees of freedom.
    judged : ndarray of bool, shape (...)
        Whether it says something: all tracks are resolved.
    """

    chi: FloatArray
    weight: FloatArray
    freedom: float
    judged: BoolArray


@dataclass(frozen=True)
class SteeringUncertainty:
    """Running sums over the covariances of one run.

    Attributes
    ----------
    excess : float
        Of chi^2 over its degrees of freedom, pure number.
    expected : float
        Degrees of freedom, what chi^2 is in an array as described.
    variance : float
        Of that, pure number.
    weight : float
        What the excess is with e = 1, pure number.
    n_seen : int
        Covariances seen; of a large array every fourth one is judged.
    """

    excess: float = 0.0
    expected: float = 0.0
    variance: float = 0.0
    weight: float = 0.0
    n_seen: int = 0

    @property
    def error(self) -> float:
        """Relative rms error e of the elements, 0 = none that is sure, pure number."""
        least = max(_SURE * np.sqrt(self.variance), _LEAST_EXCESS * self.expected)
        if self.weight <= 0.0 or self.excess < least:
            return 0.0
        error = float(np.sqrt(self.excess / self.weight))
        return error if error >= _LEAST_ERROR else 0.0

    def looks_at(self, n_elements: int) -> bool:
        """Return whether the next covariance is judged, not only counted."""
        return n_elements <= _LARGE or self.n_seen % 4 == 0

    def update(self, misfit: SteeringMisfit | None, share: float) -> SteeringUncertainty:
        """Return the sums after one more covariance.

        Parameters
        ----------
        misfit : SteeringMisfit or None
            Of the covariance of a single run; None = it is only counted.
        share : float
            How many of its snapshots are new, 0 to 1.
        """
        if misfit is None or not misfit.judged:
            return replace(self, n_seen=self.n_seen + 1)
        chi, freedom, kept = float(misfit.chi), misfit.freedom, _KEPT**share
        weight = float(misfit.weight)
        if chi - freedom > _LARGEST_SQUARE * weight:
            # The tracks are not where the sources are.
            return replace(self, n_seen=self.n_seen + 1)
        return SteeringUncertainty(
            excess=kept * self.excess + share * (chi - freedom),
            expected=kept * self.expected + share * freedom,
            variance=kept**2 * self.variance + share * 2.0 * freedom,
            weight=kept * self.weight + share * weight,
            n_seen=self.n_seen + 1,
        )

    def widened(self, tracks: BearingTracks, estimates: SubspaceEstimates) -> BearingTracks:
        """Return tracks whose variances hold what the errors of the elements may be.

        Parameters
        ----------
        tracks : BearingTracks
            With the variances of their filters.
        estimates : SubspaceEstimates
            Array and frequency.
        """
        if not self.error or not len(tracks.id):
            return tracks
        variance = self.variances(estimates, tracks.arrival_angle)
        covariance = tracks.covariance.copy()
        covariance[..., 0, 0] += variance
        return replace(
            tracks,
            covariance=covariance,
            measurement_variance=tracks.measurement_variance + variance,
        )

    def variances(self, estimates: SubspaceEstimates, angles: FloatArray) -> FloatArray:
        """Return the variance of each bearing by the errors of the elements.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Array and frequency.
        angles : ndarray, shape (n_tracks,)
            rad.

        Returns
        -------
        ndarray, shape (n_tracks,)
            rad^2.
        """
        number = wavenumber(estimates.center_frequency, estimates.sound_speed)
        slopes = steering_pair(estimates.element_positions, angles, number, "array_centre")[1]
        squared = (slopes.real**2 + slopes.imag**2).sum(axis=-2)
        return np.asarray(self.error**2 / np.maximum(squared, self.error**2 / PRIOR_VARIANCE))

    def notices(self, estimates: SubspaceEstimates) -> tuple[Notice, ...]:
        """Return what a user should know of the array.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Array and frequency.
        """
        if self.error < _TOLD_FROM:
            return ()
        deviation = np.rad2deg(np.sqrt(self.variances(estimates, np.zeros(1))[0]))
        text = (
            f"The data fit the steering vectors of the tracks within {100.0 * self.error:.0f} % "
            f"only (rms error of gain and phase); bearings are uncertain by {deviation:.2g} deg "
            "more (at broadside), which their variances hold. Calibrate the array."
        )
        return (Notice(Severity.WARN, "calibration", text),)


def tells_of_steering(estimates: SubspaceEstimates, n_tracks: int) -> bool:
    """Return whether a covariance with so many tracks is one to judge or to count at all."""
    n_free = len(estimates.element_positions) - 2 * n_tracks
    enough = 0 < _rank(estimates, n_tracks) <= n_tracks and n_free >= _FEWEST_DIMENSIONS
    return estimates.covariance is not None and enough


def steering_misfit(
    estimates: SubspaceEstimates, angles: FloatArray, subspace: SignalSubspace | None = None
) -> SteeringMisfit:
    """Return what covariances leave of their signal eigenvectors at the angles of the tracks.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Of one run or of several alike; such as :func:`tells_of_steering` of.
    angles : ndarray, shape (..., n_tracks)
        Of all tracks in the middle of the covariance, rad.
    subspace : SignalSubspace, optional
        Of the covariances, if it is known already; of any rank.

    Raises
    ------
    ValueError
        If the estimates have no covariance.
    """
    covariance, n_tracks = estimates.covariance, angles.shape[-1]
    if covariance is None:
        raise ValueError("The estimates have no covariance.")
    n_elements, rank = len(estimates.element_positions), _rank(estimates, n_tracks)
    n_free, snapshots = n_elements - 2 * n_tracks, estimates.covariance_snapshots
    close = unresolved(angles, angles, estimates).sum(axis=(-2, -1)) > n_tracks
    if subspace is None or subspace.eigenvalues.shape[-1] != rank:
        subspace = signal_subspace_of(estimates, rank)
    number = wavenumber(estimates.center_frequency, estimates.sound_speed)
    pair = steering_pair(estimates.element_positions, angles, number, "array_centre")
    spanned = np.linalg.qr(subspace.whitened(np.concatenate(pair, axis=-1))).Q
    within = np.swapaxes(spanned, -1, -2).conj() @ subspace.vectors
    outside = subspace.vectors - spanned @ within
    ratios = np.maximum(subspace.eigenvalues / subspace.noise_power[..., None], 1.0)
    weights = 2.0 * snapshots * (ratios - 1.0) ** 2 / ratios
    distances = (outside.real**2 + outside.imag**2).sum(axis=-2)
    return SteeringMisfit(
        chi=np.asarray((weights * distances).sum(axis=-1)),
        weight=np.asarray(weights.sum(axis=-1) * n_free / n_elements),
        freedom=2.0 * rank * n_free,
        judged=np.asarray(~close & covariance.any(axis=(-2, -1))),
    )


def _rank(estimates: SubspaceEstimates, n_tracks: int) -> int:
    rank = estimates.rank if estimates.rank >= 0 else n_tracks
    return min(rank, estimates.covariance_snapshots - 1)
