"""Protects the smoother of directions: outliers, silence, honest covariance, no compass."""

import numpy as np
import pytest

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.batch.direction_smoother import (
    DirectionHistory,
    DirectionSmootherConfiguration,
    smooth_directions,
    systematic_covariance,
)

N_SECONDS = 240
DEPTH = 1300.0
DEVIATION = np.radians(0.5)
STATIONS = np.array([[0.0, 0.0], [-1000.0, -300.0]])


def straight_ship() -> FloatArray:
    times = np.repeat(np.arange(N_SECONDS), 2)[:, None]
    return np.asarray(np.array([400.0, 900.0]) + times * np.array([2.0, -1.0]))


def directions(
    seed: int, elevations: bool = True, wild: float = 0.0, turn: float = 0.0
) -> tuple[DirectionHistory, FloatArray]:
    """Return what both stations measure of a ship that moves straight, and its path."""
    generator = np.random.default_rng(seed)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    ship = straight_ship() @ rotation.T
    station = np.tile(STATIONS, (N_SECONDS, 1)) @ rotation.T
    offset = ship - station
    elevation = np.arctan2(DEPTH, np.hypot(*offset.T))
    noise = DEVIATION * generator.standard_normal((2, len(ship)))
    anywhere = generator.uniform(-np.pi, np.pi, len(ship))
    is_wild = generator.random(len(ship)) < wild
    azimuth = np.arctan2(offset[:, 1], offset[:, 0]) + noise[0] / np.cos(elevation)
    azimuth = wrap_angle(np.where(is_wild, anywhere, azimuth))
    measured = elevation + noise[1] if elevations else np.full(len(ship), np.nan)
    times = np.repeat(np.arange(N_SECONDS, dtype=float), 2)
    height = np.full(len(ship), DEPTH)
    deviation = np.full(len(ship), DEVIATION)
    return DirectionHistory(times, station, height, azimuth, measured, deviation), ship


def test_azimuths_of_two_stations_find_the_ship() -> None:
    history, ship = directions(1, elevations=False)
    track = smooth_directions(history, ship + 300.0)
    error = np.hypot(*(track.mean[:, :2] - ship).T)
    # One pair of azimuths alone: 0.5 deg at 1.6 to 2 km, some 20 m.
    assert np.median(error) < 12.0


def test_every_fifth_azimuth_may_be_anything() -> None:
    history, ship = directions(2, wild=0.2)
    track = smooth_directions(history, ship + np.array([200.0, -200.0]))
    error = np.hypot(*(track.mean[:, :2] - ship).T)
    assert np.max(error) < 25.0


def test_silence_is_bridged_by_the_motion() -> None:
    history, ship = directions(3)
    quiet = (history.times >= 80.0) & (history.times < 160.0)
    silent = np.where(quiet, np.nan, history.azimuth)
    risen = np.where(quiet, np.nan, history.elevation)
    gone = DirectionHistory(
        history.times, history.position, history.height, silent, risen, history.deviation
    )
    only_noise = DirectionSmootherConfiguration(systematic_deviation_deg=0.0)
    track = smooth_directions(gone, ship, only_noise)
    assert np.max(np.hypot(*(track.mean[quiet, :2] - ship[quiet]).T)) < 20.0
    heard = smooth_directions(history, ship, only_noise)
    middle = len(ship) // 2
    assert np.trace(track.covariance[middle]) > 1.2 * np.trace(heard.covariance[middle])


@pytest.mark.slow
def test_the_covariance_is_that_of_the_errors() -> None:
    only_noise = DirectionSmootherConfiguration(
        systematic_deviation_deg=0.0, degrees_of_freedom=200.0, acceleration=1e-4
    )
    values = []
    for seed in range(15):
        history, ship = directions(seed)
        track = smooth_directions(history, ship, only_noise)
        middle = len(ship) // 2
        error = track.mean[middle, :2] - ship[middle]
        values.append(error @ np.linalg.solve(track.covariance[middle, :2, :2], error) / 2.0)
    # 15 runs of 2 degrees of freedom: 0.46 to 1.79 has a probability of 99 %.
    assert 0.46 < np.mean(values) < 1.79


def test_a_systematic_error_stays_in_the_covariance() -> None:
    history, ship = directions(4)
    one_station = DirectionHistory(
        history.times,
        np.broadcast_to(STATIONS[0], ship.shape),
        history.height,
        history.azimuth,
        history.elevation,
        history.deviation,
    )
    deviation = np.radians(0.7)
    covariance = systematic_covariance(one_station, ship, deviation)
    direction = ship / np.hypot(*ship.T)[:, None]
    slant = DEPTH**2 + np.sum(ship**2, axis=1)
    along = np.einsum("ni,nij,nj->n", direction, covariance, direction)
    # An elevation error moves the position by slant^2 / depth along the ray's azimuth.
    np.testing.assert_allclose(np.sqrt(along), deviation * slant / DEPTH, rtol=1e-3)
    both = systematic_covariance(history, ship, deviation)
    assert np.all(np.trace(both, axis1=1, axis2=2) < np.trace(covariance, axis1=1, axis2=2))


@pytest.mark.slow
@pytest.mark.parametrize("turn", [1.0, 3.0])
def test_turning_the_scene_turns_the_path(turn: float) -> None:
    history, ship = directions(5)
    turned, turned_ship = directions(5, turn=turn)
    one = smooth_directions(history, ship)
    other = smooth_directions(turned, turned_ship)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    np.testing.assert_allclose(other.mean[:, :2], one.mean[:, :2] @ rotation.T, atol=1e-5)
