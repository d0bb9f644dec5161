"""Positions from bearings, stage by stage: targets at two stations, and one target beside peers."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.bench.contact_stages import stone_soup_installed
from sonar_tracking.evaluation.bench.kernel import PEER
from sonar_tracking.evaluation.bench.stone_soup_tma_peer import KINDS, stone_soup_path
from sonar_tracking.evaluation.bench.timing import scaling_exponent
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout
from sonar_tracking.evaluation.offline.offline_tma_chain import passive_frame
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import (
    BEARINGS_ONLY,
    RANGE_BANK,
    SYSTEMS,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.scenarios.target import LineConfiguration, TargetConfiguration
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, simulate_runs
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage

TARGETS = (1, 3, 6, 12, 24)
DATA_SECONDS = 60.0
CIRCLE = 6000.0
"""Radius of the circle the targets are on, m; its middle is between the stations."""

MOST_SECONDS = 8.0
"""Of processor time for one number of targets: what comes after is not measured."""

SCENE_RUNS = 3
CROSS_FIX = "two stations"
SCENE = "S1, one target, 400 frames"

TMA_LAYOUTS = (
    TableLayout(
        "Positions from bearings, one thread",
        (
            Column("milliseconds_per_frame", "ms/frame", ".2f"),
            Column("worst_milliseconds", "worst, ms", ".1f"),
            Column("frames", "frames", ".0f"),
            Column("exponent", "exponent", ".2f"),
        ),
        "Stations of the scenario cross_fix, targets on a circle, each with a tonal; from the "
        "first frame, which pairs bearings of the stations.",
    ),
    TableLayout(
        "One target, one thread",
        (
            Column("microseconds_per_frame", "µs/frame", ",.0f"),
            Column("range_error_m", "range error, m", ",.0f"),
        ),
        f"Median error of {SCENE_RUNS} runs in the last frame. The peers, and the range bank "
        "'bearings only', take no tonals.",
    ),
)


def measure_targets(n_targets: int) -> StudyRow:
    """Measure the tracker with targets at two stations.

    Parameters
    ----------
    n_targets : int
        How many.
    """
    frames = _frames(n_targets)
    stage = TmaTrackerStage(TmaTrackerConfiguration(), 2)
    seconds: list[float] = []
    for frame in frames:
        started = time.process_time()
        stage.update(frame)
        seconds.append(time.process_time() - started)
        if sum(seconds) > MOST_SECONDS:
            break
    figures = {
        "milliseconds_per_frame": 1e3 * float(np.mean(seconds)),
        "worst_milliseconds": 1e3 * max(seconds),
        "frames": float(len(seconds)),
    }
    return StudyRow(f"targets {n_targets}", CROSS_FIX, figures)


def target_exponent(rows: Sequence[StudyRow]) -> tuple[StudyRow, ...]:
    """Return the rows of :func:`measure_targets` with the exponent in the last one."""
    sizes = [float(row.system.split()[-1]) for row in rows]
    seconds = [row.metrics["milliseconds_per_frame"] for row in rows]
    last = rows[-1]
    figures = {**last.metrics, "exponent": scaling_exponent(sizes, seconds)}
    return (*rows[:-1], StudyRow(last.system, last.condition, figures))


@dataclass(frozen=True)
class _Finished:
    """Processor time of a run, s, and its error of range at the end, m."""

    seconds: float
    error: float


def measure_scene() -> tuple[StudyRow, ...]:
    """Measure estimators of one target on S1, and Stone Soup's where that is installed."""
    runs = [
        simulate_runs(scenario("S1"), [seed])
        for seed in np.random.SeedSequence(1).spawn(SCENE_RUNS)
    ]
    systems: dict[str, Callable[[TmaRuns], FloatArray]] = {
        name: _ours(name) for name in (RANGE_BANK, BEARINGS_ONLY)
    }
    if stone_soup_installed():
        systems |= {f"{PEER}Stone Soup {kind}": _peer(kind) for kind in KINDS}
    rows = []
    for name, path in systems.items():
        finished = [_run(path, run) for run in runs]
        n_frames = len(runs[0].scene.times)
        figures = {
            "microseconds_per_frame": 1e6 * min(one.seconds for one in finished) / n_frames,
            "range_error_m": float(np.median([one.error for one in finished])),
        }
        rows.append(StudyRow(name, SCENE, figures))
    return tuple(rows)


def _run(path: Callable[[TmaRuns], FloatArray], runs: TmaRuns) -> _Finished:
    started = time.process_time()
    last = path(runs)[-1]
    seconds = time.process_time() - started
    sensor = runs.scene.sensor_position[-1]
    found, true = (np.hypot(*(state[:2] - sensor)) for state in (last, runs.truth[0, -1]))
    return _Finished(seconds, abs(float(found - true)))


def _ours(name: str) -> Callable[[TmaRuns], FloatArray]:
    def path(runs: TmaRuns) -> FloatArray:
        estimator = SYSTEMS[name]()
        means = [estimator.update(frame).mean for frame in runs.frames()]
        return np.concatenate(means)

    return path


def _peer(kind: str) -> Callable[[TmaRuns], FloatArray]:
    def path(runs: TmaRuns) -> FloatArray:
        frames = list(runs.frames())
        interval = float(np.diff(runs.scene.times[:2])[0])
        return stone_soup_path(frames, kind, runs.scene.acceleration, interval)

    return path


def _frames(n_targets: int) -> list[PassiveFrame]:
    simulation = BearingSimulation(_scenario(n_targets))
    frames = iter(simulation.next_frame, None)
    return [passive for frame in frames if (passive := passive_frame(frame)).bearings]


def _scenario(n_targets: int) -> Scenario:
    """Return the stations of cross_fix with other targets."""
    base = load_scenario("cross_fix")
    targets = [_target(number, n_targets) for number in range(n_targets)]
    return replace(base, targets=tuple(targets), duration=DATA_SECONDS)


def _target(number: int, n_targets: int) -> TargetConfiguration:
    azimuth = 2.0 * np.pi * (number + 0.5) / n_targets
    middle = 0.5 * load_scenario("cross_fix").bearing_sensors[1].position[0]
    position = (middle + CIRCLE * np.cos(azimuth), CIRCLE * np.sin(azimuth))
    motion = KinematicMotion(
        position=position, course_deg=float(np.degrees(2.0 * azimuth) % 360.0), speed=4.0
    )
    lines = (LineConfiguration(frequency=150.0 + 20.0 * number),)
    return TargetConfiguration(name=f"target_{number}", motion=motion, lines=lines)
