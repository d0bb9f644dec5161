"""The two sides of a line array, which one angle of arrival stands for: hypotheses of each."""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank

SIDE_PROBABILITY = 0.99
SIDE_TURN = float(np.radians(20.0))
"""One side is dropped when the other is this probable and own ship has turned by this much."""

SINGLE, LEFT, RIGHT = "single", "left", "right"


def side_weights(bank: HypothesisBank, n_sides: int) -> FloatArray:
    """Return the probability of each side, shape (n_sides,)."""
    return np.asarray(np.exp(bank.log_weight).reshape(n_sides, -1).sum(axis=-1))


def side_of(bank: HypothesisBank, side: int, n_sides: int) -> HypothesisBank:
    """Return the hypotheses of one side, their weights normalised."""
    count = len(bank.log_weight) // n_sides
    own = slice(side * count, (side + 1) * count)
    weight = bank.log_weight[own] - np.logaddexp.reduce(bank.log_weight[own])
    return HypothesisBank(bank.mean[own], bank.covariance[own], weight, bank.known)
