"""One target, one track, clutter in its gate: the runs of the detection-threshold study.

The paper leaves process noise, measurement noise, cell size and start open; they are fixed here.
All systems of a run see the same target, the same measurement noise and the same clutter: points
of one stream on the unit disc, mapped into each system's own gate, with amplitudes drawn once
above the largest false-alarm probability and then cut by each system's threshold.

References
----------
Jung, Shin (2002), section 4 (Fig. 2).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import pdtr, pdtrik

from sonar_tracking.active.detection.detection_threshold import (
    GATE_SIZE,
    FalseAlarmLimits,
    closed_form_false_alarm_probability,
    detection_probability,
    detection_threshold,
    linear_from_decibel,
)
from sonar_tracking.active.detection.gate_association import (
    GateModel,
    amplitude_likelihood_ratio,
    associate_by_distance,
    associate_by_rank,
)
from sonar_tracking.active.detection.information_reduction import (
    exact_information_reduction,
    optimal_false_alarm_probability,
)
from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.filtering.kalman import KalmanState, predict, symmetrised
from sonar_tracking.records.arrays import FloatArray

INTERVAL = 1.0
N_SCANS = 35
POSITION_DEVIATION = 10.0
ACCELERATION_DEVIATION = 1.0
INITIAL_STATE = np.array([0.0, 0.0, 30.0, 20.0])
LIMITS = FalseAlarmLimits(1e-8, 0.3)

TRANSITION = np.kron(np.array([[1.0, INTERVAL], [0.0, 1.0]]), np.eye(2))
NOISE_GAIN = np.kron(np.array([[0.5 * INTERVAL**2], [INTERVAL]]), np.eye(2))
PROCESS_NOISE = ACCELERATION_DEVIATION**2 * NOISE_GAIN @ NOISE_GAIN.T
MEASUREMENT_NOISE = POSITION_DEVIATION**2 * np.eye(2)


@dataclass(frozen=True)
class ThresholdScene:
    """One condition: how strong the target is and how large a resolution cell.

    Attributes
    ----------
    level_db : float
        Signal-to-noise ratio, dB.
    cell_area : float
        m^2.
    """

    level_db: float
    cell_area: float

    @property
    def condition(self) -> str:
        """Name in tables."""
        return f"SNR {self.level_db:g} dB, cell {self.cell_area:g} m²"


SCENES = (ThresholdScene(10.0, 400.0), ThresholdScene(10.0, 1200.0), ThresholdScene(15.0, 100.0))


@dataclass(frozen=True)
class ThresholdSystem:
    """One tracker of the study.

    Attributes
    ----------
    association : str
        ``PDA``, ``HPDA`` or ``PDA with amplitude``.
    threshold : str
        ``closed form``, ``exact optimum`` or a fixed false-alarm probability.
    """

    association: str
    threshold: str

    @property
    def name(self) -> str:
        """Name in tables."""
        return f"{self.association}, {self.threshold}"


SYSTEMS = tuple(
    ThresholdSystem(association, threshold)
    for association, thresholds in (
        ("PDA", ("0.1", "0.01", "0.001", "closed form", "exact optimum")),
        ("HPDA", ("0.01", "closed form")),
        ("PDA with amplitude", ("0.1", "0.01", "closed form")),
    )
    for threshold in thresholds
)


@dataclass(frozen=True)
class ThresholdRuns:
    """Histories of one system in the runs of a batch.

    Attributes
    ----------
    error : ndarray, shape (n_runs, n_scans)
        Distance of estimate and target, m.
    information_reduction : ndarray, shape (n_runs, n_scans)
        Exact q2 at the thresholds used, pure numbers.
    """

    error: FloatArray
    information_reduction: FloatArray


def threshold_batch(batch: RunBatch) -> Mapping[tuple[str, str], ThresholdRuns]:
    """Track the runs of a batch with every system; keys are condition and system."""
    histories = {}
    for scene in SCENES:
        for system in SYSTEMS:
            runs = [track(scene, system, seed) for seed in batch.seeds]
            histories[scene.condition, system.name] = ThresholdRuns(
                np.array([run[0] for run in runs]), np.array([run[1] for run in runs])
            )
    return histories


def track(
    scene: ThresholdScene, system: ThresholdSystem, seed: np.random.SeedSequence
) -> tuple[FloatArray, FloatArray]:
    """Track one run with one system.

    Returns
    -------
    error, information_reduction : ndarray, shape (n_scans,)
        m; exact q2.
    """
    generator = np.random.default_rng(seed)
    scan_seeds = generator.integers(0, 2**63, N_SCANS)
    ratio = float(linear_from_decibel(scene.level_db))
    target = INITIAL_STATE.copy()
    state = _two_point_start(target, generator)
    errors, factors = np.empty(N_SCANS), np.empty(N_SCANS)
    for scan in range(N_SCANS):
        target = TRANSITION @ target + NOISE_GAIN @ generator.normal(0.0, ACCELERATION_DEVIATION, 2)
        predicted = predict(state, TRANSITION, PROCESS_NOISE)
        gate = _Gate.around(predicted)
        cells = gate.volume / scene.cell_area
        probability = _false_alarm_probability(system, cells, ratio)
        points, amplitudes = _contacts(
            np.random.default_rng(scan_seeds[scan]), target, gate, cells, ratio
        )
        threshold = float(detection_threshold(probability))
        kept = amplitudes > threshold
        model = GateModel(
            gate.volume,
            probability / scene.cell_area,
            float(detection_probability(probability, ratio)),
        )
        weights = _associate(system, gate, points[kept], amplitudes[kept], model, threshold, ratio)
        state = _updated(predicted, gate, points[kept], weights)
        errors[scan] = np.hypot(*(state.mean[:2] - target[:2]))
        factors[scan] = exact_information_reduction(probability, cells, ratio)
    return errors, factors


def riccati_error(scene: ThresholdScene, system: ThresholdSystem, settled: int) -> float:
    """Return the RMS position error the modified Riccati equation promises (equation 16), m.

    Parameters
    ----------
    scene : ThresholdScene
        Condition.
    system : ThresholdSystem
        Whose thresholds are used.
    settled : int
        Scans left out at the start.
    """
    ratio = float(linear_from_decibel(scene.level_db))
    state = KalmanState(INITIAL_STATE, _start_covariance())
    variances = np.empty(N_SCANS)
    for scan in range(N_SCANS):
        predicted = predict(state, TRANSITION, PROCESS_NOISE)
        gate = _Gate.around(predicted)
        cells = gate.volume / scene.cell_area
        probability = _false_alarm_probability(system, cells, ratio)
        factor = float(exact_information_reduction(probability, cells, ratio))
        reduction = factor * gate.gain @ gate.spread @ gate.gain.T
        state = KalmanState(INITIAL_STATE, symmetrised(predicted.covariance - reduction))
        variances[scan] = np.trace(state.covariance[:2, :2])
    return float(np.sqrt(np.mean(variances[settled:])))


@dataclass(frozen=True)
class _Gate:
    centre: FloatArray
    spread: FloatArray
    gain: FloatArray
    volume: float

    @classmethod
    def around(cls, predicted: KalmanState) -> _Gate:
        spread = predicted.covariance[:2, :2] + MEASUREMENT_NOISE
        gain = np.asarray(np.linalg.solve(spread, predicted.covariance[:2]).T, dtype=np.float64)
        volume = np.pi * GATE_SIZE**2 * np.sqrt(np.linalg.det(spread))
        return cls(predicted.mean[:2], spread, gain, float(volume))


def _start_covariance() -> FloatArray:
    blocks = np.array([[1.0, 1.0 / INTERVAL], [1.0 / INTERVAL, 2.0 / INTERVAL**2]])
    return np.kron(blocks, MEASUREMENT_NOISE) + PROCESS_NOISE


def _two_point_start(target: FloatArray, generator: np.random.Generator) -> KalmanState:
    before = target[:2] - INTERVAL * target[2:]
    plots = generator.normal([before, target[:2]], POSITION_DEVIATION)
    mean = np.concatenate([plots[1], (plots[1] - plots[0]) / INTERVAL])
    return KalmanState(mean, _start_covariance())


def _false_alarm_probability(system: ThresholdSystem, cells: float, ratio: float) -> float:
    if system.threshold == "closed form":
        return float(closed_form_false_alarm_probability(cells, ratio, LIMITS))
    if system.threshold == "exact optimum":
        return optimal_false_alarm_probability(cells, ratio, LIMITS)
    return float(system.threshold)


def _contacts(
    generator: np.random.Generator, target: FloatArray, gate: _Gate, cells: float, ratio: float
) -> tuple[FloatArray, FloatArray]:
    """Return positions and amplitudes inside the gate, the target's first if it is there."""
    noise, level = generator.normal(0.0, POSITION_DEVIATION, 2), generator.exponential()
    count = poisson_quantile(generator.random(), LIMITS.maximum * cells)
    # Row by row: a larger gate of another system sees the same first points.
    disc = generator.random((count, 3))
    radius, angle = np.sqrt(disc[:, 0]), 2.0 * np.pi * disc[:, 1]
    unit = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    clutter = gate.centre + GATE_SIZE * unit @ np.linalg.cholesky(gate.spread).T
    points = np.vstack([target[:2] + noise, clutter])
    amplitudes = -np.log(LIMITS.maximum) - np.log1p(-disc[:, 2])
    amplitudes = np.concatenate([[(1.0 + ratio) * level], amplitudes])
    innovations = points - gate.centre
    distance = np.sum(innovations * np.linalg.solve(gate.spread, innovations.T).T, axis=1)
    inside = distance < GATE_SIZE**2
    return points[inside], amplitudes[inside]


def poisson_quantile(probability: float, mean: float) -> int:
    """Return the least count that is not exceeded with a probability.

    As ``scipy.stats.poisson.ppf``, whose checks of its arguments take longer than all else.

    Parameters
    ----------
    probability : float
        Above 0, below 1.
    mean : float
        Mean count, positive.
    """
    count = int(np.ceil(pdtrik(probability, mean)))
    return count - 1 if count > 0 and pdtr(count - 1, mean) >= probability else count


def _associate(
    system: ThresholdSystem,
    gate: _Gate,
    points: FloatArray,
    amplitudes: FloatArray,
    model: GateModel,
    threshold: float,
    ratio: float,
) -> FloatArray:
    innovations = points - gate.centre
    distance = np.sum(innovations * np.linalg.solve(gate.spread, innovations.T).T, axis=1)
    densities = np.exp(-0.5 * distance) / (2.0 * np.pi * np.sqrt(np.linalg.det(gate.spread)))
    if system.association == "HPDA":
        return associate_by_rank(densities, amplitudes, model, ratio).probabilities
    if system.association == "PDA":
        return associate_by_distance(densities, model).probabilities
    ratios = amplitude_likelihood_ratio(amplitudes, threshold, ratio)
    return associate_by_distance(densities, model, ratios).probabilities


def _updated(
    predicted: KalmanState, gate: _Gate, points: FloatArray, weights: FloatArray
) -> KalmanState:
    """Return the mixture over the contacts and "none is the target's" (equations 9-14)."""
    innovations = points - gate.centre
    combined = weights @ innovations
    total = float(np.sum(weights))
    spread = (weights[:, None] * innovations).T @ innovations - np.outer(combined, combined)
    covariance = predicted.covariance - total * gate.gain @ gate.spread @ gate.gain.T
    covariance = covariance + gate.gain @ spread @ gate.gain.T
    return KalmanState(predicted.mean + gate.gain @ combined, symmetrised(covariance))
