"""Make the directions that the study ship-bearings reads, from the data of Where's Whaledo.

python ship_bearings.py wheresWhaledo/receiverPositionInversion two_arrays.npz EE,EW 2512 5800
python ship_bearings.py wheresWhaledo/receiverPositionInversion later_passes.npz EW 8420 12880
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat

FIRST_DAY = 6650  # of the files: 16 March 2018
GPS_SOUND_SPEED = 1490.0
EQUATORIAL_RADIUS, SQUARED_ECCENTRICITY = 6378137.0, 6.69437999014e-3


def extract(folder: Path, names: list[str], first: float, last: float) -> dict[str, Any]:
    """Return the least-squares directions of some arrays between two times, s of the day."""
    origin = loadmat(folder / "SOCAL_E_63_EE_Hmatrix_.mat")["recLoc"].ravel()
    data: dict[str, Any] = {}
    for name in names:
        geometry = loadmat(folder / f"SOCAL_E_63_{name}_Hmatrix_.mat")
        delays = loadmat(folder / f"SOCAL_E_63_{name}_shipTDOA.mat")
        gps = loadmat(folder / f"SOCAL_E_63_{name}_shipLatLon.mat")
        location, speed = geometry["recLoc"].ravel(), float(geometry["c"].item())
        place = np.array([*_east_north(location[:1], location[1:2], origin).ravel(), location[2]])
        times = _seconds(delays["T"])
        inside = (times >= first) & (times <= last)
        measured = {
            "t_s": times,
            "t_suspect": _suspect(times),
            **_directions(delays["TDOA"], geometry["H"], speed),
            **_truth(times, _seconds(gps["T"]), _east_north(gps["Lat"], gps["Lon"], origin), place),
        }
        data |= {f"{name}_{key}": values[inside] for key, values in measured.items()}
        data |= {f"{name}_array_enu_m": place, "sound_speed_m_s": speed}
    return data


def _seconds(days: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return (days.ravel() - FIRST_DAY) * 86400.0


def _directions(
    delays: np.ndarray[Any, Any], baselines: np.ndarray[Any, Any], speed: float
) -> dict[str, np.ndarray[Any, Any]]:
    """Fit delay = baseline . u / c; the length of u is not fitted and tells the quality."""
    vector = np.linalg.lstsq(baselines, speed * delays.T, rcond=None)[0].T
    misfit = delays - vector @ baselines.T / speed
    length = np.linalg.norm(vector, axis=1)
    return {
        "az_deg": np.degrees(np.arctan2(vector[:, 0], vector[:, 1])) % 360.0,
        "el_deg": np.degrees(np.arcsin(vector[:, 2] / length)),
        "norm": length,
        "fit_rms_us": 1e6 * np.sqrt(np.mean(misfit**2, axis=1)),
    }


def _suspect(times: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Mark what lies between a step back of the recorder's clock and its next leap forward."""
    suspect = np.zeros(len(times), dtype=bool)
    for back in np.flatnonzero(np.diff(times) < 0.0):
        leap = back + 1 + np.flatnonzero(np.diff(times[back + 1 :]) > 2.5)
        suspect[back + 1 : (leap[0] + 2 if len(leap) else len(times))] = True
    return suspect


def _east_north(
    latitude: np.ndarray[Any, Any], longitude: np.ndarray[Any, Any], origin: np.ndarray[Any, Any]
) -> np.ndarray[Any, Any]:
    """Return metres from the origin on the plane that touches the ellipsoid there."""
    curvature = 1.0 - SQUARED_ECCENTRICITY * np.sin(np.radians(origin[0])) ** 2
    across = EQUATORIAL_RADIUS / np.sqrt(curvature)
    along = across * (1.0 - SQUARED_ECCENTRICITY) / curvature
    east = across * np.cos(np.radians(origin[0])) * np.radians(longitude.ravel() - origin[1])
    return np.stack([east, along * np.radians(latitude.ravel() - origin[0])])


def _truth(
    times: np.ndarray[Any, Any],
    fix_times: np.ndarray[Any, Any],
    fixes: np.ndarray[Any, Any],
    place: np.ndarray[Any, Any],
) -> dict[str, np.ndarray[Any, Any]]:
    """Return where the ship was when the sound left it."""
    emission = times
    for _ in range(5):
        ship = np.stack([np.interp(emission, fix_times, fix) for fix in fixes])
        slant = np.sqrt(((ship - place[:2, None]) ** 2).sum(axis=0) + place[2] ** 2)
        emission = times - slant / GPS_SOUND_SPEED
    nearest = np.searchsorted(fix_times, emission).clip(1, len(fix_times) - 1)
    gap = fix_times[nearest] - fix_times[nearest - 1]
    inside = (emission >= fix_times[0]) & (emission <= fix_times[-1])
    return {
        "truth_ship_e_m": ship[0],
        "truth_ship_n_m": ship[1],
        "truth_valid": inside & (gap < 10.0),
    }


if __name__ == "__main__":
    arrays = sys.argv[3].split(",")
    first, last = map(float, sys.argv[4:])
    np.savez_compressed(sys.argv[2], **extract(Path(sys.argv[1]), arrays, first, last))
