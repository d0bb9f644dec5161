"""Honesty rows of the tma-frequency-fusion study: what cannot be known is said to be unknown.

The stage that a node holds, fed with single runs: its observability figure with and without lines,
with and without own-ship turns, and on a constant bearing, where Doppler does not help; and whether
the side of a line array is found once own ship has turned, not before.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scene_of_legs
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, TmaScene, simulate_runs
from sonar_tracking.tma.targets.observability import OBSERVABLE
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver

CONDITION = "observability"
RUNS = 5
"""Runs of each case: the figure hardly differs between runs."""

FIRST_TURN = 100
STRAIGHT, TURNING = (90.0,) * 4, (90.0, 0.0, 90.0, 0.0)
SIDES_CASE = "line array, own ship turns, no line"


@dataclass(frozen=True)
class ObservabilityPart:
    """Runs of one case.

    Attributes
    ----------
    case : str
        Name of the case.
    batch : RunBatch
        The first runs of it are used.
    """

    case: str
    batch: RunBatch


@dataclass(frozen=True)
class ObservabilityResult:
    """What the stage said in each run.

    Attributes
    ----------
    case : str
        Name of the case.
    figure : tuple of float
        Observability in the last frame.
    early_sides, last_sides : tuple of int
        Solutions just before own ship's first turn, and in the last frame.
    right_side : tuple of bool
        Whether the most probable solution is on the target's side in the last frame.
    """

    case: str
    figure: tuple[float, ...]
    early_sides: tuple[int, ...]
    last_sides: tuple[int, ...]
    right_side: tuple[bool, ...]


def observe_cases(part: ObservabilityPart) -> ObservabilityResult:
    """Run the stage over the runs of a case.

    Parameters
    ----------
    part : ObservabilityPart
        Case and runs.
    """
    runs = simulate_runs(_scenes()[part.case], part.batch.seeds[:RUNS])
    figures, early, last, right = [], [], [], []
    for run in range(len(runs.truth)):
        solver = TargetSolver()
        for frame, observation in enumerate(
            target_observations(runs, run, array=part.case == SIDES_CASE)
        ):
            solutions = solver.update(observation)
            if frame == FIRST_TURN - 1:
                early.append(len(solutions))
        best = max(solutions, key=lambda one: one.probability)
        figures.append(best.observability)
        last.append(len(solutions))
        away = np.hypot(*(best.mean[:2] - runs.truth[run, -1, :2]))
        distance = np.hypot(*(runs.truth[run, -1, :2] - runs.scene.sensor_position[-1]))
        right.append(bool(away < distance))
    return ObservabilityResult(part.case, tuple(figures), tuple(early), tuple(last), tuple(right))


def observability_rows(results: Sequence[ObservabilityResult]) -> tuple[StudyRow, ...]:
    """Return one row a case."""
    rows = []
    for result in results:
        metrics = {
            "observability": float(np.median(result.figure)),
            "unobservable_percent": 100.0 * float(np.mean(np.array(result.figure) < OBSERVABLE)),
            "early_sides": float(np.mean(result.early_sides)),
            "last_sides": float(np.mean(result.last_sides)),
        }
        if result.case == SIDES_CASE:
            metrics["right_side_percent"] = 100.0 * float(np.mean(result.right_side))
        rows.append(StudyRow(result.case, CONDITION, metrics))
    return tuple(rows)


def observability_cases() -> tuple[str, ...]:
    """Return the names of all cases."""
    return tuple(_scenes())


def target_observations(
    runs: TmaRuns, run: int, array: bool = False, sensor: str = "own_ship"
) -> Iterator[TargetObservation]:
    """Yield the frames of one run as a node would pass them on.

    Parameters
    ----------
    runs : TmaRuns
        Measurements.
    run : int
        Number of the run.
    array : bool
        Whether a line array along own ship's heading heard them, which cannot tell its sides.
    sensor : str
        Name of the sensor.
    """
    for frame in runs.frames():
        azimuth = float(frame.azimuth[run, 0])
        heading = float(np.arctan2(frame.velocity[1], frame.velocity[0]))
        sides = sorted((azimuth, 2 * heading - azimuth), key=lambda one: -np.sin(one - heading))
        heard = np.flatnonzero(frame.heard[run])
        yield TargetObservation(
            stamp=frame.stamp,
            sensor_id=sensor,
            position=(float(frame.position[0]), float(frame.position[1])),
            velocity=(float(frame.velocity[0]), float(frame.velocity[1])),
            azimuths=tuple(sides) if array else (azimuth,),
            azimuth_variance=float(frame.azimuth_variance),
            line_ids=tuple(int(line) + 1 for line in heard),
            frequencies=tuple(frame.frequency[run, heard].tolist()),
            frequency_deviations=tuple(frame.frequency_deviation[run, heard].tolist()),
        )


def _scenes() -> dict[str, TmaScene]:
    straight, turning = scene_of_legs(STRAIGHT, 1.0), scene_of_legs(TURNING, 1.0)
    exact = scene_of_legs(STRAIGHT, 0.05)
    direction = exact.target[:2] / np.hypot(*exact.target[:2])
    closing = exact.sensor_velocity[0] - 4.0 * direction
    constant = replace(exact, target=np.concatenate([exact.target[:2], closing]))
    return {
        "own ship straight, no line": _silent(straight),
        "own ship turns, no line": _silent(turning),
        "own ship straight, lines 1 Hz": straight,
        "own ship straight, lines 0.05 Hz": exact,
        "constant bearing, lines 0.05 Hz": replace(constant, acceleration=0.0),
        SIDES_CASE: _silent(turning),
    }


def _silent(scene: TmaScene) -> TmaScene:
    return replace(scene, heard=np.zeros_like(scene.heard))
