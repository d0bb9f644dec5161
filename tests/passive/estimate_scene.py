"""Estimates of the line array of 15 elements around a covariance: shared by the tests."""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.records.bearings import SubspaceEstimates
from tests.passive.crossing_scene import FREQUENCY, POSITIONS, SAMPLE_PERIOD, SOUND_SPEED


def estimates_of(covariance: np.ndarray | None, **changes: object) -> SubspaceEstimates:
    """Return estimates of half a second in unit noise, with two columns in one subspace."""
    values: dict[str, Any] = {
        "stamp": 0,
        "method": "covariance",
        "basis": np.eye(15, 2, dtype=complex)[None],
        "time_offsets": np.zeros(1),
        "element_positions": POSITIONS,
        "sample_period": SAMPLE_PERIOD,
        "center_frequency": FREQUENCY,
        "bandwidth": 10.0,
        "sound_speed": SOUND_SPEED,
        "effective_snapshots": 100.0,
        "covariance": covariance,
        "covariance_snapshots": 0 if covariance is None else 100,
        "covariance_time_offset": 0.0,
        "noise_power": np.array(1.0),
    }
    return SubspaceEstimates(**{**values, **changes})
