"""Protects that the stage says how long a turn of each confirmed target would not show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.performance.unseen_turn import LONGEST
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
from sonar_tracking.tma.targets.unseen_turns import Watches
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


def reported(second: int) -> TargetObservation:
    """Return an azimuth and a line of a moving station."""
    return TargetObservation(
        stamp=second * NANOSECONDS,
        sensor_id="array",
        position=(0.0, 0.0),
        velocity=(3.0, 0.0),
        azimuths=(0.6,),
        azimuth_variance=1e-4,
        line_ids=(1,),
        frequencies=(300.0,),
        frequency_deviations=(0.1,),
    )


def test_two_observations_of_one_instant_leave_the_interval_as_it_was() -> None:
    """Two bearing tracks of a station that an operator has merged tell of one target at once."""
    mean, covariance = np.array([4000.0, 3000.0, -3.0, 0.0]), np.diag([1e4, 1e4, 0.25, 0.25])
    solution = TargetSolution(
        stamp=8 * NANOSECONDS,
        side="",
        probability=1.0,
        mean=mean,
        covariance=covariance,
        observability=1.0,
        observable=True,
        line_ids=(),
        source_frequency=np.empty(0),
        source_frequency_deviation=np.empty(0),
        manoeuvre=False,
    )
    once, twice = Watches(), Watches()
    for second in (0, 4, 8):
        once.take(reported(second))
    for second in (0, 0, 4, 4, 8, 8):
        twice.take(reported(second))
    assert 0.0 < twice.unseen(solution) == once.unseen(solution) < LONGEST
