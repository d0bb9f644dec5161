"""What the default estimator remembers of a run, and how it begins, also after it was lost."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.estimators.bank_beginning import Beginning, nothing_measured
from sonar_tracking.tma.estimators.bank_restart import FULL, restart_bank
from sonar_tracking.tma.estimators.error_models import (
    ErrorEvidence,
    no_evidence,
    variance_factor,
)
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, start_bank
from sonar_tracking.tma.estimators.innovation_monitor import (
    Changes,
    InnovationWindows,
    clear_windows,
    empty_windows,
)
from sonar_tracking.tma.estimators.motion_modes import with_modes
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.estimators.vertical_motion import with_vertical

REFUSED_AZIMUTHS = 5
"""So many azimuths in a row outside every gate: the filter is elsewhere than the target."""

REFUSED_ELEVATIONS = 5.0
ELEVATION_INTERVAL, MOST_A_TIME = 4.0, 3.0
"""The same of elevations, where one that comes after a long time, s, counts as several: what they
contradict is to be found within a minute."""

REFUSED_AT_START = 3
"""So many suffice right after the first azimuth: later a near hypothesis could have moved there."""

BEYOND, BEYOND_WEIGHT = 2.5, 0.5
"""A target may be farther away than the farthest range considered by this factor; how probable this
is in comparison with one of the intervals below it. A single hypothesis is as it is."""


@dataclass(frozen=True)
class RangeBankState:
    """All that the estimator remembers.

    Attributes
    ----------
    stamp : int
        Of the last measurement, ns.
    bank : HypothesisBank
        Posterior; one component a mode of motion of each hypothesis.
    windows : InnovationWindows
        Of the monitor.
    errors : ErrorEvidence
        On the errors of the azimuths of the station that measures, and of the lines.
    refused : ndarray of int64, shape (...)
        Azimuths in a row that no hypothesis accepted.
    contradicted : ndarray, shape (...)
        The same of elevations, rare ones counted as several; a pure number.
    beginning : Beginning or None
        What was measured so far; None = that much, or from so many places, that it is as it is.
    """

    stamp: int
    bank: HypothesisBank
    windows: InnovationWindows
    errors: ErrorEvidence
    refused: IntArray
    contradicted: FloatArray
    beginning: Beginning | None = None


def start_range_bank(
    measurement: TmaMeasurement, configuration: RangeBankConfiguration
) -> RangeBankState:
    """Return the state before the first measurement, which has a finite azimuth, is taken in."""
    bank = with_modes(_start_bank(measurement, configuration), configuration)
    batch = bank.known.shape[:-1]
    windows = empty_windows(batch, measurement.n_lines)
    return RangeBankState(
        measurement.stamp,
        bank,
        windows,
        no_evidence(batch, measurement.n_lines),
        np.zeros(batch, dtype=np.int64),
        np.zeros(batch),
        nothing_measured(batch, measurement.n_lines) if configuration.learn_errors else None,
    )


def _start_bank(
    measurement: TmaMeasurement, configuration: RangeBankConfiguration
) -> HypothesisBank:
    """Return the hypotheses of the initial range, one of them for what is beyond the farthest."""
    edges, speed = configuration.range_edges(), configuration.maximum_speed
    if configuration.n_ranges == 1:
        return start_bank(measurement, edges, speed)
    bank = start_bank(measurement, np.append(edges, BEYOND * edges[-1]), speed)
    weight = np.ones(len(edges))
    weight[-1] = BEYOND_WEIGHT
    log_weight = bank.log_weight + np.log(
        np.tile(weight / np.mean(weight), measurement.azimuth.shape[-1])
    )
    return replace(bank, log_weight=log_weight)


def is_lost(state: RangeBankState, measurement: TmaMeasurement) -> BoolArray:
    """Return where to start anew, shape (...): no hypothesis has accepted the last directions."""
    refused = np.asarray(state.refused >= REFUSED_AZIMUTHS)
    refused |= state.contradicted >= REFUSED_ELEVATIONS
    return refused & np.isfinite(measurement.azimuth[..., 0]) if refused.any() else refused


def restart_lost(
    state: RangeBankState,
    measurement: TmaMeasurement,
    lost: BoolArray,
    configuration: RangeBankConfiguration,
) -> RangeBankState:
    """Return the state with some runs begun anew at a measurement: their first one was an outlier.

    Parameters
    ----------
    state : RangeBankState
        Before.
    measurement : TmaMeasurement
        Now.
    lost : ndarray of bool, shape (...)
        Which runs.
    configuration : RangeBankConfiguration
        Of the estimator.
    """
    fresh = start_range_bank(measurement, configuration)
    if state.bank.vertical:
        fresh = replace(fresh, bank=with_vertical(fresh.bank))
    if fresh.bank.log_weight.shape != state.bank.log_weight.shape:
        return fresh  # a single run whose array now has another number of sides
    beginning = state.beginning
    if beginning is not None:
        beginning = beginning.restarted(lost, variance_factor(state.errors, measurement.stamp))
    everything = Changes(np.zeros(state.bank.known.shape, dtype=bool), lost)
    return RangeBankState(
        state.stamp,
        restart_bank(state.bank, fresh.bank, lost, FULL),
        clear_windows(state.windows, everything),
        state.errors,
        np.where(lost, 0, state.refused),
        np.where(lost, 0.0, state.contradicted),
        beginning,
    )
