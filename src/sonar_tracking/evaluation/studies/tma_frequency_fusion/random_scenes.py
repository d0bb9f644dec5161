"""Random scenes of the tma-frequency-fusion study: the default outside its three scenarios.

Own ship on two to four legs of any course, a target at 2 to 12 km on any course, lines on and off
at random. Scenes whose bound on the range is above a tenth of the range are left out: no
estimator can do anything there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import LOST_BOUNDS, history_of
from sonar_tracking.evaluation.studies.tma_frequency_fusion.runs import scene_bound
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import (
    LEG_FRAMES,
    scene_of_legs,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import (
    BEARINGS_ONLY,
    PROPOSED,
    RANGE_BANK,
    STACKED,
    SYSTEMS,
)
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaScene, simulate_runs

CONDITION = "random scenes"

RUNS_PER_SCENE = 10
BOUND_PATHS = 20
"""True paths a scene's bound is averaged over: the ratio is averaged over many scenes."""

OBSERVABLE_SHARE = 0.1
COMPARED = (PROPOSED, STACKED, RANGE_BANK, BEARINGS_ONLY)


@dataclass(frozen=True)
class RandomSceneResults:
    """Errors in the last frame of the scenes that count.

    Attributes
    ----------
    ratio : dict of str to ndarray, shape (n_runs,)
        Range error over the bound, by estimator, pure numbers.
    nees : dict of str to ndarray, shape (n_runs,)
        Per dimension, pure numbers.
    """

    ratio: dict[str, FloatArray]
    nees: dict[str, FloatArray]


def estimate_random_scenes(batch: RunBatch) -> RandomSceneResults:
    """Run the estimators on one random scene per seed, a few runs each.

    Parameters
    ----------
    batch : RunBatch
        One seed a scene.
    """
    ratios: dict[str, list[FloatArray]] = {name: [] for name in COMPARED}
    nees: dict[str, list[FloatArray]] = {name: [] for name in COMPARED}
    for seed in batch.seeds:
        children = seed.spawn(1 + BOUND_PATHS)
        scene = random_scene(np.random.default_rng(children[0]))
        bound = scene_bound(scene, RunBatch(0, tuple(children[1:])))[-1, 0]
        runs = simulate_runs(scene, children[1 : 1 + RUNS_PER_SCENE])
        distance = np.hypot(*np.mean(runs.truth[:, -1, :2] - scene.sensor_position[-1], axis=0))
        if bound > OBSERVABLE_SHARE * distance:
            continue
        for name in COMPARED:
            histories = history_of(SYSTEMS[name](), runs)
            ratios[name].append(histories.error[:, -1, 0] / bound)
            nees[name].append(histories.nees[:, -1])
    return RandomSceneResults(
        {name: np.concatenate([*one, np.empty(0)]) for name, one in ratios.items()},
        {name: np.concatenate([*one, np.empty(0)]) for name, one in nees.items()},
    )


def random_scene(generator: np.random.Generator) -> TmaScene:
    """Return a scene drawn at random.

    Parameters
    ----------
    generator : numpy.random.Generator
        Source of randomness.
    """
    n_legs = int(generator.integers(2, 5))
    courses = generator.uniform(0.0, 360.0, n_legs)
    leg_of = np.minimum(np.arange(4) * n_legs // 4, n_legs - 1)
    deviation = float(generator.choice([0.1, 0.3, 1.0]))
    scene = scene_of_legs(tuple(courses[leg_of].tolist()), deviation)
    distance = generator.uniform(2000.0, 12_000.0)
    direction, course = generator.uniform(-np.pi, np.pi, 2)
    speed = generator.uniform(1.0, 10.0)
    target = np.array(
        [
            distance * np.cos(direction),
            distance * np.sin(direction),
            speed * np.cos(course),
            speed * np.sin(course),
        ]
    )
    return replace(scene, target=target, heard=_random_schedule(scene.heard.shape, generator))


def random_scene_rows(parts: Sequence[RandomSceneResults]) -> tuple[StudyRow, ...]:
    """Return one row an estimator.

    Parameters
    ----------
    parts : sequence of RandomSceneResults
        All batches.
    """
    rows = []
    for name in COMPARED:
        ratio = np.concatenate([part.ratio[name] for part in parts])
        nees = np.concatenate([part.nees[name] for part in parts])
        if not len(ratio):
            continue
        metrics = {
            "scenes": len(ratio) / RUNS_PER_SCENE,
            "random_per_bound": float(np.sqrt(np.mean(ratio**2))),
            "random_median_per_bound": float(np.median(np.abs(ratio))),
            "random_lost_percent": 100.0 * float(np.mean(np.abs(ratio) > LOST_BOUNDS)),
            "random_nees": float(np.mean(nees)),
        }
        rows.append(StudyRow(name, CONDITION, metrics))
    return tuple(rows)


def _random_schedule(shape: tuple[int, int], generator: np.random.Generator) -> BoolArray:
    """Switch every line at random instants, on average once a leg."""
    switches = generator.random(shape) < 1.0 / LEG_FRAMES
    switches[0] = generator.random(shape[1]) < 0.5
    return np.asarray(np.cumsum(switches, axis=0) % 2 == 1)
