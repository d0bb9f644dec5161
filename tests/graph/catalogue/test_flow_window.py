"""A node of a run has the window of that run, and queues for all that the window lets in."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sonar_tracking.graph.catalogue.flow_window import (
    LONGEST_WINDOW,
    SEGMENT_BYTES,
    SHORT_WINDOW,
    VARIABLE,
    depth_for,
    flow_window,
    own_flow_window,
    own_report_pause,
)
from sonar_tracking.graph.catalogue.transport_profile import LARGE_MESSAGE_BYTES
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.graph.verbs.run_scenario import plan_scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario


def test_the_window_is_long_where_messages_are_small_and_nothing_waits_for_the_wall() -> None:
    assert flow_window(math.inf, 0) == flow_window(math.inf, 3000) == LONGEST_WINDOW
    assert flow_window(math.inf, LARGE_MESSAGE_BYTES) == SHORT_WINDOW
    assert flow_window(100.0, 1000) == SHORT_WINDOW


@given(st.integers(1, 10_000_000))
def test_a_long_window_fits_into_shared_memory(size: int) -> None:
    window = flow_window(math.inf, size)
    assert window in range(SHORT_WINDOW, LONGEST_WINDOW + 1, SHORT_WINDOW)
    assert window == SHORT_WINDOW or window * size <= SEGMENT_BYTES


def test_a_node_started_by_hand_has_the_short_window(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert own_flow_window() == SHORT_WINDOW and own_report_pause() == 0.0
    monkeypatch.setenv(VARIABLE, "16")
    assert own_flow_window() == 16 and own_report_pause() > 0.0


@pytest.mark.parametrize(("rate", "depth"), [(1.0, 10), (math.inf, 70)])
def test_every_node_of_a_run_has_its_window_and_room_for_it(
    rate: float, depth: int, tmp_path: Path
) -> None:
    scenario = load_scenario("doa_fusion_long")
    options = RunOptions(rate=rate, record=tmp_path / "bag")
    plan = plan_scenario(scenario, options, tmp_path, "here")
    assert depth_for(plan.flow_window, 10) == depth
    # Odometry may have two messages a block.
    assert depth >= 2 * plan.flow_window
    for node in plan.nodes:
        process = plan.process(node, tmp_path)
        assert process.environment[VARIABLE] == str(plan.flow_window)
        assert f"flow_depth: {depth}\n" in (tmp_path / f"{node.name}.yaml").read_text()
