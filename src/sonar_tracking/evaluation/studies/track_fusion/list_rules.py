"""Rules that fuse finished tracks of two lists: what the fusion of measurements is held against.

References
----------
S. J. Julier, J. K. Uhlmann, "A non-divergent estimation algorithm in the presence of unknown
correlations", American Control Conference, 1997 (covariance intersection).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState, symmetrised
from sonar_tracking.fusion.inverse_covariance_intersection import (
    WEIGHTS,
    inverse_covariance_intersection,
)


def naive_product(first: KalmanState, second: KalmanState) -> KalmanState:
    """Return both estimates as if they had nothing in common; shapes (n,) and (n, n)."""
    return _combined(first, second, 1.0, 1.0)


def covariance_intersection(first: KalmanState, second: KalmanState) -> KalmanState:
    """Return both estimates as if they might have everything in common; (n,) and (n, n)."""
    a, b = np.linalg.inv(first.covariance), np.linalg.inv(second.covariance)
    w = WEIGHTS[:, None, None]
    information = np.linalg.slogdet(w * a + (1.0 - w) * b)[1]
    weight = float(WEIGHTS[int(np.argmax(information))])
    return _combined(first, second, weight, 1.0 - weight)


def _combined(first: KalmanState, second: KalmanState, *weights: float) -> KalmanState:
    a, b = np.linalg.inv(first.covariance), np.linalg.inv(second.covariance)
    own, other = weights[0] * a, weights[1] * b
    covariance = symmetrised(np.asarray(np.linalg.inv(own + other)))
    return KalmanState(covariance @ (own @ first.mean + other @ second.mean), covariance)


RULES: dict[str, Callable[[KalmanState, KalmanState], KalmanState]] = {
    "covariance intersection of tracks": covariance_intersection,
    "inverse covariance intersection": inverse_covariance_intersection,
    "naive product of tracks": naive_product,
}
"""By name, as in the tables."""
