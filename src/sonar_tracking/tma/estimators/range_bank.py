"""The default estimator: stacked lines in a bank of range hypotheses, never restarted.

Every line is a measurement row of its own and every source frequency a state (Jauffret's model),
but nothing is ever restarted. Each hypothesis of the initial range is a pair of extended Kalman
filters, of a target that moves straight and of one that manoeuvres; their likelihoods weigh them
(RP-EKF, IMM). How large and how lasting the errors of azimuths and lines are is learnt from the
innovations. Outliers are gated row by row; a line that has become another source is started anew.
A measurement without lines makes it a bearings-only filter, one with two azimuths follows both
sides of a line array.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.estimators.bank_batch import (
    BankBatch,
    RunRows,
    join_banks,
    separate_banks,
)
from sonar_tracking.tma.estimators.bank_replay import judge_beginning
from sonar_tracking.tma.estimators.error_innovations import (
    BankInnovations,
    as_of_first_side,
    error_innovations,
)
from sonar_tracking.tma.estimators.error_models import (
    ErrorEvidence,
    learn_errors,
    variance_factor,
)
from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    condition_bank,
    seed_lines,
)
from sonar_tracking.tma.estimators.innovation_monitor import (
    Changes,
    InnovationWindows,
    watch_innovations,
)
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows, watched_rows
from sonar_tracking.tma.estimators.motion_modes import (
    MANOEUVRING,
    MODES,
    STRAIGHT,
    modes_of,
    predict_modes,
    weaving_modes,
)
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.range_bank_state import (
    ELEVATION_INTERVAL,
    MOST_A_TIME,
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
from sonar_tracking.tma.estimators.vertical_motion import seed_height, with_vertical

ROW_ELEVATION = 1
"""Row between the azimuth and the lines; the monitor does not look at it."""

DIRECTIONS = slice(ROW_ELEVATION + 1)
"""Azimuth and elevation."""


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
        kind = (
            *(one.stamp, one.n_lines, one.sound_speed, one.propagation_speed),
            *(one.height, one.height_deviation, one.sensor_z),
            _has_modes(states[index], configuration),
            _has_height(states[index], one),
        )
        alike.setdefault(kind, []).append(index)
    updates: dict[int, RangeBankUpdate] = {}
    for same, group in alike.items():
        own = _update_alike(
            [states[index] for index in group],
            [measurements[index] for index in group],
            bool(same[-1]),
            configuration,
        )
        updates.update(zip(group, own, strict=True))
    return [updates[index] for index in range(len(measurements))]


def _update_alike(
    states: Sequence[RangeBankState | None],
    measurements: Sequence[TmaMeasurement],
    vertical: bool,
    configuration: RangeBankConfiguration,
) -> list[RangeBankUpdate]:
    """Take measurements in that have the same columns; with or without states of the height."""
    ready, restarted, begun = [], [], []
    for state, measurement in zip(states, measurements, strict=True):
        present = start_range_bank(measurement, configuration) if state is None else state
        present = judge_beginning(present, measurement.stamp, partial(_believe, configuration))
        if vertical and not present.bank.vertical:
            present = replace(present, bank=with_vertical(present.bank))
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
    for state, lost, measurement in zip(done, restarted, measurements, strict=True):
        if state.beginning is not None:
            state = replace(state, beginning=state.beginning.after(measurement))
        own = slice(run, run + lost.size)
        reborn = changes.reborn[own].reshape(state.bank.known.shape)
        manoeuvre = changes.manoeuvre[own].reshape(lost.shape)
        updates.append(RangeBankUpdate(state, reborn, manoeuvre, lost))
        run += lost.size
    return updates


def _believe(
    configuration: RangeBankConfiguration,
    state: RangeBankState | None,
    measurement: TmaMeasurement,
) -> RangeBankState:
    """Return a state after a measurement whose errors are known."""
    believing = replace(configuration, learn_errors=False)
    return update_range_banks([state], [measurement], believing)[0].state


def _has_height(state: RangeBankState | None, measurement: TmaMeasurement) -> bool:
    """Return whether the height is a state, before or from now on."""
    return measurement.estimates_height or (state is not None and state.bank.vertical)


def _has_modes(state: RangeBankState | None, configuration: RangeBankConfiguration) -> bool:
    """Return whether a target moves in several ways, as it was begun or will be."""
    return not configuration.moves_one_way if state is None else modes_of(state.bank) > 1


def _advance(
    batch: BankBatch, begun: BoolArray, configuration: RangeBankConfiguration
) -> tuple[BankBatch, Changes]:
    """Return the batch after its measurements; where a run has just begun it may be lost sooner."""
    rows_of_run = batch.rows
    predicted = _predict(batch, configuration)
    measured, errors = batch.measurement, batch.errors
    if configuration.learn_errors:
        factor = variance_factor(errors, measured.stamp)
        measured = _with_learnt_errors(batch, factor)
    if predicted.vertical:
        predicted, seeded = seed_height(predicted, measured)
        measured = replace(measured, elevation=np.where(seeded, np.nan, measured.elevation))
    rows = rows_of(predicted, measured)
    variance = innovation_variance(predicted, rows)
    windows, changes = _watch(batch, predicted, rows, variance)
    if changes.reborn.any():
        predicted = seed_lines(predicted, measured, changes.reborn[rows_of_run.owner])
        rows = rows_of(predicted, measured)
        variance = innovation_variance(predicted, rows)
    within, penalty = gate_rows(rows, variance, configuration.gate)
    weaving = weaving_modes(len(predicted.log_weight))
    bank = condition_bank(predicted, within, penalty, weaving, in_place=True)
    total = rows_of_run.log_sums(bank.log_weight)
    log_weight = bank.log_weight - total[rows_of_run.owner]
    bank = HypothesisBank(bank.mean, bank.covariance, log_weight, bank.known)
    weight = np.exp(log_weight)
    accepted = rows_of_run.any(within.present[:, 0, DIRECTIONS])
    if configuration.learn_errors:
        usable = accepted[:, 0] | (batch.refused == 0), ~changes.reborn
        sided = as_of_first_side(rows, predicted.mean, measured)
        errors = _learn(batch, factor, weight, sided, variance, usable)
    began = _manoeuvring(bank, rows_of_run) & ~_manoeuvring(batch.bank, rows_of_run)
    refused, contradicted = _count_refused(batch, rows, accepted, begun)
    after = replace(
        batch,
        bank=bank,
        windows=windows,
        errors=errors,
        refused=refused,
        contradicted=contradicted,
    )
    return after, Changes(changes.reborn, began)


def _count_refused(
    batch: BankBatch, rows: LinearisedRows, accepted: BoolArray, begun: BoolArray
) -> tuple[IntArray, FloatArray]:
    """Return how many azimuths and elevations in a row no hypothesis of a run has accepted."""
    refused = batch.rows.all(rows.present[:, 0, DIRECTIONS]) & ~accepted
    count = np.where(accepted[:, 0], 0, batch.refused + refused[:, 0])
    count = np.where(begun, REFUSED_AZIMUTHS - REFUSED_AT_START, count)
    # Where the azimuth is of something else so is the elevation: it contradicts nothing.
    contradicting = refused[:, ROW_ELEVATION] & ~refused[:, 0]
    contradicted = batch.contradicted
    if contradicting.any():
        worth = np.clip(batch.interval / ELEVATION_INTERVAL, 1.0, MOST_A_TIME)
        contradicted = contradicted + worth * contradicting
    return count, np.where(accepted[:, ROW_ELEVATION], 0.0, contradicted)


def _predict(batch: BankBatch, configuration: RangeBankConfiguration) -> HypothesisBank:
    measured, elapsed = batch.measurement, batch.interval[batch.rows.owner]
    predicted = predict_modes(batch.bank, elapsed, configuration)
    return seed_lines(predicted, measured, measured.heard & ~predicted.known)


def _manoeuvring(bank: HypothesisBank, rows: RunRows) -> BoolArray:
    """Return whether the target of each run rather manoeuvres than moves straight, (n_runs,)."""
    if modes_of(bank) == 1:
        return np.zeros(len(rows.counts), dtype=bool)
    weight = np.exp(bank.log_weight)
    more = weight[MANOEUVRING::MODES, 0] - weight[STRAIGHT::MODES, 0]
    return np.asarray(np.add.reduceat(more, rows.starts // MODES) > 0.0)


def _with_learnt_errors(batch: BankBatch, factor: FloatArray) -> TmaMeasurement:
    """Return the measurement with the variances that its errors turned out to have."""
    measured, own = batch.measurement, factor[batch.rows.owner]
    return replace(
        measured,
        azimuth_variance=measured.azimuth_variance * own[:, 0],
        frequency_deviation=measured.frequency_deviation * np.sqrt(own[:, 1:]),
    )


def _learn(
    batch: BankBatch,
    factor: FloatArray,
    weight: FloatArray,
    rows: LinearisedRows,
    variance: FloatArray,
    usable: tuple[BoolArray, BoolArray],
) -> ErrorEvidence:
    """Return what the innovations add on the errors.

    They are averaged over the hypotheses with the weights that these have afterwards. Of azimuths
    that none of them accepts only the first in a row is usable: the others are of something else;
    and no line that was just started anew.
    """
    told, runs = batch.measurement, batch.rows
    frequency = np.broadcast_to(told.frequency, (len(weight), told.n_lines))[runs.starts]
    found = error_innovations(
        BankInnovations(runs, weight, rows, variance, frequency), factor, usable
    )
    # A filter that believes in large errors is vague itself. Taken at its word it would explain any
    # innovation, and no evidence against such errors were left: its variance has grown with them.
    own_variance = found.own_variance / np.maximum(factor, 1.0)
    return learn_errors(batch.errors, found.innovation, own_variance, found.telling, told.stamp)


def _watch(
    batch: BankBatch, bank: HypothesisBank, rows: LinearisedRows, variance: FloatArray
) -> tuple[InnovationWindows, Changes]:
    """Show the innovations, averaged over the hypotheses, to the monitor."""
    weight = np.exp(bank.log_weight)
    normalised = (rows.innovation / np.sqrt(variance))[:, 0]
    watched = watched_rows(rows)
    normalised = batch.rows.sums(weight * normalised)[:, watched]
    present = batch.rows.any(rows.present[:, 0])[:, watched]
    return watch_innovations(batch.windows, normalised, present)
