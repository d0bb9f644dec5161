"""Whether what a node publishes can be used."""

from __future__ import annotations

from typing import Any

import numpy as np

NUMBERS = {
    "BearingTracks": ("arrival_angle", "covariance"),
    "Tracks": ("x", "y", "vx", "vy", "covariance"),
    "SubspaceEstimates": ("basis", "covariance", "eigenvalues"),
    "ArraySnapshots": ("data",),
    "FrequencyLines": ("frequency", "standard_deviation"),
}
"""Columns of finite numbers, by type of message."""


def is_sound(message: Any) -> bool:
    """Return whether the numbers that a message is for are numbers, and variances positive."""
    side = {"BearingTracks": 2, "Tracks": 4}.get(type(message).__name__, 0)
    for name in NUMBERS.get(type(message).__name__, ()):
        values = np.asarray(getattr(message, name), float)
        if side:
            # Of a tentative track little may be known.
            confirmed = np.asarray(message.status) == message.CONFIRMED
            values = values.reshape(len(confirmed), -1)[confirmed] if confirmed.size else values
        if not np.isfinite(values).all():
            return False
        if name == "covariance" and side:
            variances = np.diagonal(values.reshape(-1, side, side), axis1=-2, axis2=-1)
            if not (variances > 0.0).all():
                return False
    return True
