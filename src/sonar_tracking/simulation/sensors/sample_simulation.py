"""Simulation of the broadband element time series of an array, from a scenario.

Every target emits its lines, with the exact phase at the emission time, and broadband noise; own
ship adds lines from the direction of its bow, and every element has noise of its own. Levels are
defined in :mod:`sonar_tracking.simulation.scenarios.hydrophone_configuration`. Each source draws
from a generator of its own in the order of time, so that the data are a function of the scenario
alone, not of the size of the blocks.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.target import TargetConfiguration
from sonar_tracking.simulation.sensors.scene_truth import true_bearings
from sonar_tracking.simulation.sensors.simulated_data import SimulatedSamples
from sonar_tracking.simulation.signals.broadband_waveform import BroadbandWaveform
from sonar_tracking.simulation.signals.sample_propagation import (
    element_emission_times,
    plane_wave_emission_times,
)
from sonar_tracking.simulation.world.world_state import own_ship_at, true_tracks


@dataclass(frozen=True)
class _BlockScene:
    """What a block has whatever the seed.

    Attributes
    ----------
    times : ndarray, shape (n_times,)
        Of the samples, s.
    emitted : tuple of ndarray, shape (n_times, n_elements)
        When what is received left each target that is heard, s.
    from_bow : ndarray, shape (n_times, n_elements)
        When own ship's lines left its bow, s.
    bearings : BearingTracks
        True ones at its begin.
    tracks : TruthTracks
        True ones at its begin.
    own_ship : tuple of OwnShipState
        At its end, and at the begin of the first block.
    """

    times: FloatArray
    emitted: tuple[FloatArray, ...]
    from_bow: FloatArray
    bearings: BearingTracks
    tracks: TruthTracks
    own_ship: tuple[OwnShipState, ...]


class SampleSimulation:
    """Makes the blocks of a scenario, one after the other.

    Parameters
    ----------
    scenario : Scenario
        Its section ``hydrophones`` gives sampling and own ship's lines, ``array`` the geometry,
        ``noise`` the correlation between the elements.

    Raises
    ------
    ConfigurationError
        If it has no section ``hydrophones``.
    """

    def __init__(self, scenario: Scenario) -> None:
        hydrophones = scenario.hydrophones
        if hydrophones is None:
            raise ConfigurationError(
                f"The scenario {scenario.name} has no section hydrophones; add one."
            )
        self._scenario = scenario
        self._hydrophones = hydrophones
        self._receiver = scenario.receiver()
        self._positions = scenario.array.element_positions()
        self._n_samples = scenario.n_samples
        self._next = 0
        seeds = np.random.SeedSequence(scenario.seed).spawn(2 + len(scenario.targets))
        generators = [np.random.default_rng(seed) for seed in seeds]
        self._noise_generator, own_ship_generator, *target_generators = generators
        self._own_ship_phases = own_ship_generator.uniform(
            0.0, 2.0 * np.pi, len(hydrophones.own_ship_line_frequencies)
        )
        self._sources = [
            _Source(target, hydrophones.sample_rate, generator)
            for target, generator in zip(scenario.targets, target_generators, strict=True)
            if target.heard
        ]
        covariance = scenario.noise.covariance(len(self._positions))
        self._noise_factor = None if covariance is None else np.linalg.cholesky(covariance)

    def next_block(self) -> SimulatedSamples | None:
        """Return the next block, or None after the last one."""
        blocks = self._next_blocks([self])
        return None if blocks is None else blocks[0]

    def _next_blocks(
        self, simulations: Sequence[SampleSimulation]
    ) -> tuple[SimulatedSamples, ...] | None:
        """Return the next block of this and of others that differ by their seeds alone."""
        first = self._next
        if first >= self._n_samples:
            return None
        scene = self._scene(first, min(first + self._hydrophones.block_samples, self._n_samples))
        return tuple(one._block(scene) for one in simulations)

    def _scene(self, first: int, last: int) -> _BlockScene:
        begin, end = self._time(first), self._time(last)
        times = self._scenario.start + np.arange(first, last) / self._hydrophones.sample_rate
        next_stamp = END_OF_DATA if last == self._n_samples else self._scenario.stamp(end)
        states = (own_ship_at(self._scenario, begin),) if first == 0 else ()
        from_bow = np.array(np.pi / 2.0 + self._receiver.mounting_yaw)
        return _BlockScene(
            times=times,
            emitted=tuple(
                element_emission_times(source.target.motion, self._receiver, self._positions, times)
                for source in self._sources
            ),
            from_bow=plane_wave_emission_times(
                from_bow, self._receiver.sound_speed, self._positions, times
            ),
            bearings=true_bearings(self._scenario, begin, self._arrivals(begin), next_stamp),
            tracks=true_tracks(self._scenario, begin, next_stamp),
            own_ship=(*states, own_ship_at(self._scenario, end)),
        )

    def _block(self, scene: _BlockScene) -> SimulatedSamples:
        """Return what is received in the next block, whose scene is given."""
        times, truth = scene.times, scene.bearings
        self._next += len(times)
        data = self._element_noise(len(times)) + self._own_ship_lines(scene.from_bow)
        for source, emitted in zip(self._sources, scene.emitted, strict=True):
            data += source.sound(emitted) * source.target.is_present(times)[:, None]
        samples = ArraySamples(
            stamp=truth.stamp,
            data=data.astype(np.float32).astype(np.float64),
            element_positions=self._positions,
            sample_rate=self._hydrophones.sample_rate,
            sound_speed=self._scenario.array.sound_speed,
            next_stamp=truth.next_stamp,
            sensor=truth.sensor,
        )
        return SimulatedSamples(samples, truth, scene.tracks, scene.own_ship)

    def _time(self, index: int) -> float:
        return self._scenario.start + index / self._hydrophones.sample_rate

    def _arrivals(self, time: float) -> tuple[FloatArray, FloatArray]:
        instant = np.array([time])
        arrivals = [
            target.motion.arrival(instant, self._receiver) for target in self._scenario.targets
        ]
        angles = np.array([angle[0] for angle, _ in arrivals])
        return angles, np.array([rate[0] for _, rate in arrivals])

    def _element_noise(self, n_times: int) -> FloatArray:
        noise = self._noise_generator.standard_normal((n_times, len(self._positions)))
        noise *= np.sqrt(0.5 * self._hydrophones.sample_rate)
        return noise if self._noise_factor is None else noise @ self._noise_factor.T

    def _own_ship_lines(self, emitted: FloatArray) -> FloatArray:
        """Lines that come along with the array, so that they have no Doppler."""
        sound = np.zeros_like(emitted)
        hydrophones = self._hydrophones
        for frequency, level_db, phase in zip(
            hydrophones.own_ship_line_frequencies,
            hydrophones.own_ship_line_levels_db,
            self._own_ship_phases,
            strict=True,
        ):
            sound += _tone(frequency, level_db, phase, emitted)
        return sound


def simulated_together(scenarios: Sequence[Scenario]) -> Iterator[tuple[SimulatedSamples, ...]]:
    """Yield the blocks of scenarios that differ by their seeds alone, one of each at a time.

    Parameters
    ----------
    scenarios : sequence of Scenario
        As :class:`SampleSimulation` takes them; where and when sound is emitted that the elements
        receive is computed once for all of them.

    Raises
    ------
    ConfigurationError
        If a scenario has no section ``hydrophones``.
    """
    simulations = [SampleSimulation(scenario) for scenario in scenarios]
    while (blocks := simulations[0]._next_blocks(simulations)) is not None:
        yield blocks


class _Source:
    """What one target emits."""

    def __init__(
        self, target: TargetConfiguration, rate: float, generator: np.random.Generator
    ) -> None:
        self.target = target
        self._phases = generator.uniform(0.0, 2.0 * np.pi, len(target.lines))
        self._waveform = BroadbandWaveform(generator, rate)
        self._amplitude = np.sqrt(0.5 * rate * 10.0 ** (target.level_db / 10.0))

    def sound(self, emitted: FloatArray) -> FloatArray:
        """Return the sound that left the target at the given times, s."""
        sound = self._amplitude * self._waveform.at(emitted)
        for line, phase in zip(self.target.lines, self._phases, strict=True):
            tone = _tone(line.frequency, line.level_db, phase, emitted)
            sound += tone * line.is_present(emitted)
        return sound


def _tone(frequency: float, level_db: float, phase: float, emitted: FloatArray) -> FloatArray:
    amplitude = np.sqrt(2.0 * 10.0 ** (level_db / 10.0))
    return np.asarray(amplitude * np.cos(2.0 * np.pi * frequency * emitted + phase))
