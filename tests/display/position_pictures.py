"""Position tracks the tests of this directory share."""

from __future__ import annotations

from typing import Any

import numpy as np

from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource

EPOCH = 1_767_225_600
SECOND = 1_000_000_000


def position_tracks(time: float, states: list[list[float]], **columns: Any) -> PositionTracks:
    """Return confirmed tracks 1, 2, ... of the given states at a time after the epoch."""
    n = len(states)
    values: dict[str, Any] = {
        "id": np.arange(1, n + 1, dtype=np.uint64),
        "status": np.full(n, TrackStatus.CONFIRMED, np.uint8),
        "source": np.full(n, TrackSource.TMA, np.uint8),
        "state": np.array(states, float).reshape(n, 4),
    }
    return PositionTracks(stamp=EPOCH * SECOND + round(time * SECOND), **(values | columns))
