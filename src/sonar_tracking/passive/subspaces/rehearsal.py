"""Made-up data, on which a stage does everything once before the first real data come.

Whatever a computation loads or lays out at its first use is then there: the first estimate is no
slower than the others. The data are those of a line of a few elements and far sources.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from sonar_tracking.records.time import END_OF_DATA, nanoseconds

_FREQUENCY, _SOUND_SPEED, _SAMPLE_PERIOD = 1000.0, 1500.0, 5e-3
_SPARE_ELEMENTS = 8
_SNAPSHOTS = 100
_SIGNAL = 10.0
_BEGIN = 1_000_000


def rehearsed_block(n_sources: int, n_snapshots: int, period: float) -> ArraySnapshots:
    """Return a block that is as wild as noise, the only one of its run, around a sample time.

    Parameters
    ----------
    n_sources : int
        That the array must be able to tell apart.
    n_snapshots : int
        Length of the block.
    period : float
        Sample times are its multiples, s.
    """
    positions = _positions(n_sources)
    # Generators of random numbers, for this alone, would take 3 MB of the node.
    number = np.arange(n_snapshots * len(positions)).reshape(n_snapshots, -1)
    data = (1.0 + 0.5 * np.cos(np.sqrt(7.0) * number)) * np.exp(1j * np.sqrt(3.0) * number**2)
    half = nanoseconds(_SAMPLE_PERIOD) * (n_snapshots // 2)
    return ArraySnapshots(
        stamp=_BEGIN * nanoseconds(period) - half,
        data=data,
        element_positions=positions,
        sample_period=_SAMPLE_PERIOD,
        center_frequency=_FREQUENCY,
        bandwidth=10.0,
        sound_speed=_SOUND_SPEED,
        next_stamp=END_OF_DATA,
    )


def rehearsed_estimates(angles: FloatArray, method: str, second: int) -> SubspaceEstimates:
    """Return estimates that a few sources give.

    Parameters
    ----------
    angles : ndarray, shape (n_sources,)
        Arrival angles, rad.
    method : str
        How the subspace is said to have been followed.
    second : int
        Of a run, s.
    """
    positions = _positions(len(angles))
    steering = _steering(positions, angles)
    covariance = np.eye(len(positions)) + _SIGNAL * steering @ steering.conj().T
    values, vectors = np.linalg.eigh(covariance)
    return SubspaceEstimates(
        stamp=(_BEGIN + second) * nanoseconds(1.0),
        method=method,
        basis=vectors[None, :, ::-1][..., : len(angles)],
        time_offsets=np.zeros(1),
        element_positions=positions,
        sample_period=_SAMPLE_PERIOD,
        center_frequency=_FREQUENCY,
        bandwidth=10.0,
        sound_speed=_SOUND_SPEED,
        effective_snapshots=float(_SNAPSHOTS),
        rank=len(angles),
        source_count=len(angles),
        covariance=covariance,
        covariance_snapshots=_SNAPSHOTS,
        covariance_time_offset=0.0,
        eigenvalues=values[::-1],
        noise_power=np.array(1.0),
    )


def _positions(n_sources: int) -> FloatArray:
    positions = np.zeros((n_sources + _SPARE_ELEMENTS, 3))
    positions[:, 0] = 0.5 * _SOUND_SPEED / _FREQUENCY * np.arange(len(positions))
    return positions


def _steering(positions: FloatArray, angles: FloatArray) -> ComplexArray:
    wavenumber = 2.0 * np.pi * _FREQUENCY / _SOUND_SPEED
    return steering_vectors(positions, angles, wavenumber)
