"""What may not enter the recursion is named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import line_array
from sonar_tracking.passive.subspaces.block_checks import (
    check_block,
    check_first_block,
    check_next_block,
)
from sonar_tracking.records.bearings import Sensor
from tests.passive.crossing_scene import EPOCH, POSITIONS, block_of, circular_noise

DATA = circular_noise(np.random.default_rng(1), 60, 15)


def spoiled(snapshot: int, element: int, value: complex) -> np.ndarray:
    data = DATA.copy()
    data[snapshot, element] = value
    return data


@pytest.mark.parametrize("value", [np.nan, np.inf, complex(0.0, -np.inf)])
def test_sample_that_is_no_number_is_named(value: complex) -> None:
    with pytest.raises(InputError, match="Element 3 of snapshot 17 is not a finite number"):
        check_block(block_of(spoiled(17, 3, value), EPOCH))


def test_zero_snapshots_and_wrong_columns() -> None:
    with pytest.raises(InputError, match="zero snapshots"):
        check_block(block_of(DATA[:0], EPOCH))
    with pytest.raises(InputError, match=r"shape \(60, 14\) but the array has 15 elements"):
        check_block(block_of(DATA[:, :14], EPOCH))
    with pytest.raises(InputError, match=r"must be \(n_elements, 3\)"):
        check_block(block_of(DATA, EPOCH, element_positions=POSITIONS[:, 0]))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"bandwidth": 300.0}, "filter to less than 21.4 Hz"),
        ({"center_frequency": 1600.0}, "bearings alias"),
        ({"sample_period": 0.0}, "sample_period is 0"),
        ({"sound_speed": np.nan}, "sound_speed is nan"),
        ({"bandwidth": -1.0}, "bandwidth is -1"),
        ({"element_positions": POSITIONS * np.nan}, "not a finite number"),
        ({"noise_covariance": np.eye(14, dtype=complex)}, r"shape \(14, 14\)"),
        ({"noise_covariance": -np.eye(15, dtype=complex)}, "positive definite"),
        ({"noise_covariance": 2.0 * np.eye(15, dtype=complex)}, "trace 30"),
    ],
)
def test_run_that_cannot_be_used_is_refused(changes: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        check_first_block(block_of(DATA, EPOCH, **changes), 5)


def test_more_sources_than_elements() -> None:
    check_first_block(block_of(DATA, EPOCH), 14)
    with pytest.raises(InputError, match="only 15 elements; give at most 14 sources"):
        check_first_block(block_of(DATA, EPOCH), 15)
    with pytest.raises(InputError, match="at least 2"):
        check_first_block(block_of(DATA[:, :1], EPOCH, element_positions=line_array(1, 0.5)), 0)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"sample_period": 0.01}, "sample_period changed from 0.005 to 0.01"),
        ({"center_frequency": 1400.0}, "center_frequency changed"),
        ({"element_positions": POSITIONS + 0.1}, "element_positions changed"),
        ({"noise_covariance": np.eye(15, dtype=complex)}, "noise_covariance changed"),
        ({"sensor": Sensor(sensor_id="stern")}, "stop the second publisher"),
        ({"data": DATA[None]}, "batch shape"),
    ],
)
def test_change_during_the_run_is_named(changes: dict[str, object], sentence: str) -> None:
    first = block_of(DATA, EPOCH)
    check_next_block(replace(first, stamp=EPOCH + 1), first)
    with pytest.raises(InputError, match=sentence):
        check_next_block(replace(first, **changes), first)  # type: ignore[arg-type]


@pytest.mark.parametrize("bandwidth", [0.0, 21.4])
def test_a_band_up_to_a_tenth_of_the_aperture_s_is_narrow(bandwidth: float) -> None:
    """1500 m/s over 7 m are 214 Hz."""
    check_first_block(block_of(DATA, EPOCH, bandwidth=bandwidth), 5)
    with pytest.raises(InputError, match=r"it must be below 0\.1"):
        check_first_block(block_of(DATA, EPOCH, bandwidth=1500.0 / 70.0), 5)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"sample_period": np.inf}, "sample_period is inf"),
        ({"sample_period": -0.1}, "sample_period is -0.1"),
        ({"center_frequency": 0.0}, "center_frequency is 0"),
        ({"sound_speed": 0.0}, "sound_speed is 0"),
        ({"bandwidth": np.inf}, "bandwidth is inf"),
        ({"bandwidth": np.nan}, "bandwidth is nan"),
        ({"noise_covariance": np.triu(np.ones((15, 15))) + 0j}, "positive definite"),
        ({"noise_covariance": np.ones((15, 15)) + 0j}, "positive definite"),
        ({"noise_covariance": (1.0 + 2e-6) * np.eye(15) + 0j}, "trace 15"),
        ({"noise_covariance": (1.0 - 2e-6) * np.eye(15) + 0j}, "trace 15"),
        ({"element_positions": np.zeros((15, 2))}, r"shape \(15, 2\)"),
    ],
)
def test_further_numbers_that_cannot_be_used(changes: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        check_first_block(block_of(DATA, EPOCH, **changes), 5)


def test_noise_of_unit_power_in_any_colour_is_accepted() -> None:
    for noise in (np.eye(15), (1.0 + 5e-7) * np.eye(15), np.diag([0.5, 1.5, *np.ones(13)])):
        check_first_block(block_of(DATA, EPOCH, noise_covariance=noise + 0j), 5)


def test_data_must_be_a_matrix_of_at_least_one_snapshot() -> None:
    check_block(block_of(DATA[:1], EPOCH))
    check_block(block_of(np.stack([DATA, DATA]), EPOCH))
    with pytest.raises(InputError, match=r"shape \(15,\)"):
        check_block(block_of(DATA[0], EPOCH))
    pair = np.stack([DATA, DATA])
    pair[1, 4, 2] = np.nan
    with pytest.raises(InputError, match=r"Element 2 of snapshot 4 .*1 such"):
        check_block(block_of(pair, EPOCH))


def test_every_setting_must_stay_as_it_was() -> None:
    first = block_of(DATA, EPOCH, noise_covariance=np.eye(15) + 0j)
    check_next_block(first, first)
    for name in ("bandwidth", "sound_speed"):
        with pytest.raises(InputError, match=f"{name} changed"):
            check_next_block(replace(first, **{name: 1.0}), first)  # type: ignore[arg-type]
    doubled: np.ndarray = 2.0 * np.eye(15, dtype=complex)
    for noise in (None, doubled):
        with pytest.raises(InputError, match="noise_covariance changed"):
            check_next_block(replace(first, noise_covariance=noise), first)
