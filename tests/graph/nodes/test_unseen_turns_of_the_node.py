"""A live tracker says how long a turn of a target would stay unseen.

In a file of its own: two trackers in one domain would both take what is sent.
"""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.tma.performance.unseen_turn import LONGEST
from tests.graph.live_graph import Probe, node_process
from tests.graph.nodes.test_tma_tracker_node import EPOCH, NODE, SECOND, Tracker


def test_it_says_how_long_a_turn_of_a_confirmed_target_would_not_show(tmp_path: Path) -> None:
    anything = {"confirm_observability": 0.0, "confirm_relative_deviation": 100.0}
    parameters = {"use_sim_time": True, "line_topics": "[passive/frequency_lines]", **anything}
    probe = Probe()
    process = node_process(f"sonar_tracking.graph.nodes.{NODE}", tmp_path / "log.txt", **parameters)
    with process as running:
        tracker = Tracker(running, probe)
        probe.wait_matched(NODE, "/passive/bearing_tracks", "/passive/frequency_lines", "/clock")
        for number in range(3):
            tracker.send(tracker.bearings(number), tracker.lines(number))
        (row,) = tracker.wait_lists(2)[-1].id.tolist()
        probe.diagnostics.clear()
        probe.tick(EPOCH + 3 * SECOND)
        probe.wait(lambda: probe.values(f"{NODE}: unseen turns"), "status")
        told = probe.values(f"{NODE}: unseen turns")
        assert list(told) == [f"track {row}"]
        assert 0 < float(told[f"track {row}"].removesuffix(" s")) <= LONGEST
    probe.close()
