"""Scenes of the doa-coherent study: two close and three crossing targets, coherent or not.

A burst of 32 snapshots every 8 s, in which the bearings stand still, on a line array of 15
elements at half a wavelength; sources at 0 dB. Coherent sources carry one waveform, each with a
phase of its own that is random and fixed in a run.

References
----------
Hwang, Kim, Kim, Park, Nam (2005), section 4. Courses that the paper leaves open are those under
which its published figures are met; its angle from the array axis is the arrival angle + 90 deg.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from sonar_tracking.evaluation.monte_carlo.run_synthesis import true_bearings
from sonar_tracking.geometry import steering_vectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.simulation.scenarios.bearing_motion import ArctangentMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.scenarios.target import TargetConfiguration
from sonar_tracking.simulation.signals.snapshot_synthesis import (
    circular_gaussian,
    rounded_to_single,
)

PERIOD = 8.0
"""Between bursts, s."""

STEPS = 80
STEP_TIMES = PERIOD * np.arange(1.0, STEPS + 1.0)
"""Sample times that are scored, s."""

BURST_SNAPSHOTS = 32
NOISE_CORRELATION = 0.6

CLOSE, CROSSING = "2 close", "3 crossing"
INCOHERENT, COHERENT = "incoherent", "coherent"
COLOURED, BOTH = "coloured noise", "coherent, coloured noise"


@dataclass(frozen=True)
class _Pass:
    """A target on a straight course past a fixed array.

    Attributes
    ----------
    angle_deg : float
        From the array axis at the closest point, as in the paper.
    closest_time : float
        s.
    closest_range : float
        m.
    speed : float
        m/s; negative = the angle falls.
    """

    angle_deg: float
    closest_time: float
    closest_range: float
    speed: float

    def motion(self) -> ArctangentMotion:
        """Return the history of the arrival angle."""
        rate = float(np.degrees(self.speed / self.closest_range))
        return ArctangentMotion(
            rate_deg=rate, crossing_time=self.closest_time, offset_deg=self.angle_deg - 90.0
        )


_PASSES = {
    CLOSE: (_Pass(50.0, 40.0, 1500.0, 4.0), _Pass(133.5, 600.0, 1500.0, 4.0)),
    CROSSING: (
        _Pass(83.0, 120.0, 1300.0, 3.0),
        _Pass(94.0, 20.0, 1400.0, -4.0),
        _Pass(69.0, 320.0, 2300.0, 5.0),
    ),
}


@dataclass(frozen=True)
class Condition:
    """A scene and what its sources and its noise are like.

    Attributes
    ----------
    scene : str
        ``"2 close"`` or ``"3 crossing"``.
    kind : str
        ``"incoherent"``, ``"coherent"``, ``"coloured noise"`` (with incoherent sources) or
        ``"coherent, coloured noise"``.
    """

    scene: str
    kind: str

    @property
    def name(self) -> str:
        """In tables and figures."""
        return f"{self.scene}, {self.kind}"

    @property
    def n_targets(self) -> int:
        """How many targets there are."""
        return len(_PASSES[self.scene])

    @property
    def coherent(self) -> bool:
        """Whether the sources emit one waveform."""
        return self.kind in (COHERENT, BOTH)

    @property
    def rank(self) -> int:
        """Rank of the source covariance."""
        return 1 if self.coherent else self.n_targets

    def noise_covariance(self) -> ComplexArray | None:
        """Return the spatial covariance of the noise.

        Returns
        -------
        ndarray, shape (n_elements, n_elements), complex, or None
            Pure numbers with trace n_elements; None = white.
        """
        if self.kind not in (COLOURED, BOTH):
            return None
        element = np.arange(self.scenario().array.n_elements)
        apart = np.abs(element[:, None] - element)
        return np.asarray(NOISE_CORRELATION**apart, dtype=np.complex128)

    def scenario(self) -> Scenario:
        """Return array and targets."""
        return _scenario(self.scene)


@cache
def _scenario(scene: str) -> Scenario:
    """Return a scene's array and targets, asked for at every burst."""
    targets = tuple(TargetConfiguration(motion=one.motion()) for one in _PASSES[scene])
    return replace(load_scenario("doa_fusion"), targets=targets, start=0.0, duration=PERIOD * STEPS)


CONDITIONS = (
    *(
        Condition(scene, kind)
        for scene in (CLOSE, CROSSING)
        for kind in (INCOHERENT, COHERENT, COLOURED)
    ),
    *(Condition(scene, BOTH) for scene in (CLOSE, CROSSING)),
)


@dataclass(frozen=True)
class Sources:
    """Sources of several runs under one condition.

    Attributes
    ----------
    condition : Condition
        The condition.
    generators : tuple of numpy.random.Generator
        One a run.
    weights : ndarray, shape (n_runs, n_waveforms, n_targets), complex
        Of each waveform in the signal of each target, linear amplitude.
    """

    condition: Condition
    generators: tuple[np.random.Generator, ...]
    weights: ComplexArray

    def covariances(self) -> ComplexArray:
        """Return each run's source covariance, (n_runs, n_targets, n_targets), linear power."""
        return np.swapaxes(self.weights, -1, -2) @ self.weights.conj()


def sources_of(condition: Condition, seeds: Sequence[np.random.SeedSequence]) -> Sources:
    """Return the sources of several runs.

    Parameters
    ----------
    condition : Condition
        The condition.
    seeds : sequence of SeedSequence
        One a run.
    """
    generators = tuple(np.random.default_rng(seed) for seed in seeds)
    n_targets = condition.n_targets
    if condition.coherent:
        phases = [generator.uniform(0.0, 2.0 * np.pi, n_targets) for generator in generators]
        weights = np.exp(1j * np.array(phases))[:, None, :]
    else:
        weights = np.broadcast_to(np.eye(n_targets) + 0j, (len(seeds), n_targets, n_targets))
    return Sources(condition, generators, weights)


def bursts(sources: Sources) -> Iterator[ArraySnapshots]:
    """Make the bursts of several runs, the first one at time 0.

    Parameters
    ----------
    sources : Sources
        Of all runs.

    Yields
    ------
    ArraySnapshots
        Data of shape (n_runs, 32, n_elements), centred on the sample time.
    """
    condition, scenario = sources.condition, sources.condition.scenario()
    array = scenario.array
    positions, colour = array.element_positions(), condition.noise_covariance()
    n_waveforms = sources.weights.shape[1]
    shape = (BURST_SNAPSHOTS, n_waveforms + len(positions))
    half = 0.5 * (BURST_SNAPSHOTS - 1) / array.snapshot_rate
    for time in PERIOD * np.arange(STEPS + 1.0):
        angles, _ = true_bearings(scenario, np.array([time]))
        drawn = np.stack([circular_gaussian(one, shape) for one in sources.generators])
        signals = drawn[..., :n_waveforms] @ sources.weights
        noise = drawn[..., n_waveforms:]
        if colour is not None:
            noise = noise @ np.linalg.cholesky(colour).T
        received = signals @ steering_vectors(positions, angles[0], array.wavenumber()).T + noise
        yield ArraySnapshots(
            stamp=scenario.stamp(float(time) - half),
            data=rounded_to_single(received),
            element_positions=positions,
            sample_period=1.0 / array.snapshot_rate,
            center_frequency=array.center_frequency,
            bandwidth=array.bandwidth,
            sound_speed=array.sound_speed,
            noise_covariance=colour,
        )


def scored_bearings(condition: Condition) -> tuple[FloatArray, FloatArray]:
    """Return the true bearings and their rates at the steps that are scored.

    Returns
    -------
    angles, rates : ndarray, shape (n_steps, n_targets)
        rad, rad/s.
    """
    return true_bearings(condition.scenario(), STEP_TIMES)
