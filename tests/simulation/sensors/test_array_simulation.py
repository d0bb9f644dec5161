"""The simulated array: levels, noise, continuity, determinism, truth."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
)
from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation
from sonar_tracking.simulation.sensors.simulated_data import SimulatedBlock

ARRAY = {"n_elements": 8, "snapshot_rate": 200.0, "block_snapshots": 20}
TARGET = {"motion": {"kind": "linear", "offset_deg": 20.0}}


def scenario(**values: object) -> Scenario:
    mapping = {"duration": 20.0, "array": ARRAY, "targets": [TARGET], **values}
    return scenario_from_mapping(mapping, "test")


def run(world: Scenario) -> list[SimulatedBlock]:
    simulation = ArraySimulation(world)
    return list(iter(simulation.next_block, None))


def data(blocks: list[SimulatedBlock]) -> np.ndarray:
    return np.concatenate([block.snapshots.data for block in blocks])


@pytest.mark.parametrize("level_db", [-6.0, 0.0, 10.0])
def test_level_is_signal_over_noise_power_per_element(level_db: float) -> None:
    """Total power is noise 1 plus signal; 4000 snapshots know it within 5 standard deviations."""
    blocks = run(scenario(targets=[{**TARGET, "level_db": level_db}]))
    power = np.mean(np.abs(data(blocks)) ** 2, axis=0)
    expected = 1.0 + 10.0 ** (level_db / 10.0)
    np.testing.assert_allclose(power, expected, rtol=5.0 / np.sqrt(4000))
    assert blocks[0].truth_bearings.signal_to_noise_ratio == pytest.approx(expected - 1.0)


def test_signal_lies_along_the_steering_vector() -> None:
    """At 60 dB the snapshots are the steering vector times a scalar: progression and sign."""
    world = scenario(duration=0.1, targets=[{**TARGET, "level_db": 60.0}])
    snapshots = run(world)[0].snapshots
    wavenumber = 2.0 * np.pi * snapshots.center_frequency / snapshots.sound_speed
    angle = np.radians(20.0)
    expected = steering_vectors(snapshots.element_positions, np.array([angle]), wavenumber)[:, 0]
    ratio = snapshots.data / snapshots.data[:, :1]
    np.testing.assert_allclose(ratio, np.broadcast_to(expected, ratio.shape), atol=0.1)
    step = np.angle(np.mean(ratio[:, 1]))
    assert step == pytest.approx(np.pi * np.sin(angle), abs=0.01)


def test_white_noise_has_unit_covariance() -> None:
    snapshots = data(run(scenario(targets=[], duration=50.0)))
    covariance = snapshots.T @ snapshots.conj() / len(snapshots)
    np.testing.assert_allclose(covariance, np.eye(8), atol=6.0 / np.sqrt(len(snapshots)))


def test_coloured_noise_has_the_covariance_that_is_published() -> None:
    blocks = run(scenario(targets=[], duration=50.0, noise={"correlation": 0.6}))
    snapshots = data(blocks)
    published = blocks[0].snapshots.noise_covariance
    assert published is not None
    assert published[0, 3] == pytest.approx(0.6**3)
    assert np.trace(published) == pytest.approx(8.0)
    covariance = snapshots.T @ snapshots.conj() / len(snapshots)
    np.testing.assert_allclose(covariance, published, atol=6.0 / np.sqrt(len(snapshots)))


def test_noise_is_circular() -> None:
    snapshots = data(run(scenario(targets=[], duration=50.0)))
    pseudo = snapshots.T @ snapshots / len(snapshots)
    np.testing.assert_allclose(pseudo, 0.0, atol=6.0 / np.sqrt(len(snapshots)))


@pytest.mark.parametrize(
    ("phase", "rank"),
    [("fixed", 1), ("random", 1), ("turning", 2), ("random_per_block", 2)],
)
def test_rank_of_a_coherent_group(phase: str, rank: int) -> None:
    """A group of one waveform has rank 1, unless its phases move within the observation."""
    group = {"level_db": 20.0, "coherent_group": "echo"}
    targets = [
        {**group, "motion": {"kind": "linear", "offset_deg": -30.0}},
        {
            **group,
            "coherent_phase": phase,
            "coherent_phase_deg": 70.0,
            "coherent_phase_rate_deg": 36.0,
            "motion": {"kind": "linear", "offset_deg": 25.0},
        },
    ]
    snapshots = data(run(scenario(targets=targets)))
    eigenvalues = np.linalg.eigvalsh(snapshots.T @ snapshots.conj() / len(snapshots))
    assert np.sum(eigenvalues > 10.0) == rank


def test_independent_targets_have_full_rank() -> None:
    motions = [{"kind": "linear", "offset_deg": angle} for angle in (-40.0, 0.0, 30.0)]
    snapshots = data(
        run(scenario(targets=[{"level_db": 20.0, "motion": motion} for motion in motions]))
    )
    eigenvalues = np.linalg.eigvalsh(snapshots.T @ snapshots.conj() / len(snapshots))
    assert np.sum(eigenvalues > 10.0) == 3


def test_same_scenario_gives_the_same_bits() -> None:
    world = scenario(duration=1.0)
    np.testing.assert_array_equal(data(run(world)), data(run(world)))
    other = dataclasses.replace(world, seed=world.seed + 1)
    assert not np.array_equal(data(run(world)), data(run(other)))


def test_data_do_not_depend_on_the_size_of_the_blocks() -> None:
    small = scenario(duration=1.01)
    large = scenario(duration=1.01, array={**ARRAY, "block_snapshots": 64})
    np.testing.assert_array_equal(data(run(small)), data(run(large)))


def test_data_survive_single_precision() -> None:
    snapshots = data(run(scenario(duration=0.5)))
    assert snapshots.dtype == np.complex128
    np.testing.assert_array_equal(snapshots.astype(np.complex64).astype(np.complex128), snapshots)


@pytest.mark.parametrize("rate", [200.0, 1024.0, 3.0])
def test_blocks_are_contiguous_and_the_last_one_says_so(rate: float) -> None:
    world = scenario(
        start=-1.0, duration=10.05, array={**ARRAY, "snapshot_rate": rate, "bandwidth": 100.0}
    )
    blocks = run(world)
    assert len(data(blocks)) == round(10.05 * rate)
    assert blocks[0].snapshots.stamp == world.epoch - 1_000_000_000
    for before, after in pairwise(blocks):
        snapshots = before.snapshots
        assert snapshots.next_stamp == after.snapshots.stamp
        assert len(snapshots.data) == 20
        end = snapshots.stamp + len(snapshots.data) * snapshots.sample_period * 1e9
        assert abs(end - after.snapshots.stamp) <= 256  # one float64 step at such stamps
    assert blocks[-1].snapshots.next_stamp == END_OF_DATA
    assert blocks[-1].truth_bearings.next_stamp == END_OF_DATA


def test_truth_is_the_bearing_at_the_stamp_of_the_block() -> None:
    """Theta = arctan(w (t - t_n)), the sources of the paper."""
    world = load_scenario("doa_fusion")
    simulation = ArraySimulation(dataclasses.replace(world, duration=3.0))
    rates = np.radians([2.6, 3.0, 0.9, -2.6, -2.5])
    crossings = np.array([23.0, 35.0, 35.0, 36.0, -3.0])
    for block in iter(simulation.next_block, None):
        truth = block.truth_bearings
        assert truth.stamp == block.snapshots.stamp
        time = (truth.stamp - world.epoch) * 1e-9
        np.testing.assert_allclose(truth.arrival_angle, np.arctan(rates * (time - crossings)))
        assert truth.id.tolist() == [1, 2, 3, 4, 5]


def test_paper_scenario_reaches_the_last_window_on_its_grid() -> None:
    world = load_scenario("doa_fusion")
    blocks = run(dataclasses.replace(world, targets=()))
    stamps = {block.snapshots.stamp for block in blocks}
    assert {world.stamp(float(k)) for k in range(-1, 41)} <= stamps
    last = blocks[-1].snapshots
    end = last.stamp + round((len(last.data) - 1) * last.sample_period * 1e9)
    assert end >= world.stamp(40.0 + 3 * last.sample_period)


def test_absent_target_is_neither_heard_nor_in_the_truth() -> None:
    world = scenario(duration=4.0, targets=[{**TARGET, "level_db": 30.0, "present": [1.0, 2.0]}])
    for block in run(world):
        time = (block.snapshots.stamp - world.epoch) * 1e-9
        present = 1.0 <= time < 2.0
        assert block.truth_bearings.id.tolist() == ([1] if present else [])
        assert (np.mean(np.abs(block.snapshots.data) ** 2) > 50.0) == present


def test_own_ship_is_reported_at_both_ends_of_every_block_once() -> None:
    own_ship = {"position": [5.0, 7.0], "course_deg": 90.0, "speed": 4.0}
    world = scenario(duration=1.0, own_ship=own_ship)
    blocks = run(world)
    states = [state for block in blocks for state in block.own_ship]
    assert [state.stamp for state in states] == [
        world.stamp(index * 0.1) for index in range(len(blocks) + 1)
    ]
    assert states[-1].position == pytest.approx((9.0, 7.0))
    assert states[-1].velocity == (4.0, 0.0)
    assert states[-1].yaw == pytest.approx(0.0, abs=1e-12)
    assert blocks[3].snapshots.sensor.position == pytest.approx((6.2, 7.0, 0.0))


def test_truth_tracks_are_the_states_of_the_kinematic_targets() -> None:
    ship = {"motion": {"kind": "kinematic", "position": [0.0, 900.0], "course_deg": 90, "speed": 5}}
    world = scenario(duration=2.05, targets=[TARGET, ship])
    tracks = run(world)[-1].truth_tracks
    assert tracks.stamp == world.stamp(2.0)
    assert tracks.id.tolist() == [2]
    np.testing.assert_allclose(tracks.position, [[10.0, 900.0]])
    np.testing.assert_allclose(tracks.velocity, [[5.0, 0.0]], atol=1e-12)


@pytest.mark.parametrize("name", ["doa_fusion", "doa_fusion_long", "crossing_targets"])
def test_scenarios_of_the_package_run(name: str) -> None:
    block = ArraySimulation(load_scenario(name)).next_block()
    assert block is not None
    assert np.isfinite(block.snapshots.data).all()


def test_blocks_of_the_large_array_fill_sixteen_megabytes() -> None:
    array = load_scenario("large_array").array
    assert array.n_elements * array.block_snapshots * 8 == 1 << 24
