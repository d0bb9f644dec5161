"""Protects the latency of fused lists: from the last data of a stamp, in whatever order told."""

from __future__ import annotations

import pytest

from sonar_tracking.graph.orchestration.fused_latency_meter import REMEMBERED, FusedLatencyMeter


def test_the_last_data_of_a_stamp_count_in_any_order() -> None:
    meter = FusedLatencyMeter()
    meter.data_published(10, 1.0)
    meter.data_published(10, 4.0)
    meter.list_received(10, 4.05)
    meter.list_received(20, 6.1)
    meter.data_published(20, 6.0)
    figures = meter.figures()
    assert figures["fused_count"] == 2
    assert figures["fused_p50"] == pytest.approx(75.0)


def test_lists_without_data_of_their_stamp_are_not_measured() -> None:
    meter = FusedLatencyMeter()
    for stamp in range(3 * REMEMBERED):
        meter.list_received(stamp, float(stamp))
    assert meter.figures() == {}
    meter.data_published(5, 1.0)
    meter.begin_again()
    meter.list_received(5, 100.0)
    assert meter.figures() == {}
