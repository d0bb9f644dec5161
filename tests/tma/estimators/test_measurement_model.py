"""Protects the measurement equations and their derivatives."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators import measurement_model
from sonar_tracking.tma.estimators.measurement_model import linearise, range_rate
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.estimators.travel_time import offset_seen


def measurement(azimuth: float = 0.3, frequency: float = 300.0) -> TmaMeasurement:
    return TmaMeasurement(
        stamp=1,
        position=np.array([100.0, -50.0]),
        velocity=np.array([3.0, 2.0]),
        azimuth=np.array([azimuth]),
        azimuth_variance=np.array(1e-4),
        frequency=np.array([frequency, np.nan]),
        frequency_deviation=np.array([1.0, 1.0]),
        elevation=np.array(0.5),
        elevation_variance=np.array(1e-4),
        height=900.0,
    )


STATE = np.array([[1200.0, 700.0, -4.0, 5.0, 301.0, 200.0]])
KNOWN = np.array([True, True])


def test_derivatives_are_those_of_the_prediction() -> None:
    frame = measurement()
    rows = linearise(STATE, frame, KNOWN, frame.azimuth)
    for column in range(6):
        step = np.zeros((1, 6))
        step[0, column] = 1e-3
        above = linearise(STATE + step, frame, KNOWN, frame.azimuth).innovation
        below = linearise(STATE - step, frame, KNOWN, frame.azimuth).innovation
        numerical = (below - above) / 2e-3
        np.testing.assert_allclose(rows.derivative[..., column], numerical, rtol=1e-6, atol=1e-9)


def test_range_rate_is_relative_to_the_moving_sensor() -> None:
    frame = measurement()
    together = STATE.copy()
    together[0, 2:4] = frame.velocity
    assert range_rate(together, frame) == pytest.approx(0.0)


@pytest.mark.parametrize("turn", [0.0, 2 * np.pi, -2 * np.pi])
def test_azimuths_across_the_cut_are_neighbours(turn: float) -> None:
    state = np.array([[100.0 - 1000.0, -50.0 - 1.0, 0.0, 0.0, 301.0, 200.0]])
    frame = measurement(azimuth=np.pi - 0.001 + turn)
    assert linearise(state, frame, KNOWN, frame.azimuth).innovation[0, 0] == pytest.approx(-0.002)


def test_what_is_not_there_changes_nothing() -> None:
    frame = measurement(azimuth=np.nan)
    rows = linearise(STATE, frame, np.array([False, True]), frame.azimuth)
    assert rows.present.tolist() == [[False, True, False, False]]
    assert np.all(rows.innovation[~rows.present] == 0.0)
    assert np.all(rows.derivative[~rows.present] == 0.0)
    assert np.all(rows.variance[~rows.present] == 1.0)


def test_unless_told_otherwise_sound_takes_no_time() -> None:
    frame = measurement()
    assert frame.propagation_speed == np.inf
    offset, delay = offset_seen(STATE[0, :4], frame.position, frame.propagation_speed)
    assert offset.tolist() == [1100.0, 750.0]
    assert delay == 0.0


@pytest.mark.skipif(measurement_model.COMPILED is None, reason="no compiler was there")
@pytest.mark.parametrize("vertical", [False, True])
@pytest.mark.parametrize("batch", [(), (5,), (2, 3)])
def test_compiled_rows_give_the_bits_of_numpy(
    batch: tuple[int, ...], vertical: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two sides, some gaps, sound that takes time; what is measured of each run or of all."""
    generator = np.random.default_rng(3)
    states = generator.normal(0.0, 2000.0, (*batch, 4, 6 + 2 * vertical + 4))
    states[..., 2:4] /= 500.0
    states[..., 0, :2] = [100.0, -50.0]
    frequency = generator.uniform(100.0, 300.0, (*batch, 2))
    frequency[generator.random(frequency.shape) < 0.3] = np.nan
    frame = replace(
        measurement(),
        azimuth=generator.uniform(-7.0, 7.0, (*batch, 2)),
        frequency=frequency,
        frequency_deviation=generator.uniform(0.1, 1.0, 2),
        elevation=np.where(generator.random(batch) < 0.5, np.nan, generator.random(batch)),
        propagation_speed=1500.0,
        sensor_z=-30.0,
    )
    known = generator.random((*batch, 2)) < 0.8
    compiled = linearise(states, frame, known)
    monkeypatch.setattr(measurement_model, "COMPILED", None)
    plain = linearise(states, frame, known)
    for name in ("innovation", "derivative", "variance", "present"):
        np.testing.assert_array_equal(getattr(compiled, name), getattr(plain, name), name)
