"""Protects the smoother of targets: honest where errors are not as told and where targets turn.

The scene is S1 of the study tma-frequency-fusion: own ship turns three times, 400 frames, azimuths
of 0.5 degrees and six lines of 1 Hz; the bound of the filter at its end is 83 m.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.mismatch_positions.motions import zigzag
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, TmaScene, simulate_runs
from sonar_tracking.tma.batch.target_history import TargetHistory
from sonar_tracking.tma.batch.target_smoother import (
    TargetSmootherConfiguration,
    smooth_target,
)
from sonar_tracking.tma.batch.track_smoother import TrackPath, smooth_path
from sonar_tracking.tma.estimators.range_bank import RangeBank
from tests.tma.runs_together import joined_runs, slices_of

RUNS = 3
DEVIATION = np.radians(0.5)


def turning(scene: TmaScene) -> TmaScene:
    """Return the scene with a turn of 90 degrees at 1 degree/s from 200 s on."""
    commanded, velocity = np.zeros_like(scene.commanded), scene.target[2:]
    cosine, sine = np.cos(np.radians(1.0)), np.sin(np.radians(1.0))
    for frame in range(200, 290):
        after = np.array([[cosine, -sine], [sine, cosine]]) @ velocity
        commanded[frame], velocity = after - velocity, after
    return replace(scene, commanded=commanded)


def weaving(scene: TmaScene) -> TmaScene:
    """Return the scene with a zig-zag of 30 degrees, a turn each 80 s."""
    changes = zigzag(scene.target[2:], 30.0, 80, len(scene.times), 40, 1)
    return replace(scene, commanded=changes)


def twice_as_wrong(runs: TmaRuns) -> TmaRuns:
    """Return runs whose azimuths have twice the deviation told."""
    more = np.sqrt(3.0) * DEVIATION * np.random.default_rng(3).standard_normal(runs.azimuth.shape)
    return replace(runs, azimuth=runs.azimuth + more)


def correlated(runs: TmaRuns) -> TmaRuns:
    """Return runs whose azimuth errors last for 10 s, of the deviation told."""
    generator = np.random.default_rng(4)
    kept = np.exp(-0.1)
    error = generator.standard_normal(runs.azimuth.shape)
    for frame in range(1, error.shape[1]):
        error[:, frame] = kept * error[:, frame - 1] + np.sqrt(1.0 - kept**2) * error[:, frame]
    offset = runs.truth[..., :2] - runs.scene.sensor_position
    return replace(runs, azimuth=np.arctan2(offset[..., 1], offset[..., 0]) + DEVIATION * error)


def with_outliers(runs: TmaRuns) -> TmaRuns:
    """Return runs in which every tenth azimuth is anything."""
    generator = np.random.default_rng(5)
    wild = generator.random(runs.azimuth.shape) < 0.1
    anything = generator.uniform(-np.pi, np.pi, runs.azimuth.shape)
    return replace(runs, azimuth=np.where(wild, anything, runs.azimuth))


def as_told(runs: TmaRuns) -> TmaRuns:
    return runs


def history_of(runs: TmaRuns, run: int) -> TargetHistory:
    scene = runs.scene
    nothing = np.full(len(scene.times), np.nan)
    heard = np.isfinite(runs.frequency[run])
    return TargetHistory(
        times=scene.times,
        station=np.zeros(len(scene.times), np.int64),
        position=scene.sensor_position,
        velocity=scene.sensor_velocity,
        azimuth=np.stack([runs.azimuth[run], nothing], axis=1),
        azimuth_deviation=np.full(len(scene.times), scene.azimuth_deviation),
        elevation=nothing,
        elevation_deviation=nothing,
        height=0.0,
        frequency=runs.frequency[run],
        frequency_deviation=np.where(heard, scene.frequency_deviation, np.nan),
    )


def half_a_degree_off(runs: TmaRuns) -> TmaRuns:
    """Return runs whose azimuths are all off to the same side."""
    return replace(runs, azimuth=runs.azimuth + np.radians(0.5))


SCENES: dict[str, Callable[[], TmaScene]] = {
    "S1": lambda: scenario("S1"),
    "S3": lambda: scenario("S3"),
    "turn": lambda: turning(scenario("S1")),
    "zigzag": lambda: weaving(scenario("S1")),
}
CASES: list[tuple[str, Callable[[TmaRuns], TmaRuns]]] = [
    ("S1", as_told),
    ("S1", twice_as_wrong),
    ("S1", correlated),
    ("S1", with_outliers),
    ("S1", half_a_degree_off),
    ("turn", as_told),
    ("zigzag", as_told),
]


def runs_of(name: str, disturb: Callable[[TmaRuns], TmaRuns]) -> TmaRuns:
    return disturb(simulate_runs(SCENES[name](), np.random.SeedSequence(15).spawn(RUNS)))


@cache
def filtered(*cases: tuple[str, Callable[[TmaRuns], TmaRuns]]) -> list[tuple[FloatArray, ...]]:
    """Return mean and covariance of every frame in the runs of each case, by the range bank."""
    parts, bank = [runs_of(*case) for case in cases], RangeBank()
    estimates = [bank.update(measurement) for measurement in joined_runs(parts).frames()]
    mean = np.stack([one.mean for one in estimates], axis=1)
    covariance = np.stack([one.covariance for one in estimates], axis=1)
    return [(mean[own], covariance[own]) for own in slices_of(parts)]


def smoothed(
    name: str,
    disturb: Callable[[TmaRuns], TmaRuns],
    configuration: TargetSmootherConfiguration,
) -> FloatArray:
    """Return distance (m) and NEES per dimension of every frame, shape (2, RUNS, n_frames)."""
    runs, case = runs_of(name, disturb), (name, disturb)
    together = CASES if case in CASES else [case]
    means, covariances = filtered(*together)[together.index(case)]
    scene = runs.scene
    figures = []
    for run, (mean, covariance) in enumerate(zip(means, covariances, strict=True)):
        start = smooth_path(TrackPath(scene.times, mean, covariance), 0.01).mean
        prior = KalmanState(mean[0], covariance[0])
        path = smooth_target(history_of(runs, run), start, prior, configuration)
        error = path.mean - runs.truth[run]
        figures.append([np.hypot(*error[:, :2].T), normalised_squared(error, path.covariance)])
    return np.array(figures).swapaxes(0, 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "disturb", "rmse"),
    [
        ("S1", as_told, 130.0),
        ("S1", twice_as_wrong, 180.0),
        ("S1", correlated, 350.0),
        ("S1", with_outliers, 150.0),
        ("S3", as_told, 180.0),
        ("turn", as_told, 200.0),
    ],
)
def test_the_whole_path_is_found_with_an_honest_covariance(
    name: str, disturb: Callable[[TmaRuns], TmaRuns], rmse: float
) -> None:
    few = TargetSmootherConfiguration(systematic_deviation_deg=0.1)
    distance, nees = smoothed(name, disturb, few)
    assert np.sqrt(np.mean(distance**2)) < rmse
    assert 0.4 < np.mean(nees) < 1.6
    assert np.mean(nees > 5.0) < 0.02


@pytest.mark.slow
def test_a_zigzag_is_no_lasting_error_of_bearings() -> None:
    """Taken for one, the path is hundreds of metres off, with a NEES of thirty."""
    few = TargetSmootherConfiguration(systematic_deviation_deg=0.1)
    distance, nees = smoothed("zigzag", as_told, few)
    assert np.sqrt(np.mean(distance**2)) < 350.0
    assert np.mean(nees) < 2.0


@pytest.mark.slow
def test_a_lasting_error_of_half_a_degree_is_allowed_for_by_default() -> None:
    none = TargetSmootherConfiguration(systematic_deviation_deg=0.0)
    by_configuration = [
        float(np.mean(smoothed("S1", half_a_degree_off, configuration)[1]))
        for configuration in (TargetSmootherConfiguration(), none)
    ]
    assert 0.4 < by_configuration[0] < 2.0 < 4.0 < by_configuration[1]


@pytest.mark.slow
def test_turning_the_scene_turns_the_path() -> None:
    runs = simulate_runs(scenario("S1"), np.random.SeedSequence(2).spawn(1))
    history = history_of(runs, 0)
    start, prior = runs.truth[0], KalmanState(runs.truth[0, 0], np.diag([1e6, 1e6, 100.0, 100.0]))
    cosine, sine = np.cos(1.0), np.sin(1.0)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    turned = replace(
        history,
        position=history.position @ turn.T,
        velocity=history.velocity @ turn.T,
        azimuth=wrap_angle(history.azimuth + 1.0),
    )
    both = np.kron(np.eye(2), turn)
    there = smooth_target(turned, start @ both.T, KalmanState(both @ prior.mean, prior.covariance))
    here = smooth_target(history, start, prior)
    np.testing.assert_allclose(there.mean, here.mean @ both.T, atol=1e-3)
    np.testing.assert_allclose(there.covariance, both @ here.covariance @ both.T, rtol=1e-4)


@pytest.mark.slow
def test_bent_rays_widen_the_range_that_an_elevation_gives() -> None:
    """At rest 1000 m away and 1000 m up: dr = (r^2 + h^2) / h de, with de = b / 2."""
    n, height, bending = 60, 1000.0, 0.02
    times = np.arange(float(n))
    noise = 1e-3 * np.random.default_rng(1).standard_normal((2, n))
    history = TargetHistory(
        times=times,
        station=np.zeros(n, np.int64),
        position=np.zeros((n, 2)),
        velocity=np.zeros((n, 2)),
        azimuth=np.stack([noise[0], np.full(n, np.nan)], axis=1),
        azimuth_deviation=np.full(n, 1e-3),
        elevation=np.pi / 4.0 + noise[1],
        elevation_deviation=np.full(n, 1e-3),
        height=height,
        frequency=np.empty((n, 0)),
        frequency_deviation=np.empty((n, 0)),
    )
    start = np.tile([height, 0.0, 0.0, 0.0], (n, 1))
    prior = KalmanState(start[0], np.diag([1e6, 1e6, 0.01, 0.01]))
    exact = TargetSmootherConfiguration(systematic_deviation_deg=0.0)
    straight = smooth_target(history, start, prior, exact)
    bent = smooth_target(replace(history, bending=bending), start, prior, exact)
    added = (bent.covariance - straight.covariance)[n // 2]
    assert np.sqrt(added[0, 0]) == pytest.approx(2.0 * height * bending / 2.0, rel=0.1)
    assert added[1, 1] == pytest.approx(0.0, abs=1.0)
