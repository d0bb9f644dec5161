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


@pytest.mark.parametrize("turn", [1.0, 3.0])
def test_turning_the_scene_turns_the_path(turn: float) -> None:
    history, ship = directions(5)
    turned, turned_ship = directions(5, turn=turn)
    one = smooth_directions(history, ship)
    other = smooth_directions(turned, turned_ship)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    np.testing.assert_allclose(other.mean[:, :2], one.mean[:, :2] @ rotation.T, atol=1e-5)


def by_least_squares(
    history: DirectionHistory, path: FloatArray, parameters: DirectionSmootherConfiguration
) -> tuple[FloatArray, FloatArray]:
    """Return the most probable states from one normal matrix, weights and slopes at a path."""
    count = len(history.times)
    normal, right = np.zeros((4 * count, 4 * count)), np.zeros(4 * count)
    prior = np.diag([3000.0**2] * 2 + [parameters.maximum_speed**2 / 3.0] * 2)
    normal[:4, :4] += np.linalg.inv(prior)
    right[:4] += np.linalg.solve(prior, np.append(path[0], [0.0, 0.0]))
    for k in range(count):
        own = slice(4 * k, 4 * k + 4)
        if k:
            before, interval = slice(4 * k - 4, 4 * k), history.times[k] - history.times[k - 1]
            motion = np.eye(4) + interval * np.eye(4, k=2)
            block = np.array(
                [[interval**3 / 3.0, interval**2 / 2.0], [interval**2 / 2.0, interval]]
            )
            weight = np.linalg.inv(parameters.acceleration**2 * np.kron(block, np.eye(2)))
            normal[before, before] += motion.T @ weight @ motion
            normal[before, own] -= motion.T @ weight
            normal[own, before] -= weight @ motion
            normal[own, own] += weight
        offset = path[k] - history.position[k]
        distance = np.hypot(*offset)
        elevation = np.arctan2(history.height[k], distance)
        cosine = max(np.cos(elevation), 0.05)
        turn = np.angle(np.exp(1j * history.azimuth[k]) / complex(*offset))
        fall = -history.height[k] / (distance**2 + history.height[k] ** 2)
        for residual, slope in (
            (turn * cosine, np.array([-offset[1], offset[0]]) / distance**2 * cosine),
            (history.elevation[k] - elevation, fall * offset / distance),
        ):
            if not np.isfinite(residual):
                continue
            square = history.deviation[k] ** 2
            freedom = parameters.degrees_of_freedom
            share = (freedom + 1.0) / (freedom + residual**2 / square) / square
            normal[own, own][:2, :2] += share * np.outer(slope, slope)
            right[own][:2] += share * (residual + slope @ path[k]) * slope
    covariance = np.linalg.inv(normal)
    states = (covariance @ right).reshape(count, 4)
    return states, np.stack(
        [covariance[4 * k : 4 * k + 4, 4 * k : 4 * k + 4] for k in range(count)]
    )


def test_the_path_is_the_fixed_point_of_weighted_least_squares() -> None:
    """Two stations, one of which knows elevations, with outliers and misses."""
    generator = np.random.default_rng(9)
    times = np.cumsum(generator.uniform(2.0, 8.0, 30))
    truth = np.array([600.0, 300.0]) + np.outer(times, [3.0, -2.0])
    stations = np.array([[0.0, 0.0], [500.0, -400.0]])[np.arange(30) % 2]
    offset = truth - stations
    distance = np.hypot(offset[:, 0], offset[:, 1])
    height = np.where(np.arange(30) % 2, -60.0, 0.0)
    deviation = np.where(np.arange(30) % 3, 0.02, 0.04)
    azimuth = np.arctan2(offset[:, 1], offset[:, 0]) + deviation * generator.normal(size=30)
    azimuth[7] += 0.6
    azimuth[12] = np.nan
    elevation = np.arctan2(height, distance) + deviation * generator.normal(size=30)
    elevation[::2] = np.nan
    history = DirectionHistory(times, stations, height, azimuth, elevation, deviation)
    parameters = DirectionSmootherConfiguration(
        acceleration=0.05, maximum_speed=8.0, systematic_deviation_deg=0.0, passes=40
    )
    found = smooth_directions(history, truth + 20.0, parameters)
    states, covariance = by_least_squares(history, found.mean[:, :2], parameters)
    spread = np.sqrt(np.einsum("nii->ni", covariance))
    assert np.max(np.abs(states - found.mean) / spread) < 1e-3
    scale = spread[:, :, None] * spread[:, None, :]
    np.testing.assert_allclose(found.covariance / scale, covariance / scale, atol=1e-3)


def test_a_systematic_error_is_that_of_all_stations_together() -> None:
    """Two stations at right angles fix a place to the error times the two distances."""
    history = DirectionHistory(
        times=np.arange(2.0),
        position=np.array([[0.0, 0.0], [1000.0, -500.0]]),
        height=np.zeros(2),
        azimuth=np.zeros(2),
        elevation=np.full(2, np.nan),
        deviation=np.full(2, 0.01),
    )
    path = np.array([[1000.0, 0.0], [1000.0, 0.0]])
    expected = np.diag([(0.01 * 500.0) ** 2, (0.01 * 1000.0) ** 2])
    for place in systematic_covariance(history, path, 0.01):
        assert place == pytest.approx(expected, rel=1e-4, abs=1e-6)
    # One station alone: along the line of sight nothing is known but the start.
    alone = DirectionHistory(
        *(column[:1] for column in (history.times, history.position, history.height)),
        *(column[:1] for column in (history.azimuth, history.elevation, history.deviation)),
    )
    (place,) = systematic_covariance(alone, path[:1], 0.01)
    assert place == pytest.approx(np.diag([3000.0**2, 10.0**2]), rel=2e-5)


def test_a_known_height_fixes_the_range_of_one_station_with_elevations() -> None:
    """A slope of h / (d^2 + h^2) by the range: 0.01 rad are 104 m at 1000 m over 100 m."""
    history = DirectionHistory(
        times=np.zeros(1),
        position=np.zeros((1, 2)),
        height=np.array([-100.0]),
        azimuth=np.zeros(1),
        elevation=np.zeros(1),
        deviation=np.full(1, 0.01),
    )
    (place,) = systematic_covariance(history, np.array([[1000.0, 0.0]]), 0.01)
    along = 0.01 * (1000.0**2 + 100.0**2) / 100.0
    across = 0.01 * np.hypot(1000.0, 100.0)  # an angle across is less in azimuth by the cosine
    assert place == pytest.approx(np.diag([along**2, across**2]), rel=2e-3)
