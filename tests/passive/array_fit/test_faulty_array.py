"""Bearings of an array that is not as described: no false track, the fault named, honest errors."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.arrays import ComplexArray
from sonar_tracking.records.bearings import BearingTracks
from tests.passive.crossing_scene import EPOCH, WAVENUMBER, block_of, circular_noise

TRUTH = np.deg2rad([-20.0, 15.0])
SECONDS = 12


def data_of(seed: int, n_elements: int, level: float, errors: ComplexArray) -> ComplexArray:
    generator, n_snapshots = np.random.default_rng(seed), 200 * SECONDS
    vectors = steering_vectors(line_array(n_elements, 0.5), TRUTH, WAVENUMBER)
    sources = 10.0 ** (level / 20.0) * circular_noise(generator, n_snapshots, 2)
    waves = sources @ (errors[:, None] * vectors).T
    return waves + circular_noise(generator, n_snapshots, n_elements)


def tracked(data: ComplexArray) -> tuple[list[BearingTracks], dict[str, str]]:
    """Return the tracks and the last sentence about each culprit."""
    stage = SubspaceStage(SubspaceConfiguration())
    tracker = BearingTrackerStage(BearingTrackerConfiguration())
    tracks, sentences = [], {}
    positions = line_array(data.shape[1], 0.5)
    for first in range(0, len(data), 100):
        stamp = EPOCH + first * 5_000_000
        block = block_of(
            data[first : first + 100], stamp, element_positions=positions, bandwidth=1.0
        )
        update = stage.update(block)
        notices = list(update.notices)
        for each in update.estimates:
            after = tracker.update(each)
            notices += after.notices
            tracks.append(after.tracks)
        sentences.update({notice.culprit: notice.text for notice in notices})
    return tracks, sentences


def errors_of(seed: int, n_elements: int) -> ComplexArray:
    """Return gains and phases with errors of 5 per cent and 5 degrees."""
    generator = np.random.default_rng(seed)
    phases = np.deg2rad(5.0) * generator.standard_normal(n_elements)
    gains = 1.0 + 0.05 * generator.standard_normal(n_elements)
    return np.asarray(gains * np.exp(1j * phases))


@pytest.mark.parametrize("n_elements", [8, 15])
def test_an_inverted_element_is_named_and_brings_no_false_track(n_elements: int) -> None:
    errors = np.ones(n_elements, dtype=complex)
    errors[4] = -1.0
    tracks, sentences = tracked(data_of(1, n_elements, 20.0, errors))
    assert "Element 4 looks inverted" in sentences["fault 4"]
    assert all(np.count_nonzero(each.established) <= 2 for each in tracks)
    assert np.count_nonzero(tracks[-1].established) == 2
    late = tracks[-1].arrival_angle[tracks[-1].established]
    assert np.allclose(np.sort(late), TRUTH, atol=np.deg2rad(0.2))


@pytest.mark.parametrize("n_elements", [8, 15])
def test_exchanged_channels_are_named_and_bring_no_false_track(n_elements: int) -> None:
    data = data_of(2, n_elements, 20.0, np.ones(n_elements, dtype=complex))
    data[:, [3, 6]] = data[:, [6, 3]]
    tracks, sentences = tracked(data)
    assert "Channels 3 and 6 look exchanged" in sentences["fault 3-6"]
    assert all(np.count_nonzero(each.established) <= 2 for each in tracks)
    assert np.count_nonzero(tracks[-1].established) == 2


@pytest.mark.slow
@pytest.mark.parametrize("level", [10.0, 20.0, 30.0])
def test_an_array_that_is_not_calibrated_has_honest_variances(level: float) -> None:
    squares = []
    for seed in range(3):
        tracks, sentences = tracked(data_of(seed, 15, level, errors_of(seed, 15)))
        assert "rms error of gain and phase" in sentences["calibration"]
        assert all(np.count_nonzero(each.established) <= 2 for each in tracks)
        last = tracks[-1]
        order = np.argsort(last.arrival_angle[last.established])
        errors = last.arrival_angle[last.established][order] - TRUTH
        squares.append(errors**2 / last.covariance[last.established][order, 0, 0])
    assert np.mean(squares) < 3.0
    assert np.mean(squares) > 0.05


def test_an_array_as_described_is_not_named() -> None:
    tracks, sentences = tracked(data_of(4, 15, 20.0, np.ones(15, dtype=complex)))
    assert sentences == {}
    deviation = np.rad2deg(np.sqrt(tracks[-1].covariance[0, 0, 0]))
    assert deviation < 0.02
