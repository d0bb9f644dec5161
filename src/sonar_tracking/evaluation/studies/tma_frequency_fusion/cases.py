"""Bad data and manoeuvres of the tma-frequency-fusion study: what the default makes of them.

Every case is one of the scenarios with one thing gone wrong, in the same runs as the clean rows,
so that each error stands against the clean one. The estimator has one parameter set throughout.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import (
    TmaHistories,
    frame_metrics,
    history_of,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.runs import (
    SceneBatch,
    SceneBound,
    SceneHistories,
    scene_bound,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import (
    PROPOSED,
    RANGE_BANK,
    SYSTEMS,
)
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, TmaScene, simulate_runs

CHANGE_FRAME = 250
TURN_RATE_DEG, TURN_FRAMES = 3.0, 30
SETTLED_FRAME = 330
CHANGED_LINE, FALSE_FREQUENCY = 1, 215.0
SHIFT_DEVIATIONS = 3.0
OUTLIERS, OUTLIER_SPREAD = 0.05, 50.0

CONDITION = "gone wrong: "
"""How the condition of these rows begins."""


@dataclass(frozen=True)
class Case:
    """One thing gone wrong.

    Attributes
    ----------
    scenario : str
        S1, S2 or S3.
    scene : callable
        Changes the scene before anything is drawn.
    measured : callable
        Changes what was measured.
    """

    scenario: str
    scene: Callable[[TmaScene], TmaScene]
    measured: Callable[[TmaRuns, tuple[np.random.SeedSequence, ...]], TmaRuns]

    @property
    def changes_scene(self) -> bool:
        """Whether its bound is not that of the scenario."""
        return self.scene is not _same


def estimate_case(part: SceneBatch) -> SceneHistories:
    """Run the default and the paper's estimator on a batch of a case.

    Parameters
    ----------
    part : SceneBatch
        Name of the case, and runs.
    """
    case = CASES[part.scenario]
    seeds = part.batch.seeds
    runs = case.measured(simulate_runs(case.scene(scenario(case.scenario)), seeds), seeds)
    histories = {name: history_of(SYSTEMS[name](), runs) for name in (RANGE_BANK, PROPOSED)}
    return SceneHistories(part.scenario, histories)


def case_bound(part: SceneBatch) -> SceneBound:
    """Return the bound of a case's scene (of clean measurements).

    Parameters
    ----------
    part : SceneBatch
        Name of the case, and runs whose true paths are used.
    """
    case = CASES[part.scenario]
    return SceneBound(part.scenario, scene_bound(case.scene(scenario(case.scenario)), part.batch))


def case_rows(
    histories: Mapping[str, Mapping[str, TmaHistories]], bounds: Mapping[str, FloatArray]
) -> tuple[StudyRow, ...]:
    """Return the rows of all cases.

    Parameters
    ----------
    histories : mapping
        By scenario or case, then by estimator.
    bounds : mapping of str to ndarray, shape (n_frames, 4)
        By scenario, and by case where it changes the scene: root of the bounds on range, azimuth,
        course and speed, m, deg, deg, m/s.
    """
    rows = []
    for name, case in CASES.items():
        bound = bounds[name if case.changes_scene else case.scenario]
        for system in (RANGE_BANK, PROPOSED):
            own, clean = histories[name][system], histories[case.scenario][system]
            metrics = frame_metrics(own, bound, -1)
            without = frame_metrics(clean, bounds[case.scenario], -1)
            settled = np.mean(own.nees[:, SETTLED_FRAME:], axis=0)
            after = slice(CHANGE_FRAME, None)
            rows.append(
                StudyRow(
                    system,
                    f"{CONDITION}{name}, {case.scenario}",
                    {
                        "case_range_rmse_m": metrics["range_rmse_m"],
                        "range_median_m": metrics["range_median_m"],
                        "range_per_bound": metrics["range_per_bound"],
                        "range_per_clean": metrics["range_rmse_m"] / without["range_rmse_m"],
                        "nees_settled": float(np.max(settled)),
                        "manoeuvre_percent": _percent(own.manoeuvre[:, after]),
                        "reborn_percent": _percent(own.reborn[:, after]),
                    },
                )
            )
    return tuple(rows)


def _percent(alarms: BoolArray) -> float:
    return 100.0 * float(np.mean(np.any(alarms, axis=1)))


def _same(scene: TmaScene) -> TmaScene:
    return scene


def _as_measured(runs: TmaRuns, seeds: tuple[np.random.SeedSequence, ...]) -> TmaRuns:
    return runs


def _turning(scene: TmaScene) -> TmaScene:
    """Let the target turn to starboard by 90 degrees in 30 s."""
    commanded = scene.commanded.copy()
    angles = -np.radians(TURN_RATE_DEG) * np.arange(TURN_FRAMES + 1)
    x, y = scene.target[2:]
    velocity = np.stack(
        [x * np.cos(angles) - y * np.sin(angles), x * np.sin(angles) + y * np.cos(angles)], axis=1
    )
    commanded[CHANGE_FRAME : CHANGE_FRAME + TURN_FRAMES] = np.diff(velocity, axis=0)
    return replace(scene, commanded=commanded)


def _blacked_out(scene: TmaScene) -> TmaScene:
    """Silence all lines in frames 150 to 199; those that come then are new ones."""
    heard = scene.heard
    before, after = heard.copy(), heard.copy()
    before[150:] = False
    after[:200] = False
    return replace(
        scene,
        heard=np.concatenate([before, after], axis=1),
        line_frequency=np.concatenate([scene.line_frequency, scene.line_frequency + 5.0]),
    )


def _with_changed_line(runs: TmaRuns, seeds: tuple[np.random.SeedSequence, ...]) -> TmaRuns:
    """Put a false, steady source under the name of a line."""
    frequency = runs.frequency.copy()
    for run, seed in enumerate(seeds):
        noise = _generator(seed).standard_normal(frequency.shape[1] - CHANGE_FRAME)
        steady = FALSE_FREQUENCY + runs.scene.frequency_deviation * noise
        frequency[run, CHANGE_FRAME:, CHANGED_LINE] = steady
    return replace(runs, frequency=frequency)


def _with_shifted_line(runs: TmaRuns, seeds: tuple[np.random.SeedSequence, ...]) -> TmaRuns:
    """Shift one line by three standard deviations."""
    frequency = runs.frequency.copy()
    shift = SHIFT_DEVIATIONS * runs.scene.frequency_deviation
    frequency[:, CHANGE_FRAME:, CHANGED_LINE] += shift
    return replace(runs, frequency=frequency)


def _with_shifted_lines(runs: TmaRuns, seeds: tuple[np.random.SeedSequence, ...]) -> TmaRuns:
    """Shift all lines like Doppler, the weakest shift by three standard deviations."""
    frequency = runs.frequency.copy()
    source = runs.scene.line_frequency
    shift = SHIFT_DEVIATIONS * runs.scene.frequency_deviation * source / source.min()
    frequency[:, CHANGE_FRAME:] += shift
    return replace(runs, frequency=frequency)


def _with_outliers(runs: TmaRuns, seeds: tuple[np.random.SeedSequence, ...]) -> TmaRuns:
    """Make 5 % of the azimuths anything, and 5 % of the frequencies wrong by up to 50 Hz."""
    azimuth, frequency = runs.azimuth.copy(), runs.frequency.copy()
    for run, seed in enumerate(seeds):
        generator = _generator(seed)
        hit = np.less(generator.random(azimuth.shape[1]), OUTLIERS)
        anything = generator.uniform(-np.pi, np.pi, hit.shape)
        azimuth[run] = np.where(hit, anything, azimuth[run])
        hit_lines = np.less(generator.random(frequency.shape[1:]), OUTLIERS)
        off = generator.uniform(-OUTLIER_SPREAD, OUTLIER_SPREAD, hit_lines.shape)
        frequency[run] += np.where(hit_lines, off, 0.0)
    return replace(runs, azimuth=azimuth, frequency=frequency)


def _generator(seed: np.random.SeedSequence) -> np.random.Generator:
    """Return the run's second source of randomness: the first one made the clean run."""
    return np.random.default_rng(
        np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, 1))
    )


CASES = {
    "target turns 90 deg in 30 s": Case("S1", _turning, _as_measured),
    "all lines gone for 50 s": Case("S3", _blacked_out, _as_measured),
    "one line is another source": Case("S2", _same, _with_changed_line),
    "one line is another, well-measured source": Case("S3", _same, _with_changed_line),
    "one line 3 sigma off": Case("S2", _same, _with_shifted_line),
    "all lines 3 sigma off": Case("S3", _same, _with_shifted_lines),
    "5 % outliers": Case("S1", _same, _with_outliers),
}
"""By name, in the order of the report."""
