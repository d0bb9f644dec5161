"""Latency counts from the block that holds the last snapshot an estimate needs."""

import itertools

import pytest

from sonar_tracking.graph.orchestration.latency_meter import LatencyMeter

SECOND = 1_000_000_000
START = 1_767_225_600 * SECOND


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_the_completing_block_counts_in_any_order_of_arrival(order: tuple[int, ...]) -> None:
    meter = LatencyMeter()
    for number in range(30):
        meter.block_published(START + number * SECOND // 10, 100.0 + 0.1 * number)
    # Three snapshots of 5 ms after the sample time: they lie in block 10, sent at 101.0 s.
    events = [
        lambda: meter.estimate_described(START + SECOND, 0.015),
        lambda: meter.tracks_received(START + SECOND, 101.007),
        lambda: meter.block_published(START + 30 * SECOND // 10, 103.0),
    ]
    for index in order:
        events[index]()
    summary = meter.summary()
    assert summary.count == 1
    assert summary.median == pytest.approx(7.0)
    assert summary.algorithmic == pytest.approx(15.0)


def test_a_window_may_end_in_the_block_before_or_exactly_at_a_block() -> None:
    meter = LatencyMeter()
    for number in range(3):
        meter.block_published(START + number * SECOND, float(number))
    meter.estimate_described(START + SECOND, -0.015)
    meter.tracks_received(START + SECOND, 0.004)
    meter.estimate_described(START + 2 * SECOND, 0.0)
    meter.tracks_received(START + 2 * SECOND, 2.008)
    assert meter.summary().median == pytest.approx(6.0)


def test_a_window_cut_short_does_not_shorten_the_algorithmic_delay() -> None:
    meter = LatencyMeter()
    meter.estimate_described(START, 0.015)
    meter.estimate_described(START + SECOND, -0.05)
    assert meter.summary().algorithmic == pytest.approx(15.0)


def test_nothing_measured() -> None:
    summary = LatencyMeter().summary()
    assert summary.count == 0
    assert summary.median != summary.median


def test_stamps_that_return_are_timed_by_their_latest_blocks() -> None:
    meter = LatencyMeter()
    for wall in (0.0, 100.0):
        meter.begin_again()
        meter.block_published(10**9, wall)
        meter.estimate_described(10**9, 0.0)
        meter.tracks_received(10**9, wall + 0.010)
    assert meter.summary().count == 2
    assert meter.summary().percentile_99 == pytest.approx(10.0)
