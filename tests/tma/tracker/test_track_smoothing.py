"""Protects smoothing of a recorded list: whose measurements count, what rows say afterwards."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sonar_tracking.evaluation.metrics.position_score import score_position_tracks
from sonar_tracking.evaluation.metrics.position_truth import truth_as_tracks
from sonar_tracking.evaluation.offline.offline_tma_chain import OfflineTmaRun, passive_frame
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import seconds
from sonar_tracking.tma.batch.target_smoother import TargetSmootherConfiguration
from sonar_tracking.tma.targets.observation_log import ObservationLog, Observations
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.track_smoothing import SmoothedTracks, smooth_tracks
from tests.tma.offline_runs import offline_tma_run as run

pytestmark = pytest.mark.slow

TRACKER = TmaTrackerConfiguration()
SMOOTHER = TargetSmootherConfiguration(systematic_deviation_deg=0.1)


def observed(one: OfflineTmaRun) -> Observations:
    log = ObservationLog(TRACKER)
    log.add_all(passive_frame(frame) for frame in one.frames)
    assert not log.problems
    return log.observations


def smoothed(name: str, seed: int | None = None) -> SmoothedTracks:
    return _smoothed(name, seed)


@cache
def _smoothed(name: str, seed: int | None) -> SmoothedTracks:
    one = run(name, seed)
    return smooth_tracks(one.tracks, observed(one), TRACKER, SMOOTHER)


def truth(name: str, seed: int | None = None) -> list[PositionTracks]:
    return [truth_as_tracks(frame.truth_tracks) for frame in run(name, seed).frames]


def test_targets_are_known_from_the_beginning_with_an_honest_covariance() -> None:
    """The tracker knows them after a turn, or two; both sides of the array are rows until then."""
    far, median = [], []
    for seed in (None, 3):
        before = score_position_tracks(truth("tma", seed), run("tma", seed).tracks)
        after = score_position_tracks(truth("tma", seed), smoothed("tma", seed).pictures)
        assert before.identities.held_share < 0.6 and after.identities.held_share > 0.95
        assert after.rmse_m < before.rmse_m
        assert after.identities.false_tracks == 0
        assert 0.1 < after.nees_per_dimension < 1.6
        far.append((before.far_share, after.far_share))
        median.append((before.median_error_m, after.median_error_m))
    often, seldom = np.mean(far, axis=0)
    assert seldom < min(0.0316, 0.25 * often)
    large, small = np.mean(median, axis=0)
    assert small < 0.7 * large


def test_two_stations_that_were_joined_both_count_from_the_beginning() -> None:
    before = score_position_tracks(truth("cross_fix"), run("cross_fix").tracks)
    after = score_position_tracks(truth("cross_fix"), smoothed("cross_fix").pictures)
    assert after.rmse_m < 0.8 * before.rmse_m and after.identities.held_share > 0.95
    assert 0.1 < after.nees_per_dimension < 1.6
    # What the moored station had alone until then is no target of its own; the sides of the line
    # array are open until then.
    alone = [len(one) for one in run("cross_fix").tracks]
    together = [len(one) for one in smoothed("cross_fix").pictures]
    n_targets = len(truth("cross_fix")[0])
    assert np.max(alone) == 3 * n_targets and np.max(together) == 2 * n_targets


def test_rows_say_what_they_are_and_keep_the_rest() -> None:
    for old, new in zip(run("tma").tracks, smoothed("tma").pictures, strict=True):
        assert new.stamp == old.stamp and new.id.tolist() == old.id.tolist()
        assert np.all(new.source == TrackSource.SMOOTHED)
        assert new.bearing_track_id.tolist() == old.bearing_track_id.tolist()
        assert new.contributor_sensor == old.contributor_sensor
        # What was confirmed, coasted or ended stays so.
        kept = old.status != TrackStatus.TENTATIVE
        assert new.status[kept].tolist() == old.status[kept].tolist()


def test_a_side_that_was_never_confirmed_stays_tentative() -> None:
    confirmed = {
        number
        for picture in run("tma").tracks
        for number in picture.id[picture.established].tolist()
    }
    for picture in smoothed("tma").pictures:
        assert set(picture.id[picture.established].tolist()) <= confirmed


def test_without_its_bearings_a_track_is_smoothed_from_the_list_alone() -> None:
    pictures = run("cross_fix").tracks[:100]
    alone = smooth_tracks(pictures, {}, TRACKER, SMOOTHER)
    assert len(alone.without_measurements) == alone.n_tracks and not alone.failed
    assert all(np.isfinite(picture.state).all() for picture in alone.pictures)


def test_rows_of_others_and_rows_that_are_unknown_are_left_out() -> None:
    pictures = list(run("cross_fix").tracks[:40])
    n_rows = len(pictures[-1])
    source = pictures[-1].source.copy()
    source[0] = TrackSource.ACTIVE
    pictures[-1] = replace(pictures[-1], source=source)
    covariance = pictures[-2].covariance.copy()
    covariance[0] = np.nan
    pictures[-2] = replace(pictures[-2], covariance=covariance)
    seen: list[tuple[int, int]] = []
    out = smooth_tracks(
        pictures, observed(run("cross_fix")), TRACKER, SMOOTHER, lambda *one: seen.append(one)
    )
    assert [len(picture) for picture in out.pictures[-2:]] == [n_rows - 1, n_rows - 1]
    assert seen == [(number + 1, out.n_tracks) for number in range(out.n_tracks)]


def rows_of_the_first_confirmed(pictures: Sequence[PositionTracks]) -> dict[int, int]:
    """Return the rows of the target that is confirmed first, by stamp, from then on."""
    first = next(picture for picture in pictures if picture.established.any())
    identifier = first.id[picture_row(first)]
    return {
        picture.stamp: int(np.flatnonzero(picture.id == identifier)[0])
        for picture in pictures
        if picture.stamp >= first.stamp and identifier in picture.id
    }


def picture_row(picture: PositionTracks) -> int:
    return int(np.flatnonzero(picture.established)[0])


def with_status(picture: PositionTracks, row: int, status: TrackStatus) -> PositionTracks:
    codes = picture.status.copy()
    codes[row] = status
    return replace(picture, status=codes)


def test_what_was_measured_while_a_row_was_coasted_is_of_something_else() -> None:
    pictures, clean = run("tma").tracks, smoothed("tma").pictures
    rows = rows_of_the_first_confirmed(pictures)
    silence = set(list(rows)[60:120])
    told = [
        with_status(one, rows[one.stamp], TrackStatus.COASTED) if one.stamp in silence else one
        for one in pictures
    ]
    log = {key: dict(along) for key, along in observed(run("tma")).items()}
    for along in log.values():
        for stamp in silence & along.keys():
            turned = tuple(each + 0.3 for each in along[stamp].azimuths)
            along[stamp] = replace(along[stamp], azimuths=turned)
    out = smooth_tracks(told, log, TRACKER, SMOOTHER).pictures
    for one, other in zip(out, clean, strict=True):
        if one.stamp not in silence:
            continue
        row = rows[one.stamp]
        assert one.status[row] == TrackStatus.COASTED
        apart = one.state[row, :2] - other.state[row, :2]
        assert apart @ np.linalg.solve(one.covariance[row, :2, :2], apart) < 4.0
    # In the middle it may have stopped half of the silence ago.
    middle = next(one for one in out if one.stamp == sorted(silence)[30])
    claimed, state = (part[rows[middle.stamp]] for part in (middle.covariance, middle.state))
    waited = seconds(sorted(silence)[30] - sorted(silence)[0])
    assert np.trace(claimed[:2, :2]) > 0.8 * waited**2 * float(state[2:] @ state[2:])


def test_a_row_that_lost_its_confirmation_stays_without() -> None:
    pictures = run("tma").tracks
    rows = rows_of_the_first_confirmed(pictures)
    doubted = set(list(rows)[60:120])
    told = [
        with_status(one, rows[one.stamp], TrackStatus.TENTATIVE) if one.stamp in doubted else one
        for one in pictures
    ]
    for one in smooth_tracks(told, observed(run("tma")), TRACKER, SMOOTHER).pictures:
        if one.stamp in doubted:
            assert one.status[rows[one.stamp]] == TrackStatus.TENTATIVE


def test_a_row_that_ends_before_it_was_confirmed_was_never_confirmed() -> None:
    pictures = list(run("tma").tracks)
    rows = rows_of_the_first_confirmed(pictures)
    first = next(index for index, one in enumerate(pictures) if one.stamp in rows)
    identifier = pictures[first].id[rows[pictures[first].stamp]]
    told = pictures[: first + 1]
    told[-1] = with_status(told[-1], rows[told[-1].stamp], TrackStatus.TERMINATED)
    for one in smooth_tracks(told, observed(run("tma")), TRACKER, SMOOTHER).pictures[:-1]:
        assert np.all(one.status[one.id == identifier] == TrackStatus.TENTATIVE)


def test_tracks_that_were_coasted_all_the_time_are_smoothed_from_the_list_alone() -> None:
    coasted = [
        replace(one, status=np.full(len(one), TrackStatus.COASTED, np.uint8))
        for one in run("cross_fix").tracks[:60]
    ]
    out = smooth_tracks(coasted, observed(run("cross_fix")), TRACKER, SMOOTHER)
    assert len(out.without_measurements) == out.n_tracks > 0
    assert all(np.isfinite(picture.covariance).all() for picture in out.pictures)
