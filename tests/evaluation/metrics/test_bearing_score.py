"""The score of bearing tracks on cases small enough to count by hand."""

import json
from collections.abc import Mapping, Sequence

import numpy as np
import pytest

from sonar_tracking.evaluation.metrics.bearing_score import BearingScore, score_bearing_tracks
from sonar_tracking.records.bearings import BearingTracks, TrackStatus

SECOND = 1_000_000_000
START = 1_767_225_600


def bearings(
    time: float,
    angles_deg: Mapping[int, float],
    rate_deg: float = 0.0,
    status: TrackStatus = TrackStatus.CONFIRMED,
    variance: float = np.nan,
) -> BearingTracks:
    n = len(angles_deg)
    unknown = np.full(n, np.nan)
    return BearingTracks(
        stamp=START * SECOND + round(time * SECOND),
        id=np.array(list(angles_deg), dtype=np.uint64),
        status=np.full(n, status, dtype=np.uint8),
        arrival_angle=np.radians(np.array(list(angles_deg.values()), dtype=float)),
        arrival_angle_rate=np.full(n, np.radians(rate_deg)),
        covariance=np.broadcast_to(variance * np.eye(2), (n, 2, 2)),
        measurement=unknown,
        measurement_variance=unknown,
        innovation=unknown,
        signal_to_noise_ratio=unknown,
        existence_probability=unknown,
        ambiguous=np.ones(n, dtype=bool),
    )


def score(lists: Sequence[Mapping[int, float]], truth: Mapping[int, float]) -> BearingScore:
    """Score one list a second against targets at rest."""
    return score_bearing_tracks(
        [bearings(time, truth) for time in range(len(lists))],
        [bearings(time, angles) for time, angles in enumerate(lists)],
    )


def test_perfect_tracks() -> None:
    result = score([{7: 10.0, 8: -20.0}] * 10, {1: 10.0, 2: -20.0})
    assert result.rmse_deg == pytest.approx(0.0, abs=1e-12)
    assert (result.ospa_deg, result.gospa_deg) == pytest.approx((0.0, 0.0), abs=1e-12)
    identities = result.identities
    assert identities.continuity == identities.smallest_continuity == identities.held_share == 1.0
    assert identities.identity_swaps == identities.lost_tracks == identities.false_tracks == 0
    assert identities.confirmation_delay_periods == 1.0
    assert identities.confirmation_delay == pytest.approx(1.0)


def test_errors_are_those_of_the_assigned_pairs() -> None:
    """Errors 3 and 4 deg: RMSE sqrt(12.5), median 3.5, OSPA sqrt(12.5), GOSPA 5 deg."""
    result = score([{7: 13.0, 8: -24.0}] * 4, {1: 10.0, 2: -20.0})
    assert result.rmse_deg == pytest.approx(12.5**0.5)
    assert result.median_error_deg == pytest.approx(3.5)
    assert result.ospa_deg == pytest.approx(12.5**0.5)
    assert result.gospa_deg == pytest.approx(5.0)


def test_exchange_of_identities_is_one_swap_a_target() -> None:
    before, after = {7: 10.0, 8: -20.0}, {7: -20.0, 8: 10.0}
    identities = score([before] * 6 + [after] * 14, {1: 10.0, 2: -20.0}).identities
    assert identities.identity_swaps == 2
    assert identities.lasting_identity_swaps == 2
    assert identities.continuity == pytest.approx(14 / 20)


def test_exchange_for_a_moment_is_no_lasting_swap() -> None:
    before, after = {7: 10.0, 8: 11.0}, {7: 11.0, 8: 10.0}
    identities = score([before] * 6 + [after] + [before] * 6, {1: 10.0, 2: 11.0}).identities
    assert identities.identity_swaps == 4
    assert identities.lasting_identity_swaps == 0


def test_swap_is_seen_across_a_gap() -> None:
    identities = score([{7: 10.0}] * 5 + [{}] * 2 + [{9: 10.0}] * 5, {1: 10.0}).identities
    assert identities.identity_swaps == identities.lasting_identity_swaps == 1
    assert identities.lost_tracks == 0


@pytest.mark.parametrize(("missing", "lost"), [(4, 0), (5, 1), (20, 1)])
def test_lost_after_five_periods_without_identity(missing: int, lost: int) -> None:
    lists = [{7: 10.0}] * 3 + [{7: 16.0}] * missing + [{7: 10.0}] * 3
    identities = score(lists, {1: 10.0}).identities
    assert identities.lost_tracks == lost
    assert identities.held_share == pytest.approx(6 / (6 + missing))


def test_late_start_is_delay_and_not_loss() -> None:
    identities = score([{}] * 8 + [{7: 10.0}] * 8, {1: 10.0}).identities
    assert identities.lost_tracks == 0
    assert identities.confirmation_delay_periods == 9.0
    assert identities.confirmation_delay == pytest.approx(9.0)


def test_target_that_is_never_held_is_named() -> None:
    result = score([{7: 10.0}] * 10, {1: 10.0, 2: -40.0})
    assert result.identities.targets_never_held == 1
    assert result.identities.lost_tracks == 0
    assert result.identities.smallest_continuity == 0.0
    assert result.ospa_deg == pytest.approx((25.0 / 2) ** 0.5)


@pytest.mark.parametrize(("near_periods", "false_tracks"), [(9, 1), (10, 0)])
def test_false_track_is_near_a_truth_for_less_than_half_its_life(
    near_periods: int, false_tracks: int
) -> None:
    lists = [{7: 10.0, 9: 12.0 if time < near_periods else 60.0} for time in range(20)]
    identities = score(lists, {1: 10.0}).identities
    assert identities.false_tracks == false_tracks
    assert identities.false_tracks_per_hour == pytest.approx(false_tracks * 180.0)


@pytest.mark.parametrize(
    ("status", "targets_held"),
    [
        (TrackStatus.TENTATIVE, 0.0),
        (TrackStatus.CONFIRMED, 1.0),
        (TrackStatus.COASTED, 1.0),
        (TrackStatus.TERMINATED, 0.0),
    ],
)
def test_only_confirmed_and_coasted_tracks_count(status: TrackStatus, targets_held: float) -> None:
    result = score_bearing_tracks(
        [bearings(0.0, {1: 10.0})], [bearings(0.0, {7: 10.0}, status=status)]
    )
    assert result.identities.held_share == targets_held


def test_truth_is_interpolated_and_carried_on_for_one_step() -> None:
    truth = [bearings(time, {1: 2.0 * time}, rate_deg=2.0) for time in (0.0, 1.0, 2.0)]
    times = (-0.5, 0.25, 1.0, 1.75, 2.9, 3.1)
    tracks = [bearings(time, {7: 2.0 * time}, rate_deg=2.0) for time in times]
    result = score_bearing_tracks(truth, tracks)
    assert (result.periods, result.unscored_periods) == (4, 2)
    assert result.rmse_deg == pytest.approx(0.0, abs=1e-9)


def test_absence_of_the_target_is_no_loss() -> None:
    truth = [bearings(time, {1: 10.0} if not 5 <= time < 15 else {}) for time in range(20)]
    tracks = [bearings(time, {7: 10.0} if time < 5 or time > 16 else {}) for time in range(20)]
    identities = score_bearing_tracks(truth, tracks).identities
    assert identities.lost_tracks == 0
    assert identities.continuity == pytest.approx(8 / 10)


def test_nees_is_one_for_errors_of_one_standard_deviation() -> None:
    deviation = np.radians(1.0)
    truth = [bearings(0.0, {1: 10.0}), bearings(1.0, {1: 10.0})]
    tracks = [bearings(t, {7: 11.0}, rate_deg=-1.0, variance=deviation**2) for t in (0.0, 1.0)]
    result = score_bearing_tracks(truth, tracks)
    assert result.nees_per_dimension == pytest.approx(1.0)
    assert result.nees_band[0] < 1.0 < result.nees_band[1]


@pytest.mark.parametrize("lists", [[], [{}] * 3, [{7: 10.0}] * 3])
def test_mapping_is_valid_json_whatever_is_missing(lists: list[dict[int, float]]) -> None:
    for truth in ([], [bearings(time, {1: 10.0}) for time in range(3)]):
        tracks = [bearings(time, angles) for time, angles in enumerate(lists)]
        mapping = score_bearing_tracks(truth, tracks).to_mapping()
        assert json.loads(json.dumps(mapping, allow_nan=False)) == mapping
