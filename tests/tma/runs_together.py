"""Runs before one own ship that an estimator follows together: each costs little more than none.

What one run gives does not depend on the others: tests/tma/estimators/test_range_bank.py.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import (
    Estimator,
    TmaHistories,
    history_of,
)
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns


def joined_runs(parts: Sequence[TmaRuns]) -> TmaRuns:
    """Return the runs of all parts, whose targets may move as they like."""
    scene = parts[0].scene
    for other in (part.scene for part in parts[1:]):
        for name in ("times", "sensor_position", "sensor_velocity"):
            np.testing.assert_array_equal(getattr(other, name), getattr(scene, name))
        for name in ("azimuth_deviation", "frequency_deviation", "sound_speed"):
            assert getattr(other, name) == getattr(scene, name)
    return TmaRuns(
        scene,
        np.concatenate([part.truth for part in parts]),
        np.concatenate([part.azimuth for part in parts]),
        np.concatenate([part.frequency for part in parts]),
    )


def slices_of(parts: Sequence[TmaRuns]) -> list[slice]:
    """Return where the runs of each part are among those of all."""
    ends = np.cumsum([len(part.azimuth) for part in parts]).tolist()
    return [slice(first, last) for first, last in zip([0, *ends], ends, strict=False)]


def follow_together(estimator: Estimator, parts: Sequence[TmaRuns]) -> list[TmaHistories]:
    """Return what an estimator did in the runs of each part."""
    whole = history_of(estimator, joined_runs(parts))
    return [
        TmaHistories(whole.error[own], whole.nees[own], whole.manoeuvre[own], whole.reborn[own])
        for own in slices_of(parts)
    ]
