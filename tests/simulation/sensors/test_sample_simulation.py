"""The simulated element time series: levels, exact delays, Doppler, determinism, truth."""

from itertools import pairwise

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    scenario_from_mapping,
    scenario_to_mapping,
)
from sonar_tracking.simulation.sensors.sample_simulation import SampleSimulation
from sonar_tracking.simulation.sensors.simulated_data import SimulatedSamples

ARRAY = {"n_elements": 4, "spacing": 2.0, "center_frequency": 300.0, "bandwidth": 5.0}
LOUD = {"frequency": 250.0, "level_db": 120.0}
RATE = 1000.0


def scenario(**values: object) -> Scenario:
    return scenario_from_mapping({"duration": 8.0, "array": ARRAY, **values}, "test")


def target(lines: object = (), level_db: float = -100.0, **motion: object) -> dict[str, object]:
    return {"level_db": level_db, "lines": lines, "motion": {"kind": "kinematic", **motion}}


def run(world: Scenario, block_samples: int = 250, **values: object) -> list[SimulatedSamples]:
    hydrophones = {"sample_rate": RATE, "block_samples": block_samples, **values}
    mapping = {**scenario_to_mapping(world), "hydrophones": hydrophones}
    simulation = SampleSimulation(scenario_from_mapping(mapping, "test"))
    return list(iter(simulation.next_block, None))


def data(blocks: list[SimulatedSamples]) -> np.ndarray:
    return np.concatenate([block.samples.data for block in blocks])


def analytic(samples: np.ndarray, frequency: float) -> np.ndarray:
    """Return the complex amplitude of a tone in each column, by least squares at its frequency."""
    time = np.arange(len(samples)) / RATE
    basis = np.stack(
        [np.cos(2 * np.pi * frequency * time), -np.sin(2 * np.pi * frequency * time)], axis=1
    )
    real, imaginary = np.linalg.lstsq(basis, samples, rcond=None)[0]
    return real + 1j * imaginary


@pytest.mark.parametrize("level_db", [-6.0, 3.0])
def test_broadband_level_is_the_ratio_to_the_noise_in_every_band(level_db: float) -> None:
    """Noise has power 1 in 1 Hz; 32,000 samples know the sum within 5 standard deviations."""
    samples = data(run(scenario(targets=[target(level_db=level_db, position=[0.0, 900.0])])))
    density = np.abs(np.fft.rfft(samples[:, 0])) ** 2 * 2.0 / (RATE * len(samples))
    band = density[len(density) // 10 : len(density) * 8 // 10]
    assert np.mean(band) == pytest.approx(
        1.0 + 10.0 ** (level_db / 10.0), rel=5.0 / np.sqrt(len(band))
    )


def test_level_of_a_line_is_its_power_over_that_of_the_noise_in_one_hertz() -> None:
    line = {"frequency": 250.0, "level_db": 40.0}
    samples = data(run(scenario(targets=[target([line], position=[0.0, 900.0])])))
    power = 0.5 * np.abs(analytic(samples, 250.0)) ** 2
    np.testing.assert_allclose(power, 1e4, rtol=0.02)


def test_delays_between_elements_are_those_of_the_curved_wavefront() -> None:
    """A target 30 m away: the phases follow the distances to the elements, no plane wave does."""
    world = scenario(targets=[target([LOUD], position=[20.0, 22.0])])
    amplitude = analytic(data(run(world)), 250.0)
    elements = np.stack([np.zeros(4), 2.0 * np.arange(4)], axis=1)  # the bow points north
    distance = np.linalg.norm(np.array([20.0, 22.0]) - elements, axis=1)
    expected = -2.0 * np.pi * 250.0 * (distance - distance[0]) / 1500.0
    measured = np.angle(amplitude / amplitude[0])
    np.testing.assert_allclose(np.angle(np.exp(1j * (measured - expected))), 0.0, atol=1e-3)


def test_doppler_is_that_of_both_platforms() -> None:
    """Own ship 6 m/s towards a target that closes with 4 m/s: (c + 6) / (c - 4), head on."""
    world = scenario(
        own_ship={"speed": 6.0},
        targets=[target([LOUD], position=[0.0, 5000.0], course_deg=180.0, speed=4.0)],
    )
    samples = data(run(world))[:, 0]
    expected = 250.0 * 1506.0 / 1496.0
    halves = [analytic(half, expected)[None] for half in np.split(samples, 2)]
    # A frequency error turns the phase from one half to the other by 2 pi f 4 s.
    advance = 2.0 * np.pi * expected * 4.0
    turn = np.angle(halves[1][0] / halves[0][0] * np.exp(-1j * advance))
    assert abs(turn) / (2.0 * np.pi * 4.0) < 1e-4


def test_arrival_angle_of_a_bearing_only_target_sets_the_delays() -> None:
    motion = {"kind": "linear", "offset_deg": 30.0}
    world = scenario(targets=[{"level_db": -100.0, "lines": [LOUD], "motion": motion}])
    amplitude = analytic(data(run(world)), 250.0)
    step = np.angle(amplitude[1:] / amplitude[:-1])
    np.testing.assert_allclose(step, 2.0 * np.pi * 250.0 * 2.0 * 0.5 / 1500.0, atol=1e-3)


def test_own_ship_is_heard_from_its_bow_without_doppler() -> None:
    world = scenario(own_ship={"speed": 10.0})
    samples = data(run(world, own_ship_line_frequencies=(250.0,), own_ship_line_levels_db=(120.0,)))
    step = np.angle(analytic(samples, 250.0)[1:] / analytic(samples, 250.0)[:-1])
    np.testing.assert_allclose(step, 2.0 * np.pi * 250.0 * 2.0 / 1500.0, atol=1e-3)
    first, second = (analytic(half, 250.0)[0] for half in np.split(samples, 2))
    assert abs(np.angle(second / first)) < 1e-3


def test_lines_and_targets_come_and_go() -> None:
    line = {**LOUD, "present": [2.0, 4.0]}
    samples = data(run(scenario(targets=[target([line], position=[0.0, 1500.0])])))
    heard = np.abs(samples[:, 0].reshape(8, -1)).max(axis=1) > 1e5
    assert heard.tolist() == [False, False, False, True, True, False, False, False]


def test_block_size_does_not_change_the_data() -> None:
    world = scenario(
        own_ship={"speed": 5.0},
        targets=[target([LOUD], 0.0, position=[500.0, 900.0], course_deg=200.0, speed=9.0)],
    )
    np.testing.assert_array_equal(data(run(world, 250)), data(run(world, 333)))


def test_blocks_are_contiguous_and_the_last_one_says_so() -> None:
    blocks = run(scenario(duration=1.1, own_ship={"speed": 5.0}))
    for block, following in pairwise(blocks):
        assert block.samples.next_stamp == following.samples.stamp == block.samples.end_stamp
        assert block.own_ship[-1].stamp == following.samples.stamp
    assert [len(block.samples.data) for block in blocks] == [250] * 4 + [100]
    assert blocks[-1].samples.next_stamp == END_OF_DATA
    assert len(blocks[0].own_ship) == 2


def test_what_cannot_be_simulated_is_refused_with_its_name() -> None:
    high = {"frequency": 600.0, "level_db": 0.0}
    with pytest.raises(ConfigurationError, match=r"targets\[0\]\.lines.*1200 Hz"):
        run(scenario(targets=[target([high])]))
    with pytest.raises(ConfigurationError, match="coherent_group"):
        run(scenario(targets=[{**target(), "coherent_group": "echo"}]))
    with pytest.raises(ConfigurationError, match="one level for each"):
        run(scenario(), own_ship_line_frequencies=(50.0,))
