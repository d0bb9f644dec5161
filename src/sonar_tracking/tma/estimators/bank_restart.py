"""Restarts of a bank of filters: of all it knows, of its covariance, or of its source frequencies.

The published filters restart when lines come or go; the range bank restarts only when it has lost
its target.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar, cast

import numpy as np

from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.tma.estimators.hypothesis_bank import SOURCE_FREQUENCY_SPREAD, HypothesisBank
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC

AnyArray = TypeVar("AnyArray", bound=np.ndarray[Any, Any])

NEVER, FULL, COVARIANCE, SOURCE_FREQUENCY = "never", "full", "covariance", "source_frequency"


def restart_bank(
    bank: HypothesisBank, fresh: HypothesisBank, which: BoolArray, policy: str
) -> HypothesisBank:
    """Return the bank with some of its runs restarted.

    Parameters
    ----------
    bank : HypothesisBank
        Posterior of the previous frame.
    fresh : HypothesisBank
        A start at the present frame, without lines.
    which : ndarray of bool, shape (...)
        Runs to restart.
    policy : str
        ``full``: motion and all source frequencies. ``covariance``: the covariance, not the
        estimate. ``source_frequency``: the source frequencies only.
    """
    known = bank.known & ~which[..., None]
    if policy == SOURCE_FREQUENCY:
        return replace(bank, known=known)
    diffuse = fresh.covariance.copy()
    if policy == COVARIANCE:
        lines = np.arange(KINEMATIC, bank.mean.shape[-1])
        diffuse[..., lines, lines] = (SOURCE_FREQUENCY_SPREAD * bank.mean[..., KINEMATIC:]) ** 2
        return replace(bank, covariance=choose(which, diffuse, bank.covariance))
    covariance = choose(which, diffuse, bank.covariance)
    mean = choose(which, fresh.mean, bank.mean)
    weight = choose(which, fresh.log_weight, bank.log_weight)
    return HypothesisBank(mean, covariance, weight, known)


def choose(which: BoolArray, one: AnyArray, other: AnyArray) -> AnyArray:
    """Return the values of one for some runs, of shape (...), and those of another for the rest.

    Parameters
    ----------
    which : ndarray of bool, shape (...)
        Runs that have those of the first.
    one, other : ndarray, shape (..., any further dimensions)
        In any unit.
    """
    shape = which.shape + (1,) * (other.ndim - which.ndim)
    return cast(AnyArray, np.where(which.reshape(shape), one, other))
