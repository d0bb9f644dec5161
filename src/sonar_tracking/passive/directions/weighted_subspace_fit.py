"""Weighted subspace fitting: score and information of all arrival angles in a block covariance.

The weighted squared distance of the signal eigenvectors from the span of the steering vectors is,
for many snapshots, the negative log-likelihood of the angles. It, its gradient and its Gauss-Newton
matrix are all a tracker needs of a block:

    w_m = (lambda_m - sigma^2)^2 / lambda_m,  y_m = S^+ e_m,  r_m = P_S e_m,
    J = (2 N / sigma^2) Re[(S'^H P_S S') o sum_m w_m conj(y_m) y_m^T],
    g = (2 N / sigma^2) Re sum_m w_m conj(y_m) o (S'^H r_m),

o elementwise, everything whitened. Coherent sources only lower the number of eigenvectors. Nothing
is inverted that a crossing could make singular: there J is singular, which a prior makes harmless.

References
----------
M. Viberg, B. Ottersten, "Sensor array processing based on subspace fitting", IEEE Trans. Signal
Processing 39(5), 1991; Hwang, Kim, Kim, Park, Nam (2005), eqs. 14-19, for the derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.kalman import symmetrised
from sonar_tracking.geometry import steering_pair
from sonar_tracking.passive.directions.signal_subspace import SignalSubspace
from sonar_tracking.passive.directions.steering_span import steering_span
from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class SubspaceFit:
    """What a block says of the angles, at given angles.

    Attributes
    ----------
    log_likelihood : ndarray, shape (...)
        But for what does not depend on the angles, a pure number.
    score : ndarray, shape (..., n_targets)
        g, gradient of the log-likelihood, 1/rad.
    information : ndarray, shape (..., n_targets, n_targets)
        J, symmetric, not negative, possibly singular, 1/rad^2.
    """

    log_likelihood: FloatArray
    score: FloatArray
    information: FloatArray


def weighted_subspace_fit(
    subspace: SignalSubspace,
    snapshots: int,
    positions: FloatArray,
    angles: FloatArray,
    wavenumber: float,
) -> SubspaceFit:
    """Return score and information of the angles.

    Parameters
    ----------
    subspace : SignalSubspace
        Of the block covariance.
    snapshots : int
        N, snapshots in the block.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    angles : ndarray, shape (..., n_targets)
        rad; fewer targets than elements.
    wavenumber : float
        rad/m.
    """
    vectors, derivatives = (
        subspace.whitened(each) for each in steering_pair(positions, angles, wavenumber)
    )
    span = steering_span(vectors)
    amplitudes = span.inverse @ subspace.vectors
    residuals = span.outside(subspace.vectors)
    outside = span.outside(derivatives)
    adjoint = np.swapaxes(outside, -1, -2).conj()
    ratios = np.maximum(subspace.eigenvalues / subspace.noise_power[..., None], 1.0)
    weights = 2.0 * snapshots * (ratios - 1.0) ** 2 / ratios
    weighted = amplitudes.conj() * weights[..., None, :]
    information = ((adjoint @ outside) * (weighted @ np.swapaxes(amplitudes, -1, -2))).real
    score = (weighted * (adjoint @ residuals)).real.sum(axis=-1)
    distances = (residuals.real**2 + residuals.imag**2).sum(axis=-2)
    return SubspaceFit(
        log_likelihood=-0.5 * (weights * distances).sum(axis=-1),
        score=score,
        information=symmetrised(information),
    )
