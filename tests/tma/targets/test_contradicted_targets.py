"""Protects what is said of a target whose measurements stop fitting: a jump, an elevation."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.simulation.sensors.bearing_simulation import SimulatedFrame
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, TmaUpdate
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import (
    DIRECTIONS,
    NEAR,
    error_of,
    listed,
    running,
    scene,
    simulated,
    with_bearings,
)

pytestmark = pytest.mark.slow

START = 250
"""Frame from which on the measurements are wrong; the target is confirmed by then."""

HEIGHT, WRONG_ELEVATION = 300.0, float(np.radians(38.0))
DEVIATION = float(np.radians(0.5))

Change = Callable[[int, PassiveFrame, SimulatedFrame], PassiveFrame]


Followed = list[tuple[int, TmaUpdate, SimulatedFrame]]
"""Number of a frame, what came of it, and the truth."""


@cache
def ship(seed: int) -> list[tuple[PassiveFrame, SimulatedFrame]]:
    return simulated(scene(DIRECTIONS, targets=(NEAR,), duration=START + 100.0, seed=seed))


@cache
def confirmed(seed: int) -> tuple[bytes, Followed]:
    """Return a stage, pickled, when measurements begin to be wrong, and what it said before."""
    stage = TmaTrackerStage()
    before = [
        (number, stage.update(frame), truth)
        for number, (frame, truth) in enumerate(ship(seed)[:START])
    ]
    return pickle.dumps(stage), before


def misled(change: Change, seed: int) -> Followed:
    """Return what becomes of a ship in frames that are changed from some time on."""
    kept, before = confirmed(seed)
    stage = pickle.loads(kept)
    return before + [
        (number, stage.update(change(number, frame, truth)), truth)
        for number, (frame, truth) in enumerate(ship(seed)[START:], START)
    ]


def followed(change: Change, seed: int, every: int = 1, **parameters: float) -> Followed:
    """Return what becomes of a ship in frames of which some are changed."""
    stage = TmaTrackerStage(TmaTrackerConfiguration(**parameters))  # type: ignore[arg-type]
    return [
        (number, stage.update(change(number, frame, truth)), truth)
        for number, (frame, truth) in enumerate(ship(seed))
        if number % every == 0
    ]


def jump(angle_deg: float) -> Change:
    """Return a source that falls silent while its bearing goes on, elsewhere."""
    generator = np.random.default_rng(1)
    start: list[float] = []

    def changed(number: int, frame: PassiveFrame, _: SimulatedFrame) -> PassiveFrame:
        if number < START:
            return frame
        start.append(float(frame.bearings[0].measurement[0]))
        wrong = start[0] + np.radians(angle_deg) + DEVIATION * generator.standard_normal()
        return replace(with_bearings(frame, measurement=np.array([wrong])), lines=())

    return changed


def elevations(number: int, frame: PassiveFrame, truth: SimulatedFrame) -> PassiveFrame:
    """Return a frame with true elevations, and false ones from some time on."""
    own = np.array(frame.bearings[0].sensor.position[:2])
    distance = float(np.hypot(*(truth.truth_tracks.position[0] - own)))
    right = np.arctan2(HEIGHT, distance) if number < START else WRONG_ELEVATION
    noise = DEVIATION * np.random.default_rng(number).standard_normal()
    return with_bearings(
        frame, elevation=np.array([right + noise]), elevation_variance=np.array([DEVIATION**2])
    )


@pytest.mark.parametrize("angle_deg", [-60.0, 5.0])
def test_bearings_that_jump_elsewhere_leave_the_target_where_it_was(angle_deg: float) -> None:
    for seed in (5, 6):
        updates = misled(jump(angle_deg), seed)
        statuses = {number: listed(update).status.tolist() for number, update, _ in updates}
        assert statuses[START - 1] == [TrackStatus.CONFIRMED]
        lost = next(n for n in range(START, START + 30) if TrackStatus.COASTED in statuses[n])
        assert lost <= START + 10
        for number in range(lost, START + 100):
            assert TrackStatus.CONFIRMED not in statuses[number]
        said = [notice.text for number, update, _ in updates for notice in update.notices]
        assert any("do not fit its position any more" in one for one in said)
        _, update, truth = updates[lost + 30]
        rows = listed(update)
        old = rows.selected(rows.status == TrackStatus.COASTED)
        assert error_of(old, truth) < 400.0
        assert rows.id.tolist() == [1, 2] and set(rows.bearing_track_id) == {1}
        ended = [n for n, status in statuses.items() if TrackStatus.TERMINATED in status]
        assert len(ended) == 1 and 60 <= ended[0] - START <= 80


def test_a_source_that_is_heard_again_where_it_was_expected_keeps_its_row() -> None:
    wrong = jump(60.0)

    def returning(number: int, frame: PassiveFrame, truth: SimulatedFrame) -> PassiveFrame:
        return wrong(number, frame, truth) if number < START + 25 else frame

    updates = misled(returning, 5)
    last = running(listed(updates[-1][1]))
    assert 1 in last.id.tolist()
    assert last.status[last.id == 1].tolist() == [TrackStatus.CONFIRMED]


@pytest.mark.parametrize("every", [1, 10, 20])
def test_elevations_that_contradict_a_position_are_found_within_a_minute(every: int) -> None:
    updates = followed(elevations, 5, every, target_height=HEIGHT)
    statuses = {number: listed(update).status.tolist() for number, update, _ in updates}
    before = max(number for number in statuses if number < START)
    assert statuses[before] == [TrackStatus.CONFIRMED]
    lost = min(n for n in statuses if n >= START and statuses[n] != [TrackStatus.CONFIRMED])
    assert lost <= START + 60
    said = [notice.text for number, update, _ in updates for notice in update.notices]
    assert any("not confirmed any more" in one for one in said)
