"""The default estimator: stacked lines in a bank of range hypotheses, never restarted.

Every line is a measurement row of its own and every source frequency a state (Jauffret's model),
but nothing is ever restarted. Each hypothesis of the initial range is an extended Kalman filter;
their likelihoods weigh them (RP-EKF). Outliers are gated row by row; a line that has become
another source is started anew; a manoeuvring target gets more process noise for a while. A
measurement without lines makes it a bearings-only filter, one with two azimuths follows both sides
of a line array.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.estimators.bank_batch import BankBatch, join_banks, separate_banks
from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    condition_bank,
    predict_bank,
    seed_lines,
)
from sonar_tracking.tma.estimators.innovation_monitor import (
    Changes,
    InnovationWindows,
    clear_windows,
    extend_windows,
    judge,
)
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.range_bank_state import (
    REFUSED_AT_START,
    REFUSED_AZIMUTHS,
    RangeBankState,
    is_lost,
    restart_lost,
    start_range_bank,
)
from sonar_tracking.tma.estimators.recursion import (
    estimate_of,
    gate_rows,
    innovation_variance,
    rows_of,
)
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement

ROW_ELEVATION = 1
"""Row between the azimuth and the lines; the monitor does not look at it."""


@dataclass(frozen=True)
class RangeBankUpdate:
    """A state after a measurement, and what happened on the way.

    Attributes
    ----------
    state : RangeBankState
        At the stamp of the measurement.
    reborn, manoeuvre, restarted : ndarray of bool, shape (...)
        As in :class:`TmaEstimate`.
    """

    state: RangeBankState
    reborn: BoolArray
    manoeuvre: BoolArray
    restarted: BoolArray


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
        (done,) = update_range_banks([self.state], [measurement], self._configuration)
        self.state = done.state
        return estimate_of(
            done.state.bank, measurement, done.reborn, done.manoeuvre, done.restarted
        )


def update_range_banks(
    states: Sequence[RangeBankState | None],
    measurements: Sequence[TmaMeasurement],
    configuration: RangeBankConfiguration,
) -> list[RangeBankUpdate]:
    """Take a measurement of each of many banks in, those of like measurements at once.

    Parameters
    ----------
    states : sequence of RangeBankState or None
        Of runs of any shape (...), with any number of hypotheses; None = the first measurement.
    measurements : sequence of TmaMeasurement
        Of each state, as :meth:`RangeBank.update` takes them.
    configuration : RangeBankConfiguration
        Of all of them.
    """
    alike: dict[tuple[float, ...], list[int]] = {}
    for index, one in enumerate(measurements):
        kind = (one.stamp, one.n_lines, one.height, one.sound_speed, one.propagation_speed)
        alike.setdefault(kind, []).append(index)
    updates: dict[int, RangeBankUpdate] = {}
    for group in alike.values():
        own = _update_alike(
            [states[index] for index in group],
            [measurements[index] for index in group],
            configuration,
        )
        updates.update(zip(group, own, strict=True))
    return [updates[index] for index in range(len(measurements))]


def _update_alike(
    states: Sequence[RangeBankState | None],
    measurements: Sequence[TmaMeasurement],
    configuration: RangeBankConfiguration,
) -> list[RangeBankUpdate]:
    ready, restarted, begun = [], [], []
    for state, measurement in zip(states, measurements, strict=True):
        present = start_range_bank(measurement, configuration) if state is None else state
        lost = is_lost(present, measurement)
        if lost.any():
            present = restart_lost(present, measurement, lost, configuration)
        ready.append(present)
        restarted.append(lost)
        begun.append(np.ravel(lost) if state is not None else np.ones(lost.size, dtype=bool))
    batch = join_banks(ready, measurements)
    after, changes = _advance(batch, np.concatenate(begun), configuration)
    done = separate_banks(ready, after, measurements[0].stamp)
    updates, run = [], 0
    for state, lost in zip(done, restarted, strict=True):
        own = slice(run, run + lost.size)
        reborn = changes.reborn[own].reshape(state.bank.known.shape)
        manoeuvre = changes.manoeuvre[own].reshape(lost.shape)
        updates.append(RangeBankUpdate(state, reborn, manoeuvre, lost))
        run += lost.size
    return updates


def _advance(
    batch: BankBatch, begun: BoolArray, configuration: RangeBankConfiguration
) -> tuple[BankBatch, Changes]:
    """Return the batch after its measurements; where a run has just begun it may be lost sooner."""
    rows_of_run, measured = batch.rows, batch.measurement
    predicted = _predict(batch, configuration)
    rows = rows_of(predicted, measured)
    variance = innovation_variance(predicted, rows)
    windows, changes = _watch(batch, predicted, rows, variance)
    if np.any(changes.manoeuvre) or np.any(changes.reborn):
        predicted = _loosen(predicted, changes.manoeuvre[rows_of_run.owner], configuration)
        predicted = seed_lines(predicted, measured, changes.reborn[rows_of_run.owner])
        rows = rows_of(predicted, measured)
        variance = innovation_variance(predicted, rows)
    offered = rows.present[:, 0, 0]
    rows, penalty = gate_rows(rows, variance, configuration.gate)
    accepted = rows.present[:, 0, 0]
    refused = rows_of_run.all(offered & ~accepted)
    bank = condition_bank(predicted, rows, penalty)
    total = rows_of_run.log_sums(bank.log_weight)
    bank = replace(bank, log_weight=bank.log_weight - total[rows_of_run.owner])
    end = measured.stamp + nanoseconds(configuration.manoeuvre_duration)
    until = np.where(changes.manoeuvre, end, batch.manoeuvre_until).astype(np.int64)
    count = np.where(rows_of_run.any(accepted), 0, batch.refused + refused)
    count = np.where(begun, REFUSED_AZIMUTHS - REFUSED_AT_START, count)
    after = replace(batch, bank=bank, windows=windows, manoeuvre_until=until, refused=count)
    return after, changes


def _predict(batch: BankBatch, configuration: RangeBankConfiguration) -> HypothesisBank:
    measured, owner = batch.measurement, batch.rows.owner
    acceleration = np.where(
        measured.stamp <= batch.manoeuvre_until,
        configuration.manoeuvre_acceleration,
        configuration.acceleration,
    )
    predicted = predict_bank(batch.bank, batch.interval[owner], acceleration[owner])
    return seed_lines(predicted, measured, measured.heard & ~predicted.known)


def _loosen(
    bank: HypothesisBank, manoeuvre: BoolArray, configuration: RangeBankConfiguration
) -> HypothesisBank:
    """Let the motion go where a manoeuvre is found: it began some time ago."""
    lag = configuration.manoeuvre_lag
    variance = np.where(manoeuvre, configuration.manoeuvre_speed**2, 0.0)[..., None]
    covariance = bank.covariance.copy()
    for axis in range(2):
        covariance[..., axis, axis] += variance * lag**2 / 3.0
        covariance[..., axis, 2 + axis] += variance * lag / 2.0
        covariance[..., 2 + axis, axis] += variance * lag / 2.0
        covariance[..., 2 + axis, 2 + axis] += variance
    return replace(bank, covariance=covariance)


def _watch(
    batch: BankBatch, bank: HypothesisBank, rows: LinearisedRows, variance: FloatArray
) -> tuple[InnovationWindows, Changes]:
    """Show the innovations, averaged over the hypotheses, to the monitor."""
    weight = np.exp(bank.log_weight)
    normalised = (rows.innovation / np.sqrt(variance))[:, 0]
    watched = np.arange(rows.variance.shape[-1]) != ROW_ELEVATION
    normalised = batch.rows.sums(weight * normalised)[:, watched]
    present = batch.rows.any(rows.present[:, 0])[:, watched]
    extended = extend_windows(batch.windows, normalised, present)
    changes = judge(extended, present)
    return clear_windows(extended, changes), changes
