"""Bearings in noise whose colour nobody has told: no false track, and the diagnostics say so."""

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
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates
from tests.passive.block_scene import noise_colour
from tests.passive.crossing_scene import EPOCH, WAVENUMBER, block_of, circular_noise

SECONDS = 20
TRUTH = np.deg2rad([-20.0, 15.0])


def data_in_noise(seed: int, correlation: float, n_elements: int) -> ComplexArray:
    generator, n_snapshots = np.random.default_rng(seed), 200 * SECONDS
    vectors = steering_vectors(line_array(n_elements, 0.5), TRUTH, WAVENUMBER)
    noise = circular_noise(generator, n_snapshots, n_elements)
    if correlation:
        noise = noise @ np.linalg.cholesky(noise_colour(correlation, n_elements)).T
    return circular_noise(generator, n_snapshots, 2) @ vectors.T + noise


def tracked(
    data: ComplexArray, size: int = 100
) -> tuple[list[SubspaceEstimates], list[BearingTracks], set[str]]:
    """Return estimates, tracks and the culprits that were named."""
    stage, tracker = (
        SubspaceStage(SubspaceConfiguration()),
        BearingTrackerStage(BearingTrackerConfiguration()),
    )
    estimates, tracks, named = [], [], set()
    positions = line_array(data.shape[1], 0.5)
    for first in range(0, len(data), size):
        stamp = EPOCH + first * 5_000_000
        block = block_of(
            data[first : first + size], stamp, element_positions=positions, bandwidth=1.0
        )
        update = stage.update(block)
        named |= {notice.culprit for notice in update.notices}
        for each in update.estimates:
            estimates.append(each)
            tracks.append(tracker.update(each).tracks)
    return estimates, tracks, named


@pytest.mark.slow
@pytest.mark.parametrize("n_elements", [8, 15, 32])
def test_no_false_track_in_noise_of_unknown_correlation(n_elements: int) -> None:
    _, tracks, named = tracked(data_in_noise(5, 0.6, n_elements))
    assert named == {"noise"}
    late = tracks[12:]
    assert np.mean([np.count_nonzero(each.established) == 2 for each in late]) >= 0.9
    squares = [
        (np.sort(each.arrival_angle[each.established]) - TRUTH) ** 2
        / each.covariance[each.established][np.argsort(each.arrival_angle[each.established]), 0, 0]
        for each in late
        if np.count_nonzero(each.established) == 2
    ]
    assert np.mean(squares) < 2.0


@pytest.mark.slow
def test_white_noise_is_not_named_and_nothing_is_whitened() -> None:
    estimates, _, named = tracked(data_in_noise(6, 0.0, 15))
    assert named == set()
    assert all(each.noise_covariance is None for each in estimates)


@pytest.mark.slow
def test_the_colour_does_not_depend_on_how_the_data_are_cut() -> None:
    data = data_in_noise(7, 0.6, 15)[:1600]
    one, other = tracked(data, 100)[0], tracked(data, 800)[0]
    assert len(one) == len(other) > 10
    for ours, theirs in zip(one, other, strict=True):
        assert ours.source_count == theirs.source_count
        if ours.noise_covariance is None:
            assert theirs.noise_covariance is None
            continue
        assert theirs.noise_covariance is not None
        assert np.allclose(ours.noise_covariance, theirs.noise_covariance)
