"""Protects the study on real bearings: what is read, what is left out, what comes of it."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.studies.ship_bearings.data import ArrayBearings, read_bearings
from sonar_tracking.evaluation.studies.ship_bearings.node_tracks import NODE, live_track
from sonar_tracking.evaluation.studies.ship_bearings.pairing import pair_bearings
from sonar_tracking.evaluation.studies.ship_bearings.study import (
    UNLABELLED,
    PairingPart,
    locate,
    pair,
    ship_bearings,
    ship_rows,
)
from sonar_tracking.evaluation.studies.ship_bearings.tracks import (
    ANTENNA,
    BOTH,
    CROSS,
    FIXES,
    GATED,
    SINGLE,
    SMOOTHED,
    ShipTrack,
    locate_ship,
)
from sonar_tracking.evaluation.studies.study_catalogue import run_study
from tests.recorded_data import recorded_data

DEPTH = 1300.0
N_SECONDS = 200
HALF_AN_HOUR, THREE_QUARTERS = 1800.0, 2700.0
"""s."""

SERIES = ("times", "azimuth", "elevation", "deviation", "ship", "consistent")
"""What an array has of each measurement."""


def circling(seed: int) -> dict[str, Any]:
    """Return made-up bearings of a ship on a circle, one in ten of them anything."""
    generator = np.random.default_rng(seed)
    times = 100.0 + np.arange(N_SECONDS)
    angle = 0.003 * times
    ship = 800.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    data: dict[str, Any] = {"sound_speed_m_s": np.array(1488.0)}
    for name, place in (("EE", (0.0, 0.0)), ("EW", (-1000.0, -300.0))):
        offset = ship - place
        distance = np.hypot(*offset.T)
        compass = np.degrees(np.arctan2(offset[:, 0], offset[:, 1]))
        elevation = np.degrees(np.arctan2(DEPTH, distance))
        noise = generator.standard_normal((2, N_SECONDS))
        wild = generator.random(N_SECONDS) < 0.1
        data |= {
            f"{name}_t_s": times.copy(),
            f"{name}_az_deg": compass + noise[0] + np.where(wild, 120.0, 0.0),
            f"{name}_el_deg": elevation + 0.5 * noise[1],
            f"{name}_fit_rms_us": np.where(wild, 200.0, 6.0),
            f"{name}_norm": np.where(wild, 0.8, 1.0),
            f"{name}_t_suspect": np.zeros(N_SECONDS, dtype=bool),
            f"{name}_truth_ship_e_m": ship[:, 0],
            f"{name}_truth_ship_n_m": ship[:, 1],
            f"{name}_truth_valid": np.ones(N_SECONDS, dtype=bool),
            f"{name}_array_enu_m": np.array([*place, -DEPTH]),
        }
    return data


@pytest.fixture(scope="module")
def made_up(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("made_up") / "bearings.npz"
    np.savez(path, **circling(1))
    return path


@pytest.fixture(scope="module")
def located(made_up: Path) -> tuple[ShipTrack, ...]:
    return locate(made_up)


def test_every_way_finds_a_circling_ship(located: tuple[ShipTrack, ...]) -> None:
    rows = ship_rows([located])
    medians = {(row.system, row.condition): row.metrics["median_m"] for row in rows}
    assert len(medians) == 25
    assert medians[SINGLE, "array EE"] < 30.0
    assert medians[BOTH, "array EE and EW"] < 30.0
    assert medians[CROSS, "array EE and EW"] < 80.0  # azimuths of 1 deg at up to 1.8 km
    # The filter beats the single seconds that it is made of, and the smoother the filter.
    assert medians[BOTH, "array EE and EW"] < medians[FIXES, "array EE"]
    assert medians[FIXES + GATED, "array EE"] <= medians[FIXES, "array EE"]
    assert medians[NODE + BOTH, "array EE and EW"] < 60.0
    for way in (CROSS, BOTH):
        assert medians[SMOOTHED + way, "array EE and EW"] < medians[way, "array EE and EW"]


def test_an_antenna_where_the_noise_comes_from_is_found_there(
    located: tuple[ShipTrack, ...],
) -> None:
    rows = {(row.system, row.condition): row.metrics for row in ship_rows([located])}
    assert abs(rows[ANTENNA + BOTH, "array EE and EW"]["antenna_m"]) < 5.0
    assert np.isnan(rows[BOTH, "array EE and EW"]["antenna_m"])


def test_bearings_without_labels_go_to_their_ships(made_up: Path) -> None:
    (row,) = ship_rows([pair(PairingPart(made_up, 1))])
    assert row.system == UNLABELLED
    assert row.metrics["right_percent"] > 97.0
    assert row.metrics["made_up_median_m"] < 40.0


def test_seconds_with_doubtful_time_are_left_out(tmp_path: Path) -> None:
    data = circling(2)
    data["EE_t_suspect"][50] = True
    data["EE_t_s"][100:110] -= 20.0
    data["EE_az_deg"][3] = np.nan
    path = tmp_path / "glitch.npz"
    np.savez(path, **data)
    array = read_bearings(path)[0]
    assert len(array.times) == N_SECONDS - 12
    assert np.all(np.diff(array.times) > 0.0)


def beginning(array: ArrayBearings, end: float) -> ArrayBearings:
    """Return what an array has measured until a time in s."""
    early = array.times < end
    return replace(array, **{name: getattr(array, name)[early] for name in SERIES})


def thinned(array: ArrayBearings, every: int) -> ArrayBearings:
    """Return some of the measurements of an array: one of so many."""
    return replace(array, **{name: getattr(array, name)[::every] for name in SERIES})


def test_a_wrong_file_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="cannot be read"):
        read_bearings(tmp_path / "absent.npz")
    path = tmp_path / "other.npz"
    np.savez(path, nothing=np.zeros(1))
    with pytest.raises(ConfigurationError, match="no bearings"):
        read_bearings(path)
    with pytest.raises(ConfigurationError, match="--data"):
        run_study("ship-bearings")


def test_pictures_are_drawn(made_up: Path, located: tuple[ShipTrack, ...], tmp_path: Path) -> None:
    tracks = located[::9]  # of all ways and arrays some
    pictures = ship_bearings(made_up).draw([tracks], ship_rows([tracks]), tmp_path)
    assert len(pictures) == len(tracks)
    assert all(picture.stat().st_size > 5_000 for picture in pictures)


@pytest.mark.data
@pytest.mark.parametrize(
    ("file", "every", "single_seconds"),
    [
        (
            "two_arrays_A",
            1,
            {
                (SINGLE, "array EE"): 22.0,
                (SINGLE, "array EW"): 31.0,
                (CROSS, "array EE and EW"): 25.0,
                (BOTH, "array EE and EW"): 22.0,
            },
        ),
        ("array_EW_B", 3, {(SINGLE, "array EW"): 31.0}),
    ],
)
def test_the_real_ship_is_found_better_than_by_single_seconds(
    file: str, every: int, single_seconds: dict[tuple[str, str], float]
) -> None:
    """One measurement of so many is taken of the single array: it has more than enough."""
    measured = read_bearings(recorded_data(f"harp_ship_bearings/{file}.npz"))
    tracks = locate_ship(tuple(thinned(array, every) for array in measured))
    rows = {(row.system, row.condition): row.metrics for row in ship_rows([tracks])}
    for (way, arrays), median in single_seconds.items():
        assert rows[SMOOTHED + way, arrays]["median_m"] < median
        assert 0.3 < rows[SMOOTHED + way, arrays]["median_nees"] < 2.0


@pytest.mark.data
@pytest.mark.parametrize(
    ("file", "names", "system", "least", "length", "every"),
    [
        ("two_arrays_A", ("EE",), SINGLE, 85.0, HALF_AN_HOUR, 5),
        ("two_arrays_A", ("EW",), SINGLE, 85.0, np.inf, 6),
        ("two_arrays_A", ("EE", "EW"), BOTH, 85.0, HALF_AN_HOUR, 6),
        ("array_EW_B", ("EW",), SINGLE, 92.0, np.inf, 9),
        ("two_arrays_A", ("EE", "EW"), CROSS, 85.0, THREE_QUARTERS, 5),
    ],
)
def test_ellipses_of_the_node_hold_the_real_ship(
    file: str, names: tuple[str, ...], system: str, least: float, length: float, every: int
) -> None:
    """Told the depth alone. For five minutes the ship is silent: rows that say so are apart.

    One measurement of so many is taken. Without the part of errors that never average out 80, 72,
    75, 83 and 71 % are in the ellipses.
    """
    arrays = read_bearings(recorded_data(f"harp_ship_bearings/{file}.npz"))
    end = arrays[0].times[0] + length
    chosen = tuple(thinned(beginning(array, end), every) for array in arrays if array.name in names)
    (row,) = ship_rows([(live_track(system, chosen, system != CROSS),)])
    assert least <= row.metrics["in_ellipse_percent"] <= 99.0
    assert row.metrics["confirmed_percent"] + row.metrics["coasted_percent"] > 80.0
    assert row.metrics["coasted_percent"] < 13.0, "the silence, and a minute after it"


@pytest.mark.data
def test_real_bearings_without_labels_go_to_their_ships() -> None:
    """Every second bearing of the first half hour of the recording."""
    arrays = read_bearings(recorded_data("harp_ship_bearings/two_arrays_A.npz"))
    end = arrays[0].times[0] + HALF_AN_HOUR
    beginnings = tuple(thinned(beginning(array, end), 2) for array in arrays)
    (row,) = ship_rows([(pair_bearings(beginnings, np.random.default_rng(1)),)])
    assert row.metrics["right_percent"] > 99.0
    assert row.metrics["real_median_m"] < 25.0
