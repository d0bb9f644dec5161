"""Protects what leaves the trackers of contacts: units, sources, and that nothing is swapped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.active.contacts.gate_threshold_registry import AS_DETECTED
from sonar_tracking.active.tracks.contact_track_list import (
    ContactTrackRows,
    shown_tracks,
    thresholds_without_gates,
)
from sonar_tracking.records.positions import TrackSource
from tests.active.detection.test_clutter_monitor import MODEL

SECOND = 1_000_000_000


def test_rows_become_the_picture_at_the_ping() -> None:
    rows = ContactTrackRows(
        id=np.array([7, 9]),
        status=np.array([1, 2]),
        existence=np.array([0.5, 0.75]),
        state=np.arange(8.0).reshape(2, 4),
        covariance=np.arange(32.0).reshape(2, 4, 4),
        initiated=np.array([3 * SECOND, 4 * SECOND]),
        updated=np.array([5 * SECOND + SECOND // 2, 6 * SECOND]),
    )
    tracks = shown_tracks(rows, 11, 12)
    assert (tracks.stamp, tracks.next_stamp) == (11, 12)
    assert (tracks.id.tolist(), tracks.status.tolist()) == ([7, 9], [1, 2])
    assert tracks.source.tolist() == [TrackSource.ACTIVE] * 2
    assert tracks.existence_probability.tolist() == [0.5, 0.75]
    assert (tracks.initiated.tolist(), tracks.updated.tolist()) == ([3.0, 4.0], [5.5, 6.0])
    assert tracks.hypothesis_probability.tolist() == [1.0, 1.0]
    np.testing.assert_array_equal(tracks.state, rows.state)
    np.testing.assert_array_equal(tracks.covariance, rows.covariance)


def test_a_ping_without_gates_tells_the_thresholds_of_the_search() -> None:
    model = replace(MODEL, threshold=2.5, false_alarm_probability=0.1)
    told = thresholds_without_gates(11, 12, model)
    assert (told.stamp, told.next_stamp, told.method) == (11, 12, AS_DETECTED)
    assert (told.search_threshold, told.search_false_alarm_probability) == (2.5, 0.1)
    of_gates = [told.track_id, told.false_alarm_probability, told.threshold]
    of_gates += [told.resolution_cells, told.gate_volume, told.signal_to_noise_ratio_linear]
    assert [one.shape for one in of_gates] == [(0,)] * 6
    assert (told.predicted_position.shape, told.gate_covariance.shape) == ((0, 2), (0, 2, 2))
    unknown = thresholds_without_gates(11)
    assert np.isnan(unknown.search_threshold)
    assert np.isnan(unknown.search_false_alarm_probability)
