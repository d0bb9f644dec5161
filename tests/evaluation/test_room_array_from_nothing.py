"""The recorded array with the default tracker that is given neither number nor bearings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.room_array.rows import FROM_NOTHING, RoomResult
from sonar_tracking.evaluation.studies.room_array.study import RoomTask, track_recordings
from tests.recorded_data import recorded_data

MEASURED = "ula32_room_responses/rir_sources_1_2_3_4_5_8_9.npz"


@pytest.fixture(scope="module")
def results() -> Sequence[RoomResult]:
    """Return what is found of two sources at once and of single ones, each sent once."""
    cases = ((4, 9), (8, 9), (4,), (8,))
    seed = np.random.SeedSequence(2)
    return track_recordings(
        RoomTask(str(recorded_data(MEASURED)), 5000.0, seed, cases, (FROM_NOTHING,))
    )


@pytest.mark.data
def test_two_sources_and_no_more_are_found_at_nearly_every_sub_array(
    results: Sequence[RoomResult],
) -> None:
    pairs = [result for result in results if len(result.sources) == 2]
    assert len(pairs) == 2
    errors = np.concatenate([r.errors_deg[r.apart] for r in pairs])
    miscount = np.concatenate([r.miscount[r.apart] for r in pairs])
    assert np.isfinite(errors).all(axis=1).mean() >= 0.9
    assert np.nanmedian(np.abs(errors)) <= 2.0
    assert (miscount == 0).mean() >= 0.8


@pytest.mark.data
def test_reflections_of_a_single_source_are_no_sources(results: Sequence[RoomResult]) -> None:
    single = [result for result in results if len(result.sources) == 1]
    assert len(single) == 2
    for result in single:
        assert np.isfinite(result.errors_deg).mean() >= 0.9, f"source {result.sources[0]} found"
        assert np.nanmedian(np.abs(result.errors_deg)) <= 2.0
        assert (result.miscount == 0).mean() >= 0.9
