"""What a condition of the study consists of, and what makes its runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.evaluation.studies.mismatch_positions.motions import zigzag
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, TmaScene, simulate_runs
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration

Seeds = Sequence[np.random.SeedSequence]

Draw = Callable[[TmaScene, Seeds], TmaRuns]
"""From a scene and the seeds of runs to the runs, with errors as they are."""

NO_TURNS = 1e9
"""Mean time between the manoeuvres of a target that never does, s."""

BELIEVING = RangeBankConfiguration(
    manoeuvre_interval=NO_TURNS,
    manoeuvre_acceleration=0.01,
    weave_speed=0.0,
    wander_acceleration=0.01,
    learn_errors=False,
)
"""Takes every error to be as told, and the target to go straight: all modes are the same."""


@dataclass(frozen=True)
class Condition:
    """One condition of the study.

    Attributes
    ----------
    name : str
        In tables.
    scene : TmaScene
        The truth but for the errors; the bound is that of its deviations, white.
    draw : callable
        Makes the runs.
    claimed_azimuth, claimed_frequency : float
        Deviations that the sensor claims, as multiples of those of the scene.
    told_azimuth, told_frequency : float
        White deviations that are equivalent to the true errors, as multiples.
    told : RangeBankConfiguration
        Parameters of the estimator that is told the truth.
    settled : int
        First frame whose rows count.
    """

    name: str
    scene: TmaScene
    draw: Draw = simulate_runs
    claimed_azimuth: float = 1.0
    claimed_frequency: float = 1.0
    told_azimuth: float = 1.0
    told_frequency: float = 1.0
    told: RangeBankConfiguration = field(default_factory=lambda: BELIEVING)
    settled: int = 100

    def claimed(self, runs: TmaRuns) -> TmaRuns:
        """Return runs as the sensor tells them."""
        return _with_deviations(runs, self.claimed_azimuth, self.claimed_frequency)

    def true(self, runs: TmaRuns) -> TmaRuns:
        """Return runs with deviations that are equivalent to the true errors."""
        return _with_deviations(runs, self.told_azimuth, self.told_frequency)


@dataclass(frozen=True)
class LastingErrors:
    """Draws runs whose errors last: exponentially correlated in time.

    Attributes
    ----------
    azimuth_time : float
        Time constant of all the error of azimuths, s; 0 = white.
    wander, wander_time : float
        Deviation and time constant of what the frequency of each line wanders by beside its white
        error, Hz and s.
    """

    azimuth_time: float = 0.0
    wander: float = 0.0
    wander_time: float = 1.0

    def __call__(self, scene: TmaScene, seeds: Seeds) -> TmaRuns:
        """Return the runs."""
        if self.azimuth_time > 0.0:
            exact = simulate_runs(replace(scene, azimuth_deviation=0.0), seeds)
            runs = replace(exact, scene=scene)
        else:
            runs = simulate_runs(scene, seeds)
        azimuth, frequency = runs.azimuth.copy(), runs.frequency.copy()
        for run, seed in enumerate(seeds):
            # Another stream than that of the runs themselves.
            generator = np.random.default_rng(
                np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, 1))
            )
            if self.azimuth_time > 0.0:
                errors = lasting(
                    generator.standard_normal((scene.times.size, 1)), self.azimuth_time
                )
                azimuth[run] += scene.azimuth_deviation * errors[:, 0]
            normal = generator.standard_normal(frequency.shape[1:])
            frequency[run] += self.wander * lasting(normal, self.wander_time)
        return replace(runs, azimuth=azimuth, frequency=frequency)


@dataclass(frozen=True)
class ZigZag:
    """Draws runs in which the target goes zig-zag.

    Attributes
    ----------
    angle_deg : float
        Between its two courses.
    interval : int
        Frames between turns.
    drawn : bool
        Whether each run begins with another turn, at another time; otherwise the first one is to
        port, after an interval.
    """

    angle_deg: float
    interval: int = 80
    drawn: bool = True

    def __call__(self, scene: TmaScene, seeds: Seeds) -> TmaRuns:
        """Return the runs."""
        parts = []
        for seed in seeds:
            first, side = self.interval, 1
            if self.drawn:
                generator = np.random.default_rng(seed.generate_state(4))
                first = 1 + int(generator.integers(self.interval))
                side = 1 if generator.random() < 0.5 else -1
            changes = zigzag(
                scene.target[2:], self.angle_deg, self.interval, scene.times.size, first, side
            )
            parts.append(simulate_runs(replace(scene, commanded=changes), [seed]))
        return TmaRuns(
            scene,
            np.concatenate([part.truth for part in parts]),
            np.concatenate([part.azimuth for part in parts]),
            np.concatenate([part.frequency for part in parts]),
        )


def lasting(normal: FloatArray, time_constant: float) -> FloatArray:
    """Return errors of variance one that last, made of independent ones.

    Parameters
    ----------
    normal : ndarray, shape (n_frames, n)
        Standard normal, pure numbers.
    time_constant : float
        In frames.

    Returns
    -------
    ndarray, shape (n_frames, n)
        Pure numbers.
    """
    phi = np.exp(-1.0 / time_constant)
    errors = normal.copy()
    for frame in range(1, len(errors)):
        errors[frame] = phi * errors[frame - 1] + np.sqrt(1.0 - phi**2) * normal[frame]
    return errors


def lasting_factor(time_constant: float) -> float:
    """Return the white deviation that is equivalent to an error that lasts so many frames."""
    phi = np.exp(-1.0 / time_constant)
    return float(np.sqrt((1.0 + phi) / (1.0 - phi)))


def _with_deviations(runs: TmaRuns, azimuth: float, frequency: float) -> TmaRuns:
    scene = runs.scene
    return replace(
        runs,
        scene=replace(
            scene,
            azimuth_deviation=azimuth * scene.azimuth_deviation,
            frequency_deviation=frequency * scene.frequency_deviation,
        ),
    )
