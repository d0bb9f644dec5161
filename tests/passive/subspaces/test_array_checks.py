"""Protects the bearing grids from arrays and waves that they cannot be made for."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import line_array
from sonar_tracking.passive.subspaces.array_checks import check_array


@pytest.mark.parametrize("length", [1.001e-4, 0.5, 599.9])
def test_a_ten_thousandth_to_six_hundred_wavelengths_can_be_searched(length: float) -> None:
    check_array(line_array(2, length), 1500.0, 1500.0)


@pytest.mark.parametrize(
    ("length", "frequency"), [(0.0, 1500.0), (0.999e-4, 1500.0), (600.1, 1500.0), (1.0, 1e6)]
)
def test_shorter_and_longer_ones_are_refused(length: float, frequency: float) -> None:
    with pytest.raises(InputError, match="Check the units"):
        check_array(line_array(2, length), frequency, 1500.0)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_a_wave_has_a_frequency_and_a_speed(value: float) -> None:
    with pytest.raises(InputError, match="center_frequency is"):
        check_array(line_array(2, 0.5), value, 1500.0)
    with pytest.raises(InputError, match="sound_speed is"):
        check_array(line_array(2, 0.5), 1500.0, value)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_positions_are_numbers(value: float) -> None:
    positions = line_array(3, 0.5)
    positions[1, 2] = value
    with pytest.raises(InputError, match="element position"):
        check_array(positions, 1500.0, 1500.0)
