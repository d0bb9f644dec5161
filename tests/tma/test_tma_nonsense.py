"""Protects the stage from arbitrary nonsense: every frame gives a finite list."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.records.bearings import AngleKind, TrackStatus
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import ARRAY, DIRECTIONS, FAR, NEAR, listed, scene, simulated

NONSENSE = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e300, 1e-300, -1e9, 7.0)
TRACK_COLUMNS = ("measurement", "measurement_variance", "arrival_angle", "existence_probability")
LINE_COLUMNS = ("frequency", "standard_deviation", "arrival_angle", "arrival_angle_variance")


def spoilt(record: Any, columns: tuple[str, ...], generator: np.random.Generator) -> Any:
    """Return a record with nonsense in some of its entries."""
    changes: dict[str, Any] = {}
    for name in columns:
        values = getattr(record, name).copy()
        where = generator.random(values.shape) < 0.2
        values[where] = generator.choice(NONSENSE, int(np.sum(where)))
        changes[name] = values
    return replace(record, **changes)


def spoilt_frame(frame: PassiveFrame, generator: np.random.Generator) -> PassiveFrame:
    bearings, lines = [], []
    for one in frame.bearings:
        bad = spoilt(one, TRACK_COLUMNS, generator)
        if generator.random() < 0.1:
            bad = replace(bad, angle_kind=AngleKind(int(generator.integers(2))))
        if generator.random() < 0.1:
            bad = replace(bad, ambiguous=~bad.ambiguous)
        if generator.random() < 0.1:
            status = generator.integers(0, len(TrackStatus), len(bad.id)).astype(np.uint8)
            bad = replace(bad, status=status)
        if generator.random() < 0.1:
            identifiers = generator.integers(0, 4, len(bad.id)).astype(np.uint64)
            bad = replace(bad, id=identifiers)
        if generator.random() < 0.1:
            position = tuple(generator.choice(NONSENSE, 3).tolist())
            bad = replace(bad, sensor=replace(bad.sensor, position=position))
        bearings.append(bad)
    for heard in frame.lines:
        bad = spoilt(heard, LINE_COLUMNS, generator)
        bad = replace(bad, track_id=generator.integers(0, 4, len(bad.line_id)).astype(np.uint64))
        lines.append(bad)
    return replace(frame, bearings=tuple(bearings), lines=tuple(lines))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_nonsense_is_survived(seed: int) -> None:
    generator = np.random.default_rng(seed)
    buoy = replace(
        DIRECTIONS, sensor_id="buoy", namespace="buoy", platform="fixed", position=(6000.0, 0.0)
    )
    frames = simulated(scene(ARRAY, buoy, targets=(NEAR, FAR), duration=80.0))
    stage = TmaTrackerStage(n_stations=2)
    seen: set[int] = set()
    ended: set[int] = set()
    for frame, _ in frames:
        tracks = listed(stage.update(spoilt_frame(frame, generator)))
        assert np.isfinite(tracks.state).all() and np.isfinite(tracks.covariance).all()
        assert np.all(np.linalg.eigvalsh(tracks.covariance) > -1e-6)
        over = set(tracks.id[tracks.status == TrackStatus.TERMINATED].tolist())
        running = set(tracks.id.tolist()) - over
        assert not running & ended and not over & ended and over <= seen
        seen |= running
        ended |= over
