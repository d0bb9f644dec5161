"""Simulation of one array: blocks of snapshots with own ship and truth, from a scenario.

The random numbers of a snapshot are drawn together and in order, so that the data are a function
of the scenario alone: of neither pacing nor the size of the blocks (but for phases that are random
per block). Data are rounded to single precision, as messages carry them.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import ArraySnapshots, Sensor
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.scene_truth import true_bearings
from sonar_tracking.simulation.sensors.simulated_data import SimulatedBlock
from sonar_tracking.simulation.signals.snapshot_synthesis import (
    circular_gaussian,
    rounded_to_single,
    synthesize_snapshots,
)
from sonar_tracking.simulation.signals.source_signals import SourceSignals
from sonar_tracking.simulation.world.world_state import own_ship_at, true_tracks


class ArraySimulation:
    """Makes the blocks of a scenario, one after the other.

    Parameters
    ----------
    scenario : Scenario
        What to simulate.
    """

    def __init__(self, scenario: Scenario) -> None:
        array = scenario.array
        self._scenario = scenario
        self._receiver = scenario.receiver()
        self._positions = array.element_positions()
        self._n_snapshots = scenario.n_samples
        self._next = 0
        data_seed, phase_seed = np.random.SeedSequence(scenario.seed).spawn(2)
        self._generator = np.random.default_rng(data_seed)
        self._signals = SourceSignals(scenario.targets, np.random.default_rng(phase_seed))
        covariance = scenario.noise.covariance(len(self._positions))
        self._noise_covariance = None if covariance is None else covariance.astype(np.complex128)
        self._noise_factor = None if covariance is None else np.linalg.cholesky(covariance)

    def next_block(self) -> SimulatedBlock | None:
        """Return the next block, or None after the last one."""
        first = self._next
        if first >= self._n_snapshots:
            return None
        last = min(first + self._scenario.array.block_snapshots, self._n_snapshots)
        times = self._scenario.start + np.arange(first, last) / self._scenario.array.snapshot_rate
        angles, rates = self._arrivals(times)
        self._next = last

        next_stamp = END_OF_DATA if last == self._n_snapshots else self._stamp(last)
        begin = self._time(first)
        truth = true_bearings(self._scenario, begin, (angles[0], rates[0]), next_stamp)
        states = (own_ship_at(self._scenario, begin),) if first == 0 else ()
        return SimulatedBlock(
            snapshots=self._snapshots(times, angles, truth.stamp, next_stamp, truth.sensor),
            truth_bearings=truth,
            truth_tracks=true_tracks(self._scenario, begin, next_stamp),
            own_ship=(*states, own_ship_at(self._scenario, self._time(last))),
        )

    def _time(self, index: int) -> float:
        return self._scenario.start + index / self._scenario.array.snapshot_rate

    def _stamp(self, index: int) -> int:
        return self._scenario.stamp(self._time(index))

    def _arrivals(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        angles = np.empty((len(times), len(self._scenario.targets)))
        rates = np.empty_like(angles)
        for index, target in enumerate(self._scenario.targets):
            angles[:, index], rates[:, index] = target.motion.arrival(times, self._receiver)
        return angles, rates

    def _snapshots(
        self, times: FloatArray, angles: FloatArray, stamp: int, next_stamp: int, sensor: Sensor
    ) -> ArraySnapshots:
        array = self._scenario.array
        n_waveforms = self._signals.n_waveforms
        drawn = circular_gaussian(self._generator, (len(times), n_waveforms + len(self._positions)))
        noise = drawn[:, n_waveforms:]
        if self._noise_factor is not None:
            noise = noise @ self._noise_factor.T
        data = synthesize_snapshots(
            self._positions,
            array.wavenumber(),
            angles,
            self._signals.signals(times, drawn[:, :n_waveforms]),
            noise,
        )
        return ArraySnapshots(
            stamp=stamp,
            data=rounded_to_single(data),
            element_positions=self._positions,
            sample_period=1.0 / array.snapshot_rate,
            center_frequency=array.center_frequency,
            bandwidth=array.bandwidth,
            sound_speed=array.sound_speed,
            noise_covariance=self._noise_covariance,
            next_stamp=next_stamp,
            sensor=sensor,
        )
