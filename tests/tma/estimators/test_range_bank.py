"""Protects the default estimator: accuracy, honesty, and what it does with bad data."""

from dataclasses import replace
from functools import cache
from itertools import islice

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import (
    TmaHistories,
    history_of,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, TmaScene, simulate_runs
from sonar_tracking.tma.estimators.hypothesis_bank import predict_bank
from sonar_tracking.tma.estimators.motion_modes import MANOEUVRING, MODES
from sonar_tracking.tma.estimators.range_bank import RangeBank
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.range_bank_state import start_range_bank
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from tests.tma.runs_together import follow_together

BOUND_S1, BOUND_S2, BOUND_S3 = 80.5, 144.1, 83.2
"""Root of the posterior bound on the range in the last frame, m."""

RUNS = {"S1": (10, 30), "S2": (20, 40), "S3": (20, 40)}
"""First and past last: the NEES of half of the frames is as certain as one of twice the runs."""


def runs_of(scene: TmaScene, n_runs: int, first: int = 0) -> TmaRuns:
    return simulate_runs(scene, np.random.SeedSequence(11).spawn(first + n_runs)[first:])


def last_range_rmse(histories: TmaHistories) -> float:
    return float(np.sqrt(np.mean(histories.error[:, -1, 0] ** 2)))


@cache
def followed(name: str) -> list[TmaHistories]:
    """Return the runs of a scene; of S1 those with outliers too, of S3 some with silence."""
    first, past_last = RUNS[name]
    parts = [runs_of(scenario(name), past_last - first, first)]
    if name == "S1":
        parts.append(wild(parts[0]))
    if name == "S3":
        parts.append(runs_of(silenced(scenario(name)), 12, first))
    return follow_together(RangeBank(), parts)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "limit", "least_nees"),
    [("S1", 1.35 * BOUND_S1, 0.6), ("S2", 1.8 * BOUND_S2, 0.6), ("S3", 1.35 * BOUND_S3, 0.8)],
)
def test_near_the_bound_and_consistent(name: str, limit: float, least_nees: float) -> None:
    histories = followed(name)[0]
    assert last_range_rmse(histories) < limit
    assert least_nees < np.mean(histories.nees[:, 200:]) < 1.5
    assert np.count_nonzero(histories.manoeuvre) <= histories.manoeuvre.size / 4000


@pytest.mark.slow
@pytest.mark.parametrize("angle_deg", [53.0, 359.7])
def test_turning_the_scene_turns_the_result(angle_deg: float) -> None:
    angle = np.radians(angle_deg)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    runs = runs_of(scenario("S1"), 2)
    one, other = RangeBank(), RangeBank()
    for frame in islice(runs.frames(), 250):
        turned = replace(
            frame,
            position=rotation @ frame.position,
            velocity=rotation @ frame.velocity,
            azimuth=frame.azimuth + angle,
        )
        here, there = one.update(frame), other.update(turned)
    expected = np.concatenate([here.mean[:, :2] @ rotation.T, here.mean[:, 2:] @ rotation.T], 1)
    np.testing.assert_allclose(there.mean, expected, rtol=1e-6)


@pytest.mark.slow
def test_true_frame_intervals_are_used() -> None:
    scene = scenario("S1")
    intervals = np.exp(np.random.default_rng(9).uniform(np.log(0.25), np.log(4.0), 400))
    times = np.cumsum(intervals / intervals.mean())
    steps = scene.sensor_velocity[:-1] * np.diff(times)[:, None]
    position = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    histories = history_of(
        RangeBank(), runs_of(replace(scene, times=times, sensor_position=position), 15)
    )
    # The truth's accelerations last a frame each: longer frames make it swerve more than assumed.
    assert np.mean(histories.nees[:, -1]) < 2.0
    assert last_range_rmse(histories) < 2.0 * BOUND_S1


def silenced(scene: TmaScene) -> TmaScene:
    """Return the scene without lines for 50 s, and from then on with half of them."""
    heard = scene.heard.copy()
    heard[150:200] = False
    heard[200:, :3] = False
    return replace(scene, heard=heard)


@pytest.mark.slow
def test_a_blackout_is_bridged_by_bearings() -> None:
    assert last_range_rmse(followed("S3")[1]) < 1.6 * BOUND_S3


def wild(runs: TmaRuns) -> TmaRuns:
    """Make 5 % of azimuths and frequencies anything."""
    generator = np.random.default_rng(6)
    hit = generator.random(runs.azimuth.shape) < 0.05
    azimuth = np.where(hit, generator.uniform(-np.pi, np.pi, hit.shape), runs.azimuth)
    hit_lines = generator.random(runs.frequency.shape) < 0.05
    off = generator.uniform(-50.0, 50.0, hit_lines.shape)
    return replace(runs, azimuth=azimuth, frequency=runs.frequency + np.where(hit_lines, off, 0.0))


@pytest.mark.slow
def test_outliers_cost_little() -> None:
    clean, disturbed = followed("S1")
    assert last_range_rmse(disturbed) < 1.15 * last_range_rmse(clean)


@pytest.mark.slow
def test_one_run_does_not_depend_on_the_others() -> None:
    alone = history_of(RangeBank(), runs_of(scenario("S1"), 1, RUNS["S1"][0]))
    np.testing.assert_allclose(alone.error[0], followed("S1")[0].error[0], rtol=1e-6)


def test_missing_and_repeated_frames_leave_a_finite_answer() -> None:
    runs = runs_of(scenario("S1"), 1)
    estimator = RangeBank(RangeBankConfiguration(n_ranges=3))
    for index, frame in enumerate(runs.frames()):
        if 20 < index < 40:
            frame = replace(
                frame,
                azimuth=np.full_like(frame.azimuth, np.nan),
                frequency=np.full_like(frame.frequency, np.nan),
            )
        for _ in range(2 if index == 50 else 1):
            estimate = estimator.update(frame)
        if index == 60:
            break
    assert np.all(np.isfinite(estimate.mean))
    assert np.all(np.linalg.eigvalsh(estimate.covariance) > 0.0)


def frame(number: int, azimuth: float, **changes: object) -> TmaMeasurement:
    """Return one azimuth a second, measured at rest with a tenth of a degree."""
    made = TmaMeasurement(
        stamp=number * 1_000_000_000,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.array([azimuth]),
        azimuth_variance=np.array(np.radians(0.1) ** 2),
    )
    return replace(made, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(("accepted", "refused"), [(1, 3), (2, 5), (6, 5)])
def test_a_lost_filter_starts_again_after_five_refusals_and_after_three_at_the_start(
    accepted: int, refused: int
) -> None:
    bank = RangeBank()
    for number in range(accepted):
        assert not bank.update(frame(number, 0.3)).restarted
    restarted = [
        bool(bank.update(frame(accepted + number, 3.0)).restarted) for number in range(refused + 2)
    ]
    assert restarted == [False] * refused + [True, False]
    estimate = bank.update(frame(accepted + refused + 2, 3.0))
    assert np.arctan2(estimate.mean[1], estimate.mean[0]) == pytest.approx(3.0, abs=1e-2)


def test_silence_is_no_refusal_and_an_accepted_azimuth_begins_the_count_anew() -> None:
    bank = RangeBank()
    for number in range(2):
        bank.update(frame(number, 0.3))
    pattern = [3.0] * 4 + [0.3] + [3.0] * 3 + [np.nan] + [3.0] * 2
    for number, azimuth in enumerate(pattern, start=2):
        assert not bank.update(frame(number, azimuth)).restarted
    assert not bank.update(frame(20, np.nan)).restarted, "a lost filter waits for an azimuth"
    assert bank.update(frame(21, 3.0)).restarted


@pytest.mark.parametrize(("interval", "frames"), [(1, 5), (2, 5), (8, 3), (20, 2), (60, 2)])
def test_elevations_that_nothing_accepts_start_the_filter_again_within_a_minute_or_two(
    interval: int, frames: int
) -> None:
    """Those that come rarely count more: 8 s apart as two, 12 s and more as three."""
    bank = RangeBank()
    height, deviation = 300.0, np.radians(0.3)
    restarted = []
    for number in range(30):
        elevation = np.arctan2(height, 3000.0) if number < 20 else np.radians(25.0)
        measured = frame(
            number * interval,
            0.3,
            elevation=np.array(elevation),
            elevation_variance=np.array(deviation**2),
            height=height,
        )
        restarted.append(bool(bank.update(measured).restarted))
    assert restarted.index(True) == 20 + frames
    assert bank.state is not None
    position = np.exp(bank.state.bank.log_weight) @ bank.state.bank.mean[:, :2]
    assert np.hypot(*position) == pytest.approx(height / np.tan(np.radians(25.0)), rel=0.1)


def test_of_azimuths_in_a_row_that_are_refused_only_the_first_says_something_of_errors() -> None:
    bank = RangeBank()
    for number in range(40):
        bank.update(frame(number, 0.3))
    learnt = []
    for number in range(40, 44):
        bank.update(frame(number, 0.4))
        assert bank.state is not None
        learnt.append(bank.state.errors.table[0, 0])
    assert bank.state is not None and bank.state.refused == 4
    for later in learnt[1:]:
        np.testing.assert_array_equal(later, learnt[0])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["S1", "S3"])
def test_a_target_beyond_the_farthest_range_is_not_put_within_it(name: str) -> None:
    """30 km away, expected within 20 km; own ship turns in the first scene only."""
    far = replace(scenario(name), target=np.array([24_000.0, 18_000.0, -3.0, 0.0]))
    histories = history_of(RangeBank(), runs_of(far, 12))
    assert np.mean(histories.nees[:, 200:]) < 2.0


@pytest.mark.parametrize("sides", [1, 2])
def test_one_hypothesis_more_is_beyond_the_farthest_range_and_half_as_likely(sides: int) -> None:
    first = replace(frame(0, 0.3), azimuth=np.array([0.3, -0.7][:sides]))
    configuration = RangeBankConfiguration(n_ranges=4)
    bank = start_range_bank(first, configuration).bank
    weight = np.exp(bank.log_weight).reshape(sides, 5, MODES).sum(axis=2)
    assert weight == pytest.approx(np.tile([2.0, 2.0, 2.0, 2.0, 1.0], (sides, 1)) / 9.0 / sides)
    distance = np.hypot(*bank.mean[:, :2].T).reshape(sides, 5, MODES)
    assert distance[:, 4] == pytest.approx(35_000.0)
    single = start_range_bank(first, RangeBankConfiguration(n_ranges=1)).bank
    assert len(single.log_weight) == sides * MODES


def test_each_mode_has_its_own_process_noise() -> None:
    """Without an azimuth the estimate is the prediction alone."""
    configuration = RangeBankConfiguration(
        acceleration=0.02,
        manoeuvre_acceleration=0.3,
        manoeuvre_interval=1e9,
        manoeuvre_duration=1e9,
        wander_acceleration=0.06,
        weave_speed=0.0,
    )
    bank = RangeBank(configuration)
    bank.update(frame(0, 0.3))
    assert bank.state is not None
    before = bank.state.bank
    bank.update(frame(5, np.nan))
    for mode, acceleration in enumerate([0.02, 0.3, 0.06, 0.02, 0.02, 0.02]):
        own = slice(mode, None, MODES)
        alone = replace(before, mean=before.mean[own], covariance=before.covariance[own])
        expected = predict_bank(alone, 5.0, np.array(acceleration))
        assert bank.state.bank.mean[own] == pytest.approx(expected.mean)
        assert bank.state.bank.covariance[own] == pytest.approx(expected.covariance, rel=1e-6)


def test_a_target_that_moves_one_way_has_one_filter_a_hypothesis_that_is_as_good_as_six() -> None:
    lines, deviation = np.array([300.0, 210.0]), np.full(2, 0.1)
    found, components = [], []
    for wander in (0.01, 0.01 * (1.0 + 1e-14)):
        configuration = RangeBankConfiguration(
            manoeuvre_acceleration=0.01, wander_acceleration=wander, weave_speed=0.0
        )
        bank = RangeBank(configuration)
        for number in range(40):
            position = np.array([10.0 * number, -2.0 * max(number - 20, 0)])
            measured = frame(number, 0.3, frequency=lines, frequency_deviation=deviation)
            estimate = bank.update(replace(measured, position=position))
        assert bank.state is not None
        found.append(estimate)
        components.append(len(bank.state.bank.log_weight))
    assert components == [7, 7 * MODES]
    assert found[0].mean == pytest.approx(found[1].mean, rel=1e-9)
    assert found[0].covariance == pytest.approx(found[1].covariance, rel=1e-9)
    assert not found[0].manoeuvre


def test_a_turn_of_the_target_is_said_once_it_is_likely() -> None:
    """All lines shift by a thousandth of their frequencies: 1.5 m/s, up to three deviations."""
    bank = RangeBank(RangeBankConfiguration(n_ranges=1, acceleration=1e-4))
    lines, deviation = np.array([300.0, 210.0, 150.0]), np.full(3, 0.1)
    said = []
    for number in range(100):
        shifted = lines * (1.0 + (0.001 if number >= 60 else 0.0))
        measured = frame(number, 0.3, frequency=shifted, frequency_deviation=deviation)
        said.append(bool(bank.update(measured).manoeuvre))
    assert not any(said[:60])
    assert sum(said[60:65]) == sum(said[60:]) == 1
    assert bank.state is not None
    manoeuvring = np.exp(bank.state.bank.log_weight[MANOEUVRING::MODES]).sum()
    assert manoeuvring < 0.1, "it goes straight on again"
    speed = bank.state.bank.mean[0, 2:4] @ [np.cos(0.3), np.sin(0.3)]
    assert speed == pytest.approx(-1.5, abs=0.5)


def test_a_line_that_became_another_source_is_seeded_anew_and_nothing_else() -> None:
    bank = RangeBank(RangeBankConfiguration(n_ranges=1, acceleration=1e-4))
    lines, deviation = np.array([300.0, 210.0, 150.0]), np.full(3, 0.1)
    for number in range(80):
        before = bank.state
        shifted = lines + (np.array([0.0, 5.0, 0.0]) if number >= 60 else 0.0)
        measured = frame(number, 0.3, frequency=shifted, frequency_deviation=deviation)
        estimate = bank.update(measured)
        if np.any(estimate.reborn):
            break
    assert estimate.reborn.tolist() == [False, True, False]
    assert before is not None
    assert bank.state is not None
    after = bank.state.bank
    assert after.mean[0, 5] / before.bank.mean[0, 5] == pytest.approx(215.0 / 210.0, rel=1e-3)
    others = [0, 1, 2, 3, 4, 6]
    predicted = predict_bank(before.bank, 1.0, np.array(1e-4))
    assert after.mean[0, others] == pytest.approx(predicted.mean[0, others], abs=0.05)


def test_hypotheses_of_range_are_spaced_geometrically() -> None:
    configuration = RangeBankConfiguration(minimum_range=100.0, maximum_range=800.0, n_ranges=3)
    assert configuration.range_edges() == pytest.approx([100.0, 200.0, 400.0, 800.0])
