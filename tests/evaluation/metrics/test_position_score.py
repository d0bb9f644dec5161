"""The score of position tracks on cases small enough to count by hand."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.metrics.position_score import PositionScore, score_position_tracks
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import (
    PositionTracks,
    TrackHypothesis,
    TrackSource,
    no_position_tracks,
)

SECOND = 1_000_000_000
START = 1_767_225_600

Places = Mapping[int, tuple[float, ...]]


def picture(
    time: float,
    places: Places,
    status: TrackStatus = TrackStatus.CONFIRMED,
    variance: float = np.nan,
) -> PositionTracks:
    """Return tracks at x, y or x, y, vx, vy."""
    n = len(places)
    return PositionTracks(
        stamp=START * SECOND + round(time * SECOND),
        id=np.array(list(places), np.uint64),
        status=np.full(n, status, np.uint8),
        source=np.full(n, TrackSource.ACTIVE, np.uint8),
        state=np.array([(*place, 0.0, 0.0)[:4] for place in places.values()]).reshape(n, 4),
        covariance=np.broadcast_to(variance * np.eye(4), (n, 4, 4)),
    )


def two_sided(
    time: float,
    left: tuple[float, float],
    right: tuple[float, float],
    probability_left: float,
    ids: tuple[int, int] = (7, 8),
) -> PositionTracks:
    return PositionTracks(
        stamp=START * SECOND + round(time * SECOND),
        id=np.array(ids, np.uint64),
        status=np.full(2, TrackStatus.CONFIRMED, np.uint8),
        source=np.full(2, TrackSource.TMA, np.uint8),
        state=np.array([(*left, 0.0, 0.0), (*right, 0.0, 0.0)]),
        hypothesis=np.array([TrackHypothesis.LEFT, TrackHypothesis.RIGHT], np.uint8),
        hypothesis_probability=np.array([probability_left, 1.0 - probability_left]),
        bearing_track_id=np.array([3, 3], np.uint64),
    )


def score(lists: Sequence[Places], truth: Places, cutoff_m: float = 200.0) -> PositionScore:
    """Score one list a second against targets at rest."""
    return score_position_tracks(
        [picture(time, truth) for time in range(len(lists))],
        [picture(time, places) for time, places in enumerate(lists)],
        cutoff_m,
    )


def test_perfect_tracks() -> None:
    result = score([{7: (100.0, 0.0), 8: (0.0, 900.0)}] * 10, {1: (100.0, 0.0), 2: (0.0, 900.0)})
    assert (result.rmse_m, result.ospa_m, result.gospa_m) == (0.0, 0.0, 0.0)
    assert result.median_nearest_m == result.velocity_rmse_m_per_s == 0.0
    identities = result.identities
    assert identities.continuity == identities.held_share == 1.0
    assert identities.identity_swaps == identities.false_tracks == 0
    assert identities.confirmation_delay_periods == 1.0


def test_errors_are_distances_of_the_assigned_pairs() -> None:
    """Errors (3, 4) and (0, 12): RMSE sqrt((25 + 144) / 2), GOSPA 13 m."""
    result = score([{7: (3.0, 4.0), 8: (900.0, 12.0)}] * 4, {1: (0.0, 0.0), 2: (900.0, 0.0)})
    assert result.rmse_m == result.ospa_m == pytest.approx(84.5**0.5)
    assert result.median_error_m == pytest.approx(8.5)
    assert result.gospa_m == pytest.approx(13.0)


def test_beyond_the_cutoff_a_track_is_false_and_its_target_missed() -> None:
    """250 m off: OSPA is the cut-off, GOSPA^2 one missed and one false; nearest tells how far."""
    result = score([{7: (250.0, 0.0)}] * 36, {1: (0.0, 0.0)})
    assert result.ospa_m == pytest.approx(200.0)
    assert result.gospa_m == pytest.approx(200.0)
    assert np.isnan(result.rmse_m) and result.median_nearest_m == pytest.approx(250.0)
    assert result.identities.targets_never_held == result.identities.false_tracks == 1
    assert result.identities.false_tracks_per_hour == pytest.approx(100.0)
    assert score([{7: (250.0, 0.0)}] * 36, {1: (0.0, 0.0)}, 300.0).rmse_m == pytest.approx(250.0)


def test_rows_far_from_every_target_are_counted_whatever_the_cutoff() -> None:
    """Of three rows one is 150 m from a target, one 500 m; the third has its target at 0 m."""
    truth = [picture(0, {1: (0.0, 0.0), 2: (5000.0, 0.0)})]
    tracks = [picture(0, {7: (150.0, 0.0), 8: (5500.0, 0.0), 9: (0.0, 0.0)})]
    assert score_position_tracks(truth, tracks).far_share == pytest.approx(1.0 / 3.0)
    assert score_position_tracks(truth, tracks, 1000.0).far_share == pytest.approx(1.0 / 3.0)
    closer = score_position_tracks(truth, tracks, far_limit_m=100.0)
    assert (closer.far_limit_m, closer.far_share) == (100.0, pytest.approx(2.0 / 3.0))
    assert score_position_tracks([picture(0, {})], tracks).far_share == 1.0
    assert np.isnan(score_position_tracks(truth, [picture(0, {})]).far_share)


def test_exchange_of_identities_is_one_swap_a_target() -> None:
    before, after = {7: (0.0, 0.0), 8: (900.0, 0.0)}, {7: (900.0, 0.0), 8: (0.0, 0.0)}
    identities = score([before] * 6 + [after] * 14, {1: (0.0, 0.0), 2: (900.0, 0.0)}).identities
    assert identities.identity_swaps == identities.lasting_identity_swaps == 2
    assert identities.continuity == pytest.approx(14 / 20)


def test_late_confirmation_is_delay() -> None:
    """Tentative for three periods: the fourth is the first that counts."""
    truth = [picture(2.0 * step, {1: (0.0, 0.0)}) for step in range(10)]
    status = [TrackStatus.TENTATIVE] * 3 + [TrackStatus.CONFIRMED] * 7
    tracks = [picture(2.0 * step, {7: (1.0, 0.0)}, entry) for step, entry in enumerate(status)]
    identities = score_position_tracks(truth, tracks).identities
    assert identities.confirmation_delay_periods == 4.0
    assert identities.confirmation_delay == pytest.approx(8.0)
    assert identities.continuity == pytest.approx(0.7)


@pytest.mark.parametrize("status", [TrackStatus.TENTATIVE, TrackStatus.TERMINATED])
def test_only_tracks_that_claim_a_target_count(status: TrackStatus) -> None:
    result = score_position_tracks(
        [picture(0, {1: (0.0, 0.0)})], [picture(0, {7: (0.0, 0.0)}, status)]
    )
    assert result.ospa_m == 200.0 and result.identities.held_share == 0.0


def test_truth_is_joined_at_the_stamp_of_the_tracks() -> None:
    """A target at 10 m/s, sampled each 10 s: exact between samples and one sample beyond."""
    truth = [picture(time, {1: (10.0 * time, 0.0, 10.0, 0.0)}) for time in (0, 10, 20)]
    tracks = [picture(time, {7: (10.0 * time, 0.0, 10.0, 0.0)}) for time in (-1, 3, 10, 27, 31)]
    result = score_position_tracks(truth, tracks)
    assert (result.periods, result.unscored_periods) == (3, 2)
    assert result.rmse_m == pytest.approx(0.0, abs=1e-9)
    assert result.velocity_rmse_m_per_s == pytest.approx(0.0, abs=1e-9)


def test_nees_is_one_for_errors_of_one_standard_deviation() -> None:
    tracks = [picture(time, {7: (2.0, -2.0, 2.0, 2.0)}, variance=4.0) for time in range(5)]
    result = score_position_tracks([picture(time, {1: (0.0, 0.0)}) for time in range(5)], tracks)
    assert result.nees_per_dimension == pytest.approx(1.0)
    assert result.nees_band == pytest.approx((0.4844 / 4, 11.1433 / 4), rel=1e-3)
    singular = [picture(time, {7: (2.0, -2.0)}, variance=0.0) for time in range(5)]
    assert np.isnan(score_position_tracks(tracks, singular).nees_per_dimension)


def test_two_sides_of_a_bearing_are_one_track_on_the_more_probable_side() -> None:
    """Right for three periods of five, then the left row alone: no swap, no false track."""
    truth = [picture(time, {1: (100.0, 0.0)}) for time in range(8)]
    open_side = [
        two_sided(time, (110.0, 0.0), (110.0, 900.0), probability)
        for time, probability in enumerate([0.6, 0.4, 0.5, 0.4, 0.9])
    ]
    resolved = [picture(time, {7: (110.0, 0.0)}) for time in (5, 6, 7)]
    result = score_position_tracks(truth, open_side + resolved)
    assert result.two_sided_share == pytest.approx(5 / 8)
    assert result.wrong_side_share == pytest.approx(2 / 5)
    assert result.rmse_m == pytest.approx(10.0)
    assert result.identities.identity_swaps == result.identities.false_tracks == 0
    assert result.identities.continuity == pytest.approx(6 / 8)


def test_the_side_that_remains_keeps_the_identity_of_the_pair() -> None:
    truth = [picture(time, {1: (100.0, 0.0)}) for time in range(20)]
    open_side = [two_sided(time, (100.0, 0.0), (100.0, 0.0), 0.9) for time in range(10)]
    remains = [picture(time, {8: (100.0, 0.0)}) for time in range(10, 20)]
    identities = score_position_tracks(truth, open_side + remains).identities
    assert identities.identity_swaps == 0 and identities.continuity == 1.0


def test_rows_of_different_bearings_are_different_tracks() -> None:
    """Without a common bearing track both sides count: one of them is false."""
    entry = two_sided(0, (100.0, 0.0), (100.0, 900.0), 0.5)
    apart = PositionTracks(
        stamp=entry.stamp,
        id=entry.id,
        status=entry.status,
        source=entry.source,
        state=entry.state,
        hypothesis=entry.hypothesis,
    )
    result = score_position_tracks([picture(0, {1: (100.0, 0.0)})], [apart])
    assert result.two_sided_share == 0.0 and result.identities.false_tracks == 1


def test_stations_number_their_bearings_independently() -> None:
    """Bearing track 3 of either station: two targets, each with an open side."""
    one = two_sided(0, (100.0, 0.0), (100.0, 900.0), 0.9)
    other = two_sided(0, (5000.0, 0.0), (5000.0, 900.0), 0.9)
    both = PositionTracks(
        stamp=one.stamp,
        id=np.array([7, 8, 9, 10], np.uint64),
        status=np.concatenate([one.status, other.status]),
        source=np.concatenate([one.source, other.source]),
        state=np.concatenate([one.state, other.state]),
        hypothesis=np.concatenate([one.hypothesis, other.hypothesis]),
        hypothesis_probability=np.concatenate([one.hypothesis_probability] * 2),
        bearing_track_id=np.full(4, 3, np.uint64),
        contributor_track=np.arange(4, dtype=np.uint32),
        contributor_id=np.full(4, 3, np.uint64),
        contributor_sensor=("bow", "bow", "tail", "tail"),
    )
    truth = [picture(0, {1: (100.0, 0.0), 2: (5000.0, 0.0)})]
    result = score_position_tracks(truth, [both])
    assert result.two_sided_share == 1.0 and result.ospa_m == 0.0
    assert result.identities.false_tracks == 0


@pytest.mark.parametrize("lists", [[], [{}], [{7: (np.nan, 0.0)}], [{7: (1.0, np.inf)}]])
def test_mapping_is_valid_json_whatever_is_missing(lists: list[Places]) -> None:
    mapping = score(lists, {1: (0.0, 0.0)}).to_mapping()
    assert json.loads(json.dumps(mapping, allow_nan=False)) == mapping
    nothing = score_position_tracks([no_position_tracks(START)], [no_position_tracks(START)])
    assert nothing.ospa_m == 0.0 and json.dumps(nothing.to_mapping(), allow_nan=False)


def test_heights_count_where_they_are_estimated_and_known() -> None:
    """Errors of 3 and 4 m at a deviation of 5 m; what was only assumed does not count."""
    truth, tracks = [], []
    for time, height, deviation in ((0.0, 3.0, 5.0), (1.0, -4.0, 5.0), (2.0, 100.0, np.nan)):
        place = picture(time, {1: (0.0, 0.0)})
        truth.append(replace(place, z=np.array([-50.0])))
        z, spread = np.array([height - 50.0]), np.array([deviation])
        tracks.append(replace(place, z=z, z_standard_deviation=spread))
    score = score_position_tracks(truth, tracks)
    assert score.height_rmse_m == pytest.approx(np.sqrt(12.5))
    assert score.height_nees == pytest.approx(0.5)
    without = score_position_tracks(truth, [picture(0.0, {1: (0.0, 0.0)})])
    assert np.isnan(without.height_rmse_m) and without.to_mapping()["height_nees"] is None
