"""The exact information reduction factor of a PDA filter, and the threshold that maximises it.

How much of a clean measurement's information is left when it may be missed and hides in clutter:
q2 S = E[nu nu'] over the number of clutter points in the gate and where they fall. The published
nested integrals collapse into one: with 1/(b + sum e_j) = int exp(-t (b + sum e_j)) dt the sum over
a Poisson number of points becomes a compound Poisson transform. In a plane, with gate size g,

    q2     = (P_D / 2) int_0^inf exp(-t b) exp(rho V (phi(t) - 1)) G(t) dt,
    phi(t) = (2 / g^2) [E1(t exp(-g^2 / 2)) - E1(t)],
    G(t)   = int_0^g exp(-r^2) r^3 exp(-t exp(-r^2 / 2)) dr,
    b      = (2 / g^2) rho V (1 - P_D P_G) / P_D,    rho V = n P_F.

References
----------
Jung, Shin (2002), equations 15-18.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import exp1

from sonar_tracking.active.detection.detection_threshold import (
    GATE_SIZE,
    FalseAlarmLimits,
    checked_gate,
    detection_probability,
)
from sonar_tracking.records.arrays import FloatArray

LOG_INTEGRATION_VARIABLE = (-34.0, 14.0, 600)
"""Trapezoid in ln t: first, last, number of points; the integrand vanishes outside."""

SMALLEST_FALSE_ALARM_PROBABILITY = 1e-12
GRID_POINTS = 400


def exact_information_reduction(
    false_alarm_probability: ArrayLike,
    resolution_cells: float,
    signal_to_noise_ratio_linear: float,
) -> FloatArray:
    """Return q2 for a gate of 4 standard deviations in a plane.

    Parameters
    ----------
    false_alarm_probability : array_like, shape (...)
        P_F per resolution cell, probabilities.
    resolution_cells : float
        n, cells in the gate.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.

    Returns
    -------
    ndarray, shape (...)
        Pure numbers between 0 and 1.
    """
    probability = np.asarray(false_alarm_probability, dtype=np.float64)
    detection = detection_probability(probability, signal_to_noise_ratio_linear)
    return information_reduction(detection, resolution_cells * probability)


def information_reduction(
    detection_probability: ArrayLike, expected_clutter: ArrayLike
) -> FloatArray:
    """Return q2 for a probability of detection and a mean number of clutter points in the gate.

    Parameters
    ----------
    detection_probability : array_like, shape (...)
        P_D, probabilities.
    expected_clutter : array_like, shape (...)
        rho V, mean counts.

    Returns
    -------
    ndarray, shape (...)
        Pure numbers between 0 and 1.
    """
    detection = np.asarray(detection_probability, dtype=np.float64)
    clutter = np.asarray(expected_clutter, dtype=np.float64)
    variable, transform_minus_one, weights = _tables()
    probability_in_gate = 1.0 - np.exp(-0.5 * GATE_SIZE**2)
    missed = (1.0 - detection * probability_in_gate) / detection
    decay = (2.0 / GATE_SIZE**2) * clutter * missed
    exponent = -decay[..., None] * variable + clutter[..., None] * transform_minus_one
    return np.asarray(0.5 * detection * (np.exp(exponent) @ weights))


def optimal_false_alarm_probability(
    resolution_cells: float, signal_to_noise_ratio_linear: float, limits: FalseAlarmLimits
) -> float:
    """Return the P_F of greatest exact q2: a grid for the global maximum, then Brent's method.

    Parameters
    ----------
    resolution_cells : float
        n, cells in the gate; positive.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.
    limits : FalseAlarmLimits
        What the result is clamped to.

    Raises
    ------
    InputError
        If there are not more than 0 cells, or the ratio is negative or no number.
    """
    from scipy.optimize import minimize_scalar  # takes longer to load than a study to start

    cells, ratio = checked_gate(resolution_cells, signal_to_noise_ratio_linear)
    n_cells = float(cells)
    grid = np.linspace(np.log(SMALLEST_FALSE_ALARM_PROBABILITY), 0.0, GRID_POINTS)
    factors = exact_information_reduction(np.exp(grid), n_cells, ratio)
    best = int(np.argmax(factors))
    bounds = (grid[max(best - 1, 0)], grid[min(best + 1, GRID_POINTS - 1)])

    def loss(logarithm: float) -> float:
        return -float(exact_information_reduction(np.exp(logarithm), n_cells, ratio))

    refined = minimize_scalar(loss, bounds=bounds, method="bounded", options={"xatol": 1e-7})
    logarithm = refined.x if -refined.fun >= factors[best] else grid[best]
    return float(np.clip(np.exp(logarithm), limits.minimum, limits.maximum))


@lru_cache(maxsize=1)
def _tables() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return t, phi(t) - 1 and G(t) dt at the integration points."""
    first, last, count = LOG_INTEGRATION_VARIABLE
    logarithm = np.linspace(first, last, count)
    variable = np.exp(logarithm)
    smallest = np.exp(-0.5 * GATE_SIZE**2)
    transform = (2.0 / GATE_SIZE**2) * (exp1(variable * smallest) - exp1(variable))
    nodes, node_weights = np.polynomial.legendre.leggauss(200)
    radius = 0.5 * GATE_SIZE * (nodes + 1.0)
    node_weights = 0.5 * GATE_SIZE * node_weights * radius**3 * np.exp(-(radius**2))
    integral = np.exp(-variable[:, None] * np.exp(-0.5 * radius**2)) @ node_weights
    step = np.full(count, logarithm[1] - logarithm[0])
    step[[0, -1]] *= 0.5
    return variable, transform - 1.0, integral * variable * step
