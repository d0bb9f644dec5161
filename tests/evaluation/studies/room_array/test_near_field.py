"""Near sources of a recorded array: spherical waves locate them, plane waves do not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.room_array.figures import draw_room_array
from sonar_tracking.evaluation.studies.room_array.near_field import (
    NearFieldTask,
    locate_near_sources,
)
from sonar_tracking.evaluation.studies.room_array.near_field_rows import (
    PLANE,
    SPHERICAL,
    SPHERICAL_MUSIC,
    NearFieldResult,
    near_field_rows,
)
from tests.evaluation.free_field import write_free_field
from tests.recorded_data import recorded_data

MEASURED = "ula32_room_responses/rir_sources_1_2_3_4_5_8_9.npz"


def located(file: Path, cases: tuple[tuple[int, ...], ...]) -> tuple[NearFieldResult, ...]:
    """Return what the methods find at 5 kHz."""
    seed = np.random.SeedSequence(1)
    return locate_near_sources(NearFieldTask(str(file), 5000.0, 80.0, seed, 0, cases))


def of(results: tuple[NearFieldResult, ...], method: str, n_elements: int) -> NearFieldResult:
    (chosen,) = [r for r in results if (r.method, r.n_elements) == (method, n_elements)]
    return chosen


def test_without_reflections_the_survey_is_found(tmp_path: Path) -> None:
    file = write_free_field(tmp_path / "room.npz", 14, ((0.3, 0.05), (0.4, 0.35)))
    results = located(file, ((1, 2),))
    for method in (SPHERICAL, SPHERICAL_MUSIC):
        whole, parts = of(results, method, 14), of(results, method, 8)
        assert whole.found.shape == (1, 2, 2) and parts.found.shape == (7, 2, 2)
        error = np.abs(whole.found - whole.surveyed)
        assert np.degrees(error[..., 0].max()) < 0.3
        assert (error[..., 1] / whole.surveyed[..., 1]).max() < 0.03
        assert np.degrees(np.abs(parts.found - parts.surveyed)[..., 0].max()) < 1.5
    plane = of(results, PLANE, 14)
    assert np.isinf(plane.found[..., 1]).all()
    assert np.degrees(np.abs(plane.found - plane.surveyed)[..., 0].max()) > 2.0
    assert plane.rayleigh == pytest.approx(2.0 * 0.39**2 / (343.0 / 5000.0))


def test_rows_and_picture(tmp_path: Path) -> None:
    file = write_free_field(tmp_path / "room.npz", 14, ((0.3, 0.05), (0.4, 0.35)))
    results = located(file, ((1,), (1, 2)))
    rows = {(row.system, row.condition): row.metrics for row in near_field_rows(results)}
    assert len(rows) == 2 * 2 * 3
    spherical = rows["1 and 2, spherical", "near field, 14 elements"]
    assert spherical["near_found_percent"] == 100.0
    assert spherical["near_median_surveyed_range_error_percent"] < 3.0
    assert "near_median_range_error_percent" not in rows["1, plane", "near field, 8 elements"]
    (image,) = draw_room_array([results], (), tmp_path)
    assert image.name == "room_near_field.png"
    assert image.read_bytes().startswith(b"\x89PNG")


@pytest.mark.data
def test_measured_near_sources_are_where_the_onsets_locate_them() -> None:
    results = located(recorded_data(MEASURED), ((2,), (9,)))
    for result in (r for r in results if r.n_elements == 32):
        error = np.abs(result.found - result.located)[0, 0]
        if result.method == PLANE:
            assert np.degrees(error[0]) > 2.0
        else:
            assert np.degrees(error[0]) < 1.0
            assert error[1] / result.located[0, 0, 1] < 0.1
