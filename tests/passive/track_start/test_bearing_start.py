"""Automatic start: joined bearings, rates, identities, and no extra tracks."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.passive.track_start.bearing_start import BearingStart
from sonar_tracking.passive.track_start.tentative_track import TentativeTrack
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from tests.passive.crossing_scene import (
    EPOCH,
    POSITIONS,
    WAVENUMBER,
    ComplexArray,
    FloatArray,
    blocks_of,
    crossing_angles,
    crossing_data,
    crossing_rates,
    snapshots_of,
)
from tests.passive.estimate_scene import estimates_of
from tests.passive.tracked_together import tracked_together

PUBLISHED = BearingTrackerConfiguration(
    method="ml_fusion",
    process_noise_deg2=1.0,
    measurement_variance_deg2=36.0,
    fused_variance="independent",
    phase_reference="first_element",
)


def tracked(
    data: ComplexArray,
    subspaces: SubspaceConfiguration,
    configuration: BearingTrackerConfiguration,
) -> list[BearingTracks]:
    """Return the tracks of snapshots that begin at t = -1 s."""
    return tracked_together([data], subspaces, configuration)[0]


def confirmed(track: BearingTracks) -> FloatArray:
    """Return the angles of the confirmed rows, ascending."""
    return np.sort(track.arrival_angle[track.status == TrackStatus.CONFIRMED])


@pytest.mark.parametrize("source_count", [5, 0])
def test_five_targets_start_within_four_covariances(source_count: int) -> None:
    subspaces = SubspaceConfiguration(
        method="past", forgetting_factor=0.86, period=1.0, source_count=source_count
    )
    tracks = tracked(crossing_data(1, 0.0, 4.0), subspaces, PUBLISHED)
    # Tentative from the first covariance on, with the identifiers they keep.
    for number, track in enumerate(tracks[:3]):
        assert set(track.status) == {TrackStatus.TENTATIVE}
        assert np.isnan(track.arrival_angle_rate).all() == (number == 0)
        assert np.isnan(track.measurement).all()
    assert all(set(track.id) == {1, 2, 3, 4, 5} for track in tracks)
    started = tracks[3]
    assert set(started.status) == {TrackStatus.CONFIRMED}
    order = np.argsort(started.arrival_angle)
    truth = np.argsort(crossing_angles(3.0))
    errors = started.arrival_angle[order] - crossing_angles(3.0)[truth]
    rates = started.arrival_angle_rate[order] - crossing_rates(3.0)[truth]
    assert np.abs(np.rad2deg(errors)).max() < 0.6
    assert np.abs(np.rad2deg(rates)).max() < 0.5
    assert np.all(errors**2 < 16.0 * started.covariance[order, 0, 0])


@pytest.mark.slow
def test_started_tracks_survive_the_crossings() -> None:
    # Twelve runs of the whole scene at 0 dB, from nothing; from truth all runs succeed.
    subspaces = SubspaceConfiguration(method="past", forgetting_factor=0.86, period=1.0)
    successes = 0
    runs = [crossing_data(seed, 0.0, 40.0) for seed in range(12)]
    for tracks in tracked_together(runs, subspaces, PUBLISHED):
        at_start, at_end = tracks[3], tracks[-1]
        owner = {
            number: int(np.argmin(np.abs(crossing_angles(3.0) - angle)))
            for number, angle in zip(at_start.id, at_start.arrival_angle, strict=True)
        }
        truth = crossing_angles(40.0)
        errors = [
            angle - truth[owner[number]] if number in owner else np.inf
            for number, angle in zip(at_end.id, at_end.arrival_angle, strict=True)
        ]
        complete = len(errors) == 5 and len(set(owner.values())) == 5
        successes += complete and bool(np.rad2deg(np.abs(errors)).max() < 3.0)
    assert successes >= 11


@pytest.mark.slow
@pytest.mark.parametrize("level_db", [10.0, 20.0])
def test_strong_moving_targets_start_no_extra_tracks(level_db: float) -> None:
    # Up to 3 deg/s: each smears over two eigenvalues.
    times = np.arange(-200, 8000) / 200.0
    centres = np.deg2rad([-50.0, -25.0, 0.0, 25.0, 50.0])
    truth = centres + np.deg2rad(10.0) * np.sin(0.3 * times[:, None] + np.arange(5))
    data = snapshots_of(np.random.default_rng(2), truth, level_db)
    tracks = tracked(data, SubspaceConfiguration(period=1.0), BearingTrackerConfiguration())
    seen = {
        number
        for track in tracks
        for number in track.id[track.status == TrackStatus.CONFIRMED].tolist()
    }
    assert len(seen) == 5
    at_end = np.sort(centres + np.deg2rad(10.0) * np.sin(0.3 * 39.0 + np.arange(5)))
    assert np.rad2deg(confirmed(tracks[-1])) == pytest.approx(np.rad2deg(at_end), abs=0.5)


@pytest.mark.slow
def test_noise_alone_starts_nothing() -> None:
    data = snapshots_of(np.random.default_rng(3), np.zeros((4000, 1)), -300.0)
    for count in (0, 2):
        tracks = tracked(data, SubspaceConfiguration(source_count=count), PUBLISHED)
        assert all(len(confirmed(track)) == 0 for track in tracks)


def test_line_through_joined_bearings() -> None:
    second = 1_000_000_000
    track = TentativeTrack(
        id=1,
        stamps=tuple(EPOCH + n * second for n in range(4)),
        angles=(0.1, 0.3, 0.5, 0.7),
        variances=(1e-4,) * 4,
    )
    mean, covariance = track.line(EPOCH + 3 * second)
    assert mean == pytest.approx([0.7, 0.2])
    # Least squares at the end of four equidistant points: 7/10 and 1/5 of the variance.
    assert np.diag(covariance) == pytest.approx([0.7e-4, 0.2e-4])


@pytest.mark.slow
def test_covariances_that_share_snapshots_are_used_once() -> None:
    # Ten estimates a second, each with the newest half second of snapshots.
    subspaces = SubspaceConfiguration(period=0.1, source_count=5)
    tracks = tracked(crossing_data(4, 5.0, 3.0), subspaces, BearingTrackerConfiguration())
    first = next(n for n, track in enumerate(tracks) if len(confirmed(track)) == 5)
    assert tracks[first].stamp - tracks[0].stamp >= 1.5e9


@pytest.mark.slow
def test_missing_target_starts_later_than_the_others() -> None:
    # The third source comes up after 6 s; the identities of the others are maintained.
    generator = np.random.default_rng(5)
    angles = np.broadcast_to(np.deg2rad([-30.0, 0.0, 30.0]), (3200, 3))
    levels = np.full((3200, 3), 5.0)
    levels[:1400, 1] = -300.0
    data = snapshots_of(generator, angles, levels)  # type: ignore[arg-type]
    tracks = tracked(data, SubspaceConfiguration(source_count=3), BearingTrackerConfiguration())
    early, late = tracks[5], tracks[-1]
    assert np.rad2deg(confirmed(early)) == pytest.approx([-30.0, 30.0], abs=1.0)
    assert np.rad2deg(confirmed(late)) == pytest.approx([-30.0, 0.0, 30.0], abs=1.0)
    names = early.id[early.status == TrackStatus.CONFIRMED]
    assert set(names.tolist()) < set(late.id.tolist())


def test_without_a_covariance_nothing_happens() -> None:
    data = crossing_data(6, 0.0, 1.0)
    stage = SubspaceStage(SubspaceConfiguration(source_count=5, covariance_snapshots=0))
    estimates = [e for block in blocks_of(data) for e in stage.update(block).estimates]
    start = BearingStart(process_noise=1e-4, maximum_rate=0.1, next_id=1)
    assert start.update(estimates[0], np.empty(0)) == (start, ())


def test_batch_of_runs_needs_given_bearings() -> None:
    data = crossing_data(7, 0.0, 1.0, batch=(2,))
    stage = SubspaceStage(SubspaceConfiguration(source_count=5))
    estimates = [e for block in blocks_of(data) for e in stage.update(block).estimates]
    with pytest.raises(InputError, match="give the bearings"):
        BearingTrackerStage(BearingTrackerConfiguration()).update(estimates[0])


@pytest.mark.parametrize(
    ("source_count", "rank", "n_begun"), [(0, 1, 0), (-1, 1, 1), (-1, 0, 0), (1, 0, 1), (2, 1, 2)]
)
def test_a_count_of_zero_is_a_count(source_count: int, rank: int, n_begun: int) -> None:
    """The rank stands in only where nothing was counted: in the bearings that are looked for.

    Two sources of a tenth of the noise: too weak for MDL on a hundred snapshots, but with a power
    of 2.5 along their bearings.
    """
    vectors = steering_vectors(POSITIONS, np.arcsin([0.0, 8.0 / 15.0]), WAVENUMBER)
    covariance = np.eye(15) + vectors @ np.diag([0.11, 0.1]) @ vectors.conj().T
    estimates = estimates_of(covariance, source_count=source_count, rank=rank)
    start = BearingStart(process_noise=0.0, maximum_rate=0.0, next_id=5, follows_count=True)
    after, started = start.update(estimates, np.empty(0))
    assert started == ()
    assert [track.id for track in after.tentative] == [5, 6][:n_begun]
    assert after.next_id == 5 + n_begun
