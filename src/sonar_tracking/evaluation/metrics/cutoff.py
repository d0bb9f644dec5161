"""The distances beyond which a position track is none of a target, or far off."""

from __future__ import annotations

import math

from sonar_tracking.errors import ConfigurationError

CUTOFF_M = 200.0
"""Used unless told otherwise, m."""

FAR_LIMIT_M = 200.0
"""From the nearest target, beyond which a row counts as far off, unless told otherwise, m."""


def check_cutoff(cutoff_m: float) -> None:
    """Refuse a cut-off, m, that is no positive distance.

    Raises
    ------
    ConfigurationError
        If it is not.
    """
    if not (math.isfinite(cutoff_m) and cutoff_m > 0.0):
        raise ConfigurationError(f"The cut-off is {cutoff_m} m; give a positive distance.")


def check_far_limit(far_limit_m: float) -> None:
    """Refuse a limit, m, that is no positive distance.

    Raises
    ------
    ConfigurationError
        If it is not.
    """
    if not (math.isfinite(far_limit_m) and far_limit_m > 0.0):
        raise ConfigurationError(f"The far limit is {far_limit_m} m; give a positive distance.")
