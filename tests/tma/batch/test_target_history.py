"""Protects what measurements are taken to say at a path: derivatives, sides, travel time."""

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.batch.target_history import AZIMUTH, ELEVATION, TargetHistory, rows_at


def history(n: int = 3, elevations: bool = True, speed: float = 1500.0) -> TargetHistory:
    """Return measurements of two stations, one line, which are anything."""
    generator = np.random.default_rng(4)
    nothing = np.full(n, np.nan)
    return TargetHistory(
        times=np.arange(float(n)),
        station=np.arange(n) % 2,
        position=generator.normal(0.0, 100.0, (n, 2)),
        velocity=generator.normal(0.0, 5.0, (n, 2)),
        azimuth=np.stack([np.full(n, 0.7), nothing], axis=1),
        azimuth_deviation=np.full(n, 0.01),
        elevation=np.full(n, 0.3) if elevations else nothing,
        elevation_deviation=np.full(n, 0.01),
        height=900.0,
        frequency=np.full((n, 1), 300.0),
        frequency_deviation=np.full((n, 1), 0.1),
        propagation_speed=speed,
    )


def path_of(one: TargetHistory) -> FloatArray:
    path = np.tile(np.array([1500.0, 1100.0, 4.0, -3.0]), (len(one.times), 1))
    lasting = np.zeros((len(path), 2 * one.n_errors))
    return np.concatenate([path, lasting, np.full((len(path), 1), 301.0)], axis=1)


@pytest.mark.parametrize("elevations", [True, False])
def test_derivatives_are_those_of_what_is_predicted(elevations: bool) -> None:
    """Neglected: that travel time and the spread of a lasting error depend on the position."""
    one = history(elevations=elevations, speed=np.inf)
    path = path_of(one)
    assert path.shape[1] == one.size
    there = rows_at(one, path)
    for column in range(one.size):
        step = 1e-4
        moved = path.copy()
        moved[:, column] += step
        found = (there.residual - rows_at(one, moved).residual) / step
        np.testing.assert_allclose(found, there.derivative[:, :, column], rtol=1e-4, atol=1e-7)


def test_the_target_is_seen_where_it_was_when_the_sound_left() -> None:
    """Straight east at 10 m/s, 1500 m north of the station: seen 10 m west of where it is."""
    one = history(1, elevations=False)
    one.position[:] = one.velocity[:] = 0.0
    path = path_of(one)
    path[0, :4], path[0, 4:6] = (0.0, 1500.0, 10.0, 0.0), 0.0
    one.azimuth[0, 0] = np.arctan2(1500.0, -10.0)
    assert rows_at(one, path).residual[0, AZIMUTH] == pytest.approx(0.0, abs=1e-6)


def test_of_two_sides_the_nearer_one_counts_and_what_is_not_there_is_nothing() -> None:
    one = history(2, elevations=False)
    path = path_of(one)
    seen = 0.7 - rows_at(one, path).residual[:, AZIMUTH]
    one.azimuth[:] = np.stack([seen + 2.0, seen - 0.02], axis=1)
    rows = rows_at(one, path)
    np.testing.assert_allclose(rows.residual[:, AZIMUTH], -0.02)
    assert not rows.present[:, ELEVATION].any() and not rows.derivative[:, ELEVATION].any()
    one.azimuth[1] = np.nan
    assert rows_at(one, path).present[:, AZIMUTH].tolist() == [True, False]
