"""Inverse covariance intersection: fuses estimates whose common past is not known.

    P^-1 = A^-1 + B^-1 - (w A + (1 - w) B)^-1

with w that minimises the determinant of P, whatever the units. It claims no more than is true,
whatever information both have in common, and less is lost than by covariance intersection.

References
----------
B. Noack, J. Sijs, M. Reinhardt, U. D. Hanebeck, "Decentralized data fusion with inverse covariance
intersection", Automatica 79, 35-41, 2017.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState, symmetrised

WEIGHTS = np.linspace(0.0, 1.0, 33)
"""Of the first estimate; the determinant is flat about its minimum."""


def inverse_covariance_intersection(first: KalmanState, second: KalmanState) -> KalmanState:
    """Return two estimates of one state, fused.

    Parameters
    ----------
    first, second : KalmanState
        Mean of shape (n,), covariance of shape (n, n), in any common units.
    """
    a, b = np.linalg.inv(first.covariance), np.linalg.inv(second.covariance)
    w = WEIGHTS[:, None, None]
    shared = np.linalg.inv(w * first.covariance + (1.0 - w) * second.covariance)
    fused = symmetrised(np.linalg.inv(a + b - shared))
    best = int(np.argmin(np.linalg.slogdet(fused)[1]))
    weight, covariance, common = WEIGHTS[best], fused[best], shared[best]
    information = (a - weight * common) @ first.mean + (b - (1.0 - weight) * common) @ second.mean
    return KalmanState(covariance @ information, covariance)
