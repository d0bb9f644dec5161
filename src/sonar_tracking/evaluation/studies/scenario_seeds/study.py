"""Study scenario-seeds: what the scenarios that end in positions give with many seeds.

A run of a scenario is one draw of its noise; a figure of one run says little. Each scenario is run
through its chain with the seeds from the one given on, and every figure of the score is told as
its median over the seeds with the 10 and 90 % quantiles, so that seed 1 is what ``sonar-tracking
run`` shows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.position_score import PositionScore, score_position_tracks
from sonar_tracking.evaluation.metrics.position_truth import truth_as_tracks
from sonar_tracking.evaluation.monte_carlo.batch_runner import Task
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.offline.offline_bearing_chain import stage_configuration
from sonar_tracking.evaluation.offline.offline_contact_chain import run_offline_active_chain
from sonar_tracking.evaluation.offline.offline_sample_chain import positions_of_samples
from sonar_tracking.evaluation.offline.offline_tma_chain import (
    TRACKER,
    passive_frame,
    run_offline_tma_chains,
)
from sonar_tracking.evaluation.studies.scenario_seeds.figures import draw_errors
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.tma.batch.target_smoother import TargetSmootherConfiguration
from sonar_tracking.tma.targets.observation_log import ObservationLog
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.track_smoothing import smooth_tracks

QUANTILES = {"low": 10.0, "median": 50.0, "high": 90.0}
"""Over the seeds, %."""


RUNS_PER_TASK = 10
"""Computed together; more would save little and leave workers idle at the end."""


@dataclass(frozen=True)
class SeededRuns:
    """Runs of a scenario that are computed together.

    Attributes
    ----------
    scenario : str
        Its name.
    seeds : tuple of int
        Of the noise, one a run.
    duration : float or None
        Of the data, s; None = the scenario's own.
    """

    scenario: str
    seeds: tuple[int, ...]
    duration: float | None = None


@dataclass(frozen=True)
class RunFigures:
    """What one run gave.

    Attributes
    ----------
    system : str
        The scenario, and whether its tracks are smoothed.
    seed : int
        Of the run.
    figures : dict of str to float
        Of its score; NaN = unknown.
    """

    system: str
    seed: int
    figures: dict[str, float]


Scores = tuple[PositionScore, ...]
"""Of the tracks as they came, and of those with hindsight if there are any."""


def score_contacts(scenarios: Sequence[Scenario]) -> list[Scores]:
    """Return the score of each of several scenarios with an active sonar."""
    return [(run_offline_active_chain(scenario).score(),) for scenario in scenarios]


def score_bearings(scenarios: Sequence[Scenario]) -> list[Scores]:
    """Return the scores of each of several scenarios with stations that measure bearings."""
    scores: list[Scores] = []
    for scenario, run in zip(scenarios, run_offline_tma_chains(scenarios), strict=True):
        frames = [passive_frame(frame) for frame in run.frames]
        truth = [truth_as_tracks(frame.truth_tracks) for frame in run.frames]
        smoothed = _smoothed(scenario, frames, run.tracks)
        scores.append((run.score(), score_position_tracks(truth, smoothed)))
    return scores


def score_samples(scenarios: Sequence[Scenario]) -> list[Scores]:
    """Return the scores of the positions made of each of several scenarios with hydrophones."""
    scores: list[Scores] = []
    for scenario, run in zip(scenarios, positions_of_samples(scenarios), strict=True):
        truth = [truth_as_tracks(one) for one in run.truth]
        smoothed = _smoothed(scenario, run.frames, run.positions)
        scores.append(
            (
                score_position_tracks(truth, run.positions),
                score_position_tracks(truth, smoothed),
            )
        )
    return scores


def _smoothed(
    scenario: Scenario, frames: Sequence[PassiveFrame], tracks: Sequence[PositionTracks]
) -> tuple[PositionTracks, ...]:
    where = f"{scenario.name}: nodes.{TRACKER}"
    tracker = stage_configuration(TmaTrackerConfiguration, scenario.nodes.get(TRACKER, {}), where)
    log = ObservationLog(tracker)
    log.add_all(frames)
    smoother = TargetSmootherConfiguration(
        acceleration=tracker.acceleration, manoeuvre_acceleration=tracker.manoeuvre_acceleration
    )
    return smooth_tracks(tracks, log.observations, tracker, smoother).pictures


CHAINS: dict[str, Callable[[Sequence[Scenario]], list[Scores]]] = {
    "active": score_contacts,
    "tma": score_bearings,
    "cross_fix": score_bearings,
    "tonals": score_samples,
}
"""What scores the runs of each scenario, which differ by their seeds, from its chain; in the order
of the time that they take."""

SYSTEMS = ("{}", "{}, smoothed")
"""What the tracks of each score are called."""

FIGURES = ("median_error_m", "rmse_m", "far_share", "held_share", "nees_median_per_dimension")
FIGURES_OF_TIME = ("confirmation_delay", "confirmation_delay_periods")
COUNTS = ("false_tracks", "identity_swaps", "targets_never_held")


def score_runs(runs: SeededRuns) -> tuple[RunFigures, ...]:
    """Return the figures of runs of a scenario.

    Parameters
    ----------
    runs : SeededRuns
        Scenario and seeds.
    """
    scenario = load_scenario(runs.scenario)
    if runs.duration is not None:
        scenario = replace(scenario, duration=runs.duration)
    scores = CHAINS[runs.scenario]([replace(scenario, seed=seed) for seed in runs.seeds])
    return tuple(
        RunFigures(system.format(runs.scenario), seed, _figures(score))
        for seed, own in zip(runs.seeds, scores, strict=True)
        for system, score in zip(SYSTEMS, own, strict=False)
    )


def _figures(score: PositionScore) -> dict[str, float]:
    scored = score.to_mapping()
    figures = {}
    for name in (*FIGURES, *FIGURES_OF_TIME, *COUNTS):
        value = scored[name]
        figures[name] = float(value) if isinstance(value, int | float) else np.nan
    return figures


def scenario_rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Return one row a system: quantiles of each figure over the seeds, means of counts."""
    parts = [part for result in results for part in result]
    rows = []
    for name in _systems(parts):
        own = [part for part in parts if part.system == name]
        metrics = {}
        for figure in (*FIGURES, *FIGURES_OF_TIME):
            values = np.array([one.figures[figure] for one in own])
            known = values[np.isfinite(values)]
            for label, quantile in QUANTILES.items():
                value = np.percentile(known, quantile) if len(known) else np.nan
                metrics[f"{figure}_{label}"] = float(value)
        for count in COUNTS:
            metrics[f"{count}_mean"] = float(np.mean([one.figures[count] for one in own]))
        lost = [one for one in own if np.isnan(one.figures["median_error_m"])]
        metrics["runs_without_positions"] = float(len(lost))
        seeds = [one.seed for one in own]
        rows.append(StudyRow(name, f"seeds {min(seeds)} to {max(seeds)}", metrics))
    return tuple(rows)


def _systems(parts: Sequence[RunFigures]) -> list[str]:
    """Return the systems that there are figures of, in the order of the scenarios."""
    there = {part.system for part in parts}
    every = (system.format(name) for name in CHAINS for system in SYSTEMS)
    return [name for name in every if name in there]


def _tasks(runs: int, seed: int) -> tuple[Task, ...]:
    if runs < 1:
        raise ConfigurationError(f"runs is {runs}; a study needs at least 1 run.")
    if seed < 0:
        raise ConfigurationError(f"seed is {seed}; give a whole number of at least 0.")
    seeds = tuple(range(seed, seed + runs))
    parts = [seeds[first : first + RUNS_PER_TASK] for first in range(0, runs, RUNS_PER_TASK)]
    # Those of the longest runs come first: short tasks at the end leave no worker idle.
    names = reversed(CHAINS)
    return tuple(Task(score_runs, SeededRuns(name, own)) for name in names for own in parts)


def _spread(figure: str, heading: str, form: str) -> tuple[Column, ...]:
    """Return the columns of a figure: median, then the two quantiles around it."""
    return (
        Column(f"{figure}_median", heading, form),
        Column(f"{figure}_low", "10 %", form),
        Column(f"{figure}_high", "90 %", form),
    )


def _draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
    parts = [part for result in results for part in result]
    errors = {
        name: [one.figures["median_error_m"] for one in parts if one.system == name]
        for name in _systems(parts)
    }
    return draw_errors(errors, directory)


SCENARIO_SEEDS = StudyDefinition(
    name="scenario-seeds",
    description="the scenarios that end in positions, with many seeds",
    default_runs=20,
    tasks=_tasks,
    rows=scenario_rows,
    layouts=(
        TableLayout(
            "Position errors of the scenarios, over seeds",
            (
                *_spread("median_error_m", "median m", ".1f"),
                *_spread("rmse_m", "RMSE m", ".1f"),
                *_spread("far_share", "far off", ".3f"),
            ),
            "Median over the seeds, and its 10 and 90 % quantiles, of each run's median error and "
            "RMSE of the rows that are assigned to a target, and of its share of rows more than "
            "200 m from every target.",
        ),
        TableLayout(
            "Tracks of the scenarios, over seeds",
            (
                *_spread("held_share", "time tracked", ".3f"),
                *_spread("confirmation_delay", "delay s", ".0f"),
                *_spread("nees_median_per_dimension", "NEES", ".2f"),
                Column("false_tracks_mean", "false", ".2f"),
                Column("identity_swaps_mean", "swaps", ".2f"),
                Column("runs_without_positions", "none", ".0f"),
            ),
            "NEES: median of each run, 0.84 is consistent. false, swaps: mean count a run. none: "
            "runs in which no confirmed row was near a target.",
        ),
    ),
    draw=_draw,
)
