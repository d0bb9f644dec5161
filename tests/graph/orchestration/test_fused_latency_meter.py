"""Protects the latency of fused lists: from the newest data up to a stamp, however told."""

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


def test_a_list_tells_of_earlier_pings_whose_echoes_come_later() -> None:
    """Bearings of 12 s are complete at 16 s, the echoes of the ping of 10 s at 18 s."""
    meter = FusedLatencyMeter()
    meter.data_published(12, 16.0)
    meter.data_published(10, 18.0)
    meter.list_received(10, 18.02)
    meter.list_received(12, 18.04)
    meter.data_published(14, 20.0)
    meter.list_received(14, 20.06)
    figures = meter.figures()
    assert figures["fused_count"] == 3
    assert figures["fused_p50"] == pytest.approx(40.0)
    assert figures["fused_p99"] < 60.1
