"""A target moves straight or manoeuvres: two modes of each range hypothesis, interacting.

The modes differ in their process noise. Before each prediction every mode takes over from the
other what may have changed into it meanwhile (Markov chain in continuous time, so that irregular
frames are no matter). Nothing need be decided: while the data do not tell a turn from a straight
path the estimate's covariance holds both, and a turn that is none costs next to nothing.

A vessel that manoeuvres changes its course rather than its speed: with velocity v, turn rate w and
J the rotation by 90 degrees its acceleration is w J v. With white turn rate of spectral density s

    d E[v] / dt = -s / 2 E[v],   d E[v v^T] / dt = s (J E[v v^T] J^T - E[v v^T]):

the noise is across the course where that is known, the same in all directions where it is not, and
E |v|^2 stays. s is such that the acceleration has the density that is configured.

The two modes of a hypothesis are neighbours in the bank: straight, then manoeuvring.

References
----------
Blom and Bar-Shalom, "The interacting multiple model algorithm for systems with Markovian switching
coefficients", IEEE Trans. Automatic Control 33(8), 1988.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, add_acceleration
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC

MODES = 2
"""Of motion: straight, manoeuvring."""

STRAIGHT, MANOEUVRING = 0, 1

import os
CHANGE,SLOW=float(os.environ.get('CH','.3')),float(os.environ.get('SL','2.'))
LEAST_POWER, LEAST_TURN = 1e-6, 1e-6
"""Of the mean square speed, m^2/s^2, and of the turn variance of a prediction, rad^2: below it
rounding would count."""


def with_modes(bank: HypothesisBank, interval: float, duration: float) -> HypothesisBank:
    """Return a bank in which each component has become two, equal but for their weights.

    Parameters
    ----------
    bank : HypothesisBank
        Without modes.
    interval, duration : float
        Mean time between manoeuvres, and of a manoeuvre, s.
    """
    share = np.log(np.array([interval, duration]) / (interval + duration))
    return HypothesisBank(
        np.repeat(bank.mean, MODES, axis=-2),
        np.repeat(bank.covariance, MODES, axis=-3),
        (bank.log_weight[..., None] + share).reshape(*bank.log_weight.shape[:-1], -1),
        bank.known,
    )


def mix_modes(
    bank: HypothesisBank, elapsed: FloatArray, interval: float, duration: float
) -> HypothesisBank:
    """Return the bank after the modes have had time to change into each other.

    Parameters
    ----------
    bank : HypothesisBank
        Every component a batch entry of its own, shape (n_components, 1).
    elapsed : ndarray, shape (n_components,)
        Time since the last measurement of each component, s.
    interval, duration : float
        Mean time between manoeuvres, and of a manoeuvre, s.
    """
    before = bank.log_weight.reshape(-1, MODES)
    joint = before[:, :, None] + _log_transition(elapsed[::MODES], interval, duration)
    after = np.logaddexp(joint[:, 0], joint[:, 1])
    # Share of what comes from the other mode in each.
    other = np.stack(
        [np.exp(joint[:, 1, 0] - after[:, 0]), np.exp(joint[:, 0, 1] - after[:, 1])], 1
    )
    size = bank.mean.shape[-1]
    mean = bank.mean.reshape(-1, MODES, size)
    covariance = bank.covariance.reshape(-1, MODES, size, size)
    step = (mean[:, ::-1] - mean) * other[..., None]
    apart = mean[:, 1] - mean[:, 0]
    between = (other * (1.0 - other))[..., None, None] * (
        apart[:, None, :, None] * apart[:, None, None, :]
    )
    swapped = covariance[:, ::-1] - covariance
    mixed = covariance + other[..., None, None] * swapped + between
    return replace(
        bank,
        mean=(mean + step).reshape(bank.mean.shape),
        covariance=mixed.reshape(bank.covariance.shape),
        log_weight=after.reshape(bank.log_weight.shape),
    )


def predict_modes(
    bank: HypothesisBank, elapsed: FloatArray, acceleration: float, manoeuvre_acceleration: float
) -> HypothesisBank:
    """Return the bank after each component has moved as its mode says.

    Parameters
    ----------
    bank : HypothesisBank
        Every component a batch entry of its own, shape (n_components, 1).
    elapsed : ndarray, shape (n_components,)
        s.
    acceleration : float
        Process noise of both modes, m/s^2.
    manoeuvre_acceleration : float
        Of turns: root mean square of the two axes, m/s^2.
    """
    turning = slice(MANOEUVRING, None, MODES)
    velocity = bank.mean[turning, 0, 2:KINEMATIC]
    second = velocity[:, :, None] * velocity[:, None, :]
    second += bank.covariance[turning, 0, 2:KINEMATIC, 2:KINEMATIC]
    power = np.maximum(second[:, 0, 0] + second[:, 1, 1], LEAST_POWER)
    step = elapsed[turning]
    rate = manoeuvre_acceleration**2 / np.maximum(power, SLOW**2)
    turned = np.maximum(rate * step, LEAST_TURN)
    kept, reach = np.ones((len(elapsed), 1, 1)), elapsed[:, None, None].copy()
    kept[turning, 0, 0], reach[turning, 0, 0] = np.exp(-turned), _reach(turned) * step
    # As if the velocity decayed.
    mean, covariance = bank.mean.copy(), bank.covariance.copy()
    mean[..., :2] += reach * mean[..., 2:KINEMATIC]
    mean[..., 2:KINEMATIC] *= kept
    kept, reach = kept[..., None], reach[..., None]
    covariance[..., :2, :] += reach * covariance[..., 2:KINEMATIC, :]
    covariance[..., :, :2] += reach * covariance[..., :, 2:KINEMATIC]
    covariance[..., 2:KINEMATIC, :] *= kept
    covariance[..., :, 2:KINEMATIC] *= kept
    density = np.full((len(elapsed), 1), acceleration**2)
    density[turning, 0] += (CHANGE * manoeuvre_acceleration) ** 2
    density[turning, 0] += rate * np.maximum(SLOW**2 - power, 0.0)
    add_acceleration(covariance, elapsed[:, None], density)
    _add_turns(covariance[turning, 0], second, step, turned)
    return replace(bank, mean=mean, covariance=covariance)


def _reach(turned: FloatArray) -> FloatArray:
    """Return how far a target is expected to come, in parts of a straight path."""
    return np.asarray(-np.expm1(-turned) / turned)


def _add_turns(
    covariance: FloatArray, second: FloatArray, step: FloatArray, turned: FloatArray
) -> None:
    """Add what turns do beyond the decay of the velocity, in place.

    The equations of the module in closed form; E[v v^T] has a part that is the same in all
    directions, and an uneven one.

    Parameters
    ----------
    covariance : ndarray, shape (n, 4 + n_lines, 4 + n_lines)
        Of the states.
    second : ndarray, shape (n, 2, 2)
        E[v v^T] before, m^2/s^2.
    step, turned : ndarray, shape (n,)
        t, s; and s t / 2, a pure number.
    """
    t, x = step[:, None, None], turned[:, None, None]
    even = 0.5 * (second[:, :1, :1] + second[:, 1:, 1:]) * np.eye(2)
    uneven = second - even
    kept, kept_twice, reach = np.exp(-x), np.exp(-2.0 * x), _reach(x)
    once, four_times = -np.expm1(-x), -np.expm1(-4.0 * x)
    together = kept * -np.expm1(-3.0 * x) / (3.0 * x)
    position, velocity = slice(2), slice(2, KINEMATIC)
    covariance[:, velocity, velocity] += (1.0 - kept_twice) * (even - kept_twice * uneven)
    between = t * (reach * once * even + (together - reach * kept) * uneven)
    covariance[:, position, velocity] += between
    covariance[:, velocity, position] += between
    even_reach = 2.0 * (x - once) / x**2 - reach**2
    uneven_reach = 2.0 * (once - 0.25 * four_times) / (3.0 * x**2) - reach**2
    covariance[:, position, position] += t**2 * (even_reach * even + uneven_reach * uneven)


def _log_transition(elapsed: FloatArray, interval: float, duration: float) -> FloatArray:
    """Return the log of the probability of changing from one mode (row) to another (column)."""
    settled = -np.expm1(-elapsed * (1.0 / interval + 1.0 / duration))
    begins = settled * duration / (interval + duration)
    ends = settled * interval / (interval + duration)
    with np.errstate(divide="ignore"):
        table = np.log(np.stack([1.0 - begins, begins, ends, 1.0 - ends], axis=-1))
    return np.asarray(table.reshape(-1, MODES, MODES))
