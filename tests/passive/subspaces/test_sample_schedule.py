"""From stamps to snapshot indices: exact for any period, robust against rounded stamps."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sonar_tracking.passive.subspaces.sample_schedule import (
    BlockTiming,
    SampleSchedule,
    first_timing,
    nearest_integer,
    period_in_nanoseconds,
)

EPOCH = 1_767_225_600 * 1_000_000_000

rates = st.sampled_from([200.0, 160.0, 93.75, 97.3, 48000 / 512, 44100 / 256, 7.0])


def test_periods_are_exact_fractions() -> None:
    assert period_in_nanoseconds(0.1) == 10**8
    assert period_in_nanoseconds(1 / 93.75) == Fraction(32_000_000, 3)
    assert period_in_nanoseconds(1 / 3) == Fraction(10**9, 3)


def test_ties_go_to_the_earlier() -> None:
    assert nearest_integer(Fraction(5, 2)) == 2
    assert nearest_integer(Fraction(-5, 2)) == -3
    assert nearest_integer(Fraction(26, 10)) == 3


@given(rates, st.lists(st.integers(1, 70), min_size=2, max_size=30), st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_contiguous_blocks_continue_the_count(rate: float, sizes: list[int], skip: int) -> None:
    # Stamps rounded to ns, as every recording has them: the count neither drifts nor gaps.
    done = skip
    timing = first_timing(EPOCH + round(done / rate * 1e9), sizes[0], 1.0 / rate)
    first = timing.first_index
    for size, following in zip(sizes, [*sizes[1:], 5], strict=True):
        done += size
        timing, missing = timing.following(EPOCH + round(done / rate * 1e9), following)
        assert missing == 0
        assert timing.first_index - first == done - skip


@given(rates, st.integers(1, 500), st.floats(-0.4, 0.4))
@settings(max_examples=40, deadline=None)
def test_gaps_are_counted_in_snapshots(rate: float, lost: int, jitter: float) -> None:
    timing = first_timing(EPOCH, 20, 1.0 / rate)
    stamp = EPOCH + round((20 + lost + jitter) / rate * 1e9)
    following, missing = timing.following(stamp, 20)
    assert missing == lost
    assert following.first_index == timing.last_index + 1 + lost


def test_window_is_centred_on_the_sample_time() -> None:
    schedule = SampleSchedule(period_in_nanoseconds(1.0), 7, 1)
    timing = first_timing(EPOCH, 200, 1.0 / 200.0)
    number = EPOCH // 10**9 + 3
    window = schedule.window(number, timing)
    assert window.stamp == EPOCH + 3 * 10**9
    assert list(window.indices) == [timing.first_index + 600 + k for k in range(-3, 4)]
    offsets = [timing.time_offset(index, window.stamp) for index in window.indices]
    assert offsets == pytest.approx([0.005 * k for k in range(-3, 4)], abs=1e-15)


def test_block_windows_lie_on_multiples_of_the_step() -> None:
    schedule = SampleSchedule(period_in_nanoseconds(1.0), 3, 20)
    timing = BlockTiming(EPOCH, 7, 100, period_in_nanoseconds(1.0 / 97.0))
    window = schedule.window(EPOCH // 10**9 + 1, timing)
    # The snapshot nearest to the sample time is 7 + 97 = 104, the multiple nearest to it 100.
    assert list(window.indices) == [80, 100, 120]


def test_estimate_waits_for_the_last_of_subspaces_and_covariance() -> None:
    timing = BlockTiming(EPOCH, 7, 100, period_in_nanoseconds(1.0 / 97.0))
    for lookahead, complete in ((0, 120), (10, 120), (30, 134)):
        schedule = SampleSchedule(period_in_nanoseconds(1.0), 3, 20, lookahead)
        window = schedule.window(EPOCH // 10**9 + 1, timing)
        assert window.covariance_end == 104 + lookahead
        assert window.complete == complete


@given(
    rates,
    st.integers(0, 10**7),
    st.sampled_from([1, 5, 20]),
    st.sampled_from([1, 3, 7]),
    st.sampled_from([0, 3, 50]),
)
@settings(max_examples=60, deadline=None)
def test_first_sample_time_has_a_complete_window(
    rate: float, start: int, step: int, n_subspaces: int, lookahead: int
) -> None:
    schedule = SampleSchedule(period_in_nanoseconds(0.5), n_subspaces, step, lookahead)
    timing = first_timing(EPOCH + start * 1000, 20, 1.0 / rate)
    number = schedule.first_complete(timing)
    assert schedule.window(number, timing).first > timing.first_index
    before = schedule.window(number - 1, timing)
    assert before.first <= timing.first_index or before.stamp < timing.stamp
    unfinished = schedule.first_unfinished(timing)
    assert schedule.window(unfinished, timing).complete >= timing.first_index
    assert schedule.window(unfinished - 1, timing).complete < timing.first_index


def test_a_tie_does_not_depend_on_the_rounding_of_stamps() -> None:
    # At 93.75 Hz every second sample time lies half-way between two snapshots.
    period = 1.0 / 93.75
    whole = first_timing(EPOCH, 1000, period)
    target = EPOCH + 2 * 10**9
    for done in range(0, 187, 11):
        stamp = EPOCH + round(done * period * 1e9)
        part = BlockTiming(stamp, whole.first_index + done, 11, whole.sample_period)
        assert part.nearest_index(target) == whole.nearest_index(target)


@given(
    rates | st.floats(1e-3, 1e7),
    st.integers(0, 10**9),
    st.integers(1, 5000),
    st.integers(-(10**12), 10**12),
    st.integers(0, 4),
)
def test_integers_give_what_fractions_give(
    rate: float, late: int, size: int, apart: int, halves: int
) -> None:
    period = period_in_nanoseconds(1.0 / rate)
    timing = first_timing(EPOCH + late, size, 1.0 / rate)
    stamp = timing.stamp + apart
    assert timing.end_stamp == timing.stamp + nearest_integer(size * period)
    tie = Fraction(1, 1000)
    nearest = timing.first_index + nearest_integer(Fraction(apart) / period - tie)
    assert timing.nearest_index(stamp) == nearest
    assert timing.following(stamp, 7)[1] == nearest_integer((stamp - timing.end_stamp) / period)
    for index in (timing.first_index + size, size + 0.5 * halves):
        exact = (timing.stamp - stamp + (Fraction(index) - timing.first_index) * period) / 10**9
        assert timing.time_offset(index, stamp) == float(exact)
    schedule = SampleSchedule(period * 3, 3, 2)
    assert schedule.stamp(size) == nearest_integer(size * 3 * period)
