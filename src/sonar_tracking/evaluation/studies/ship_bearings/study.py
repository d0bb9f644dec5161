"""Study ship-bearings: a real ship located from the bearings of bottom-mounted arrays.

A research vessel circled two small arrays of four hydrophones on the sea floor, whose raw bearings
came once a second, outliers and quiet stretches included. Its GPS is the truth, and nothing else:
no parameter of a filter or smoother comes from it. The ship is located from the azimuths of both
arrays (cross-fix), from azimuth and elevation of one array at known depth, and from all together.
It is located by the node with its defaults, too, and with hindsight. All figures are computed from
the data; their authors print none to compare with. With two arrays a second, simulated ship is
added, and bearings of either array have to be given to the ship they are of.

References
----------
Snyder, Wiggins, Baumann-Pickering, Hildebrand, "Where's Whaledo: a software toolkit for array
localization of animal vocalizations", PLOS Computational Biology, 2024.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.evaluation.metrics.cutoff import FAR_LIMIT_M
from sonar_tracking.evaluation.monte_carlo.batch_runner import Task
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.studies.ship_bearings.data import read_bearings
from sonar_tracking.evaluation.studies.ship_bearings.figures import draw_tracks
from sonar_tracking.evaluation.studies.ship_bearings.node_tracks import node_tracks
from sonar_tracking.evaluation.studies.ship_bearings.pairing import (
    MADE_UP,
    REAL,
    PairingResult,
    pair_bearings,
)
from sonar_tracking.evaluation.studies.ship_bearings.tracks import ShipTrack, locate_ship
from sonar_tracking.records.arrays import FloatArray

SHIP_BEARINGS = "ship-bearings"

MEDIAN_OF_NEES = float(np.log(2.0))
"""Median of a consistent NEES per dimension of a position; outliers would own the mean."""

SETTLING = 60
"""First measurements, which are not scored."""

UNLABELLED = "whose bearing it is"

ELLIPSE = 5.991464547107979
"""Square of the half axes of the ellipse that holds 95 % of a plane normal distribution."""

LAYOUTS = (
    TableLayout(
        "A ship located from the sea floor",
        (
            Column("median_m", "median m", ".1f"),
            Column("rmse_m", "RMSE m", ".1f"),
            Column("percentile_90_m", "90 % m", ".1f"),
            Column("beyond_200_percent", f"> {FAR_LIMIT_M:.0f} m %", ".1f"),
            Column("median_nees", "NEES", ".2f"),
            Column("in_ellipse_percent", "in 95 % ellipse", ".1f"),
            Column("confirmed_percent", "confirmed %", ".1f"),
            Column("coasted_percent", "coasted %", ".1f"),
            Column("coasted_in_ellipse_percent", "of them in ellipse", ".1f"),
            Column("antenna_m", "antenna m", ".1f"),
            Column("seconds", "seconds", ".0f"),
        ),
        "Horizontal distance from the ship's GPS at the instant of emission; raw bearings, "
        "outliers and silence left in unless said. NEES: median over that of a consistent "
        "estimator. in 95 % ellipse: share of positions whose ellipse holds the GPS. confirmed: "
        "confirmed rows of the node over frames; all before counts these alone. coasted: rows "
        "of the node that say that the ship is not heard, over frames. antenna: how far "
        "the GPS is ahead of the noise, which only the GPS can tell; these rows have "
        "seen it, the others have not. All figures are computed from the data.",
    ),
    TableLayout(
        "Two ships, bearings without labels",
        (
            Column("right_percent", "right %", ".2f"),
            Column("free_percent", "left out %", ".1f"),
            Column("real_median_m", "real ship m", ".1f"),
            Column("made_up_median_m", "second ship m", ".1f"),
        ),
        "right: share of the bearings given to a ship that are its own. left out: of all bearings. "
        "Medians of the filter's position error.",
    ),
)


@dataclass(frozen=True)
class PairingPart:
    """Runs with a second ship.

    Attributes
    ----------
    path : Path
        ``.npz`` file.
    seed : int
        Of the second ship's bearings.
    """

    path: Path
    seed: int


def locate(path: Path) -> tuple[ShipTrack, ...]:
    """Return the tracks of all ways to locate the ship.

    Parameters
    ----------
    path : Path
        ``.npz`` file.
    """
    arrays = read_bearings(path)
    return (*locate_ship(arrays), *node_tracks(arrays))


def pair(part: PairingPart) -> tuple[PairingResult, ...]:
    """Return what comes of bearings without labels; nothing where there is one array only.

    Parameters
    ----------
    part : PairingPart
        File and seed.
    """
    arrays = read_bearings(part.path)
    if len(arrays) < 2:
        return ()
    return (pair_bearings(arrays, np.random.default_rng(part.seed)),)


def ship_rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Return one row a track, and one of the bearings without labels."""
    parts = [part for result in results for part in result]
    rows = [_track_row(part) for part in parts if isinstance(part, ShipTrack)]
    rows += [_pairing_row(part) for part in parts if isinstance(part, PairingResult)]
    return tuple(rows)


def ship_bearings(path: Path) -> StudyDefinition:
    """Return the study of the bearings in a file; only the second ship is random.

    Parameters
    ----------
    path : Path
        ``.npz`` file.
    """

    def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
        parts = [part for result in results for part in result]
        return draw_tracks([part for part in parts if isinstance(part, ShipTrack)], directory)

    return StudyDefinition(
        name=SHIP_BEARINGS,
        description="a real ship located from the bearings of arrays on the sea floor",
        default_runs=1,
        tasks=lambda runs, seed: (Task(locate, path), Task(pair, PairingPart(path, seed))),
        rows=ship_rows,
        layouts=LAYOUTS,
        draw=draw,
    )


def _track_row(track: ShipTrack) -> StudyRow:
    first = 0 if track.instants else SETTLING
    distance = np.hypot(*(track.position - track.ship).T)
    coasted = np.zeros(len(distance), bool) if track.coasted is None else track.coasted
    counts = ~coasted & (np.arange(len(distance)) >= first)
    error, nees = _known(distance[counts]), track.nees[counts]
    if not len(error):
        return StudyRow(track.system, f"array {track.arrays}", {"median_m": np.nan, "seconds": 0.0})
    instants = track.instants or np.nan
    metrics = {
        "median_m": float(np.median(error)),
        "rmse_m": float(np.sqrt(np.mean(error**2))),
        "percentile_90_m": float(np.percentile(error, 90)),
        "beyond_200_percent": 100.0 * float(np.mean(error > FAR_LIMIT_M)),
        "median_nees": _median(nees) / MEDIAN_OF_NEES,
        "in_ellipse_percent": _in_ellipse(nees),
        "confirmed_percent": 100.0 * float(np.sum(~coasted)) / instants,
        "coasted_percent": 100.0 * float(np.sum(coasted)) / instants,
        "coasted_in_ellipse_percent": _in_ellipse(track.nees[coasted]),
        "antenna_m": track.antenna,
        "seconds": float(len(error)),
    }
    return StudyRow(track.system, f"array {track.arrays}", metrics)


def _median(values: FloatArray) -> float:
    known = _known(values)
    return float(np.median(known)) if len(known) else np.nan


def _in_ellipse(nees: FloatArray) -> float:
    """Return the share of positions whose 95 % ellipse holds the truth, per cent."""
    known = _known(nees)
    return 100.0 * float(np.mean(2.0 * known < ELLIPSE)) if len(known) else np.nan


def _pairing_row(result: PairingResult) -> StudyRow:
    given = result.right + result.wrong
    metrics = {
        "right_percent": 100.0 * result.right / given,
        "free_percent": 100.0 * result.free / (given + result.free),
        "real_median_m": float(np.median(_known(result.error[:, REAL]))),
        "made_up_median_m": float(np.median(_known(result.error[:, MADE_UP]))),
    }
    return StudyRow(UNLABELLED, f"array {result.arrays}", metrics)


def _known(values: FloatArray) -> FloatArray:
    return np.asarray(values[np.isfinite(values)])
