"""Figures, rows and tables of the near sources: plane against spherical waves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout
from sonar_tracking.evaluation.studies.room_array.rows import APART_DEG, FOUND_DEG
from sonar_tracking.records.arrays import BoolArray, FloatArray

PLANE, SPHERICAL, SPHERICAL_MUSIC = "plane", "spherical", "spherical MUSIC"
"""Waves that are steered with, by maximum likelihood if not by MUSIC."""


@dataclass(frozen=True)
class NearFieldResult:
    """Bearings and ranges by one method with sub-arrays of one size.

    Attributes
    ----------
    method : str
        PLANE, SPHERICAL or SPHERICAL_MUSIC.
    run : int
        Number of the run.
    sources : tuple of int
        Sources that were heard.
    frequency : float
        Hz.
    n_elements : int
        Of each sub-array.
    rayleigh : float
        Range beyond which plane waves hold for it, m.
    surveyed, located, found : ndarray, shape (n_positions, n_sources, 2)
        Angle (rad) and range (m) at the centre of each sub-array: of the surveyed positions, of
        those by the onsets of the responses, and as found; NaN = fewer than given.
    """

    method: str
    run: int
    sources: tuple[int, ...]
    frequency: float
    n_elements: int
    rayleigh: float
    surveyed: FloatArray
    located: FloatArray
    found: FloatArray

    @property
    def apart(self) -> BoolArray:
        """Positions that hear the sources at least APART_DEG apart, shape (n_positions,)."""
        angles = self.surveyed[..., 0]
        spread = angles.max(axis=1) - angles.min(axis=1)
        return np.asarray((spread >= np.radians(APART_DEG)) | (len(self.sources) == 1))


def near_field_rows(results: Sequence[NearFieldResult]) -> tuple[StudyRow, ...]:
    """Return one row a size of the array, case and method, over frequencies and runs."""
    rows = []
    for n_elements in sorted({r.n_elements for r in results}):
        of_size = [r for r in results if r.n_elements == n_elements]
        for sources, method in dict.fromkeys((r.sources, r.method) for r in of_size):
            chosen = [r for r in of_size if (r.sources, r.method) == (sources, method)]
            numbers = " and ".join(str(source) for source in sources)
            rows.append(
                StudyRow(
                    system=f"{numbers}, {method}",
                    condition=f"near field, {n_elements} elements",
                    metrics={f"near_{k}": v for k, v in _figures(chosen).items()},
                )
            )
    return tuple(rows)


def _figures(results: Sequence[NearFieldResult]) -> dict[str, float]:
    """Return the figures of one case and method where the sources are apart."""
    surveyed, located, found = (
        np.concatenate([values[r.apart] for r in results for values in [getattr(r, name)]])
        for name in ("surveyed", "located", "found")
    )
    error = np.degrees(np.abs(found[..., 0] - located[..., 0]))
    hit = error < FOUND_DEG
    metrics = {
        "positions": float(len(found)),
        "rayleigh_m": float(np.mean([r.rayleigh for r in results])),
        "range_m": float(np.median(located[..., 1])),
        "found_percent": 100.0 * float(hit.all(axis=1).mean()),
        "median_error_deg": _median(error),
        "median_surveyed_error_deg": _median(np.degrees(np.abs((found - surveyed)[..., 0]))),
    }
    if results[0].method != PLANE:
        metrics["median_range_error_percent"] = _range_error(found[..., 1], located[..., 1])
        metrics["median_surveyed_range_error_percent"] = _range_error(
            found[..., 1], surveyed[..., 1]
        )
    return metrics


def _range_error(found: FloatArray, true: FloatArray) -> float:
    return _median(100.0 * np.abs(found / true - 1.0))


def _median(values: FloatArray) -> float:
    """Return the median of the values that are numbers; infinite ones count."""
    known = values[~np.isnan(values)]
    return float(np.median(known)) if known.size else np.nan


NEAR_FIELD_LAYOUTS = (
    TableLayout(
        "Near sources, given how many: plane against spherical waves",
        (
            Column("near_range_m", "range m", ".2f"),
            Column("near_found_percent", "found %", ".0f"),
            Column("near_median_error_deg", "error deg", ".2f"),
            Column("near_median_range_error_percent", "range %", ".0f"),
            Column("near_median_surveyed_error_deg", "survey deg", ".2f"),
            Column("near_median_surveyed_range_error_percent", "survey %", ".0f"),
        ),
        f"Sources at least {APART_DEG:g} deg apart, three frequencies. Range to and errors from "
        "the positions by the onsets of the responses, then errors from the survey, which is up "
        f"to 0.1 m off. Found: within {FOUND_DEG:g} deg. Plane waves hold beyond 1.3 m for eight "
        "elements and 25 m for 32.",
    ),
)
