"""Bad elements are named and left out, good ones never; the sources are tracked on the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.passive.subspaces.channel_monitor import (
    QUARANTINE_SNAPSHOTS,
    ChannelMonitor,
    new_monitor,
    updated_monitors,
    used_elements,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from tests.passive.block_scene import noise_colour
from tests.passive.crossing_scene import (
    EPOCH,
    POSITIONS,
    ComplexArray,
    block_of,
    blocks_of,
    circular_noise,
    snapshots_of,
)

DATA = circular_noise(np.random.default_rng(1), 2000, 15)
OTHERS = [n for n in range(15) if n != 4]


def updated(
    monitor: ChannelMonitor, block: ArraySnapshots
) -> tuple[ChannelMonitor, tuple[Notice, ...]]:
    return updated_monitors([monitor], [block])[0]


def clipped(data: ComplexArray, gain: float) -> ComplexArray:
    """Return the data with element 4 amplified and clipped at three times its own noise."""
    data = data.copy()
    loud = gain * data[:, 4]
    data[:, 4] = np.clip(loud.real, -3.0, 3.0) + 1j * np.clip(loud.imag, -3.0, 3.0)
    return data


def watched(data: ComplexArray, size: int = 100) -> tuple[list[bool], list[str]]:
    """Return the elements used in the end and the sentences about the last block."""
    monitor = new_monitor(15)
    for first in range(0, len(data), size):
        monitor, notices = updated(monitor, block_of(data[first : first + size], EPOCH))
        assert all(notice.severity is Severity.WARN for notice in notices)
    return monitor.used.tolist(), [notice.text for notice in notices]


def test_silent_and_faint_elements_are_left_out() -> None:
    data = DATA.copy()
    data[:, 4] = 0.0
    data[:, 9] *= 0.02
    used, texts = watched(data[:100])
    assert [n for n in range(15) if not used[n]] == [4, 9]
    assert ["Element 4 is silent" in texts[0], "Element 9 is silent" in texts[1]] == [True, True]
    assert all("left out" in text for text in texts)


def test_saturated_element_is_named_and_left_out() -> None:
    used, texts = watched(clipped(DATA, 30.0))
    assert [n for n in range(15) if not used[n]] == [4]
    assert len(texts) == 1
    assert "Element 4 is clipped" in texts[0]
    assert "left out" in texts[0]


def test_clipped_element_of_usual_level_is_named_and_used() -> None:
    data = clipped(DATA, 6.0)
    data[:, 4] *= 0.3
    used, texts = watched(data)
    assert all(used)
    assert "clipped" in texts[0]
    assert "used as they are" in texts[0]


def test_loud_element_is_left_out() -> None:
    data = DATA.copy()
    data[:, 4] *= 20.0
    used, texts = watched(data[:100])
    assert [n for n in range(15) if not used[n]] == [4]
    assert "20 dB louder" in texts[0]


@pytest.mark.slow
@pytest.mark.parametrize("size", [1, 100])
def test_good_elements_are_never_reported(size: int) -> None:
    assert watched(DATA, size) == ([True] * 15, [])
    # Levels 20 dB apart are calibration, not death.
    assert watched(DATA * np.logspace(-1, 0, 15), size) == ([True] * 15, [])
    # Strong sources of constant amplitude and of any number.
    generator = np.random.default_rng(2)
    tone = np.exp(2j * np.pi * generator.random((2000, 1)))
    assert watched(DATA + 10.0 * tone, size) == ([True] * 15, [])
    angles = np.broadcast_to(np.deg2rad([-30.0, 20.0]), (2000, 2))
    assert watched(snapshots_of(generator, angles, 20.0), size) == ([True] * 15, [])


def test_when_most_are_bad_all_are_used() -> None:
    data = DATA.copy()
    data[:, :8] = 0.0
    used, texts = watched(data)
    assert all(used)
    assert len(texts) == 8
    assert all("used as they are" in text for text in texts)
    assert watched(np.zeros_like(DATA))[0] == [True] * 15


def test_element_is_used_again_when_it_has_been_good_for_a_while() -> None:
    data = np.concatenate([DATA, DATA, DATA])
    data[:1000, 4] = 0.0
    assert not watched(data[: 1000 + QUARANTINE_SNAPSHOTS - 100])[0][4]
    assert watched(data[: 1000 + QUARANTINE_SNAPSHOTS + 100]) == ([True] * 15, [])


def test_positions_and_noise_go_with_the_element() -> None:
    used = np.array([n != 4 for n in range(15)])
    block = block_of(DATA, EPOCH, noise_covariance=noise_colour(0.6))
    kept = used_elements(block, used)
    assert np.array_equal(kept.data, DATA[:, OTHERS])
    assert np.array_equal(kept.element_positions, POSITIONS[OTHERS])
    assert kept.noise_covariance is not None
    assert np.array_equal(kept.noise_covariance, noise_colour(0.6)[np.ix_(OTHERS, OTHERS)])
    assert used_elements(block, np.ones(15, dtype=bool)) is block


@pytest.mark.parametrize("method", ["covariance", "past", "block_past"])
def test_every_sample_time_has_an_estimate_of_the_elements_that_are_used(method: str) -> None:
    angles = np.broadcast_to(np.deg2rad([-30.0, 10.0]), (4000, 2))
    data = snapshots_of(np.random.default_rng(3), angles, 5.0)
    data[1030:1400, 4] = 0.0
    stage = SubspaceStage(SubspaceConfiguration(method=method, period=0.5))
    estimates: list[SubspaceEstimates] = []
    sizes = []
    for block in blocks_of(data, 20, EPOCH):
        for each in stage.update(block).estimates:
            estimates.append(each)
            sizes.append(len(each.element_positions))
            assert each.basis.shape[-2] == sizes[-1]
            assert each.covariance is None or each.covariance.shape[-1] == sizes[-1]
    assert np.all(np.diff([each.stamp for each in estimates]) == 500_000_000)
    changes = np.flatnonzero(np.diff(sizes))
    assert [sizes[0], sizes[changes[0] + 1], sizes[-1]] == [15, 14, 15]
    assert len(changes) == 2
    assert sum(each.basis.shape[-3] == 0 for each in estimates) <= 2


def test_estimates_are_those_of_an_array_without_the_element() -> None:
    angles = np.broadcast_to(np.deg2rad([-30.0, 10.0]), (2000, 2))
    data = snapshots_of(np.random.default_rng(4), angles, 5.0)
    data[:, 4] = 0.0
    whole, rest = (SubspaceStage(SubspaceConfiguration(period=0.5)) for _ in range(2))
    for block in blocks_of(data, 100, EPOCH):
        without = replace(block, data=block.data[:, OTHERS], element_positions=POSITIONS[OTHERS])
        pairs = zip(whole.update(block).estimates, rest.update(without).estimates, strict=True)
        for ours, theirs in pairs:
            assert np.array_equal(ours.element_positions, theirs.element_positions)
            assert ours.covariance is not None
            assert theirs.covariance is not None
            assert np.allclose(ours.covariance, theirs.covariance)
            assert (ours.rank, ours.source_count) == (theirs.rank, theirs.source_count)


@pytest.mark.parametrize(("source_count", "n_left"), [(3, 4), (4, 6)])
def test_no_element_is_left_out_that_the_stated_sources_need(
    source_count: int, n_left: int
) -> None:
    """Four elements of six hold a subspace of three columns, but none of four."""
    data = DATA[:400, :6].copy()
    data[:, [1, 4]] = 0.0
    configuration = SubspaceConfiguration(period=0.5, source_count=source_count)
    stage = SubspaceStage(configuration)
    estimates: list[SubspaceEstimates] = []
    for block in blocks_of(data, 100, EPOCH):
        estimates += stage.update(replace(block, element_positions=POSITIONS[:6])).estimates
    assert len(estimates[-1].element_positions) == n_left


def steady(powers: list[float], n_snapshots: int) -> ComplexArray:
    """Return snapshots of constant amplitude: the powers are exact from the first one on."""
    phases = np.exp(1j * np.arange(n_snapshots))[:, None]
    return np.asarray(phases * np.sqrt(np.array(powers)))


def left_out(data: ComplexArray, size: int = 10) -> list[int]:
    monitor = new_monitor(data.shape[1])
    for first in range(0, len(data), size):
        part = data[first : first + size]
        monitor, _ = updated(
            monitor, block_of(part, EPOCH, element_positions=POSITIONS[: data.shape[1]])
        )
    return np.flatnonzero(~monitor.used).tolist()


@pytest.mark.parametrize(
    ("power", "bad"), [(1.01e-3, False), (0.99e-3, True), (99.0, False), (101.0, True)]
)
def test_elements_30_db_below_or_20_db_above_the_median_are_bad(power: float, bad: bool) -> None:
    levels = [0.5, 1.0, power, 2.0, 1.0]
    assert left_out(steady(levels, 60)) == ([2] if bad else [])
    # Of fewer than fifty snapshots the level is not judged, but nothing at all is silence.
    assert left_out(steady(levels, 40)) == []
    assert left_out(steady(levels, 50)) == ([2] if bad else [])
    assert left_out(steady([1.0, 1.0, 0.0], 1)) == [2]


def on_and_off(shares: list[float], gains: list[float], n_snapshots: int = 400) -> ComplexArray:
    """Return amplitudes that are on for a share of the time: E|x|^4 / (E|x|^2)^2 = 1 / share."""
    turn = (np.arange(n_snapshots)[:, None] % 100) < 100.0 * np.array(shares)
    return np.asarray(turn * np.sqrt(np.array(gains) / np.array(shares)) + 0j)


@pytest.mark.parametrize(
    ("share", "gain", "clipped_element", "bad"),
    [
        (0.73, 1.0, True, False),  # 1.37 beside 2: less by 0.63
        (0.70, 1.0, False, False),  # 1.43: by 0.57
        (0.73, 4.2, True, True),  # and 6.2 dB louder
        (0.73, 3.8, True, False),
        (0.70, 4.2, False, False),
    ],
)
def test_clipping_is_a_flat_amplitude_and_saturation_a_loud_one(
    share: float, gain: float, clipped_element: bool, bad: bool
) -> None:
    data = on_and_off([0.5, 0.5, share, 0.5, 0.5], [1.0, 1.0, gain, 1.0, 1.0])
    monitor = new_monitor(5)
    for first in range(0, 400, 100):
        monitor, notices = updated(
            monitor, block_of(data[first : first + 100], EPOCH, element_positions=POSITIONS[:5])
        )
        named = [notice.culprit for notice in notices]
        assert named == (["element 2"] if clipped_element and first >= 100 else [])
    assert np.flatnonzero(~monitor.used).tolist() == ([2] if bad else [])


def test_power_is_a_plain_mean_at_first_and_forgets_after_fifty_snapshots() -> None:
    powers = [1.0, 3.0, 8.0, 2.0, 5.0, 0.5, 4.0, 9.0]
    monitor, seen, power, amplitude = new_monitor(2), 0, 0.0, 0.0
    for value in powers:
        data = np.full((10, 2), np.sqrt(value) + 0j)
        monitor, _ = updated(monitor, block_of(data, EPOCH, element_positions=POSITIONS[:2]))
        share = max(10.0 / (10.0 + min(seen, 50)), 0.2)
        power = share * value + (1.0 - share) * power
        share = max(10.0 / (10.0 + min(seen, 200)), 0.05)
        amplitude = share * value**2 + (1.0 - share) * amplitude
        seen += 10
        assert monitor.power == pytest.approx(np.full(2, power))
        assert monitor.amplitudes[1] == pytest.approx(np.full(2, amplitude))
    assert monitor.n_snapshots == 80


def test_quarantine_is_a_thousand_good_snapshots() -> None:
    data = np.concatenate([steady([1.0, 0.0, 1.0], 10), steady([1.0, 1.0, 1.0], 1000)])
    assert left_out(data[:1000], 10) == [1]
    assert left_out(data, 10) == []


@pytest.mark.parametrize(("n_bad", "used"), [(2, 3), (3, 5)])
def test_bad_elements_are_left_out_as_long_as_they_are_the_fewer(n_bad: int, used: int) -> None:
    data = steady([0.0] * n_bad + [1.0] * (5 - n_bad), 60)
    assert 5 - len(left_out(data)) == used
    assert left_out(steady([0.0, 0.0, 1.0, 1.0], 60)) == [], "half of them: all are used"


def test_quarantine_is_a_thousand_good_snapshots_not_one_less() -> None:
    good = steady([1.0, 1.0, 1.0, 1.0, 1.0], QUARANTINE_SNAPSHOTS)
    faint = good[:60] * np.array([1.0, 1.0, 0.01, 1.0, 1.0])
    monitor = new_monitor(5)
    for data, n_used in [(faint, 4), (good[:-1], 4), (good[-1:], 5)]:
        block = block_of(data, EPOCH, element_positions=POSITIONS[:5])
        monitor, _ = updated(monitor, block)
        assert np.count_nonzero(monitor.used) == n_used
    assert monitor.n_snapshots == 60 + QUARANTINE_SNAPSHOTS


@pytest.mark.parametrize(("n_snapshots", "told"), [(49, 0), (50, 1)])
def test_levels_are_judged_after_fifty_snapshots(n_snapshots: int, told: int) -> None:
    data = steady([1.0, 1.0, 1e-4, 1.0, 1.0], n_snapshots)
    block = block_of(data, EPOCH, element_positions=POSITIONS[:5])
    assert len(updated(new_monitor(5), block)[1]) == told


def test_the_median_is_that_of_the_elements_that_are_heard() -> None:
    """Two of five are dead: the median of the others is 1, so that 90 is not yet too loud."""
    data = steady([0.0, 0.0, 1.0, 1.0, 90.0], 60)
    block = block_of(data, EPOCH, element_positions=POSITIONS[:5])
    monitor, notices = updated(new_monitor(5), block)
    assert monitor.used.tolist() == [False, False, True, True, True]
    assert [notice.culprit for notice in notices] == ["element 0", "element 1"]


def test_a_constant_amplitude_among_gaussian_elements_is_clipped() -> None:
    """E|x|^4 / (E|x|^2)^2: 1 of a constant amplitude, 2 of Gaussian sound, none of a dead one."""
    data = DATA[:200, :5].copy()
    data[:, 1] = 1.0
    data[:, 2] = 0.0
    block = block_of(data, EPOCH, element_positions=POSITIONS[:5])
    texts = [notice.text for notice in updated(new_monitor(5), block)[1]]
    assert ["silent" in text for text in texts] == [True, False]
    assert "Element 1 is clipped" in texts[1]


def test_the_runs_of_a_batch_are_watched_as_each_by_itself() -> None:
    good = block_of(DATA[:300], EPOCH)
    silent = block_of(np.where(np.arange(15) == 4, 0.0, DATA[300:600]), EPOCH)
    short = block_of(clipped(DATA[600:850], 50.0), EPOCH)
    blocks = [good, silent, short]
    monitors = [new_monitor(15)] * 3
    for _ in range(2):
        together = updated_monitors(monitors, blocks)
        for (own, told), before, block in zip(together, monitors, blocks, strict=True):
            alone, notices = updated(before, block)
            assert told == notices and own.used.tolist() == alone.used.tolist()
            np.testing.assert_array_equal(own.amplitudes, alone.amplitudes)
            np.testing.assert_array_equal(own.plateau.below, alone.plateau.below)
        monitors = [own for own, _ in together]
    assert [monitor.used.all() for monitor in monitors] == [True, False, False]
