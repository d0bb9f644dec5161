"""A run scored while it goes on has the score of the run scored as a whole, to the last bit."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from sonar_tracking.evaluation.metrics.bearing_score import (
    BearingScore,
    OnlineBearingScore,
    score_bearing_tracks,
)
from sonar_tracking.evaluation.metrics.online_score import KEPT_TRUTH
from sonar_tracking.evaluation.metrics.position_score import (
    OnlinePositionScore,
    score_position_tracks,
)
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.positions import PositionTracks
from tests.evaluation.metrics.test_bearing_score import bearings
from tests.evaluation.metrics.test_position_score import picture

SECONDS = 300


@cache
def scene(truth_offset: float) -> tuple[tuple[BearingTracks, ...], tuple[BearingTracks, ...]]:
    """Return truth at ten samples a second, and noisy lists of tracks that come, swap and go."""
    random = np.random.default_rng(1)
    truth = [
        bearings(0.1 * step + truth_offset, {1: 10.0 + 0.01 * step, 2: -20.0})
        for step in range(10 * SECONDS)
    ]
    tracks = []
    for second in range(2, SECONDS):
        angles = {10 + second // 90: 10.0 + 0.1 * second, 20: -20.0, 30 + second: 60.0}
        kept = {one: a + random.normal() for one, a in angles.items() if random.random() > 0.2}
        tracks.append(bearings(float(second), kept, variance=1e-3))
    return tuple(truth), tuple(tracks)


@cache
def score_of_the_whole(truth_offset: float) -> BearingScore:
    return score_bearing_tracks(*scene(truth_offset))


@pytest.mark.slow
@pytest.mark.parametrize("lag", [0, 1, 40])
@pytest.mark.parametrize("truth_offset", [0.0, 0.03])
def test_bearings_that_come_with_the_truth_or_after_it(lag: int, truth_offset: float) -> None:
    truth, waiting = scene(truth_offset)
    tracks = list(waiting)
    online = OnlineBearingScore()
    for sample in truth:
        online.add_truth(sample)
        while tracks and tracks[0].stamp + lag * 10**8 <= sample.stamp:
            online.add_tracks(tracks.pop(0))
    for rest in tracks:
        online.add_tracks(rest)
    whole = score_of_the_whole(truth_offset)
    assert online.score() == whole
    assert online.score() == whole, "a score can be asked for twice"


def test_positions_that_come_before_the_truth() -> None:
    truth = [picture(float(time), {1: (10.0 * time, 5.0)}) for time in range(0, 60, 2)]
    tracks = [picture(float(time), {7: (10.0 * time, 5.0 + time)}) for time in range(58)]
    online = OnlinePositionScore()
    waiting: list[PositionTracks] = list(tracks)
    for sample in truth:
        while waiting and waiting[0].stamp < sample.stamp:
            online.add_tracks(waiting.pop(0))
        online.add_truth(sample)
    for rest in waiting:
        online.add_tracks(rest)
    np.testing.assert_equal(
        online.score().to_mapping(), score_position_tracks(truth, tracks).to_mapping()
    )


def test_truth_nobody_waits_for_is_not_kept() -> None:
    online = OnlineBearingScore()
    for step in range(3 * KEPT_TRUTH):
        online.add_truth(bearings(0.1 * step, {1: 10.0}))
    assert len(online.truth.samples) <= KEPT_TRUTH
    online.add_tracks(bearings(0.3 * KEPT_TRUTH, {1: 10.0}, status=TrackStatus.CONFIRMED))
    online.add_truth(bearings(0.3 * KEPT_TRUTH + 0.1, {1: 10.0}))
    assert len(online.truth.samples) == 2
    assert online.score().periods == 1
