"""Tonal tracks: confirmed by M of N, followed through drift and silence, never renamed."""

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState, predict, update
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.lines.line_tracks import HeardLine, LineTrack, LineTracks
from sonar_tracking.records.time import NANOSECONDS

BIN = 0.5
DEVIATION = 0.03


def heard(frequency: float, track_id: int = 1) -> HeardLine:
    return HeardLine(track_id, frequency, DEVIATION**2, 100.0)


def follow(
    tracks: LineTracks, frames: list[list[HeardLine]], first: int = 0
) -> list[list[tuple[int, float]]]:
    """Feed one frame a second; return identifier and frequency of what each reported."""
    reports = []
    for index, frame in enumerate(frames, start=first):
        tracks.predict(index * NANOSECONDS)
        reported = tracks.update(index * NANOSECONDS, frame, BIN)
        reports.append([(line.line_id, peak.frequency) for line, peak in reported])
    return reports


def test_m_detections_among_n_frames_confirm_a_line() -> None:
    pattern = [True, False, True, False, True, True]
    frames = [[heard(100.0)] if there else [] for there in pattern]
    reports = follow(LineTracks(LineTrackerConfiguration()), frames)
    assert [len(each) for each in reports] == [0, 0, 0, 0, 1, 1]


def test_a_peak_that_does_not_come_back_is_forgotten() -> None:
    tracks = LineTracks(LineTrackerConfiguration())
    follow(tracks, [[heard(100.0)], [], [], []])
    assert tracks.lines == ()


def test_a_line_is_followed_through_drift_and_a_pause_under_one_name() -> None:
    """0.03 Hz/s, the drift a turning ship gives to 300 Hz, and 6 s of silence."""
    times = np.arange(40.0)
    frames = [[heard(300.0 + 0.03 * time)] if not 20 <= time < 26 else [] for time in times]
    reports = follow(LineTracks(LineTrackerConfiguration()), frames)
    assert {line for each in reports for line, _ in each} == {1}
    assert [len(each) for each in reports] == [0, 0] + [1] * 18 + [0] * 6 + [1] * 14


def test_a_line_that_ended_comes_back_under_a_new_name() -> None:
    frames = [[heard(100.0)]] * 5 + [[]] * 12 + [[heard(100.0)]] * 5
    tracks = LineTracks(LineTrackerConfiguration(first_id=7))
    names = [line for each in follow(tracks, frames) for line, _ in each]
    assert names == [7, 7, 7, 8, 8, 8]
    tracks.clear()
    assert follow(tracks, [[heard(50.0)]] * 3, first=30)[-1] == [(9, 50.0)]


@pytest.mark.slow
def test_filtered_frequency_and_drift_are_consistent_with_their_covariance() -> None:
    """Normalised squared error of a drifting line, mean over 200 runs, is that of 2 numbers."""
    generator = np.random.default_rng(2)
    squares = []
    for _ in range(200):
        tracks = LineTracks(LineTrackerConfiguration(drift_noise=0.0))
        drift = 0.05 * generator.standard_normal()
        noise = DEVIATION * generator.standard_normal(20)
        follow(tracks, [[heard(200.0 + drift * k + noise[k])] for k in range(20)])
        (line,) = tracks.lines
        error = line.state - np.array([200.0 + drift * 19.0, drift])
        squares.append(error @ np.linalg.solve(line.covariance, error))
    assert 1.5 < np.mean(squares) < 2.5


def test_two_lines_keep_their_names_side_by_side() -> None:
    frames = [[heard(100.0), heard(101.2)]] * 10
    reports = follow(LineTracks(LineTrackerConfiguration()), frames)
    assert reports[-1] == [(1, 100.0), (2, 101.2)]


def test_lines_of_two_targets_that_cross_in_frequency_stay_with_their_owners() -> None:
    times = np.arange(30.0)
    frames = [[heard(100.0 + 0.05 * time, 1), heard(101.5 - 0.05 * time, 2)] for time in times]
    tracks = LineTracks(LineTrackerConfiguration())
    follow(tracks, frames)
    owner = {line.line_id: (line.track_id, line.state[0]) for line in tracks.lines}
    assert owner[1][0] == 1 and abs(owner[1][1] - 101.45) < 0.1
    assert owner[2][0] == 2 and abs(owner[2][1] - 100.05) < 0.1


def test_a_line_goes_on_under_its_name_when_only_another_beam_hears_it() -> None:
    frames = [[heard(100.0, 1)]] * 5 + [[heard(100.0, 2)]] * 5
    tracks = LineTracks(LineTrackerConfiguration())
    reports = follow(tracks, frames)
    assert {line for each in reports for line, _ in each} == {1}
    assert tracks.lines[0].track_id == 2


def test_a_line_known_better_than_half_a_bin_may_still_move_by_that() -> None:
    """Its source hunts: 0.24 Hz are eight deviations, and less than half a bin."""
    frames = [[heard(100.0)]] * 20 + [[heard(100.24)]] * 5
    names = {
        name for each in follow(LineTracks(LineTrackerConfiguration()), frames) for name, _ in each
    }
    assert names == {1}


def test_two_lines_nearer_than_their_errors_are_told_apart_by_their_beams() -> None:
    frames = [[heard(100.0, 1), heard(100.05, 2)]] * 10 + [[heard(100.05, 1), heard(100.0, 2)]]
    tracks = LineTracks(LineTrackerConfiguration())
    assert follow(tracks, frames)[-1] == [(1, 100.05), (2, 100.0)]


def test_an_old_line_goes_before_a_new_one() -> None:
    """A peak of noise beside a line is forgotten, although it would fit a peak between better."""
    frames = [[heard(100.0)]] * 10 + [[heard(100.0), heard(100.1)], [heard(100.06)]]
    assert follow(LineTracks(LineTrackerConfiguration()), frames)[-1] == [(1, 100.06)]


def test_a_line_is_predicted_and_updated_as_by_a_kalman_filter() -> None:
    generator = np.random.default_rng(3)
    root = generator.normal(size=(2, 2))
    line = LineTrack(3, 1, 0, np.array([100.0, 0.02]), 1e-3 * root @ root.T)
    moved = line.predict(2_500_000_000, 1e-4)
    transition = np.array([[1.0, 2.5], [0.0, 1.0]])
    noise = 1e-4 * np.array([[2.5**3 / 3.0, 2.5**2 / 2.0], [2.5**2 / 2.0, 2.5]])
    before = predict(KalmanState(line.state, line.covariance), transition, noise)
    np.testing.assert_allclose(moved.state, before.mean)
    np.testing.assert_allclose(moved.covariance, before.covariance)
    updated = moved.update(HeardLine(9, 100.2, 4e-4, 50.0))
    after = update(before, np.array([100.2]), np.array([[1.0, 0.0]]), np.array([[4e-4]])).state
    np.testing.assert_allclose(updated.state, after.mean)
    np.testing.assert_allclose(updated.covariance, after.covariance, atol=1e-15)
    assert (updated.line_id, updated.track_id, updated.stamp) == (3, 9, 2_500_000_000)


def test_a_new_line_drifts_as_much_as_is_possible() -> None:
    tracks = LineTracks(LineTrackerConfiguration(maximum_drift=0.2))
    tracks.update(5, [heard(100.0, 4)], BIN)
    (line,) = tracks.lines
    assert (line.stamp, line.track_id, line.state.tolist()) == (5, 4, [100.0, 0.0])
    np.testing.assert_allclose(line.covariance, np.diag([DEVIATION**2, 0.04]))


def assigned(peaks: list[HeardLine], deviation: float = 0.04) -> int | None:
    """Return the peak that goes to a line of track 1 at 100 Hz known to a deviation."""
    tracks = LineTracks(LineTrackerConfiguration())
    covariance = np.diag([deviation**2, 1e-6])
    tracks.lines = (LineTrack(1, 1, 0, np.array([100.0, 0.0]), covariance, confirmed=True),)
    reported = tracks.update(0, peaks, BIN)
    return next((peaks.index(peak) for line, peak in reported if line.line_id == 1), None)


def test_a_gate_is_four_deviations_or_half_a_bin() -> None:
    # Deviations 0.4 and 0.03 Hz: 4 sqrt(0.16 + 0.0009) = 1.604 Hz; 0.04 and 0.03: 0.2 < 0.25 Hz.
    for deviation, reach in [(0.4, 1.604), (0.04, 0.25)]:
        for sign in (1.0, -1.0):
            assert assigned([heard(100.0 + sign * (reach - 1e-3))], deviation) == 0
            assert assigned([heard(100.0 + sign * (reach + 1e-3))], deviation) is None


def test_another_beam_must_fit_better_by_three_deviations_squared() -> None:
    # sqrt(0.04^2 + 0.03^2) = 0.05 Hz: the own peak is 3.1 or 2.9 deviations off, the other at 0.02.
    for own, chosen in [(0.16, 1), (0.14, 0)]:
        peaks = [heard(100.0 + own, 1), heard(99.98, 2)]
        assert assigned(peaks) == chosen


def test_a_peak_beyond_the_gate_costs_no_more_than_one_at_the_gate() -> None:
    # 0.22 Hz are 4.4 deviations, within half a bin: 16 of the gate, against 9 + 8.4 of the other.
    peaks = [heard(100.22, 1), heard(100.0 - 0.05 * 2.9, 2)]
    assert assigned(peaks) == 0


def test_a_line_lives_as_long_as_it_can_still_be_confirmed_and_ten_frames_after() -> None:
    configuration = LineTrackerConfiguration(confirmation_hits=2, confirmation_frames=4)
    for pattern, lives in [("1", 1), ("100", 1), ("1000", 0), ("1001", 1)]:
        tracks = LineTracks(configuration)
        follow(tracks, [[heard(100.0)] if there == "1" else [] for there in pattern])
        assert len(tracks.lines) == lives
    for silence, lives in [(9, 1), (10, 0)]:
        tracks = LineTracks(configuration)
        follow(tracks, [[heard(100.0)]] * 2 + [[]] * silence)
        assert len(tracks.lines) == lives


def test_one_detection_confirms_where_one_is_enough() -> None:
    tracks = LineTracks(LineTrackerConfiguration(confirmation_hits=1, confirmation_frames=1))
    assert follow(tracks, [[heard(100.0)]]) == [[(1, 100.0)]]
