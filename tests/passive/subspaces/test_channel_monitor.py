"""Bad elements are named and left out, good ones never; the sources are tracked on the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import Severity
from sonar_tracking.passive.subspaces.channel_monitor import (
    QUARANTINE_SNAPSHOTS,
    new_monitor,
    used_elements,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.bearings import SubspaceEstimates
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
        monitor, notices = monitor.update(block_of(data[first : first + size], EPOCH))
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
