"""Recorded arrays: the sign of the survey, and the whole way from WAV to tracks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.studies.room_array.figures import draw_room_array
from sonar_tracking.evaluation.studies.room_array.positions import onset_positions
from sonar_tracking.evaluation.studies.room_array.responses import read_room_responses
from sonar_tracking.evaluation.studies.room_array.rows import FROM_NOTHING, TOLD, RoomResult
from sonar_tracking.evaluation.studies.room_array.study import (
    RoomTask,
    room_array,
    room_rows,
    room_tasks,
    track_recordings,
)
from tests.evaluation.free_field import write_free_field
from tests.recorded_data import recorded_data

MEASURED = "ula32_room_responses/rir_sources_1_2_3_4_5_8_9.npz"
DISTANT = ((30.0, 20.0), (30.0, -4.0))


def result_of(
    sources: tuple[int, ...], truth: object, tracked: object, extra: object, run: int = 0
) -> RoomResult:
    """Return a result of angles in deg."""
    angles = [np.radians(np.asarray(values, dtype=float)) for values in (truth, tracked, extra)]
    located = angles[0] + np.radians(1.0)
    return RoomResult(FROM_NOTHING, run, sources, 5000.0, angles[0], located, angles[1], angles[2])


def test_a_source_ahead_of_the_centre_has_a_positive_angle(tmp_path: Path) -> None:
    room = read_room_responses(write_free_field(tmp_path / "room.npz", 12, DISTANT))
    assert room.n_sub_arrays == 5
    angles = np.degrees([room.arrival_angle(1, k) for k in range(5)])
    assert abs(angles[0] - np.degrees(np.arctan2(20.0 - 0.105, 30.0))) < 1e-9
    assert (np.diff(angles) < 0).all()
    assert room.arrival_angle(2, 0) < 0
    assert [room.sub_array_at(t) for t in (0.0, 3.9, 4.1, 11.9, 99.0)] == [0, 0, 1, 4, 4]


def test_without_reflections_the_tracks_are_where_the_survey_says(tmp_path: Path) -> None:
    file = write_free_field(tmp_path / "room.npz", 12, DISTANT)
    task = RoomTask(str(file), 5000.0, np.random.SeedSequence(1), ((1, 2),))
    told, nothing = track_recordings(task)
    assert (told.system, nothing.system) == (TOLD, FROM_NOTHING)
    for result in (told, nothing):
        assert result.errors_deg.shape == (5, 2)
        assert np.abs(result.errors_deg).max() < 0.5
        assert result.apart.all()
        assert (result.miscount == 0).all()


@pytest.mark.data
def test_the_measured_array_finds_two_sources() -> None:
    task = RoomTask(
        str(recorded_data(MEASURED)), 5000.0, np.random.SeedSequence(1), ((4, 9),), (TOLD,)
    )
    (result,) = track_recordings(task)
    assert result.apart.all()
    assert np.isfinite(result.errors_deg).all(), "both sources found at every sub-array"
    assert np.median(np.abs(result.errors_deg)) < 2.0


def test_onsets_tell_where_the_sound_begins(tmp_path: Path) -> None:
    places = ((0.5, 0.1), (0.8, 0.25))
    room = read_room_responses(write_free_field(tmp_path / "room.npz", 12, places))
    located = onset_positions(room)
    assert np.abs(located - places).max() < 0.02
    first = onset_positions(room, room.source_ids[:1])
    np.testing.assert_array_equal(first, [located[0], room.source_positions[1]])
    assert not np.array_equal(located[1], room.source_positions[1])


def test_rows_count_what_was_found_and_only_pairs_apart(tmp_path: Path) -> None:
    truth = [[0.0, 30.0], [0.0, 10.0]]
    result = result_of((5, 9), truth, [[1.0, 33.0], [np.nan, 12.0]], [[np.nan], [-60.0]])
    single = result_of((4,), [[0.0], [0.0]], [[0.5], [-0.5]], [[70.0], [np.nan]])
    rows = room_rows([[result, single]])
    pair, alone, together, near, singles = (row.metrics for row in rows)
    assert (pair["sub_arrays"], pair["found_percent"]) == (2, 50.0)
    assert pair["median_error_deg"] == pytest.approx(2.0)
    assert pair["median_onset_error_deg"] == pytest.approx(1.0)
    assert pair["worst_error_deg"] == pytest.approx(3.0)
    assert pair["apart_sub_arrays"] == 1 and pair["apart_found_percent"] == 100.0
    assert pair["sub_array_0_source_9_error_deg"] == pytest.approx(3.0)
    assert np.isnan(pair["sub_array_1_source_5_error_deg"])
    # One of two missing and one extra track: the count is right by number, the extra one told.
    assert pair["count_right_percent"] == 100.0 and pair["extra_tracks"] == 0.5
    assert alone["count_right_percent"] == 50.0 and alone["count_high_percent"] == 50.0
    assert alone["median_error_deg"] == pytest.approx(0.5) and "apart_sub_arrays" not in alone
    assert together["together_sub_arrays"] == near["together_sub_arrays"] == 1
    assert singles["together_sub_arrays"] == 2 and singles["together_count_right_percent"] == 50.0
    assert together["together_worst_pair_found_percent"] == 100.0
    (image,) = draw_room_array([[result, single]], rows, tmp_path)
    assert image.read_bytes().startswith(b"\x89PNG")


def test_runs_are_told_each_and_together() -> None:
    truth = [[0.0, 30.0]]
    runs = [
        result_of((5, 9), truth, [[1.0, 33.0]], [[]], run=0),
        result_of((5, 9), truth, [[np.nan, 31.0]], [[]], run=1),
    ]
    rows = {(row.system, row.condition): row.metrics for row in room_rows([[r] for r in runs])}
    condition = f"{FROM_NOTHING}, pairs 20 deg apart or more"
    assert rows["run 1", condition]["together_found_percent"] == 100.0
    assert rows["run 2", condition]["together_count_low_percent"] == 100.0
    assert rows["all pairs", condition]["together_found_percent"] == 50.0
    case = rows["sources 5 and 9", f"{FROM_NOTHING}, 5000 Hz"]
    assert case["sub_array_0_source_9_error_deg"] == pytest.approx(2.0), "mean over the runs"


def test_signals_depend_on_the_seed_alone_not_on_the_cases_beside() -> None:
    tasks = room_tasks("responses.npz", 2, 1)
    recordings = [task.argument for task in tasks if isinstance(task.argument, RoomTask)]
    assert {task.run for task in recordings} == {0, 1}
    cases = [case for task in recordings for case in task.cases]
    assert len(cases) == 2 * 3 * 10 and len(set(cases)) == 10
    by_seed = {(task.seed.spawn_key, task.frequency) for task in recordings}
    assert len(by_seed) == 2 * 3


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "other.npz", samples=np.zeros(3))
    with pytest.raises(ConfigurationError, match="holds no rir"):
        room_array(tmp_path / "other.npz")
    with pytest.raises(ConfigurationError, match="cannot be read"):
        room_array(tmp_path / "absent.npz")
