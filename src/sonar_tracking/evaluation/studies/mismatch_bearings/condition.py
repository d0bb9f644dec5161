"""What a condition of the study consists of, and what makes its runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.run_synthesis import true_bearings
from sonar_tracking.evaluation.studies.doa_coherent import scenes as published
from sonar_tracking.evaluation.studies.mismatch_bearings.array_errors import ArrayErrors
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.records.arrays import ComplexArray
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.signals.snapshot_synthesis import (
    circular_gaussian,
    rounded_to_single,
    synthesize_snapshots,
)

Seeds = Sequence[np.random.SeedSequence]

BLOCK_SNAPSHOTS = 500


@dataclass(frozen=True)
class Condition:
    """One condition of the study.

    Attributes
    ----------
    name : str
        In tables.
    scenario : Scenario
        Array, noise and targets.
    told_process_noise_deg2 : float
        What the targets really do, deg^2/s^3: of the tracker that is told the truth, and of the
        bound.
    errors : ArrayErrors
        What is wrong with the array; whoever is told the truth has it corrected.
    published : published.Condition or None
        Where bursts are those of the study doa-coherent.
    faint : bool
        Whether the question is when a track starts: beside the defaults stands the chain without
        track-before-detect.
    names_before, names_after : tuple of float
        From, to: when targets have their names, and when they should have them again, s.
    """

    name: str
    scenario: Scenario
    told_process_noise_deg2: float = 1e-6
    errors: ArrayErrors = field(default_factory=ArrayErrors)
    published: published.Condition | None = None
    faint: bool = False
    names_before: tuple[float, float] = (0.0, 0.0)
    names_after: tuple[float, float] = (0.0, 0.0)

    @property
    def estimator(self) -> SubspaceConfiguration:
        """What a user knows: when there are data, and how many at a time."""
        if self.published is None:
            return SubspaceConfiguration()
        return SubspaceConfiguration(
            period=published.PERIOD,
            covariance_snapshots=published.BURST_SNAPSHOTS,
            covariance_alignment="centred",
        )

    @property
    def n_estimates(self) -> int:
        """How many estimates there are in a run, about."""
        return round(self.scenario.duration / self.estimator.period)

    @property
    def source_rank(self) -> int:
        """Rank of the sources; one less for each that is coherent with another."""
        return len(self.scenario.targets) if self.published is None else self.published.rank

    def noise_covariance(self) -> ComplexArray | None:
        """Return the covariance of the noise, (n_elements, n_elements), pure numbers."""
        if self.published is not None:
            return self.published.noise_covariance()
        covariance = self.scenario.noise.covariance(self.scenario.array.n_elements)
        return None if covariance is None else covariance.astype(np.complex128)

    def blocks(self, seeds: Seeds) -> Iterator[ArraySnapshots]:
        """Make the snapshots of several runs as an array without errors receives them.

        Parameters
        ----------
        seeds : sequence of SeedSequence
            One a run.

        Yields
        ------
        ArraySnapshots
            Data of shape (n_runs, n_snapshots, n_elements), and the truth about the noise.
        """
        if self.published is not None:
            yield from published.bursts(published.sources_of(self.published, seeds))
            return
        colour = self.noise_covariance()
        generators = [np.random.default_rng(seed) for seed in seeds]
        rate = self.scenario.array.snapshot_rate
        n_snapshots = round(self.scenario.duration * rate)
        for first in range(0, n_snapshots, BLOCK_SNAPSHOTS):
            end = min(first + BLOCK_SNAPSHOTS, n_snapshots)
            stamp = self.scenario.stamp(first / rate)
            after = END_OF_DATA if end == n_snapshots else self.scenario.stamp(end / rate)
            block = _described(self.scenario, stamp, colour)
            data = _received(self.scenario, colour, generators, np.arange(first, end) / rate)
            yield replace(block, data=data, next_stamp=after)


def _described(scenario: Scenario, stamp: int, colour: ComplexArray | None) -> ArraySnapshots:
    array = scenario.array
    return ArraySnapshots(
        stamp=stamp,
        data=np.empty((0, array.n_elements), dtype=np.complex128),
        element_positions=array.element_positions(),
        sample_period=1.0 / array.snapshot_rate,
        center_frequency=array.center_frequency,
        bandwidth=array.bandwidth,
        sound_speed=array.sound_speed,
        noise_covariance=colour,
    )


def _received(
    scenario: Scenario,
    colour: ComplexArray | None,
    generators: Sequence[np.random.Generator],
    times: np.ndarray,
) -> ComplexArray:
    """Return the snapshots of all runs, shape (n_runs, n_times, n_elements), linear amplitude."""
    positions, number = scenario.array.element_positions(), scenario.array.wavenumber()
    n_targets = len(scenario.targets)
    shape = (len(times), n_targets + len(positions))
    drawn = np.stack([circular_gaussian(generator, shape) for generator in generators])
    noise = drawn[..., n_targets:]
    if colour is not None:
        noise = noise @ np.linalg.cholesky(colour).T
    if n_targets == 0:
        return rounded_to_single(noise)
    levels = np.array([target.level_db for target in scenario.targets])
    signals = 10.0 ** (levels / 20.0) * drawn[..., :n_targets]
    angles, _ = true_bearings(scenario, times)
    return rounded_to_single(synthesize_snapshots(positions, number, angles, signals, noise))
