"""Narrower hypotheses for a bearing from elsewhere.

A range hypothesis is narrow enough for bearings from where it was made, not for those of another
station, which cut across it: linearised at its mean it would jump to a wrong range. Each component
is taken to be uniform along the longest axis of its position and cut into equal parts.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.motion_modes import modes_of

PARTS = 3
"""Of a component, each time."""

WIDE = 0.1
"""Standard deviation as seen from the other station beyond which a component is cut, rad."""

MOST_HYPOTHESES = 108
"""A bank with as many, in all their modes, is not cut any more."""

FORGOTTEN = float(np.log(1e-6))
"""A component this much less likely than the best one does not matter any more."""


def n_hypotheses(bank: HypothesisBank) -> int:
    """Return how many hypotheses a bank of a single run has, each in all its modes."""
    return len(bank.log_weight) // modes_of(bank)


def split_bank(bank: HypothesisBank, position: FloatArray) -> HypothesisBank:
    """Return a bank narrow enough for azimuths measured at a position.

    Parameters
    ----------
    bank : HypothesisBank
        Of a single run.
    position : ndarray, shape (2,)
        Of the station that will measure, m.
    """
    while n_hypotheses(bank) * PARTS <= MOST_HYPOTHESES and _widest(bank, position) > WIDE:
        bank = _cut(bank)
    return bank


def without_unlikely(bank: HypothesisBank) -> HypothesisBank:
    """Return a bank without the components that do not matter any more.

    Parameters
    ----------
    bank : HypothesisBank
        Of a single run and a single side; all modes of a hypothesis stay or go.
    """
    likely = bank.log_weight > np.max(bank.log_weight) + FORGOTTEN
    modes = modes_of(bank)
    keep = np.repeat(np.any(likely.reshape(-1, modes), axis=1), modes)
    if np.all(keep):
        return bank
    weight = bank.log_weight[keep]
    weight = weight - np.logaddexp.reduce(weight)
    return HypothesisBank(bank.mean[keep], bank.covariance[keep], weight, bank.known)


def _widest(bank: HypothesisBank, position: FloatArray) -> float:
    """Return the largest spread of a likely component as seen from a position, rad."""
    likely = bank.log_weight > np.max(bank.log_weight) + np.log(1e-3)
    offset = bank.mean[likely, :2] - position
    distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), 1.0)
    across = np.stack([-offset[:, 1], offset[:, 0]], axis=1) / distance[:, None] ** 2
    own = np.einsum("ci,cij,cj->c", across, bank.covariance[likely, :2, :2], across)
    return float(np.sqrt(np.max(own)))


def _cut(bank: HypothesisBank) -> HypothesisBank:
    values, vectors = np.linalg.eigh(bank.covariance[:, :2, :2])
    axis = vectors[:, :, -1]
    # What a component knows besides moves with the position along the axis.
    gain = np.einsum("cij,cj->ci", bank.covariance[:, :, :2], axis) / values[:, -1:]
    deviation = np.sqrt(values[:, -1])
    width = np.sqrt(12.0) * deviation
    offsets = (np.arange(PARTS) + 0.5) / PARTS - 0.5
    mean = bank.mean[:, None] + (width[:, None] * offsets)[..., None] * gain[:, None]
    less = (1.0 - 1.0 / PARTS**2) * values[:, -1, None, None]
    covariance = bank.covariance - less * gain[:, :, None] * gain[:, None, :]
    modes, size = modes_of(bank), bank.mean.shape[-1]
    # Hypothesis, part, mode: the modes of a hypothesis are neighbours.
    mean = np.swapaxes(mean.reshape(-1, modes, PARTS, size), 1, 2)
    covariance = np.repeat(covariance.reshape(-1, 1, modes, size, size), PARTS, axis=1)
    weight = np.repeat((bank.log_weight - np.log(PARTS)).reshape(-1, 1, modes), PARTS, axis=1)
    return HypothesisBank(
        mean.reshape(-1, size), covariance.reshape(-1, size, size), weight.ravel(), bank.known
    )
