"""A target moves straight or manoeuvres: two modes of each range hypothesis, interacting.

The modes differ in their process noise. Before each prediction every mode takes over from the
other what may have changed into it meanwhile (Markov chain in continuous time, so that irregular
frames are no matter). Nothing need be decided: while the data do not tell a turn from a straight
path the estimate's covariance holds both, and a turn that is none costs next to nothing.

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
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank

MODES = 2
"""Of motion: straight, manoeuvring."""

STRAIGHT, MANOEUVRING = 0, 1


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


def _log_transition(elapsed: FloatArray, interval: float, duration: float) -> FloatArray:
    """Return the log of the probability of changing from one mode (row) to another (column)."""
    settled = -np.expm1(-elapsed * (1.0 / interval + 1.0 / duration))
    begins = settled * duration / (interval + duration)
    ends = settled * interval / (interval + duration)
    with np.errstate(divide="ignore"):
        table = np.log(np.stack([1.0 - begins, begins, ends, 1.0 - ends], axis=-1))
    return np.asarray(table.reshape(-1, MODES, MODES))
