"""The default estimator: stacked lines in a bank of range hypotheses, never restarted.

Every line is a measurement row of its own and every source frequency a state (Jauffret's model),
but nothing is ever restarted. Each hypothesis of the initial range is an extended Kalman filter;
their likelihoods weigh them (RP-EKF). Outliers are gated row by row; a line that has become
another source is started anew; a manoeuvring target gets more process noise for a while. A
measurement without lines makes it a bearings-only filter, one with two azimuths follows both sides
of a line array.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.estimators.bank_restart import FULL, restart_bank
from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    predict_bank,
    seed_lines,
    start_bank,
    update_bank,
)
from sonar_tracking.tma.estimators.innovation_monitor import (
    Changes,
    InnovationWindows,
    clear_windows,
    empty_windows,
    extend_windows,
    judge,
)
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.recursion import (
    elapsed,
    estimate_of,
    gate_rows,
    innovation_variance,
    rows_of,
)
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement

ROW_ELEVATION = 1
"""Row between the azimuth and the lines; the monitor does not look at it."""

REFUSED_AZIMUTHS = 5
"""So many azimuths in a row outside every gate: the filter is elsewhere than the target."""

REFUSED_AT_START = 3
"""So many suffice right after the first azimuth: later a near hypothesis could have moved there."""


@dataclass(frozen=True)
class RangeBankState:
    """All that the estimator remembers.

    Attributes
    ----------
    stamp : int
        Of the last measurement, ns.
    bank : HypothesisBank
        Posterior.
    windows : InnovationWindows
        Of the monitor.
    manoeuvre_until : ndarray of int64, shape (...)
        Stamp until which the target is taken to manoeuvre, ns.
    refused : ndarray of int64, shape (...)
        Azimuths in a row that no hypothesis accepted.
    """

    stamp: int
    bank: HypothesisBank
    windows: InnovationWindows
    manoeuvre_until: IntArray
    refused: IntArray


class RangeBank:
    """Position and velocity of one target from azimuths and lines.

    Parameters
    ----------
    configuration : RangeBankConfiguration
        Its parameters.
    """

    def __init__(self, configuration: RangeBankConfiguration | None = None) -> None:
        self._configuration = configuration or RangeBankConfiguration()
        self.state: RangeBankState | None = None

    def update(self, measurement: TmaMeasurement) -> TmaEstimate:
        """Take one measurement in and return where the target is.

        Parameters
        ----------
        measurement : TmaMeasurement
            Not older than the one before; the first one with a finite azimuth.

        Returns
        -------
        TmaEstimate
            At the stamp of the measurement.
        """
        new = self.state is None
        state = self.state if self.state is not None else self._start(measurement)
        lost = (state.refused >= REFUSED_AZIMUTHS) & np.isfinite(measurement.azimuth[..., 0])
        state = self._restart_lost(state, measurement, lost)
        predicted = self._predict(state, measurement)
        rows = rows_of(predicted, measurement)
        variance = innovation_variance(predicted, rows)
        windows, changes = _watch(state.windows, predicted, rows, variance)
        if np.any(changes.manoeuvre) or np.any(changes.reborn):
            predicted = self._loosen(predicted, changes.manoeuvre)
            predicted = seed_lines(predicted, measurement, changes.reborn)
            rows = rows_of(predicted, measurement)
            variance = innovation_variance(predicted, rows)
        refused = rows.present[..., 0]
        rows, penalty = gate_rows(rows, variance, self._configuration.gate)
        refused = np.all(refused & ~rows.present[..., 0], axis=-1)
        accepted = np.any(rows.present[..., 0], axis=-1)
        bank = update_bank(predicted, rows, penalty)
        duration = nanoseconds(self._configuration.manoeuvre_duration)
        until = np.where(
            changes.manoeuvre, measurement.stamp + duration, state.manoeuvre_until
        ).astype(np.int64)
        count = np.where(accepted, 0, state.refused + refused)
        count = np.where(lost | new, REFUSED_AZIMUTHS - REFUSED_AT_START, count)
        self.state = RangeBankState(measurement.stamp, bank, windows, until, count)
        return estimate_of(bank, measurement, changes.reborn, changes.manoeuvre, lost)

    def _start(self, measurement: TmaMeasurement) -> RangeBankState:
        parameters = self._configuration
        bank = start_bank(measurement, parameters.range_edges(), parameters.maximum_speed)
        batch = bank.known.shape[:-1]
        windows = empty_windows(batch, measurement.n_lines)
        nothing = np.zeros(batch, dtype=np.int64)
        return RangeBankState(measurement.stamp, bank, windows, nothing, nothing)

    def _restart_lost(
        self, state: RangeBankState, measurement: TmaMeasurement, lost: BoolArray
    ) -> RangeBankState:
        """Start anew where no hypothesis accepts the azimuths: the first one was an outlier."""
        if not np.any(lost):
            return state
        fresh = self._start(measurement)
        if fresh.bank.log_weight.shape != state.bank.log_weight.shape:
            return fresh  # a single run whose array now has another number of sides
        everything = Changes(np.zeros(state.bank.known.shape, dtype=bool), lost)
        return RangeBankState(
            state.stamp,
            restart_bank(state.bank, fresh.bank, lost, FULL),
            clear_windows(state.windows, everything),
            np.where(lost, 0, state.manoeuvre_until),
            np.where(lost, 0, state.refused),
        )

    def _predict(self, state: RangeBankState, measurement: TmaMeasurement) -> HypothesisBank:
        parameters = self._configuration
        acceleration = np.where(
            measurement.stamp <= state.manoeuvre_until,
            parameters.manoeuvre_acceleration,
            parameters.acceleration,
        )
        interval = elapsed(state.stamp, measurement.stamp)
        predicted = predict_bank(state.bank, interval, acceleration)
        return seed_lines(predicted, measurement, measurement.heard & ~predicted.known)

    def _loosen(self, bank: HypothesisBank, manoeuvre: BoolArray) -> HypothesisBank:
        """Let the motion go where a manoeuvre is found: it began some time ago."""
        lag = self._configuration.manoeuvre_lag
        variance = np.where(manoeuvre, self._configuration.manoeuvre_speed**2, 0.0)[..., None]
        covariance = bank.covariance.copy()
        for axis in range(2):
            covariance[..., axis, axis] += variance * lag**2 / 3.0
            covariance[..., axis, 2 + axis] += variance * lag / 2.0
            covariance[..., 2 + axis, axis] += variance * lag / 2.0
            covariance[..., 2 + axis, 2 + axis] += variance
        return replace(bank, covariance=covariance)


def _watch(
    windows: InnovationWindows,
    bank: HypothesisBank,
    rows: LinearisedRows,
    variance: FloatArray,
) -> tuple[InnovationWindows, Changes]:
    """Show the innovations, averaged over the hypotheses, to the monitor."""
    weight = np.exp(bank.log_weight)[..., None]
    normalised = rows.innovation / np.sqrt(variance)
    normalised = np.delete(np.sum(weight * normalised, axis=-2), ROW_ELEVATION, axis=-1)
    present = np.delete(np.any(rows.present, axis=-2), ROW_ELEVATION, axis=-1)
    extended = extend_windows(windows, normalised, present)
    changes = judge(extended, present)
    return clear_windows(extended, changes), changes
