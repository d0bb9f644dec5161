"""Figures, rows and tables of the room-array study: what was tracked at every sub-array."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray

TOLD, FROM_NOTHING = "given their number", "from nothing"
"""What the chain knows beforehand."""

FOUND_DEG = 10.0
"""A source is found where a confirmed track is nearer than this to its surveyed bearing."""
APART_DEG = 20.0
"""Pairs at least so far apart are what the array must resolve."""


@dataclass(frozen=True)
class RoomResult:
    """Bearings of one recording, one row a sub-array, one column a source.

    Attributes
    ----------
    system : str
        TOLD or FROM_NOTHING.
    run : int
        Number of the run: its signals and noise.
    sources : tuple of int
        Sources that were heard.
    frequency : float
        Hz.
    truth, located : ndarray, shape (n_sub_arrays, n_sources)
        Arrival angles of the surveyed positions, and of those by the onsets of the responses, rad.
    tracked : ndarray, shape (n_sub_arrays, n_sources)
        Confirmed tracks that belong to the sources, rad; NaN = not found.
    extra : ndarray, shape (n_sub_arrays, n_extra)
        Confirmed tracks that belong to none, rad; NaN = fewer.
    """

    system: str
    run: int
    sources: tuple[int, ...]
    frequency: float
    truth: FloatArray
    located: FloatArray
    tracked: FloatArray
    extra: FloatArray

    @property
    def errors_deg(self) -> FloatArray:
        """Tracked minus surveyed, deg, shape (n_sub_arrays, n_sources)."""
        return np.degrees(self.tracked - self.truth)

    @property
    def apart(self) -> BoolArray:
        """Sub-arrays that see the sources at least APART_DEG apart, shape (n_sub_arrays,)."""
        spread = self.truth.max(axis=1) - self.truth.min(axis=1)
        return np.asarray(spread >= np.radians(APART_DEG))

    @property
    def n_extra(self) -> IntArray:
        """Confirmed tracks that belong to no source, shape (n_sub_arrays,)."""
        return np.isfinite(self.extra).sum(axis=1)

    @property
    def miscount(self) -> IntArray:
        """Number of confirmed tracks minus that of sources, shape (n_sub_arrays,)."""
        found = np.isfinite(self.tracked).sum(axis=1)
        return np.asarray(found + self.n_extra - len(self.sources))


def recording_rows(recordings: Sequence[RoomResult]) -> tuple[StudyRow, ...]:
    """Return one row a system, case and frequency, those of all pairs and of all single sources."""
    rows: list[StudyRow] = []
    for system in dict.fromkeys(r.system for r in recordings):
        of_system = [r for r in recordings if r.system == system]
        groups = dict.fromkeys((r.frequency, r.sources) for r in of_system)
        rows.extend(
            _case_row([r for r in of_system if (r.frequency, r.sources) == group])
            for group in groups
        )
        rows.extend(_together(system, [r for r in of_system if len(r.sources) == 2]))
        rows.extend(_alone(system, [r for r in of_system if len(r.sources) == 1]))
    return tuple(rows)


def _case_row(recordings: list[RoomResult]) -> StudyRow:
    """Return the row of one case at one frequency, over all runs."""
    first = recordings[0]
    metrics = _figures([(r, np.ones(len(r.truth), dtype=bool)) for r in recordings])
    if len(first.sources) > 1 and any(r.apart.any() for r in recordings):
        apart = _figures([(r, r.apart) for r in recordings])
        metrics |= {f"apart_{name}": value for name, value in apart.items()}
    errors = np.stack([r.errors_deg for r in recordings])
    known = np.isfinite(errors)
    mean = np.where(known, errors, 0.0).sum(axis=0) / np.where(known.any(axis=0), known.sum(0), 1)
    mean[~known.any(axis=0)] = np.nan
    for sub_array, row in enumerate(mean):
        for source, error in zip(first.sources, row, strict=True):
            metrics[f"sub_array_{sub_array}_source_{source}_error_deg"] = float(error)
    numbers = " and ".join(str(source) for source in first.sources)
    return StudyRow(
        system=f"source{'s' if len(first.sources) > 1 else ''} {numbers}",
        condition=f"{first.system}, {first.frequency:g} Hz",
        metrics=metrics,
    )


def _together(system: str, pairs: list[RoomResult]) -> list[StudyRow]:
    """Return the rows of all pairs: each run, all runs, and the pairs that are too close."""
    if not any(r.apart.any() for r in pairs):
        return []
    condition = f"{system}, pairs {APART_DEG:g} deg apart or more"
    runs = tuple(dict.fromkeys(r.run for r in pairs))
    rows = []
    if len(runs) > 1:
        for run in runs:
            of_run = [r for r in pairs if r.run == run]
            rows.append(StudyRow(f"run {run + 1}", condition, _pair_figures(of_run)))
    rows.append(StudyRow("all pairs", condition, _pair_figures(pairs)))
    near = [(r, ~r.apart) for r in pairs]
    if any(chosen.any() for _, chosen in near):
        metrics = {f"together_{name}": value for name, value in _figures(near).items()}
        rows.append(StudyRow("all pairs", f"{system}, pairs closer than that", metrics))
    return rows


def _alone(system: str, recordings: list[RoomResult]) -> list[StudyRow]:
    """Return the row of all recordings of one source."""
    if not recordings:
        return []
    figures = _figures([(r, np.ones(len(r.truth), dtype=bool)) for r in recordings])
    metrics = {f"together_{name}": value for name, value in figures.items()}
    return [StudyRow("all single sources", f"{system}, one source", metrics)]


def _pair_figures(pairs: list[RoomResult]) -> dict[str, float]:
    """Return the figures of all pairs that are apart, and those of the worst pair of each kind."""
    metrics = {f"together_{k}": v for k, v in _figures([(r, r.apart) for r in pairs]).items()}
    each = []
    for sources in dict.fromkeys(r.sources for r in pairs):
        chosen = [(r, r.apart) for r in pairs if r.sources == sources and r.apart.any()]
        if chosen:
            each.append(_figures(chosen))
    worst = {
        "found_percent": min(figures["found_percent"] for figures in each),
        "median_error_deg": max(figures["median_error_deg"] for figures in each),
        "count_right_percent": min(figures["count_right_percent"] for figures in each),
    }
    return metrics | {f"together_worst_pair_{name}": value for name, value in worst.items()}


def _figures(chosen: Sequence[tuple[RoomResult, BoolArray]]) -> dict[str, float]:
    """Return the figures of some sub-arrays of some recordings of equally many sources."""
    errors = np.concatenate([r.errors_deg[mask] for r, mask in chosen])
    onset = np.concatenate([np.degrees(r.tracked - r.located)[mask] for r, mask in chosen])
    miscount = np.concatenate([r.miscount[mask] for r, mask in chosen])
    extra = np.concatenate([r.n_extra[mask] for r, mask in chosen])
    found = np.isfinite(errors)
    size, nothing = np.abs(errors[found]), not found.any()
    return {
        "sub_arrays": float(len(errors)),
        "found_percent": 100.0 * float(found.all(axis=1).mean()),
        "median_error_deg": np.nan if nothing else float(np.median(size)),
        "median_onset_error_deg": np.nan if nothing else float(np.median(np.abs(onset[found]))),
        "worst_error_deg": np.nan if nothing else float(size.max()),
        "count_right_percent": 100.0 * float((miscount == 0).mean()),
        "count_high_percent": 100.0 * float((miscount > 0).mean()),
        "count_low_percent": 100.0 * float((miscount < 0).mean()),
        "extra_tracks": float(extra.mean()),
    }


def _columns(prefix: str) -> tuple[Column, ...]:
    return (
        Column(f"{prefix}sub_arrays", "n", ".0f"),
        Column(f"{prefix}found_percent", "found %", ".1f"),
        Column(f"{prefix}median_error_deg", "error deg", ".2f"),
        Column(f"{prefix}median_onset_error_deg", "onset deg", ".2f"),
        Column(f"{prefix}worst_error_deg", "worst deg", ".1f"),
        Column(f"{prefix}count_right_percent", "count %", ".1f"),
        Column(f"{prefix}extra_tracks", "extra", ".2f"),
    )


_TOGETHER = (
    Column("together_sub_arrays", "n", ".0f"),
    Column("together_found_percent", "found %", ".1f"),
    Column("together_median_error_deg", "error deg", ".2f"),
    Column("together_count_right_percent", "count %", ".1f"),
    Column("together_extra_tracks", "extra", ".2f"),
    Column("together_worst_pair_found_percent", "least found %", ".1f"),
    Column("together_worst_pair_median_error_deg", "largest deg", ".2f"),
    Column("together_worst_pair_count_right_percent", "least count %", ".1f"),
)


def _tables(system: str) -> tuple[TableLayout, ...]:
    return (
        TableLayout(
            f"Bearings at every position of the sub-array, {system}",
            _columns(""),
            "Sub-arrays (n) at the end of their dwells; sources all found by a confirmed track "
            f"within {FOUND_DEG:g} deg; median error to the survey, to positions by the onsets of "
            "the responses; confirmed tracks as many as sources; tracks of no source.",
            system,
        ),
        TableLayout(
            f"Only where the pair is {APART_DEG:g} deg apart or more, {system}",
            _columns("apart_"),
            "",
            system,
        ),
        TableLayout(
            f"Together, {system}",
            _TOGETHER,
            "As above; last: least found, largest median error and least count right of any pair.",
            system,
        ),
    )


RECORDING_LAYOUTS = (*_tables(TOLD), *_tables(FROM_NOTHING))
