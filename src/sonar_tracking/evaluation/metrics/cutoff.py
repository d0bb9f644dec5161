"""The distance beyond which a position track is none of a target."""

from __future__ import annotations

import math

from sonar_tracking.errors import ConfigurationError

CUTOFF_M = 200.0
"""Used unless told otherwise, m."""


def check_cutoff(cutoff_m: float) -> None:
    """Refuse a cut-off, m, that is no positive distance.

    Raises
    ------
    ConfigurationError
        If it is not.
    """
    if not (math.isfinite(cutoff_m) and cutoff_m > 0.0):
        raise ConfigurationError(f"The cut-off is {cutoff_m} m; give a positive distance.")
