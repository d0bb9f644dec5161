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
