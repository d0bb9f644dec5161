"""From nothing: tracks are confirmed, held through crossings, coasted, ended, never renamed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates, TrackStatus
from tests.passive.block_scene import noise_colour
from tests.passive.crossing_scene import (
    EPOCH,
    POSITIONS,
    WAVENUMBER,
    ComplexArray,
    FloatArray,
    blocks_of,
    circular_noise,
    snapshots_of,
)
from tests.passive.tracked_together import tracked_together

pytestmark = pytest.mark.slow

FIVE = np.deg2rad([-50.0, -25.0, 0.0, 25.0, 50.0])


def times_of(duration: float) -> FloatArray:
    """Return the instants of the snapshots, s."""
    return np.arange(round(duration * 200.0)) / 200.0


def scene(seed: int, angles_deg: FloatArray, level_db: FloatArray) -> ComplexArray:
    """Return snapshots of sources whose levels (n_snapshots, n_sources) may change."""
    generator = np.random.default_rng(seed)
    vectors = steering_vectors(POSITIONS, np.deg2rad(angles_deg), WAVENUMBER)
    sources = 10.0 ** (level_db / 20.0) * circular_noise(generator, *angles_deg.shape)
    noise = circular_noise(generator, len(angles_deg), len(POSITIONS))
    return np.matmul(vectors, sources[..., None])[..., 0] + noise


def all_tracked(
    runs: Sequence[ComplexArray], method: str = "joint_map"
) -> list[list[BearingTracks]]:
    """Return the tracks of snapshots that begin at t = 0, given nothing, run by run."""
    subspaces = SubspaceConfiguration(n_subspaces=1, period=0.5, covariance_snapshots=100)
    return tracked_together(runs, subspaces, BearingTrackerConfiguration(method=method), 100, EPOCH)


def tracked(data: ComplexArray, method: str = "joint_map") -> list[BearingTracks]:
    """Return those of a single run."""
    return all_tracked([data], method)[0]


def established(tracks: BearingTracks) -> dict[int, float]:
    """Return the angles of confirmed and coasted tracks in degrees, by identifier."""
    rows = np.isin(tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
    angles = np.rad2deg(tracks.arrival_angle[rows])
    return dict(zip(tracks.id[rows].tolist(), angles.tolist(), strict=True))


def all_ids(tracks: list[BearingTracks]) -> set[int]:
    """Return the identifiers of all tracks that were ever confirmed."""
    return {number for entry in tracks for number in established(entry)}


def seconds(entry: BearingTracks) -> float:
    """Return the time of a track list, s."""
    return (entry.stamp - EPOCH) * 1e-9


@cache
def five_targets() -> dict[float, list[BearingTracks]]:
    levels = (-5.0, 0.0)
    angles = np.broadcast_to(FIVE, (12000, 5))
    runs = [snapshots_of(np.random.default_rng(1), angles, level_db) for level_db in levels]
    return dict(zip(levels, all_tracked(runs), strict=True))


@pytest.mark.parametrize(("level_db", "within"), [(-5.0, 4.0), (0.0, 2.0)])
def test_five_targets_are_confirmed_in_time_and_stay_five(level_db: float, within: float) -> None:
    tracks = five_targets()[level_db]
    first = next(entry for entry in tracks if len(established(entry)) == 5)
    assert seconds(first) <= within
    assert len(all_ids(tracks)) == 5
    for entry in tracks[tracks.index(first) :]:
        errors = np.sort(list(established(entry).values())) - np.rad2deg(FIVE)
        assert np.abs(errors).max() < 2.0
        confirmed = entry.status == TrackStatus.CONFIRMED
        assert np.all(entry.existence_probability[confirmed] > 0.5)
        assert np.all(entry.existence_probability <= 0.99)


@cache
def turning_targets() -> dict[float, list[BearingTracks]]:
    levels = (10.0, 20.0)
    angles = FIVE + np.deg2rad(10.0) * np.sin(0.3 * times_of(44.0)[:, None] + np.arange(5))
    runs = [snapshots_of(np.random.default_rng(2), angles, level_db) for level_db in levels]
    return dict(zip(levels, all_tracked(runs), strict=True))


@pytest.mark.parametrize("level_db", [10.0, 20.0])
def test_strong_turning_targets_bring_no_extra_track(level_db: float) -> None:
    tracks = turning_targets()[level_db]
    assert len(all_ids(tracks)) == 5
    for entry in [entry for entry in tracks if seconds(entry) > 6.0]:
        truth = FIVE + np.deg2rad(10.0) * np.sin(0.3 * seconds(entry) + np.arange(5))
        followed = np.sort(list(established(entry).values()))
        assert followed == pytest.approx(np.sort(np.rad2deg(truth)), abs=0.5)


@cache
def slow_crossings() -> dict[int, list[BearingTracks]]:
    times, seeds = times_of(70.0), (1, 2)
    angles = np.stack([-7.0 + 0.2 * times, 7.0 - 0.2 * times], axis=-1)
    runs = [scene(seed, angles, np.full((len(times), 2), -5.0)) for seed in seeds]
    return dict(zip(seeds, all_tracked(runs), strict=True))


@pytest.mark.parametrize("seed", [1, 2])
def test_slow_crossing_keeps_names(seed: int) -> None:
    # They are nearer than half a beamwidth for 20 s, at a level where bearings scatter by 0.25 deg.
    tracks = slow_crossings()[seed]
    assert len(all_ids(tracks)) == 2
    at_start, at_end = established(tracks[20]), established(tracks[-1])
    first, second = sorted(at_start, key=lambda number: at_start[number])
    assert at_end[first] == pytest.approx(6.9, abs=1.0)
    assert at_end[second] == pytest.approx(-6.9, abs=1.0)


def test_new_source_is_found_in_mid_run_and_ends_when_it_stays_away() -> None:
    times = times_of(40.0)
    angles = np.broadcast_to([-30.0, 20.0], (len(times), 2))
    level = np.zeros((len(times), 2))
    level[(times < 10.0) | (times >= 20.0), 1] = -300.0
    tracks = tracked(scene(3, angles, level))
    found = next(entry for entry in tracks if len(established(entry)) == 2)
    assert 10.0 < seconds(found) <= 13.0
    names = [n for n, angle in established(found).items() if angle > 0.0]
    told = [entry for entry in tracks if TrackStatus.TERMINATED in entry.status]
    assert len(told) == 1
    assert told[0].id[told[0].status == TrackStatus.TERMINATED].tolist() == names
    assert 24.0 < seconds(told[0]) < 34.0
    assert len(established(tracks[-1])) == 1
    assert len(all_ids(tracks)) == 2


def test_short_fade_is_coasted_under_the_same_name() -> None:
    times = times_of(30.0)
    angles = np.stack([np.full_like(times, -30.0), 10.0 + times], axis=-1)
    level = np.zeros((len(times), 2))
    level[(times >= 12.0) & (times < 16.0), 1] = -300.0
    tracks = tracked(scene(4, angles, level))
    assert len(all_ids(tracks)) == 2
    status = {seconds(e): set(e.status.tolist()) for e in tracks}
    assert status[14.0] == {TrackStatus.CONFIRMED, TrackStatus.COASTED}
    assert status[20.0] == {TrackStatus.CONFIRMED}
    assert max(established(tracks[-1]).values()) == pytest.approx(39.5, abs=1.0)


@cache
def crossings() -> tuple[list[BearingTracks], ...]:
    """Return the tracks of two sources that cross: of their own waveforms, and of one."""
    times = times_of(45.0)
    angles = np.stack([-20.0 + 0.7 * times, 20.0 - 0.6 * times], axis=-1)
    incoherent = scene(5, angles, np.full((len(times), 2), 3.0))
    generator = np.random.default_rng(6)
    vectors = steering_vectors(POSITIONS, np.deg2rad(angles), WAVENUMBER)
    source = 1.5 * circular_noise(generator, len(times), 1) * np.array([[1.0, 0.8j]])
    noise = circular_noise(generator, len(times), len(POSITIONS))
    return tuple(all_tracked([incoherent, np.matmul(vectors, source[..., None])[..., 0] + noise]))


@pytest.mark.parametrize("coherent", [False, True])
def test_crossing_ends_no_track(coherent: bool) -> None:
    tracks = crossings()[coherent]
    assert len(all_ids(tracks)) == 2
    at_start, at_end = established(tracks[8]), established(tracks[-1])
    assert set(at_start) == set(at_end)
    first = min(at_start, key=lambda number: at_start[number])
    assert at_end[first] == pytest.approx(-20.0 + 0.7 * 44.5, abs=2.0)


def test_two_sources_that_part_become_two_tracks() -> None:
    times = times_of(40.0)
    angles = np.stack([-0.5 * times, 0.5 * times], axis=-1)
    tracks = tracked(scene(7, angles, np.zeros((len(times), 2))))
    assert len(established(tracks[6])) == 1
    assert len(established(tracks[-1])) == 2
    assert sorted(established(tracks[-1]).values()) == pytest.approx([-19.75, 19.75], abs=2.0)


def test_all_fade_at_once_and_come_back_as_new_tracks() -> None:
    times = times_of(60.0)
    angles = np.broadcast_to([-30.0, 0.0, 30.0], (len(times), 3))
    level = np.full((len(times), 3), 0.0)
    level[(times >= 10.0) & (times < 40.0)] = -300.0
    tracks = tracked(scene(8, angles, level))
    before = {n for e in tracks if seconds(e) < 10.0 for n in established(e)}
    assert all(not established(e) for e in tracks if 30.0 < seconds(e) < 40.0)
    after = set(established(tracks[-1]))
    assert len(before) == len(after) == 3
    assert min(after) > max(before)


def test_empty_ocean_has_no_tracks() -> None:
    tracks = tracked(circular_noise(np.random.default_rng(9), 24000, 15))
    assert not all_ids(tracks)


def dead(data: ComplexArray) -> ComplexArray:
    """Return the data with a silent element from the second second on."""
    data = data.copy()
    data[200:, 4] = 0.0
    return data


def saturated(data: ComplexArray) -> ComplexArray:
    """Return the data with an element whose every sample is at full scale."""
    data = data.copy()
    data[:, 4] = 30.0 * np.exp(1j * np.round(np.angle(data[:, 4]) * 2.0 / np.pi) * np.pi / 2.0)
    return data


@pytest.mark.parametrize("fault", [dead, saturated])
def test_bad_element_costs_no_track_and_makes_none(
    fault: Callable[[ComplexArray], ComplexArray],
) -> None:
    # The noise of a saturated one, 20 dB above that of the others, would hide the sources.
    angles = np.broadcast_to([-30.0, 10.0], (6000, 2))
    tracks = tracked(fault(scene(10, angles, np.full((6000, 2), 3.0))))
    assert sorted(established(tracks[-1]).values()) == pytest.approx([-30.0, 10.0], abs=0.5)
    assert len(all_ids(tracks)) == 2
    assert all(len(established(entry)) == 2 for entry in tracks if seconds(entry) >= 4.0)


def test_source_at_endfire_is_one_track_that_knows_how_little_it_knows() -> None:
    angles = np.broadcast_to([88.0, 0.0], (8000, 2))
    tracks = tracked(scene(11, angles, np.full((8000, 2), 5.0)))
    assert len(all_ids(tracks)) == 2
    for entry in [entry for entry in tracks if seconds(entry) > 4.0]:
        at_broadside, at_endfire = sorted(established(entry).values())
        assert abs(at_broadside) < 0.5
        assert 84.0 < at_endfire <= 90.0
        deviation = np.rad2deg(np.sqrt(entry.covariance[np.argsort(entry.arrival_angle), 0, 0]))
        assert deviation[1] > 4.0 * deviation[0]
        assert abs(at_endfire - 88.0) < 4.0 * deviation[1] + 0.5


def test_source_exactly_at_endfire_is_never_two() -> None:
    # Half a wavelength apart, both ends of the line are the same wave: the sign is open.
    angles = np.broadcast_to([90.0, 0.0], (8000, 2))
    tracks = tracked(scene(11, angles, np.full((8000, 2), 10.0)))
    assert len(all_ids(tracks)) == 2
    assert all(np.abs(entry.arrival_angle).max(initial=0.0) <= np.pi / 2 for entry in tracks)
    assert sorted(np.abs(list(established(tracks[-1]).values()))) == pytest.approx([0, 90], abs=4)


def test_of_twenty_sources_the_array_tracks_those_it_tells_apart() -> None:
    generator = np.random.default_rng(5)
    levels = generator.uniform(-5.0, 25.0, 20)
    truth = np.sort(generator.uniform(-80.0, 80.0, 20))
    data = scene(12, np.broadcast_to(truth, (4000, 20)), np.broadcast_to(levels, (4000, 20)))
    stage, notices = SubspaceStage(SubspaceConfiguration(n_subspaces=1, period=0.5)), []
    for block in blocks_of(data, 100, EPOCH):
        notices += [notice.text for notice in stage.update(block).notices]
    assert any("show 14 sources or more, as many as 15 elements" in text for text in notices)
    tracks = tracked(data)
    assert 5 <= len(all_ids(tracks)) <= 14
    owners: dict[int, set[int]] = {}
    for entry in tracks:
        assert np.isfinite(entry.arrival_angle).all()
        for number, angle in established(entry).items():
            nearest = int(np.argmin(np.abs(truth - angle)))
            assert abs(truth[nearest] - angle) < 4.0
            owners.setdefault(number, set()).add(round(truth[nearest] / 8.0))
    # No identity wanders from source to source.
    assert all(max(own) - min(own) <= 1 for own in owners.values())


def test_twenty_sources_all_round_are_a_noise() -> None:
    angles = np.broadcast_to(np.linspace(-80.0, 80.0, 20), (4000, 20))
    tracks = tracked(scene(12, angles, np.zeros((4000, 20))))
    assert len(all_ids(tracks)) <= 2
    for entry in tracks:
        assert np.isfinite(entry.arrival_angle).all()


def test_rank_drop_in_mid_run_keeps_names() -> None:
    # Two sources become one waveform after 10 s, as a target and its echo.
    times = times_of(25.0)
    generator = np.random.default_rng(13)
    waveforms = 1.5 * circular_noise(generator, len(times), 2)
    waveforms[times >= 10.0, 1] = 0.8j * waveforms[times >= 10.0, 0]
    angles = np.stack([-20.0 + 0.2 * times, 15.0 - 0.2 * times], axis=-1)
    vectors = steering_vectors(POSITIONS, np.deg2rad(angles), WAVENUMBER)
    data = np.matmul(vectors, waveforms[..., None])[..., 0]
    tracks = tracked(data + circular_noise(generator, *data.shape))
    assert len(all_ids(tracks)) == 2
    at_end = [angle for _, angle in sorted(established(tracks[-1]).items())]
    assert sorted(at_end) == pytest.approx([-15.1, 10.1], abs=1.0)


@pytest.mark.parametrize("method", ["joint_map", "coherent"])
def test_coherent_sources_start_from_nothing(method: str) -> None:
    times = times_of(20.0)
    generator = np.random.default_rng(14)
    waveforms = circular_noise(generator, len(times), 1) * np.array([[1.0, 0.7j]])
    vectors = steering_vectors(POSITIONS, np.deg2rad([-20.0, 15.0]), WAVENUMBER)
    data = waveforms @ vectors.T + circular_noise(generator, len(times), 15)
    tracks = tracked(data, method)
    assert sorted(established(tracks[-1]).values()) == pytest.approx([-20.0, 15.0], abs=1.0)
    assert len(all_ids(tracks)) == 2


@cache
def estimates_of_two() -> list[SubspaceEstimates]:
    data = scene(15, np.broadcast_to([-30.0, 30.0], (1600, 2)), np.full((1600, 2), 5.0))
    stage = SubspaceStage(SubspaceConfiguration(n_subspaces=1, period=0.5))
    return [each for block in blocks_of(data, 100, EPOCH) for each in stage.update(block).estimates]


@pytest.mark.parametrize("running", [False, True], ids=["no tracks yet", "tracks"])
@pytest.mark.parametrize(
    ("noise", "reason"),
    [
        (np.diag([1.0] * 14 + [-1.0]).astype(complex), "not positive definite"),
        (np.eye(15) + 0.1j * np.eye(15, k=1), "not Hermitian"),
        (np.eye(14, dtype=complex), "15 by 15"),
        (np.full((15, 15), np.nan, dtype=complex), "finite"),
    ],
)
def test_wrong_noise_covariance_is_refused(noise: ComplexArray, reason: str, running: bool) -> None:
    tracker = BearingTrackerStage(BearingTrackerConfiguration(method="joint_map"))
    estimates = estimates_of_two()
    good = estimates[:8] if running else []
    for each in good:
        tracker.update(each)
    with pytest.raises(InputError, match=reason):
        tracker.update(replace(estimates[len(good)], noise_covariance=noise))
    # The stage is as before: the same estimate without the fault is taken.
    last = [tracker.update(each).tracks for each in estimates[len(good) :]][-1]
    assert set(established(last)) == {1, 2}


def test_noise_of_a_colour_that_is_not_told_is_no_source() -> None:
    colour = np.linalg.cholesky(noise_colour(0.3))
    assert not all_ids(tracked(circular_noise(np.random.default_rng(17), 24000, 15) @ colour.T))


def test_coloured_noise_alone_is_no_source() -> None:
    generator = np.random.default_rng(16)
    colour = noise_colour(0.6)
    data = circular_noise(generator, 6000, 15) @ np.linalg.cholesky(colour).T
    subspaces = SubspaceConfiguration(n_subspaces=1, period=0.5)
    stage = SubspaceStage(subspaces)
    tracker = BearingTrackerStage(BearingTrackerConfiguration(method="joint_map"))
    for block in blocks_of(data, 100, EPOCH, noise_covariance=colour):
        for estimates in stage.update(block).estimates:
            assert not established(tracker.update(estimates).tracks)
