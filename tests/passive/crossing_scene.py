"""Five crossing bearings seen by a line array of 15 elements: data shared by the tests."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.records.time import END_OF_DATA

EPOCH = 1_767_225_600 * 1_000_000_000
SOUND_SPEED = 1500.0
FREQUENCY = 1500.0
POSITIONS = line_array(15, 0.5)
WAVENUMBER = wavenumber(FREQUENCY, SOUND_SPEED)
SAMPLE_PERIOD = 1.0 / 200.0

_RATES = np.deg2rad([2.6, 3.0, 0.9, -2.6, -2.5])
_CROSSINGS = np.array([23.0, 35.0, 35.0, 36.0, -3.0])


def crossing_angles(times: ArrayLike) -> FloatArray:
    """Return the five arrival angles, shape (..., 5), rad."""
    return np.arctan(_RATES * (np.asarray(times)[..., None] - _CROSSINGS))


def crossing_rates(times: ArrayLike) -> FloatArray:
    """Return the rates of the five arrival angles, shape (..., 5), rad/s."""
    phase = _RATES * (np.asarray(times)[..., None] - _CROSSINGS)
    return _RATES / (1.0 + phase**2)


def circular_noise(generator: np.random.Generator, *shape: int) -> ComplexArray:
    """Return circular Gaussian noise of unit power."""
    real, imaginary = generator.standard_normal(shape), generator.standard_normal(shape)
    return (real + 1j * imaginary) / np.sqrt(2.0)


def snapshots_of(
    generator: np.random.Generator,
    angles: FloatArray,
    level_db: float | Sequence[float],
    batch: tuple[int, ...] = (),
    positions: FloatArray = POSITIONS,
) -> ComplexArray:
    """Return snapshots in unit noise of sources at angles (n_snapshots, n_sources)."""
    n_snapshots, n_sources = angles.shape
    vectors = steering_vectors(positions, angles, WAVENUMBER)
    amplitude = 10.0 ** (np.asarray(level_db) / 20.0)
    sources = amplitude * circular_noise(generator, *batch, n_snapshots, n_sources)
    clean = np.matmul(vectors, sources[..., None])[..., 0]
    return clean + circular_noise(generator, *batch, n_snapshots, len(positions))


def crossing_data(
    seed: int, level_db: float, last_time: float, batch: tuple[int, ...] = ()
) -> ComplexArray:
    """Return snapshots from t = -1 s to three snapshots after ``last_time``."""
    times = np.arange(-200, round(last_time * 200) + 4) * SAMPLE_PERIOD
    generator = np.random.default_rng(seed)
    return snapshots_of(generator, crossing_angles(times), level_db, batch)


def block_of(data: ComplexArray, stamp: int, **changes: object) -> ArraySnapshots:
    """Return one block of snapshots of the scene's array."""
    values: dict[str, object] = {
        "stamp": stamp,
        "data": data,
        "element_positions": POSITIONS,
        "sample_period": SAMPLE_PERIOD,
        "center_frequency": FREQUENCY,
        "bandwidth": 10.0,
        "sound_speed": SOUND_SPEED,
    }
    return ArraySnapshots(**{**values, **changes})  # type: ignore[arg-type]


def blocks_of(
    data: ComplexArray,
    size: int = 20,
    start: int = EPOCH - 1_000_000_000,
    period: float = SAMPLE_PERIOD,
    end: bool = False,
    **changes: object,
) -> Iterator[ArraySnapshots]:
    """Cut snapshots into contiguous blocks; ``end`` marks the last one as the end of data."""
    count = data.shape[-2]
    for first in range(0, count, size):
        last = first + size >= count
        yield block_of(
            data[..., first : first + size, :],
            start + round(first * period * 1e9),
            sample_period=period,
            next_stamp=END_OF_DATA if end and last else 0,
            **changes,
        )
