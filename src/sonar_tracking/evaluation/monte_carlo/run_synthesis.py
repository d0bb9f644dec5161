"""Snapshots of many runs of a scenario at several levels, for studies.

The runs of one batch lie in a leading dimension. Within a run all levels use the same waveforms and
the same noise (common random numbers), so that differences between levels, like those between
trackers on the same data, do not depend on luck.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.signals.snapshot_synthesis import (
    circular_gaussian,
    rounded_to_single,
    synthesize_snapshots,
)


def true_bearings(scenario: Scenario, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the true bearings and their rates.

    Parameters
    ----------
    scenario : Scenario
        Whose targets.
    times : ndarray, shape (n_times,)
        Scenario times, s.

    Returns
    -------
    angles, rates : ndarray, shape (n_times, n_targets)
        rad, rad/s.
    """
    receiver = scenario.receiver()
    arrivals = [target.motion.arrival(times, receiver) for target in scenario.targets]
    angles = np.stack([angle for angle, _ in arrivals], axis=-1)
    rates = np.stack([rate for _, rate in arrivals], axis=-1)
    return angles, rates


def snapshot_blocks(
    scenario: Scenario,
    seeds: Sequence[np.random.SeedSequence],
    levels_db: Sequence[float],
    block_snapshots: int,
) -> Iterator[ArraySnapshots]:
    """Make the snapshots of several runs, block by block.

    Parameters
    ----------
    scenario : Scenario
        Array, bearings, start and duration; the levels of its targets are replaced.
    seeds : sequence of SeedSequence
        One a run.
    levels_db : sequence of float
        Signal power over noise power per element, the same for all targets, dB.
    block_snapshots : int
        Snapshots in a block.

    Yields
    ------
    ArraySnapshots
        Data of shape (n_levels, n_runs, n_snapshots, n_elements).
    """
    array = scenario.array
    positions = array.element_positions()
    n_targets = len(scenario.targets)
    amplitudes = 10.0 ** (np.asarray(levels_db)[:, None, None, None] / 20.0)
    generators = [np.random.default_rng(seed) for seed in seeds]
    n_snapshots = round(scenario.duration * array.snapshot_rate)
    for first in range(0, n_snapshots, block_snapshots):
        last = min(first + block_snapshots, n_snapshots)
        times = scenario.start + np.arange(first, last) / array.snapshot_rate
        shape = (last - first, n_targets + len(positions))
        drawn = np.stack([circular_gaussian(generator, shape) for generator in generators])
        signals = amplitudes * drawn[..., :n_targets]
        noise = np.broadcast_to(drawn[..., n_targets:], (*signals.shape[:-1], len(positions)))
        angles, _ = true_bearings(scenario, times)
        data = synthesize_snapshots(positions, array.wavenumber(), angles, signals, noise)
        end = scenario.start + last / array.snapshot_rate
        yield ArraySnapshots(
            stamp=scenario.stamp(float(times[0])),
            data=rounded_to_single(data),
            element_positions=positions,
            sample_period=1.0 / array.snapshot_rate,
            center_frequency=array.center_frequency,
            bandwidth=array.bandwidth,
            sound_speed=array.sound_speed,
            next_stamp=END_OF_DATA if last == n_snapshots else scenario.stamp(end),
        )
