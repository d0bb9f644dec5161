"""The record all trackers of positions share: filled where nothing is known, else checked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.records.positions import PositionTracks, no_position_tracks


def three_tracks() -> PositionTracks:
    return PositionTracks(
        stamp=5,
        id=np.array([10, 11, 12], np.uint64),
        status=np.ones(3, np.uint8),
        source=np.ones(3, np.uint8),
        state=np.arange(12.0).reshape(3, 4),
        line_track=np.array([0, 2, 2], np.uint32),
        line_id=np.array([7, 8, 9], np.uint64),
        contributor_track=np.array([1, 2], np.uint32),
        contributor_id=np.array([3, 4], np.uint64),
        contributor_sensor=("bow", "tail"),
    )


def test_columns_left_out_are_unknown() -> None:
    tracks = three_tracks()
    assert tracks.covariance.shape == (3, 4, 4) and np.isnan(tracks.covariance).all()
    assert tracks.line_frequency.shape == (3,) and np.isnan(tracks.line_frequency).all()
    assert list(tracks.contributor_source) == [0, 0]
    assert len(no_position_tracks(3)) == 0


def test_confirmed_and_coasted_tracks_are_established() -> None:
    tracks = replace(three_tracks(), status=np.array([0, 1, 2], np.uint8))
    assert tracks.established.tolist() == [False, True, True]
    assert not replace(tracks, status=np.full(3, 3, np.uint8)).established.any()


def test_chosen_rows_keep_their_lines_and_contributors() -> None:
    chosen = three_tracks().selected(np.array([False, False, True]))
    assert list(chosen.id) == [12]
    assert (list(chosen.line_track), list(chosen.line_id)) == ([0, 0], [8, 9])
    assert (list(chosen.contributor_track), chosen.contributor_sensor) == ([0], ("tail",))
    assert len(three_tracks().selected(np.zeros(3, bool))) == 0


def test_a_state_of_another_shape_is_named() -> None:
    with pytest.raises(InputError, match=r"PositionTracks\.state has shape \(1, 2\)"):
        PositionTracks(
            stamp=1,
            id=np.array([1], np.uint64),
            status=np.ones(1, np.uint8),
            source=np.ones(1, np.uint8),
            state=np.zeros((1, 2)),
        )
