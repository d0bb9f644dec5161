"""Protects the datum: conversions that agree with the ellipsoid, and both ways with each other."""

from __future__ import annotations

import importlib.util

import numpy as np
import pytest

from sonar_tracking import geodesy
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.datum import Datum, datum_from_mapping, datum_from_text, datum_of
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
    scenario_to_mapping,
)

HELGOLAND = Datum(54.18, 7.89, 40.0)
ORIGINS = [
    HELGOLAND,
    Datum(0.0, 0.0),
    Datum(-33.9, 179.9999, -20.0),
    Datum(78.2, -180.0),
    Datum(90.0, 12.0),
    Datum(-90.0, 0.0),
]
SEMI_MINOR_AXIS = 6_356_752.314245
"""Of the ellipsoid, as published (TR8350.2, table 3.3), m."""


def offsets(seed: int) -> np.ndarray:
    """Return positions up to 50 km from the datum and 500 m above or below it, shape (200, 3)."""
    generator = np.random.default_rng(seed)
    azimuth = generator.uniform(-np.pi, np.pi, 200)
    distance = generator.uniform(0.0, 50_000.0, 200)
    up = generator.uniform(-500.0, 500.0, 200)
    return np.stack([distance * np.cos(azimuth), distance * np.sin(azimuth), up], axis=-1)


@pytest.mark.parametrize("datum", ORIGINS)
def test_both_ways_agree_to_a_hundredth_of_a_millimetre(datum: Datum) -> None:
    positions = offsets(1)
    places = geodesy.local_to_geodetic(positions, datum)
    assert np.abs(geodesy.geodetic_to_local(places, datum) - positions).max() < 1e-5


@pytest.mark.parametrize("datum", ORIGINS)
def test_what_floats_goes_there_and_back_at_the_height_of_the_datum(datum: Datum) -> None:
    positions = offsets(2)[:, :2]
    latitude, longitude = geodesy.surface_places(positions, datum).T
    back = geodesy.surface_positions(latitude, longitude, datum)
    assert np.abs(back - positions).max() < 1e-2


def test_quarters_of_the_globe_are_its_published_half_axes() -> None:
    quarter = np.pi / 2.0
    places = np.array([[0.0, quarter, 0.0], [quarter, 0.0, 0.0]])
    east, north = geodesy.geodetic_to_local(places, Datum(0.0, 0.0))
    major = geodesy.SEMI_MAJOR_AXIS
    np.testing.assert_allclose(east, [major, 0.0, -major], atol=1e-6)
    np.testing.assert_allclose(north, [0.0, SEMI_MINOR_AXIS, -major], atol=1e-5)


def test_small_steps_are_those_of_the_radii_of_curvature() -> None:
    datum, step = Datum(45.0, 10.0), np.radians(1e-3)
    squared = geodesy.ECCENTRICITY_SQUARED
    flat = 1.0 - squared / 2.0
    meridian = geodesy.SEMI_MAJOR_AXIS * (1.0 - squared) / flat**1.5
    parallel = geodesy.SEMI_MAJOR_AXIS / np.sqrt(2.0 * flat)
    north = geodesy.surface_positions(np.array(45.001), np.array(10.0), datum)
    east = geodesy.surface_positions(np.array(45.0), np.array(10.001), datum)
    assert north[1] == pytest.approx(meridian * step, abs=2e-3)
    assert east[0] == pytest.approx(parallel * step, abs=2e-3)


def test_the_sea_lies_below_the_tangent_plane_by_the_square_of_the_distance() -> None:
    place = np.radians([*geodesy.surface_places(np.array([50_000.0, 0.0]), Datum(0.0, 0.0)), 0.0])
    place[2] = 0.0
    up = geodesy.geodetic_to_local(place, Datum(0.0, 0.0))[2]
    assert up == pytest.approx(-(50_000.0**2) / (2.0 * geodesy.SEMI_MAJOR_AXIS), rel=1e-4)


def test_an_unknown_position_has_no_place() -> None:
    assert np.isnan(geodesy.surface_places(np.array([[np.nan, np.nan]]), HELGOLAND)).all()


@pytest.mark.skipif(not importlib.util.find_spec("pymap3d"), reason="pymap3d is not installed")
def test_places_are_those_of_pymap3d() -> None:
    import pymap3d

    positions = offsets(3)
    origin = (HELGOLAND.latitude_deg, HELGOLAND.longitude_deg, HELGOLAND.height)
    expected = np.stack(pymap3d.enu2geodetic(*positions.T, *origin), axis=-1)
    places = geodesy.local_to_geodetic(positions, HELGOLAND)
    np.testing.assert_allclose(np.degrees(places[:, :2]), expected[:, :2], atol=1e-10)
    np.testing.assert_allclose(places[:, 2], expected[:, 2], atol=1e-5)


def test_a_scenario_keeps_its_datum_for_the_recording() -> None:
    values = {
        "name": "here",
        "datum": {"latitude_deg": 54.18, "longitude_deg": 7.89},
        "active_sonar": {"maximum_range": 6000.0},
    }
    scenario = scenario_from_mapping(values, "here.yaml")
    assert scenario.datum == Datum(54.18, 7.89, 0.0)
    stored = scenario_to_mapping(scenario)
    assert scenario_from_mapping(stored, "bag") == scenario
    assert datum_of(stored, "bag") == scenario.datum


def test_a_scenario_without_a_datum_is_stored_as_before() -> None:
    stored = scenario_to_mapping(load_scenario("crossing_targets"))
    assert "datum" not in stored
    assert datum_of(stored, "bag") is None


def test_a_datum_is_typed_as_two_or_three_numbers() -> None:
    assert datum_from_text("54.18,7.89") == Datum(54.18, 7.89)
    assert datum_from_text("-33.9, 151.2, 12") == Datum(-33.9, 151.2, 12.0)


@pytest.mark.parametrize("text", ["", "54", "54,north", "1,2,3,4", "nan,2", "54.18;7.89"])
def test_what_is_no_datum_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(ConfigurationError, match=r"--datum is .* give e.g. 54.18,7.89"):
        datum_from_text(text)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"latitude_deg": 54.0}, "datum has no longitude_deg"),
        ({"latitude_deg": 95.0, "longitude_deg": 7.0}, "latitude_deg"),
        ({"latitude_deg": 5.0, "longitude_deg": 7.0, "hight": 2.0}, "height"),
        ([54.0, 7.0], "must be a mapping"),
    ],
)
def test_a_datum_that_cannot_be_used_is_named(values: object, sentence: str) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        datum_from_mapping(values, "here.yaml: datum")
