"""The recorded array with the default tracker that is given neither number nor bearings."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.room_array.rows import FROM_NOTHING
from sonar_tracking.evaluation.studies.room_array.study import RoomTask, track_recordings
from tests.recorded_data import recorded_data

MEASURED = "ula32_room_responses/rir_sources_1_2_3_4_5_8_9.npz"


@pytest.mark.data
def test_two_sources_and_no_more_are_found_at_nearly_every_sub_array() -> None:
    cases = ((4, 9), (8, 9))
    task = RoomTask(
        str(recorded_data(MEASURED)), 5000.0, np.random.SeedSequence(2), cases, (FROM_NOTHING,)
    )
    results = track_recordings(task)
    errors = np.concatenate([r.errors_deg[r.apart] for r in results])
    miscount = np.concatenate([r.miscount[r.apart] for r in results])
    assert np.isfinite(errors).all(axis=1).mean() >= 0.9
    assert np.nanmedian(np.abs(errors)) <= 2.0
    assert (miscount == 0).mean() >= 0.8


@pytest.mark.data
def test_reflections_of_a_single_source_are_no_sources() -> None:
    cases = ((4,), (8,))
    task = RoomTask(
        str(recorded_data(MEASURED)), 5000.0, np.random.SeedSequence(9), cases, (FROM_NOTHING,)
    )
    for result in track_recordings(task):
        assert np.isfinite(result.errors_deg).mean() >= 0.9, f"source {result.sources[0]} found"
        assert np.nanmedian(np.abs(result.errors_deg)) <= 2.0
        assert (result.miscount == 0).mean() >= 0.9
