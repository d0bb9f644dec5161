"""Simulated data of any size for the bench: separated sources at 0 dB on a line array."""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import line_array
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import ArraySnapshots, SubspaceEstimates
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.signals.snapshot_synthesis import (
    circular_gaussian,
    synthesize_snapshots,
)

SIZES = (15, 64, 256, 512)
"""Elements."""

SOURCES = 5
PERIOD_SNAPSHOTS = 200
SOUND_SPEED = 1500.0
WAVELENGTH = 0.075
WAVENUMBER = 2.0 * np.pi / WAVELENGTH
SEED = 1


def bench_positions(n_elements: int) -> FloatArray:
    """Return elements half a wavelength apart, shape (n_elements, 3), m."""
    return line_array(n_elements, 0.5 * WAVELENGTH)


def bench_angles(n_sources: int) -> FloatArray:
    """Return arrival angles spread evenly in their sine, shape (n_sources,), rad."""
    return np.asarray(np.arcsin(np.linspace(-0.8, 0.8, n_sources)), dtype=np.float64)


def uneven_positions(n_elements: int) -> FloatArray:
    """Return elements near those of the uniform line, shape (n_elements, 3), m."""
    positions = bench_positions(n_elements)
    positions[:, 0] += np.random.default_rng(SEED).normal(0.0, 0.05 * WAVELENGTH, n_elements)
    return positions


def bench_snapshots(
    n_elements: int, n_sources: int, n_snapshots: int = PERIOD_SNAPSHOTS
) -> ComplexArray:
    """Return snapshots of separated sources at 0 dB, shape (n_snapshots, n_elements), linear."""
    return snapshots_at(bench_positions(n_elements), n_sources, n_snapshots)


def snapshots_at(positions: FloatArray, n_sources: int, n_snapshots: int) -> ComplexArray:
    """Return snapshots of separated sources at 0 dB.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        m.
    n_sources, n_snapshots : int
        How many.

    Returns
    -------
    ndarray, shape (n_snapshots, n_elements), complex
        Linear amplitude.
    """
    generator = np.random.default_rng(SEED)
    n_elements = len(positions)
    return synthesize_snapshots(
        positions,
        WAVENUMBER,
        np.broadcast_to(bench_angles(n_sources), (n_snapshots, n_sources)),
        circular_gaussian(generator, (n_snapshots, n_sources)),
        circular_gaussian(generator, (n_snapshots, n_elements)),
    )


def bench_covariance(n_elements: int, n_sources: int) -> ComplexArray:
    """Return the covariance of a period, shape (n_elements, n_elements), linear power."""
    data = bench_snapshots(n_elements, n_sources)
    return np.asarray(data.T @ data.conj() / len(data))


def bench_block(data: ComplexArray, stamp: int, sample_period: float) -> ArraySnapshots:
    """Return snapshots as the stages take them.

    Parameters
    ----------
    data : ndarray, shape (n_snapshots, n_elements), complex
        Linear amplitude.
    stamp : int
        Of the first one, ns.
    sample_period : float
        s.
    """
    return ArraySnapshots(
        stamp=stamp,
        data=data,
        element_positions=bench_positions(data.shape[1]),
        sample_period=sample_period,
        center_frequency=SOUND_SPEED / WAVELENGTH,
        bandwidth=0.0,
        sound_speed=SOUND_SPEED,
    )


def bench_estimates(data: ComplexArray, n_sources: int) -> tuple[SubspaceEstimates, ...]:
    """Return the subspaces of every period of the snapshots, seven a period.

    Parameters
    ----------
    data : ndarray, shape (n_snapshots, n_elements), complex
        Linear amplitude.
    n_sources : int
        Dimension of the subspaces.
    """
    stage = SubspaceStage(
        SubspaceConfiguration(
            method="covariance",
            period=1.0,
            source_count=n_sources,
            n_subspaces=7,
            covariance_snapshots=PERIOD_SNAPSHOTS,
        )
    )
    return stage.update(bench_block(data, NANOSECONDS, 1.0 / PERIOD_SNAPSHOTS)).estimates
