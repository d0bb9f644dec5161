"""A bank begins anew once its errors turn out to be much larger than it has believed.

Bearings with deviations told four times too small: until it has learnt that, a bank lays all its
probability on whatever range and mode of motion happens to explain the first ones, and never finds
back. So what was measured is taken in once more, with the errors as they turned out to be: what is
left is a bank that has known them from the beginning (empirical Bayes).

References
----------
Carlin and Louis, "Bayes and Empirical Bayes Methods for Data Analysis", 2nd ed., CRC Press, 2000.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.tma.estimators.bank_beginning import Beginning
from sonar_tracking.tma.estimators.bank_restart import choose
from sonar_tracking.tma.estimators.error_models import variance_factor
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.innovation_monitor import InnovationWindows
from sonar_tracking.tma.estimators.range_bank_state import REFUSED_AZIMUTHS, RangeBankState
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

TakeIn = Callable[[RangeBankState | None, TmaMeasurement], RangeBankState]
"""Returns a state, None = there was none yet, after a measurement that is believed."""


def judge_beginning(state: RangeBankState, stamp: int, take_in: TakeIn) -> RangeBankState:
    """Return the state, the runs begun anew that are due and have believed too much.

    Parameters
    ----------
    state : RangeBankState
        Before the next measurement.
    stamp : int
        Of this, ns.
    take_in : TakeIn
        Takes in what was measured.
    """
    beginning = state.beginning
    if beginning is None or not beginning.due.any():
        return state
    factor = variance_factor(state.errors, stamp)
    which = beginning.misjudged(factor)
    if not which.any():
        return state
    again = _taken_in(beginning, factor, take_in)
    believed = np.where(which[..., None], factor, beginning.believed)
    kept = replace(state, beginning=replace(beginning, believed=believed))
    return _chosen(which, again, kept)


def _taken_in(beginning: Beginning, factor: FloatArray, take_in: TakeIn) -> RangeBankState:
    """Return the state of a bank that has known the errors from the beginning."""
    earliest = int(beginning.first.min())
    state: RangeBankState | None = None
    for number, told in enumerate(beginning.measurements[earliest:], earliest):
        if state is not None:
            # Where a run began later the state is to be lost now.
            refused = np.where(beginning.first == number, REFUSED_AZIMUTHS, state.refused)
            state = replace(state, refused=refused)
        known = replace(
            told,
            azimuth_variance=told.azimuth_variance * factor[..., 0],
            frequency_deviation=told.frequency_deviation * np.sqrt(factor[..., 1:]),
        )
        state = take_in(state, known)
    assert state is not None
    return state


def _chosen(which: BoolArray, again: RangeBankState, kept: RangeBankState) -> RangeBankState:
    """Return what was kept, but for what some runs have taken in again."""
    if which.all():
        bank, windows = again.bank, again.windows
    else:
        bank = HypothesisBank(
            choose(which, again.bank.mean, kept.bank.mean),
            choose(which, again.bank.covariance, kept.bank.covariance),
            choose(which, again.bank.log_weight, kept.bank.log_weight),
            choose(which, again.bank.known, kept.bank.known),
        )
        windows = InnovationWindows(
            choose(which, again.windows.lines, kept.windows.lines),
            choose(which, again.windows.azimuth, kept.windows.azimuth),
        )
    return replace(
        kept,
        bank=bank,
        windows=windows,
        refused=choose(which, again.refused, kept.refused),
        contradicted=choose(which, again.contradicted, kept.contradicted),
    )
