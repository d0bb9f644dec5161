"""Protects that every stage is measured, on the data it is meant for."""

from dataclasses import replace

import pytest

from sonar_tracking.evaluation.bench import contact_stages
from sonar_tracking.evaluation.bench.array_stages import (
    DEFAULT,
    PUBLISHED,
    ArrayCase,
    array_exponents,
    measure_array,
)
from sonar_tracking.evaluation.bench.stage_costs import ORCHESTRATION, stage_costs
from sonar_tracking.evaluation.bench.tma_stages import measure_targets, target_exponent
from sonar_tracking.evaluation.bench.tracking_kernels import tracking_kernels
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario


@pytest.mark.slow
@pytest.mark.parametrize("chain", [DEFAULT, PUBLISHED])
def test_an_array_has_costs_and_an_exponent(chain: str) -> None:
    rows = array_exponents([measure_array(ArrayCase(chain, size, 2)) for size in (6, 12)])
    assert [row.system for row in rows] == ["elements 6", "elements 12"]
    assert "exponent" in rows[1].metrics
    assert "exponent" not in rows[0].metrics
    for name, value in rows[0].metrics.items():
        # Of an estimate the cost of a plain block is taken off, and may be all of it.
        assert value > 0.0 or name == "milliseconds_per_estimate"


@pytest.mark.slow
def test_targets_at_two_stations_are_followed_from_the_first_frame_on() -> None:
    rows = target_exponent([measure_targets(count) for count in (1, 2)])
    assert rows[-1].system == "targets 2"
    assert "exponent" in rows[-1].metrics
    for row in rows:
        assert row.metrics["frames"] > 20
        assert row.metrics["worst_milliseconds"] >= row.metrics["milliseconds_per_frame"] > 0.0


def test_a_tracker_among_clutter_has_a_row_for_each_amount(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_stages, "CLUTTER", (5, 10))
    monkeypatch.setattr(contact_stages, "FIRST_PING", 0)
    rows = contact_stages.measure_clutter(contact_stages.SYSTEMS[0])
    assert [row.system for row in rows] == ["clutter 5", "clutter 10"]
    assert "exponent" in rows[1].metrics


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scenario", "nodes"),
    [
        ("doa_fusion", {"array_simulator", "subspace_estimator", "bearing_tracker"}),
        ("active", {"contact_simulator", "hpda_tracker"}),
    ],
)
def test_mathematics_has_a_cost_by_node(scenario: str, nodes: set[str]) -> None:
    costs = stage_costs(replace(load_scenario(scenario), duration=30.0))
    assert set(costs) == {*nodes, ORCHESTRATION}
    assert all(cost > 0.0 for cost in costs.values())


def test_every_kernel_can_be_prepared_at_its_smallest_size() -> None:
    for kernel in tracking_kernels():
        prepared = kernel.prepare(kernel.sizes[0])
        prepared.ours.call()
        assert prepared.work.flops > 0.0
        assert prepared.work.bytes > 0.0
