"""Shared estimation mathematics: Kalman filters and their consistency."""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "KalmanState",
    "KalmanUpdate",
    "chi_square_band",
    "normalised_squared",
    "predict",
    "process_noise_matrix",
    "transition_matrix",
    "update",
]

if TYPE_CHECKING:
    from sonar_tracking.filtering.consistency import chi_square_band, normalised_squared
    from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
    from sonar_tracking.filtering.kalman import KalmanState, KalmanUpdate, predict, update
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "consistency": ["chi_square_band", "normalised_squared"],
            "constant_velocity": ["process_noise_matrix", "transition_matrix"],
            "kalman": ["KalmanState", "KalmanUpdate", "predict", "update"],
        },
    )
