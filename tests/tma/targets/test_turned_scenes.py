"""Protects that no direction is better than another: a scene turned gives what it gave, turned."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import islice

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.tma_frequency_fusion.observability_rows import (
    target_observations,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scene_of_legs
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import simulate_runs
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
from sonar_tracking.tma.targets.target_solver import TargetSolver, update_solvers

TURNING = (90.0, 0.0, 90.0, 0.0)
"""Courses of own ship, deg."""

ANGLES_DEG = (0.0, 37.0, 180.0, 271.3)
"""By which one scene is turned."""


def rotation_by(angle_deg: float) -> FloatArray:
    cosine, sine = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[cosine, -sine], [sine, cosine]])


def rotated(seen: TargetObservation, angle_deg: float) -> TargetObservation:
    return replace(
        seen,
        propagation_speed=1500.0,
        position=tuple(rotation_by(angle_deg) @ seen.position),
        velocity=tuple(rotation_by(angle_deg) @ seen.velocity),
        azimuths=tuple(np.array(seen.azimuths) + np.radians(angle_deg)),
    )


@cache
def turned() -> list[dict[float, tuple[TargetSolution, ...]]]:
    """Return what is said in each frame of a scene, by the angle by which it is turned."""
    configuration, said = RangeBankConfiguration(), []
    solvers = {angle: TargetSolver(configuration) for angle in ANGLES_DEG}
    runs = simulate_runs(scene_of_legs(TURNING, 0.2), [np.random.SeedSequence(4)])
    for seen in islice(target_observations(runs, 0, array=True), 180):
        tasks = [(solver, rotated(seen, angle)) for angle, solver in solvers.items()]
        assert not any(update_solvers(tasks))
        said.append({angle: solver.solutions() for angle, solver in solvers.items()})
    return said


@pytest.mark.slow
@pytest.mark.parametrize("angle_deg", ANGLES_DEG[1:])
def test_turning_the_scene_turns_both_sides_and_all_that_is_said_of_them(angle_deg: float) -> None:
    """Sides, travel time and observability too, through own ship's turn, to one part in 1e6."""
    both = np.kron(np.eye(2), rotation_by(angle_deg))
    for said in turned():
        solutions, others = said[0.0], said[angle_deg]
        assert [one.side for one in solutions] == [one.side for one in others]
        for one, other in zip(solutions, others, strict=True):
            covariance = both @ one.covariance @ both.T
            scale = np.sqrt(np.diagonal(covariance))
            error = (other.mean - both @ one.mean) / np.abs(np.linalg.norm(one.mean))
            np.testing.assert_allclose(error, 0.0, atol=1e-6)
            np.testing.assert_allclose(
                (other.covariance - covariance) / np.outer(scale, scale), 0.0, atol=1e-6
            )
            assert other.probability == pytest.approx(one.probability, rel=1e-6)
            assert other.observability == pytest.approx(one.observability, rel=1e-6, abs=1e-9)
    assert len(solutions) == 1
