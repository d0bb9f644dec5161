"""Protects the difference between a solution and its prior."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scene_of_legs
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, TmaScene, simulate_runs
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.targets import observability as observability_module
from sonar_tracking.tma.targets.measurement_log import LOG_FRAMES, MeasurementLog
from sonar_tracking.tma.targets.observability import (
    AZIMUTH,
    ELEVATION,
    HEIGHT,
    LINES,
    POSITION,
    TIME,
    VELOCITY,
    MeasurementHistory,
    motion_information,
    observability,
    root_of,
)

STRAIGHT, TURNING = (90.0,) * 4, (90.0, 0.0, 90.0, 0.0)
PRIOR = np.diag([20_000.0**2 / 12, 100.0**2, 400.0 / 3, 400.0 / 3])


def single(frame: TmaMeasurement) -> TmaMeasurement:
    return replace(
        frame,
        azimuth=frame.azimuth[0],
        frequency=frame.frequency[0],
        frequency_deviation=frame.frequency_deviation[0],
    )


def logged(scene: TmaScene) -> tuple[TmaRuns, MeasurementLog]:
    runs = simulate_runs(replace(scene, acceleration=0.0), np.random.SeedSequence(1).spawn(1))
    frames = [single(frame) for frame in runs.frames()]
    log = MeasurementLog(frames[0], 20_000.0, 20.0)
    for frame in frames:
        log.append(frame)
    return runs, log


def prior_of(scene: TmaScene) -> FloatArray:
    """Return the prior laid along the first line of sight."""
    offset = scene.target[:2] - scene.sensor_position[0]
    along = offset / np.hypot(*offset)
    across = np.array([-along[1], along[0]])
    prior = PRIOR.copy()
    prior[:2, :2] = PRIOR[0, 0] * np.outer(along, along) + PRIOR[1, 1] * np.outer(across, across)
    return prior


def figure(scene: TmaScene) -> float:
    runs, log = logged(scene)
    return observability(
        runs.truth[0, -1], scene.line_frequency, log.history(), root_of(prior_of(scene))
    )


def silent(scene: TmaScene) -> TmaScene:
    return replace(scene, heard=np.zeros_like(scene.heard))


def range_bound(scene: TmaScene) -> float:
    """Return the root of the bound on the last range, without process noise."""
    runs, log = logged(scene)
    information = motion_information(runs.truth[0, -1], scene.line_frequency, log.history())
    covariance = np.linalg.inv(np.linalg.inv(prior_of(scene)) + information)
    transition = np.eye(4)
    transition[:2, 2:] = scene.times[-1] * np.eye(2)
    covariance = transition @ covariance @ transition.T
    offset = runs.truth[0, -1, :2] - scene.sensor_position[-1]
    along = offset / np.hypot(*offset)
    return float(np.sqrt(along @ covariance[:2, :2] @ along))


@pytest.mark.parametrize(
    ("scene", "expected"),
    [
        (silent(scene_of_legs(TURNING, 1.0)), 58.0),
        (silent(scene_of_legs(STRAIGHT, 1.0)), 2599.0),
        (replace(scene_of_legs(STRAIGHT, 1.0), heard=np.ones((400, 6), bool)), 185.0),
        (replace(scene_of_legs(STRAIGHT, 0.05), heard=np.ones((400, 6), bool)), 17.0),
    ],
)
def test_the_information_gives_the_known_bounds(scene: TmaScene, expected: float) -> None:
    assert range_bound(scene) == pytest.approx(expected, rel=0.03)


def test_bearings_alone_need_a_turn() -> None:
    assert figure(silent(scene_of_legs(STRAIGHT, 1.0))) < 0.5
    assert figure(silent(scene_of_legs(TURNING, 1.0))) > 0.9


def test_doppler_replaces_the_turn() -> None:
    assert figure(scene_of_legs(STRAIGHT, 0.05)) > 0.9


def test_doppler_does_not_help_without_bearing_rate() -> None:
    scene = scene_of_legs(STRAIGHT, 0.05)
    direction = scene.target[:2] / np.hypot(*scene.target[:2])
    closing = scene.sensor_velocity[0] - 4.0 * direction
    scene = replace(scene, target=np.concatenate([scene.target[:2], closing]))
    assert figure(scene) < 0.05


def test_the_log_keeps_its_first_and_its_last_measurements() -> None:
    _, log = logged(scene_of_legs(STRAIGHT, 1.0))
    frame = single(
        next(simulate_runs(scene_of_legs(STRAIGHT, 1.0), [np.random.SeedSequence(1)]).frames())
    )
    for second in range(LOG_FRAMES):
        log.append(replace(frame, stamp=frame.stamp + (1000 + second) * 10**9))
    times = log.history().table[:, TIME]
    assert len(times) == LOG_FRAMES
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(1000.0 + LOG_FRAMES - 1)
    assert np.all(np.diff(times) > 0.0)
    log.forget_lines((2,))
    assert not np.any(log.history().table[:, LINES + 2])


def by_differences(
    mean: np.ndarray, sources: np.ndarray, history: MeasurementHistory
) -> np.ndarray:
    """Return the information on the motion at the first time, from residuals and their slopes."""
    table = history.table
    since = table[:, TIME] - table[0, TIME]
    span = since[-1]

    def predicted(parameters: np.ndarray) -> np.ndarray:
        offset = parameters[:2] + np.outer(since, parameters[2:4]) - table[:, POSITION]
        distance = np.hypot(offset[:, 0], offset[:, 1])
        rate = np.sum(offset * (parameters[2:4] - table[:, VELOCITY]), axis=1) / distance
        lines = (1.0 - rate / history.sound_speed)[:, None] * parameters[4:]
        azimuth, elevation = (
            np.arctan2(offset[:, 1], offset[:, 0]),
            np.arctan2(table[:, HEIGHT], distance),
        )
        return np.concatenate([azimuth, elevation, lines.T.ravel()])

    at = np.concatenate([mean[:2] - span * mean[2:], mean[2:], sources])
    steps = np.diag([1e-2, 1e-2, 1e-5, 1e-5] + [1e-4] * len(sources))
    slopes = np.stack(
        [(predicted(at + step) - predicted(at - step)) / (2.0 * step.sum()) for step in steps],
        axis=1,
    )
    weight = np.concatenate(
        [
            table[:, AZIMUTH],
            table[:, ELEVATION],
            table[:, LINES:].T.ravel(),
        ]
    )
    full = slopes.T @ (weight[:, None] * slopes)
    heard = [4 + row for row in range(len(sources)) if table[:, LINES + row].any()]
    nuisance = full[np.ix_(heard, heard)]
    common = full[:4][:, heard]
    return np.asarray(full[:4, :4] - common @ np.linalg.solve(nuisance, common.T))


def turning_history() -> MeasurementHistory:
    """Return azimuths, elevations from 40 s on and three lines, one of which is never heard."""
    generator = np.random.default_rng(1)
    times = np.append(0.0, np.cumsum(generator.uniform(1.0, 9.0, 24)))
    velocity = np.where(times[:, None] < 60.0, [6.0, 1.0], [-2.0, 5.0])
    columns = (
        times[:, None],
        np.cumsum(velocity * np.diff(times, prepend=0.0)[:, None], axis=0),
        velocity,
        generator.uniform(0.0, 2e4, (25, 1)),
        np.where(times > 40.0, 3e4, 0.0)[:, None],
        np.full((25, 1), -150.0),
        generator.uniform(0.0, 50.0, (25, 3)) * [1.0, 0.0, 2.0],
    )
    return MeasurementHistory(np.concatenate(columns, axis=1), 1480.0)


MEAN, SOURCES = np.array([2500.0, 1800.0, -3.0, 4.0]), np.array([300.0, np.nan, 120.0])


def test_the_information_is_that_of_slopes_with_the_sources_eliminated() -> None:
    history, sources = turning_history(), np.where(np.isnan(SOURCES), 1.0, SOURCES)
    information = motion_information(MEAN, SOURCES, history)
    expected = by_differences(MEAN, sources, history)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(information / scale, expected / scale, atol=1e-5)


@pytest.mark.skipif(observability_module.COMPILED is None, reason="no compiler was there")
@pytest.mark.parametrize("lines", [0, 2, 3])
def test_compiled_sums_give_the_bits_of_numpy(lines: int, monkeypatch: pytest.MonkeyPatch) -> None:
    history = turning_history()
    compiled = motion_information(MEAN, SOURCES[:lines], history)
    monkeypatch.setattr(observability_module, "COMPILED", None)
    assert np.array_equal(compiled, motion_information(MEAN, SOURCES[:lines], history))
    assert np.array_equal(compiled, compiled.T)


@pytest.mark.skipif(observability_module.COMPILED is None, reason="no compiler was there")
def test_compiled_sums_refuse_buffers_of_another_shape() -> None:
    history = turning_history()
    with pytest.raises(ValueError, match="stated shape"):
        motion_information(MEAN, np.ones(4), history)
    with pytest.raises(ValueError, match="stated shape"):
        motion_information(MEAN[:3], SOURCES, history)


def test_the_figure_is_the_least_gain_over_the_prior() -> None:
    """Information of g times that of the prior in its weakest direction: g / (1 + g)."""
    table = np.zeros((3, LINES))
    table[:, TIME] = 0.0, 10.0, 20.0
    table[1:, POSITION] = [[0.0, 500.0], [700.0, 0.0]]
    table[:, AZIMUTH] = 1e4, 2e4, 1e4
    history = MeasurementHistory(table, 1500.0)
    mean = np.array([1000.0, 1000.0, 2.0, -1.0])
    prior = np.diag([1e6, 4e6, 100.0, 50.0])
    prior[0, 1] = prior[1, 0] = 1e6
    information = motion_information(mean, np.zeros(0), history)
    gain = float(np.min(np.linalg.eigvals(prior @ information).real))
    assert observability(mean, np.zeros(0), history, root_of(prior)) == pytest.approx(
        max(gain, 0.0) / (1.0 + max(gain, 0.0)), rel=1e-6, abs=1e-9
    )
    table[:, AZIMUTH] = 0.0
    silent = MeasurementHistory(table, 1500.0)
    assert observability(mean, np.zeros(0), silent, root_of(prior)) == pytest.approx(0.0, abs=1e-12)
