"""Protects: every scene of the mismatch-contacts study is what it says, and is told as it says.

How well the trackers do is not asked here: each condition is run once, at reduced length.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_positions import place_contacts
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.mismatch_contacts import motions, study
from sonar_tracking.evaluation.studies.mismatch_contacts.condition import (
    FIRST_PUBLISHED_PING,
    Condition,
    SimulatedScene,
)
from sonar_tracking.evaluation.studies.mismatch_contacts.conditions import CONDITIONS, FAST_TURN
from sonar_tracking.evaluation.studies.mismatch_contacts.runs import (
    DEFAULTS,
    TOLD,
    MismatchRun,
    MismatchTask,
    mismatch_runs,
)
from sonar_tracking.evaluation.studies.mismatch_contacts.scene import (
    UNKNOWN_TO_A_SENSOR,
    Scene,
    as_told,
    detection_probability_of,
    false_alarm_probability_of,
    k_exceedance,
    threshold_of,
)
from sonar_tracking.evaluation.studies.mismatch_contacts.sensors import (
    HEAVIER_TAILS,
    HEAVY_TAILS,
    STANDARD,
    WEAK_TARGETS,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    SceneOptions,
    simulate_scene,
)
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES
from sonar_tracking.records.arrays import FloatArray

PINGS = 14
ALWAYS = ("held_share", "false_tracks_per_hour", "identity_swaps", "continuity", "ospa_m")


def scene_of(name: str, n_pings: int = 0, seed: int = 1) -> Scene:
    condition = CONDITIONS[name]
    return condition.scene(np.random.SeedSequence(seed), n_pings or condition.n_pings)


def sensor_of(condition: Condition) -> Any:
    assert isinstance(condition.scene, SimulatedScene)
    return condition.scene.sensor


def speeds(state: FloatArray) -> FloatArray:
    speed = np.hypot(state[..., 2], state[..., 3])
    return np.asarray(speed[np.isfinite(speed)])


def near_share(scene: Scene, target: int) -> float:
    """Return the share of a target's pings with a contact within five deviations of it."""
    hits = []
    for ping, state in zip(scene.pings, scene.true_state[:, target], strict=True):
        if np.isnan(state[0]):
            continue
        placed = place_contacts(ping, 0.0)
        error = placed.position - state[:2]
        scaled = np.linalg.solve(placed.covariance, error[..., None])[..., 0]
        hits.append(np.any(np.sum(error * scaled, axis=1) < 25.0))
    return float(np.mean(hits))


@pytest.fixture(scope="module")
def results() -> list[tuple[MismatchRun, ...]]:
    """Of the first one processor times are measured: it is tracked once more for each tracker."""
    return [
        mismatch_runs(
            MismatchTask(name, (np.random.SeedSequence((3, part)),), PINGS, timed=part == 0)
        )
        for part, name in enumerate(CONDITIONS)
    ]


@pytest.fixture(scope="module")
def rows(results: list[tuple[MismatchRun, ...]]) -> tuple[StudyRow, ...]:
    return study.rows(results)


@pytest.mark.parametrize("name", CONDITIONS)
def test_row_of_a_condition_has_finite_figures(rows: tuple[StudyRow, ...], name: str) -> None:
    systems = {row.system: row.metrics for row in rows if row.condition == name}
    assert list(systems) == [DEFAULTS, TOLD]
    for metrics in systems.values():
        assert np.isfinite([metrics[figure] for figure in ALWAYS]).all()
        assert np.isfinite(metrics["nees_per_dimension"]) == (metrics["held_share"] > 0.0)
        assert np.isfinite(metrics["cpu_ms"]) == (name == next(iter(CONDITIONS)))
    assert systems[TOLD]["held_share"] > 0.0
    ratio = systems[DEFAULTS]["ospa_m"] / systems[TOLD]["ospa_m"]
    assert systems[DEFAULTS]["ospa_over_told"] == pytest.approx(ratio)


def test_same_seed_gives_the_same_run_whatever_is_tracked_with_it(
    results: list[tuple[MismatchRun, ...]],
) -> None:
    (first,) = results[0]
    seeds = tuple(np.random.SeedSequence((3, number)) for number in (7, 0, 8))
    _, again, _ = mismatch_runs(MismatchTask(first.condition, seeds, PINGS))
    for system, metrics in again.metrics.items():
        assert {n: v for n, v in metrics.items() if n != "cpu_ms"} == {
            n: v for n, v in first.metrics[system].items() if n != "cpu_ms"
        }


@pytest.mark.parametrize("name", [name for name in CONDITIONS if name.endswith(" m/s")])
def test_straight_ships_keep_their_speed_and_do_not_meet(name: str) -> None:
    condition = CONDITIONS[name]
    sensor, state = sensor_of(condition), scene_of(name).true_state
    speed = float(name.split()[-2])
    np.testing.assert_allclose(speeds(state), speed, atol=1e-9)
    step = np.diff(state[..., :2], axis=0) - sensor.ping_interval * state[:-1, :, 2:]
    assert np.nanmax(np.abs(step)) < 1e-6
    apart = state[:, :, None, :2] - state[:, None, :, :2]
    distance = np.hypot(apart[..., 0], apart[..., 1])
    others = ~np.eye(state.shape[1], dtype=bool)
    assert np.nanmin(distance[:, others]) > 0.29 * sensor.maximum_range
    present = np.isfinite(state[..., 0])
    assert present.mean() > 0.6 and present[len(state) // 2].all()
    reach = np.hypot(state[..., 0], state[..., 1])[present]
    assert reach.max() <= sensor.maximum_range


def test_speeds_grains_and_intervals_are_those_of_the_order() -> None:
    numbers = {float(name.split()[-2]) for name in CONDITIONS if name.startswith("straight")}
    assert numbers == {0.0, 2.0, 5.0, 9.0, 12.0, 15.0, 20.0}
    grains = {
        (sensor.range_standard_deviation, sensor.azimuth_standard_deviation_deg)
        for condition in CONDITIONS.values()
        if isinstance(condition.scene, SimulatedScene)
        for sensor in [condition.scene.sensor]
    }
    assert {(4.0, 0.3), (30.0, 0.5), (50.0, 1.0), (10.0, 0.2)} <= grains
    slow = [sensor_of(CONDITIONS[f"ping {interval} s, 5 m/s"]) for interval in (2, 60)]
    assert [sensor.ping_interval for sensor in slow] == [2.0, 60.0]


@pytest.mark.parametrize(
    ("name", "speed", "acceleration", "turns"),
    [
        ("turn of 0.05 m/s2", 5.0, 0.05, 1),
        ("turn of 0.05 m/s2, fine sensor", 5.0, 0.05, 1),
        ("turns of 0.3 g", 15.0, FAST_TURN, 3),
        ("turns of 0.3 g, fine sensor", 15.0, FAST_TURN, 3),
    ],
)
def test_boats_turn_as_fast_as_they_should(
    name: str, speed: float, acceleration: float, turns: int
) -> None:
    scene, sensor = scene_of(name), sensor_of(CONDITIONS[name])
    np.testing.assert_allclose(speeds(scene.true_state), speed)
    # Half a second apart the same paths show the acceleration itself.
    times = np.arange(0.0, len(scene.pings) * sensor.ping_interval, 0.5)
    state = motions.turning_paths(
        times, speed, acceleration, turns, sensor.maximum_range, np.random.default_rng(5)
    )
    change = np.diff(state[..., 2:], axis=0) / 0.5
    lateral = np.hypot(change[..., 0], change[..., 1])
    assert lateral.max() == pytest.approx(acceleration, rel=2e-3)
    course = np.unwrap(np.arctan2(state[..., 3], state[..., 2]), axis=0)
    turned = np.degrees(np.abs(course[-1] - course[0]))
    assert np.all(turned > 89.0 * turns if turns == 3 else turned > 60.0)
    assert np.all(turned < 180.0 * turns)
    straight = np.mean(lateral < 1e-6, axis=0)
    assert np.all(straight > 0.2)


def test_walk_has_the_acceleration_it_is_named_for() -> None:
    state = scene_of("random walk of 0.01 m/s2", 400).true_state
    acceleration = np.diff(state[..., 2:], axis=0) / 10.0
    assert np.nanstd(acceleration) == pytest.approx(0.01, rel=0.1)
    step = np.diff(state[..., :2], axis=0) - 10.0 * state[:-1, :, 2:] - 50.0 * acceleration
    assert np.nanmax(np.abs(step)) < 1e-6


@pytest.mark.parametrize(
    ("name", "target", "expected"),
    [
        ("straight, 0 m/s", 0, 0.9),
        ("P_D 0.5, told 0.9", 1, 0.5),
        ("P_D 0.5, not told", 2, 0.5),
        ("SNR 7 dB", 0, 0.825),
        ("SNR 7 dB, P_F 0.001", 0, 0.317),
    ],
)
def test_targets_are_detected_as_often_as_said(name: str, target: int, expected: float) -> None:
    share = near_share(scene_of(name, 600, seed=4), target)
    assert expected - 0.06 < share < expected + 0.08  # a false contact may be near


@pytest.mark.parametrize(("name", "expected"), [("wharf", 0.95), ("wharf, reflectors fade", 0.8)])
def test_reflectors_are_detected_as_often_as_said(name: str, expected: float) -> None:
    counts = [len(ping.range) for ping in scene_of(name, 200).pings]
    # Fifteen of them, the boat, and five false contacts a ping.
    assert np.mean(counts) == pytest.approx(15 * expected + 0.9 + 5.0, abs=0.7)


def test_false_contacts_are_as_many_as_said() -> None:
    scene = scene_of("straight, 0 m/s", 400)
    counts = np.array([len(ping.range) for ping in scene.pings])
    assert counts.mean() - 4 * 0.9 == pytest.approx(10.0, abs=0.6)
    share = np.concatenate([ping.range for ping in scene.pings]) / STANDARD.maximum_range
    assert np.mean(share) == pytest.approx(0.5, abs=0.03)  # uniform per cell
    ping = scene.pings[0]
    assert ping.false_alarm_probability * STANDARD.n_cells == pytest.approx(10.0)
    assert all(np.all(ping.amplitude > ping.detection_threshold) for ping in scene.pings)


@pytest.mark.parametrize("sensor", [HEAVY_TAILS, HEAVIER_TAILS])
def test_k_clutter_exceeds_its_claim_by_far(sensor: Any) -> None:
    name = f"K-distributed clutter, shape {sensor.clutter_shape:g}"
    scene = scene_of(name, 60)
    counts = np.mean([len(ping.range) for ping in scene.pings])
    expected = sensor.n_cells * false_alarm_probability_of(sensor)
    assert counts == pytest.approx(expected + 4 * detection_probability_of(sensor), rel=0.05)
    told = as_told(scene.pings[0], UNKNOWN_TO_A_SENSOR, CONDITIONS[name].claimed)
    assert told.false_alarm_probability == 1e-4
    assert scene.pings[0].false_alarm_probability > 50.0 * told.false_alarm_probability


def test_exceedance_of_k_clutter_has_its_closed_forms() -> None:
    # Shape 1/2: P = exp(-sqrt(2 t)); a large shape is exponential clutter.
    assert k_exceedance(9.0, 0.5) == pytest.approx(np.exp(-np.sqrt(18.0)), rel=1e-9)
    assert k_exceedance(3.0, 5000.0**0.5) == pytest.approx(np.exp(-3.0), rel=0.1)


def test_weak_targets_meet_the_threshold_of_the_standard_sensor() -> None:
    assert threshold_of(WEAK_TARGETS) == pytest.approx(threshold_of(STANDARD))
    assert threshold_of(STANDARD) == pytest.approx(-11.0 * np.log(0.9))


def test_contacts_tell_what_a_sensor_knows_and_no_more() -> None:
    for name, condition in CONDITIONS.items():
        ping = scene_of(name, 5).pings[0]
        told = as_told(ping, condition.hidden, condition.claimed)
        assert np.isfinite(ping.detection_probability) and len(ping.amplitude) == len(ping.range)
        assert np.isnan(told.signal_to_noise_ratio_linear) and np.isnan(told.clutter_density)
        claimed = condition.claimed.get("detection_probability", np.nan)
        np.testing.assert_equal(told.detection_probability, claimed)
        bare = "wharf" in name or "environment" in name
        assert np.isfinite(told.false_alarm_probability) == np.isfinite(told.maximum_range)
        assert np.isfinite(told.maximum_range) == (len(told.amplitude) > 0) == (not bare)
        assert told.range_standard_deviation == ping.range_standard_deviation


def test_convoy_is_in_line() -> None:
    for name in ("convoy, coarse sensor", "convoy, fine sensor"):
        state = scene_of(name).true_state
        gaps = np.hypot(*np.moveaxis(np.diff(state[..., :2], axis=1), -1, 0))
        np.testing.assert_allclose(gaps, 200.0)
        np.testing.assert_allclose(speeds(state), 6.0)
        reach = np.hypot(state[..., 0], state[..., 1])
        assert reach.min() == pytest.approx(5000.0, rel=0.01)


def test_ten_ships_are_at_one_point_at_one_time() -> None:
    state = scene_of("ten ships cross", 101).true_state
    np.testing.assert_allclose(state[50, :, :2] - state[50, :1, :2], 0.0, atol=1e-6)
    np.testing.assert_allclose(speeds(state), 4.0)
    course = np.sort(np.arctan2(state[0, :, 3], state[0, :, 2]))
    assert state.shape[1] == 10 and np.min(np.diff(course)) > np.radians(17.0)


def test_boat_passes_things_that_do_not_move() -> None:
    for name, speed in (("wharf", 3.0), ("wharf, reflectors fade", 5.0)):
        scene = scene_of(name)
        state = scene.true_state
        assert np.all(speeds(state[:, :-1]) == 0.0)
        np.testing.assert_allclose(np.diff(state[0, :-1, 0]), 30.0)
        np.testing.assert_allclose(speeds(state[:, -1]), speed)
        apart = state[:, -1, None, :2] - state[:, :-1, :2]
        assert np.hypot(apart[..., 0], apart[..., 1]).min() == pytest.approx(20.0, abs=2.0)


def test_own_ship_turns_once_round_and_its_contacts_stay_in_place() -> None:
    scene = scene_of("own ship turns")
    yaw = np.unwrap([ping.sensor_yaw for ping in scene.pings])
    assert abs(yaw[-1] - yaw[0]) == pytest.approx(2.0 * np.pi)
    velocity = np.array([ping.sensor_velocity for ping in scene.pings])
    np.testing.assert_allclose(np.hypot(*velocity.T), 6.0)
    assert {ping.frame_id for ping in scene.pings} == {"map"}
    assert near_share(scene, 0) > 0.8 and near_share(scene, 3) > 0.8


def test_nothing_but_the_telling_differs_from_the_published_scene() -> None:
    scene = scene_of("environment 2, nothing told", 30)
    seed, first = np.random.SeedSequence(1), FIRST_PUBLISHED_PING
    published = simulate_scene(SceneOptions(2), seed, first + 30)[first:]
    for own, ping, state in zip(scene.pings, published, scene.true_state, strict=True):
        np.testing.assert_array_equal(own.range, ping.contacts.range)
        np.testing.assert_array_equal(state[ping.target_id - 1], ping.state)
        assert np.count_nonzero(np.isfinite(state[:, 0])) == len(ping.target_id)


def test_study_is_known_by_name_and_draws(
    results: list[tuple[MismatchRun, ...]], rows: tuple[StudyRow, ...], tmp_path: Path
) -> None:
    definition = STUDIES["mismatch-contacts"]
    tasks = definition.tasks(2, 1)
    assert sum(len(task.argument.seeds) for task in tasks) == 2 * len(CONDITIONS)
    assert all(task.argument.timed for task in tasks) and definition.default_runs == 50
    (picture,) = definition.draw(results, rows, tmp_path)
    assert picture.stat().st_size > 10_000
