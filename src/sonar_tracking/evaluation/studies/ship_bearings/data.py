"""Bearings of the ship-bearings study: what arrays on the sea floor measured, and the GPS.

A direction is as good as its delays agree. Six delays between four hydrophones leave three misfits
when the components of a direction are fitted; its length, which is not fitted and should be one, is
a fourth. Their mean square is an estimate of the direction's variance, second by second and without
a look at where the ship was; a prior keeps it from vanishing.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.tables.npz_file import read_npz
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.batch.direction_smoother import MINIMUM_COSINE, DirectionHistory

PRIOR_DEVIATION_DEG, PRIOR_WEIGHT = 0.5, 2.0
"""Deviation of a direction before its delays are looked at, and how many misfits that counts."""

RADIANS_PER_MICROSECOND = 1.06e-3
"""Sound speed over 1.40 m, the extent of the arrays (singular value of their baselines)."""

PLACE_KEY, SOUND_SPEED_KEY = "array_enu_m", "sound_speed_m_s"
KEYS = (
    "t_s",
    "t_suspect",
    "az_deg",
    "el_deg",
    "norm",
    "fit_rms_us",
    "truth_ship_e_m",
    "truth_ship_n_m",
    "truth_valid",
    PLACE_KEY,
)
"""Of each array, behind its name and an underscore."""

N_DELAYS, N_MISFITS = 6, 4

LENGTH_MISFIT, DELAY_MISFIT_US = 0.1, 15.0
"""Directions that fit better are consistent; the second in microseconds."""


@dataclass(frozen=True)
class ArrayBearings:
    """What one array measured, in order of time, and where the ship was.

    Attributes
    ----------
    name : str
        As in the keys.
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
    consistent : ndarray of bool, shape (n,)
        Where the six delays agree with one direction: its length within 0.1 of one, misfit below
        15 microseconds.
    """

    name: str
    position: FloatArray
    times: FloatArray
    azimuth: FloatArray
    elevation: FloatArray
    deviation: FloatArray
    ship: FloatArray
    sound_speed: float
    consistent: BoolArray

    def azimuth_deviation(self) -> FloatArray:
        """Return the standard deviation of the azimuths, shape (n,), rad: large overhead."""
        cosine = np.maximum(np.abs(np.cos(self.elevation)), MINIMUM_COSINE)
        return np.asarray(self.deviation / cosine)


@dataclass(frozen=True)
class JoinedBearings:
    """Bearings of one or several arrays in one order of time.

    Attributes
    ----------
    history : DirectionHistory
        What was measured.
    azimuth_deviation : ndarray, shape (n,)
        rad.
    ship : ndarray, shape (n, 2)
        From GPS, m; NaN = not known.
    array : ndarray of int, shape (n,)
        Which array.
    names : str
        Of the arrays.
    """

    history: DirectionHistory
    azimuth_deviation: FloatArray
    ship: FloatArray
    array: IntArray
    names: str


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
    data = read_npz(path)
    names = sorted(key.removesuffix("_az_deg") for key in data if key.endswith("_az_deg"))
    names = [name for name in names if not name.endswith("_truth")]
    if not names:
        raise ConfigurationError(
            f"{path} holds no bearings: of each array it needs the keys NAME_{', NAME_'.join(KEYS)}"
            f", and {SOUND_SPEED_KEY}; bearings in a table of columns are for import bearings."
        )
    for name in names:
        _check_keys(path, name, data)
    return tuple(_array(name, data) for name in names)


def _check_keys(path: Path, name: str, data: dict[str, Any]) -> None:
    wanted = [*(f"{name}_{key}" for key in KEYS), SOUND_SPEED_KEY]
    missing = [key for key in wanted if key not in data]
    if missing:
        raise ConfigurationError(
            f"{path} lacks {', '.join(missing)} of the array {name}; the page ship-bearings of "
            "the documentation lists all keys."
        )
    count = data[f"{name}_t_s"].shape
    for key in KEYS:
        array = data[f"{name}_{key}"]
        shape = (3,) if key == PLACE_KEY else count
        if array.shape != shape or len(count) != 1 or array.dtype.kind not in "biuf":
            raise ConfigurationError(
                f"{path} has {name}_{key} of shape {array.shape}, not {shape}; give one value a "
                f"bearing, and three of {name}_{PLACE_KEY}."
            )


def join_bearings(arrays: tuple[ArrayBearings, ...], elevations: bool) -> JoinedBearings:
    """Return the bearings of arrays in one order of time.

    Parameters
    ----------
    arrays : tuple of ArrayBearings
        One or more.
    elevations : bool
        Whether to keep the elevations.
    """
    number = np.concatenate([np.full(len(one.times), n) for n, one in enumerate(arrays)])
    times = np.concatenate([one.times for one in arrays])
    order = np.argsort(times, kind="stable")
    number = number[order]
    elevation = np.concatenate([one.elevation for one in arrays])[order]
    place = np.stack([one.position for one in arrays])[number]
    return JoinedBearings(
        DirectionHistory(
            times=times[order],
            position=place[:, :2],
            height=-place[:, 2],
            azimuth=np.concatenate([one.azimuth for one in arrays])[order],
            elevation=elevation if elevations else np.full(len(elevation), np.nan),
            deviation=np.concatenate([one.deviation for one in arrays])[order],
        ),
        azimuth_deviation=np.concatenate([one.azimuth_deviation() for one in arrays])[order],
        ship=np.concatenate([one.ship for one in arrays])[order],
        array=number,
        names=" and ".join(one.name for one in arrays),
    )


def _array(name: str, data: dict[str, Any]) -> ArrayBearings:
    measured = np.isfinite(data[f"{name}_az_deg"]) & np.isfinite(data[f"{name}_el_deg"])
    usable = np.flatnonzero(measured & ~data[f"{name}_t_suspect"].astype(bool))
    # A recorder that stepped back is left out until it is past its latest instant again.
    times = data[f"{name}_t_s"][usable]
    latest = np.concatenate([[-np.inf], np.maximum.accumulate(times)[:-1]])
    usable = usable[times > latest]
    ship = np.stack([data[f"{name}_truth_ship_e_m"], data[f"{name}_truth_ship_n_m"]], axis=1)
    ship = np.where(data[f"{name}_truth_valid"].astype(bool)[:, None], ship, np.nan)
    return ArrayBearings(
        name=name,
        position=data[f"{name}_array_enu_m"],
        times=data[f"{name}_t_s"][usable],
        azimuth=azimuth_from_compass(data[f"{name}_az_deg"][usable]),
        elevation=np.radians(data[f"{name}_el_deg"][usable]),
        deviation=_deviation(data[f"{name}_fit_rms_us"][usable], data[f"{name}_norm"][usable]),
        ship=ship[usable],
        sound_speed=float(data["sound_speed_m_s"]),
        consistent=(np.abs(data[f"{name}_norm"][usable] - 1.0) < LENGTH_MISFIT)
        & (data[f"{name}_fit_rms_us"][usable] < DELAY_MISFIT_US),
    )


def _deviation(misfit_us: FloatArray, length: FloatArray) -> FloatArray:
    misfits = N_DELAYS * (RADIANS_PER_MICROSECOND * misfit_us) ** 2 + (length - 1.0) ** 2
    prior = PRIOR_WEIGHT * np.radians(PRIOR_DEVIATION_DEG) ** 2
    return np.asarray(np.sqrt((prior + misfits) / (PRIOR_WEIGHT + N_MISFITS)))
