"""Protects: a run's data depend on its seed alone, and levels and trackers see the same noise."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.run_synthesis import snapshot_blocks, true_bearings
from sonar_tracking.records.arrays import ComplexArray
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

SEEDS = np.random.SeedSequence(4).spawn(3)


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return replace(load_scenario("doa_fusion"), duration=0.25)


def data_of(
    scenario: Scenario, seeds: list[np.random.SeedSequence], levels: list[float], block: int
) -> ComplexArray:
    blocks = snapshot_blocks(scenario, seeds, levels, block)
    return np.concatenate([one.data for one in blocks], axis=-2)


def test_a_run_is_the_same_alone_and_in_a_batch_and_in_any_blocks(scenario: Scenario) -> None:
    batch = data_of(scenario, SEEDS, [-5.0, 0.0], 20)
    alone = data_of(scenario, SEEDS[1:2], [-5.0, 0.0], 50)
    assert np.array_equal(batch[:, 1], alone[:, 0])
    assert batch.shape == (2, 3, 50, 15)


def test_levels_share_waveforms_and_noise(scenario: Scenario) -> None:
    noise, weak, strong = data_of(scenario, SEEDS, [-200.0, 0.0, 20.0], 50)
    assert strong - noise == pytest.approx(10.0 * (weak - noise), abs=1e-4)
    assert np.mean(np.abs(noise) ** 2) == pytest.approx(1.0, abs=0.1)


def test_blocks_are_contiguous_and_the_last_one_says_so(scenario: Scenario) -> None:
    blocks = list(snapshot_blocks(scenario, SEEDS[:1], [0.0], 20))
    for before, after in pairwise(blocks):
        assert before.next_stamp == after.stamp
    assert blocks[0].stamp == scenario.stamp(scenario.start)
    assert blocks[-1].next_stamp == END_OF_DATA
    assert blocks[-1].data.shape[-2] == 10


def test_true_rates_are_the_slopes_of_the_true_bearings(scenario: Scenario) -> None:
    times = np.array([3.0, 20.0])
    step = 1e-4
    _, rates = true_bearings(scenario, times)
    later, earlier = (true_bearings(scenario, times + shift)[0] for shift in (step, -step))
    assert (later - earlier) / (2 * step) == pytest.approx(rates, abs=1e-8)
