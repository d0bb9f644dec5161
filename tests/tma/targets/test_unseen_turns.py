"""Protects that the stage says how long a turn of each confirmed target would not show."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sonar_tracking.tma.performance.unseen_turn import LONGEST
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import DIRECTIONS, NEAR, fed, frames_of, listed, running, scene


def unseen(lines: bool) -> dict[int, float]:
    """Return it for the target of a scene in which own ship has turned and goes straight."""
    target = NEAR if lines else replace(NEAR, lines=())
    stage = TmaTrackerStage()
    assert stage.unseen_turns() == {}
    updates = fed(stage, frames_of(scene(DIRECTIONS, targets=(target,), duration=400.0)))
    (row,) = running(listed(updates[-1])).id.tolist()
    found = stage.unseen_turns()
    assert list(found) == [row]
    return found


@pytest.mark.slow
def test_without_tonals_a_turn_is_unseen_for_longer() -> None:
    (without,), (heard,) = unseen(lines=False).values(), unseen(lines=True).values()
    assert 5.0 < heard < 0.7 * without < LONGEST
