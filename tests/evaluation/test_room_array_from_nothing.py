"""The recorded array with the default tracker that is told neither number nor bearings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sonar_tracking.evaluation import room_array

MEASURED = Path("../shared/data/ula32_room_responses/rir_sources_1_2_3_4_5_8_9.npz")


def knowing_nothing(n_sources: int) -> dict[str, dict[str, Any]]:
    """Return the parameters of the nodes for any number of sources."""
    return {
        "subspace_estimator": {
            "method": "covariance",
            "period": 0.4,
            "n_subspaces": 1,
            "covariance_snapshots": 32,
        },
        "bearing_tracker": {"method": "joint_map", "process_noise_deg2": 1.0},
    }


def test_two_sources_are_found_at_every_sub_array(monkeypatch: pytest.MonkeyPatch) -> None:
    if not MEASURED.is_file():
        pytest.skip(f"{MEASURED} is not there")
    monkeypatch.setattr(room_array, "node_parameters", knowing_nothing)
    task = room_array.RoomTask(str(MEASURED), 5000.0, np.random.SeedSequence(1), ((4, 9), (5, 9)))
    errors = np.concatenate([r.errors_deg[r.apart] for r in room_array.track_recordings(task)])
    assert np.isfinite(errors).all(axis=1).mean() >= 0.9
    assert np.nanmedian(np.abs(errors)) <= 2.0
