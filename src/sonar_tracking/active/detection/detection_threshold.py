"""The false-alarm probability that serves a tracker best, in closed form.

A threshold tau on the power z (noise mean 1, target mean 1 + SNR, both exponential) gives

    P_F = exp(-tau),    P_D = exp(-tau / (1 + SNR)) = P_F^(1 / (1 + SNR)).

A low one finds the target but fills the gate with clutter. The expected error after the next
update is least where the information reduction factor q2 is greatest; for its approximation in a
plane with a gate of 4 standard deviations,

    q2 = 0.997 P_D / (1 + 0.37 P_D^-1.57 n P_F),

the maximum has a closed form in the number n of resolution cells in the gate.

References
----------
Jung, Shin (2002), equations 2-3, 23 and 25; Kershaw, Evans (1996).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.records.arrays import FloatArray

GATE_SIZE = 4.0
"""Of the gate around a predicted position, standard deviations."""

SMALLEST_USEFUL_SIGNAL_TO_NOISE_RATIO = 1.57
"""Linear (1.96 dB): at and below it the approximate q2 only grows with P_F."""


@dataclass(frozen=True)
class FalseAlarmLimits:
    """Range a computed false-alarm probability is clamped to.

    Attributes
    ----------
    minimum, maximum : float
        Per resolution cell, 0 < minimum < maximum <= 1.

    Raises
    ------
    ConfigurationError
        If they are not in this order.
    """

    minimum: float = 1e-8
    maximum: float = 0.3

    def __post_init__(self) -> None:
        if not 0.0 < self.minimum < self.maximum <= 1.0:
            raise ConfigurationError(
                f"The limits of the false-alarm probability are {self.minimum:g} and "
                f"{self.maximum:g}; give 0 < minimum < maximum <= 1."
            )


def linear_from_decibel(level_db: ArrayLike) -> FloatArray:
    """Return a power ratio from its level in dB, shape (...): 10 dB is 10, 5 dB is 3.162."""
    return np.asarray(10.0 ** (np.asarray(level_db, dtype=np.float64) / 10.0))


def detection_threshold(false_alarm_probability: ArrayLike) -> FloatArray:
    """Return tau = -ln P_F (equation 2).

    Parameters
    ----------
    false_alarm_probability : array_like, shape (...)
        P_F, probabilities.

    Returns
    -------
    ndarray, shape (...)
        Linear power, noise mean 1.
    """
    return -np.log(np.asarray(false_alarm_probability, dtype=np.float64))


def detection_probability(
    false_alarm_probability: ArrayLike, signal_to_noise_ratio_linear: ArrayLike
) -> FloatArray:
    """Return P_D = P_F^(1 / (1 + SNR)) (equations 2 and 3).

    Parameters
    ----------
    false_alarm_probability : array_like, shape (...)
        P_F, probabilities.
    signal_to_noise_ratio_linear : array_like, shape (...)
        SNR as a power ratio, not in dB.

    Returns
    -------
    ndarray, shape (...)
        Probabilities.
    """
    exponent = 1.0 / (1.0 + np.asarray(signal_to_noise_ratio_linear, dtype=np.float64))
    return np.asarray(np.asarray(false_alarm_probability, dtype=np.float64) ** exponent)


def approximate_information_reduction(
    false_alarm_probability: ArrayLike,
    resolution_cells: ArrayLike,
    signal_to_noise_ratio_linear: ArrayLike,
) -> FloatArray:
    """Return q2 of equation 23: a plane, a gate of 4 standard deviations.

    Parameters
    ----------
    false_alarm_probability : array_like, shape (...)
        P_F per resolution cell, probabilities.
    resolution_cells : array_like, shape (...)
        n, cells in the gate; real, pure numbers.
    signal_to_noise_ratio_linear : array_like, shape (...)
        SNR as a power ratio, not in dB.

    Returns
    -------
    ndarray, shape (...)
        Pure numbers between 0 and 1.
    """
    probability = np.asarray(false_alarm_probability, dtype=np.float64)
    detection = detection_probability(probability, signal_to_noise_ratio_linear)
    clutter = np.asarray(resolution_cells, dtype=np.float64) * probability
    return np.asarray(0.997 * detection / (1.0 + 0.37 * detection**-1.57 * clutter))


def closed_form_false_alarm_probability(
    resolution_cells: ArrayLike,
    signal_to_noise_ratio_linear: float,
    limits: FalseAlarmLimits,
) -> FloatArray:
    """Return P_F* = (0.37 n (SNR - 1.57))^(-(1 + SNR) / (SNR - 0.57)), clamped (equation 25).

    Parameters
    ----------
    resolution_cells : array_like, shape (...)
        n, cells in the gate; positive, pure numbers.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB. At 1.57 and below the result is the upper limit.
    limits : FalseAlarmLimits
        What the result is clamped to.

    Returns
    -------
    ndarray, shape (...)
        Probabilities.

    Raises
    ------
    InputError
        If there are not more than 0 cells, or the ratio is negative or no number.
    """
    cells, ratio = checked_gate(resolution_cells, signal_to_noise_ratio_linear)
    if ratio <= SMALLEST_USEFUL_SIGNAL_TO_NOISE_RATIO:
        return np.full_like(cells, limits.maximum)
    base = 0.37 * cells * (ratio - SMALLEST_USEFUL_SIGNAL_TO_NOISE_RATIO)
    exponent = (1.0 + ratio) / (ratio - 0.57)
    # The logarithm is clamped, since the power itself overflows just above the smallest ratio.
    logarithm = -exponent * np.log(base)
    return np.exp(np.clip(logarithm, np.log(limits.minimum), np.log(limits.maximum)))


def checked_gate(
    resolution_cells: ArrayLike, signal_to_noise_ratio_linear: float
) -> tuple[FloatArray, float]:
    """Return cells and ratio as floats.

    Parameters
    ----------
    resolution_cells : array_like, shape (...)
        n, cells in the gate; pure numbers.
    signal_to_noise_ratio_linear : float
        SNR as a power ratio, not in dB.

    Returns
    -------
    cells : ndarray, shape (...)
        Pure numbers.
    ratio : float
        Linear.

    Raises
    ------
    InputError
        If there are not more than 0 cells, or the ratio is negative or no number.
    """
    cells = np.asarray(resolution_cells, dtype=np.float64)
    if not np.all(cells > 0.0) or not np.all(np.isfinite(cells)):
        raise InputError(
            "The number of resolution cells in the gate must be positive and finite; "
            "check the gate volume and the cell size."
        )
    ratio = float(signal_to_noise_ratio_linear)
    if not (np.isfinite(ratio) and ratio >= 0.0):
        raise InputError(
            f"The signal-to-noise ratio is {ratio:g}; give a linear power ratio of at least 0 "
            "(a level in dB has to be converted)."
        )
    return cells, ratio
