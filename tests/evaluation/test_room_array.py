"""Recorded arrays: the sign of the survey, and the whole way from WAV to tracks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.room_array import (
    RoomResult,
    RoomTask,
    room_array,
    room_rows,
    track_recordings,
)
from sonar_tracking.evaluation.room_array_figures import draw_room_array
from sonar_tracking.evaluation.room_responses import read_room_responses

MEASURED = Path("../shared/data/ula32_room_responses/rir_sources_1_2_3_4_5_8_9.npz")
RATE = 48_000
SPEED = 343.0


def write_free_field(path: Path) -> Path:
    """Write responses without reflections: two distant sources, twelve elements."""
    places = 0.03 * np.arange(12)
    positions = np.array([[30.0, 20.0], [30.0, -4.0]])
    time = np.arange(512)
    responses = np.empty((2, 12, 512))
    for source, (distance, place) in enumerate(positions):
        delays = np.hypot(distance, place - places) / SPEED * RATE
        responses[source] = np.sinc(time - (delays - delays.mean() + 256.0)[:, None])
    np.savez(
        path,
        rir=np.round(responses * 30_000).astype(np.int16),
        rir_scale=1 / 30_000,
        fs_hz=RATE,
        source_id=np.array([1, 2]),
        source_xz_m=positions,
        mic_xz_m=np.stack([np.zeros(12), places], axis=-1),
    )
    return path


def test_a_source_ahead_of_the_centre_has_a_positive_angle(tmp_path: Path) -> None:
    room = read_room_responses(write_free_field(tmp_path / "room.npz"))
    assert room.n_sub_arrays == 5
    angles = np.degrees([room.arrival_angle(1, k) for k in range(5)])
    assert abs(angles[0] - np.degrees(np.arctan2(20.0 - 0.105, 30.0))) < 1e-9
    assert (np.diff(angles) < 0).all()
    assert room.arrival_angle(2, 0) < 0
    assert [room.sub_array_at(t) for t in (0.0, 3.9, 4.1, 11.9, 99.0)] == [0, 0, 1, 4, 4]


def test_without_reflections_the_tracks_are_where_the_survey_says(tmp_path: Path) -> None:
    file = write_free_field(tmp_path / "room.npz")
    task = RoomTask(str(file), 5000.0, np.random.SeedSequence(1), ((1, 2),))
    (result,) = track_recordings(task)
    assert result.errors_deg.shape == (5, 2)
    assert np.abs(result.errors_deg).max() < 0.5
    assert result.apart.all()


def test_the_measured_array_finds_two_sources(tmp_path: Path) -> None:
    if not MEASURED.is_file():
        pytest.skip(f"{MEASURED} is not there")
    task = RoomTask(str(MEASURED), 5000.0, np.random.SeedSequence(1), ((4, 9),))
    (result,) = track_recordings(task)
    assert result.apart.all()
    assert np.isfinite(result.errors_deg).all(), "both sources found at every sub-array"
    assert np.median(np.abs(result.errors_deg)) < 2.0


def test_rows_count_what_was_found_and_only_pairs_apart(tmp_path: Path) -> None:
    truth = np.radians([[0.0, 30.0], [0.0, 10.0]])
    tracked = np.radians([[1.0, 33.0], [np.nan, 12.0]])
    single = RoomResult((4,), 4500.0, truth[:, :1], np.radians([[0.5], [-0.5]]))
    rows = room_rows([[RoomResult((5, 9), 5000.0, truth, tracked), single]])
    pair, alone, together = (row.metrics for row in rows)
    assert (pair["sub_arrays"], pair["found_percent"]) == (2, 50.0)
    assert pair["median_error_deg"] == pytest.approx(2.0)
    assert pair["worst_error_deg"] == pytest.approx(3.0)
    assert pair["apart_sub_arrays"] == 1 and pair["apart_found_percent"] == 100.0
    assert pair["sub_array_0_source_9_error_deg"] == pytest.approx(3.0)
    assert alone["median_error_deg"] == pytest.approx(0.5) and "apart_sub_arrays" not in alone
    assert together["pairs_sub_arrays"] == 1
    results = [[single]]
    (image,) = draw_room_array(results, rows, tmp_path)
    assert image.read_bytes().startswith(b"\x89PNG")


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "other.npz", samples=np.zeros(3))
    with pytest.raises(ConfigurationError, match="holds no rir"):
        room_array(tmp_path / "other.npz")
    with pytest.raises(ConfigurationError, match="cannot be read"):
        room_array(tmp_path / "absent.npz")
