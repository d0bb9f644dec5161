"""Snapshots of many runs of a scenario at several levels, for studies.

The runs of one batch lie in a leading dimension. Within a run all levels use the same waveforms and
the same noise (common random numbers), so that differences between levels, like those between
trackers on the same data, do not depend on luck.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.scene_truth import array_sensor_at
from sonar_tracking.simulation.sensors.scene_truth import true_bearings as bearings_at
from sonar_tracking.simulation.signals.snapshot_synthesis import (
    circular_gaussian,
    rounded_to_single,
    synthesize_snapshots,
)
from sonar_tracking.simulation.signals.source_signals import SourceSignals

START_SECONDS = 2.0
"""At the beginning, in which long blocks are as short as those of the scenario."""


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
    if not scenario.targets:
        return np.empty((len(times), 0)), np.empty((len(times), 0))
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


def long_blocks(
    scenario: Scenario, seeds: Sequence[int], block_snapshots: int
) -> Iterator[ArraySnapshots]:
    """Make the snapshots of a scenario with each of several seeds, in blocks longer than its own.

    They are those of :class:`~sonar_tracking.simulation.sensors.array_simulation.ArraySimulation`,
    bit for bit, of white noise and signals whose phases do not change from block to block. What all
    runs have in common is made once. The first and the last blocks are those of the scenario: what
    a stage finds out at its start, and windows begun at the end, depend on where blocks end.

    Parameters
    ----------
    scenario : Scenario
        Whose seed is replaced.
    seeds : sequence of int
        One a run.
    block_snapshots : int
        Snapshots in a block.

    Yields
    ------
    ArraySnapshots
        Data of shape (n_runs, n_snapshots, n_elements).
    """
    array, positions = scenario.array, scenario.array.element_positions()
    sequences = [np.random.SeedSequence(seed).spawn(2) for seed in seeds]
    generators = [np.random.default_rng(data) for data, _ in sequences]
    signals = [SourceSignals(scenario.targets, np.random.default_rng(p)) for _, p in sequences]
    for first, end in pairwise(_block_ends(scenario, block_snapshots)):
        times = scenario.start + np.arange(first, end) / array.snapshot_rate
        shape = (end - first, signals[0].n_waveforms + len(positions))
        drawn = np.stack([circular_gaussian(generator, shape) for generator in generators])
        sounds = [
            one.signals(times, own[:, : one.n_waveforms])
            for one, own in zip(signals, drawn, strict=True)
        ]
        noise = drawn[..., signals[0].n_waveforms :]
        angles, _ = true_bearings(scenario, times)
        data = synthesize_snapshots(positions, array.wavenumber(), angles, np.stack(sounds), noise)
        begin, after = (scenario.start + index / array.snapshot_rate for index in (first, end))
        yield ArraySnapshots(
            stamp=scenario.stamp(begin),
            data=rounded_to_single(data),
            element_positions=positions,
            sample_period=1.0 / array.snapshot_rate,
            center_frequency=array.center_frequency,
            bandwidth=array.bandwidth,
            sound_speed=array.sound_speed,
            next_stamp=END_OF_DATA if end == _n_snapshots(scenario) else scenario.stamp(after),
            sensor=array_sensor_at(scenario, begin),
        )


def _n_snapshots(scenario: Scenario) -> int:
    return round(scenario.duration * scenario.array.snapshot_rate)


def _block_ends(scenario: Scenario, block_snapshots: int) -> list[int]:
    """Return where blocks begin, and where the last one ends."""
    own, n_snapshots = scenario.array.block_snapshots, _n_snapshots(scenario)
    last = (n_snapshots - 1) // own * own
    start = min(round(START_SECONDS * scenario.array.snapshot_rate) // own * own, last)
    return [*range(0, start, own), *range(start, last, block_snapshots), last, n_snapshots]


def block_truth(scenario: Scenario) -> tuple[BearingTracks, ...]:
    """Return the true bearings at the beginning of each block of a scenario, whatever its seed."""
    rate, n_block = scenario.array.snapshot_rate, scenario.array.block_snapshots
    begins = np.arange(0, _n_snapshots(scenario), n_block)
    times = scenario.start + begins / rate
    angles, rates = true_bearings(scenario, times)
    stamps = [*(scenario.stamp(float(time)) for time in times[1:]), END_OF_DATA]
    return tuple(
        bearings_at(scenario, float(time), (angles[row], rates[row]), stamps[row])
        for row, time in enumerate(times)
    )
