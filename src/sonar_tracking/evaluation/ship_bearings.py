"""Study ship-bearings: a real ship located from the bearings of bottom-mounted arrays.

A research vessel circled two small arrays of four hydrophones on the sea floor, whose raw bearings
came once a second, outliers and quiet stretches included. Its GPS is the truth. The ship is located
from the azimuths of both arrays (cross-fix), from azimuth and elevation of one array at known
depth, and from all together; beside it, without any filter, where the rays of single seconds meet
the surface.

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

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.batch_runner import Task
from sonar_tracking.evaluation.ship_bearings_figures import draw_tracks
from sonar_tracking.evaluation.study import StudyRow
from sonar_tracking.evaluation.study_definition import Column, StudyDefinition, TableLayout
from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.tma.range_bank import RangeBank, RangeBankConfiguration
from sonar_tracking.tma.records import FloatArray, TmaMeasurement

SHIP_BEARINGS = "ship-bearings"

DIRECTION_DEVIATION_DEG = 0.8
MISFIT_DEVIATION_DEG, MISFIT_SCALE = 0.08, 30.0
LENGTH_DEVIATION_DEG, LENGTH_SCALE = 30.0, 0.05
"""Standard deviation of a direction: at best; per microsecond that the six delays misfit; per unit
that the direction's length is off one. The latter two grow faster beyond their scale, where the
delays belong to different arrivals. An azimuth has the deviation over cos(elevation)."""

MINIMUM_COSINE = 0.05
"""Overhead an azimuth says nothing; its variance is not let grow for ever."""

CONFIGURATION = RangeBankConfiguration(
    minimum_range=50.0,
    maximum_range=4000.0,
    n_ranges=4,
    maximum_speed=8.0,
    acceleration=0.03,
    manoeuvre_acceleration=0.1,
)
"""A ship that keeps turning, seen from the sea floor."""

MEDIAN_OF_NEES = float(np.log(2.0))
"""Median of a consistent NEES per dimension of a position; outliers would own the mean."""

SETTLING = 60
"""First measurements, which are not scored."""

FIXES = "rays of single seconds"
CROSS, SINGLE, BOTH = "azimuths of both arrays", "azimuth and elevation", "everything"
LAYOUTS = (
    TableLayout(
        "A ship located from the sea floor",
        (
            Column("median_m", "median m", ".1f"),
            Column("rmse_m", "RMSE m", ".1f"),
            Column("percentile_90_m", "90 % m", ".1f"),
            Column("beyond_200_percent", "> 200 m %", ".1f"),
            Column("median_nees", "NEES", ".2f"),
            Column("seconds", "seconds", ".0f"),
        ),
        "Horizontal distance from the ship's GPS at the instant of emission; raw bearings, "
        "outliers left in. NEES: median over that of a consistent filter. Published medians are of "
        "single seconds, outliers taken out.",
    ),
)
PUBLISHED_MEDIAN = {"EE": 22.0, "EW": 31.0}
"""Of single seconds with azimuth and elevation, outliers taken out, m."""


@dataclass(frozen=True)
class ArrayBearings:
    """What one array measured, in order of time, and where the ship was.

    Attributes
    ----------
    name : str
        EE or EW.
    position : ndarray, shape (3,)
        East, north, up, m.
    times : ndarray, shape (n,)
        s.
    azimuth, elevation : ndarray, shape (n,)
        Measured, rad; azimuth anticlockwise from east.
    deviation : ndarray, shape (n,)
        Standard deviation of the direction, from how well the delays agree, rad.
    ship : ndarray, shape (n, 2)
        From GPS at the instant of emission, m; NaN = not known.
    sound_speed : float
        m/s.
    """

    name: str
    position: FloatArray
    times: FloatArray
    azimuth: FloatArray
    elevation: FloatArray
    deviation: FloatArray
    ship: FloatArray
    sound_speed: float


@dataclass(frozen=True)
class ShipTrack:
    """Located ship.

    Attributes
    ----------
    system, arrays : str
        How, and by which arrays.
    times : ndarray, shape (n,)
        s.
    position, ship : ndarray, shape (n, 2)
        Located and true, m.
    nees : ndarray, shape (n,)
        Of the position, per dimension; NaN = no covariance.
    """

    system: str
    arrays: str
    times: FloatArray
    position: FloatArray
    ship: FloatArray
    nees: FloatArray


def read_bearings(path: Path) -> tuple[ArrayBearings, ...]:
    """Return the bearings in a file, without the seconds whose time is in doubt.

    Parameters
    ----------
    path : Path
        ``.npz`` file.

    Raises
    ------
    ConfigurationError
        If it is not there or holds no bearings.
    """
    try:
        with np.load(path) as file:
            data = {name: file[name] for name in file.files}
    except (OSError, ValueError) as error:
        raise ConfigurationError(f"{path} cannot be read as bearings (.npz): {error}.") from error
    names = [name for name in ("EE", "EW") if f"{name}_az_deg" in data]
    if not names:
        raise ConfigurationError(f"{path} holds no bearings of an array EE or EW.")
    return tuple(_array(name, data) for name in names)


def locate(path: Path) -> tuple[ShipTrack, ...]:
    """Return the tracks of all ways to locate the ship.

    Parameters
    ----------
    path : Path
        ``.npz`` file.
    """
    arrays = read_bearings(path)
    tracks = []
    for array in arrays:
        tracks.append(_single_seconds(array))
        tracks.append(_tracked(SINGLE, (array,), elevations=True))
    if len(arrays) > 1:
        tracks.append(_tracked(CROSS, arrays, elevations=False))
        tracks.append(_tracked(BOTH, arrays, elevations=True))
    return tuple(tracks)


def ship_rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Return one row a track."""
    rows = []
    for track in (track for result in results for track in result):
        error = np.hypot(*(track.position - track.ship)[SETTLING:].T)
        error = error[np.isfinite(error)]
        published = {}
        if track.system == FIXES:
            published["median_m"] = PUBLISHED_MEDIAN[track.arrays]
        nees = track.nees[SETTLING:]
        nees = nees[np.isfinite(nees)]
        metrics = {
            "median_m": float(np.median(error)),
            "rmse_m": float(np.sqrt(np.mean(error**2))),
            "percentile_90_m": float(np.percentile(error, 90)),
            "beyond_200_percent": 100.0 * float(np.mean(error > 200.0)),
            "median_nees": float(np.median(nees) / MEDIAN_OF_NEES) if len(nees) else np.nan,
            "seconds": float(len(error)),
        }
        rows.append(StudyRow(track.system, f"array {track.arrays}", metrics, published))
    return tuple(rows)


def ship_bearings(path: Path) -> StudyDefinition:
    """Return the study of the bearings in a file; it has no random runs.

    Parameters
    ----------
    path : Path
        ``.npz`` file.
    """

    def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
        return draw_tracks([track for result in results for track in result], directory)

    return StudyDefinition(
        name=SHIP_BEARINGS,
        description="a real ship located from the bearings of arrays on the sea floor",
        default_runs=1,
        tasks=lambda runs, seed: (Task(locate, path),),
        rows=ship_rows,
        layouts=LAYOUTS,
        draw=draw,
    )


def _array(name: str, data: dict[str, Any]) -> ArrayBearings:
    measured = np.isfinite(data[f"{name}_az_deg"]) & np.isfinite(data[f"{name}_el_deg"])
    usable = np.flatnonzero(measured & ~data[f"{name}_t_suspect"])
    # A recorder that stepped back is left out until it is past its latest instant again.
    times = data[f"{name}_t_s"][usable]
    latest = np.concatenate([[-np.inf], np.maximum.accumulate(times)[:-1]])
    usable = usable[times > latest]
    ship = np.stack([data[f"{name}_truth_ship_e_m"], data[f"{name}_truth_ship_n_m"]], axis=1)
    ship = np.where(data[f"{name}_truth_valid"][:, None], ship, np.nan)
    return ArrayBearings(
        name=name,
        position=data[f"{name}_array_enu_m"],
        times=data[f"{name}_t_s"][usable],
        azimuth=azimuth_from_compass(data[f"{name}_az_deg"][usable]),
        elevation=np.radians(data[f"{name}_el_deg"][usable]),
        deviation=_deviation(data[f"{name}_fit_rms_us"][usable], data[f"{name}_norm"][usable]),
        ship=ship[usable],
        sound_speed=float(data["sound_speed_m_s"]),
    )


def _deviation(misfit_us: FloatArray, length: FloatArray) -> FloatArray:
    off = np.abs(length - 1.0)
    misfit = MISFIT_DEVIATION_DEG * misfit_us * (1.0 + misfit_us / MISFIT_SCALE)
    odd = LENGTH_DEVIATION_DEG * off * (1.0 + off / LENGTH_SCALE)
    return np.asarray(np.radians(np.sqrt(DIRECTION_DEVIATION_DEG**2 + misfit**2 + odd**2)))


def _measurements(array: ArrayBearings, elevations: bool) -> list[TmaMeasurement]:
    across = array.deviation / np.maximum(np.abs(np.cos(array.elevation)), MINIMUM_COSINE)
    return [
        TmaMeasurement(
            stamp=round(float(time) * 1e9),
            position=array.position[:2],
            velocity=np.zeros(2),
            azimuth=np.array([azimuth]),
            azimuth_variance=np.array(spread**2),
            elevation=np.array(elevation if elevations else np.nan),
            elevation_variance=np.array(deviation**2),
            height=-float(array.position[2]),
            sound_speed=array.sound_speed,
        )
        for time, azimuth, elevation, deviation, spread in zip(
            array.times, array.azimuth, array.elevation, array.deviation, across, strict=True
        )
    ]


def _tracked(system: str, arrays: tuple[ArrayBearings, ...], elevations: bool) -> ShipTrack:
    frames = [
        (measurement, ship)
        for array in arrays
        for measurement, ship in zip(_measurements(array, elevations), array.ship, strict=True)
    ]
    frames.sort(key=lambda frame: frame[0].stamp)
    estimator = RangeBank(CONFIGURATION)
    position, nees = np.empty((len(frames), 2)), np.empty(len(frames))
    ships = np.array([ship for _, ship in frames])
    for index, (measurement, ship) in enumerate(frames):
        estimate = estimator.update(measurement)
        position[index] = estimate.mean[:2]
        error = position[index] - ship
        nees[index] = 0.5 * error @ np.linalg.solve(estimate.covariance[:2, :2], error)
    times = np.array([measurement.stamp * 1e-9 for measurement, _ in frames])
    names = " and ".join(array.name for array in arrays)
    return ShipTrack(system, names, times, position, ships, nees)


def _single_seconds(array: ArrayBearings) -> ShipTrack:
    """Return where the ray of each second meets the surface; NaN where it never does."""
    slope = np.where(array.elevation > 0.0, np.tan(array.elevation), np.nan)
    distance = -array.position[2] / slope
    direction = np.stack([np.cos(array.azimuth), np.sin(array.azimuth)], axis=1)
    position = array.position[:2] + distance[:, None] * direction
    unknown = np.full(len(distance), np.nan)
    return ShipTrack(FIXES, array.name, array.times, position, array.ship, unknown)
