"""Banks of many runs as one: every hypothesis is a row, whichever run it belongs to.

The runs may have different numbers of hypotheses: nothing is padded. What concerns a hypothesis
alone is computed for all of them at once; what concerns a run is a reduction over its rows. Every
number is the one the run alone would give, to the last bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import prod
from typing import Any, TypeVar, cast

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.estimators.error_models import N_MODELS, ErrorEvidence
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.innovation_monitor import WINDOW, InnovationWindows
from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.recursion import elapsed
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaMeasurement

AnyArray = TypeVar("AnyArray", bound=np.ndarray[Any, Any])


@dataclass(frozen=True)
class RunRows:
    """Which rows belong to which run.

    Attributes
    ----------
    counts : ndarray of int, shape (n_runs,)
        Rows of each run, one after the other.
    """

    counts: IntArray

    @cached_property
    def owner(self) -> IntArray:
        """Run of each row, shape (n_rows,)."""
        return np.repeat(np.arange(len(self.counts)), self.counts)

    @cached_property
    def starts(self) -> IntArray:
        """First row of each run, shape (n_runs,)."""
        return np.cumsum(self.counts) - self.counts

    @cached_property
    def _places(self) -> dict[int, IntArray]:
        """Where columns of so many values go in the sums over runs."""
        return {}

    def sums(self, values: FloatArray) -> FloatArray:
        """Return the sums over the rows of each run.

        Parameters
        ----------
        values : ndarray, shape (n_rows, n)
            In any unit: pure numbers, m, Hz.

        Returns
        -------
        ndarray, shape (n_runs, n)
            In the unit of the values.
        """
        n_runs, width = len(self.counts), values.shape[1]
        place = self._places.get(width)
        if place is None:
            place = (self.owner[:, None] * width + np.arange(width)).ravel()
            self._places[width] = place
        total = np.bincount(place, weights=values.ravel(), minlength=n_runs * width)
        return np.asarray(total.reshape(n_runs, width), np.float64)

    def log_sums(self, values: FloatArray) -> FloatArray:
        """Return the logarithm of the sum of exponentials over the rows of each run.

        Parameters
        ----------
        values : ndarray, shape (n_rows, ...)
            Logarithms, pure numbers.

        Returns
        -------
        ndarray, shape (n_runs, ...)
            Logarithms, pure numbers.
        """
        return np.asarray(np.logaddexp.reduceat(values, self.starts, axis=0))

    def any(self, values: BoolArray) -> BoolArray:
        """Return whether a row of each run is true, of shape (n_rows, ...)."""
        return np.asarray(np.logical_or.reduceat(values, self.starts, axis=0))

    def all(self, values: BoolArray) -> BoolArray:
        """Return whether all rows of each run are true, of shape (n_rows, ...)."""
        return np.asarray(np.logical_and.reduceat(values, self.starts, axis=0))


@dataclass(frozen=True)
class BankBatch:
    """Runs whose measurements have the same columns, before these are taken in.

    Attributes
    ----------
    rows : RunRows
        Hypotheses of each run.
    bank : HypothesisBank
        Every hypothesis a batch entry with one component.
    windows : InnovationWindows
        Of each run.
    interval : ndarray, shape (n_runs,)
        Since the last measurement, s.
    errors : ErrorEvidence
        Of each run.
    refused : ndarray of int64, shape (n_runs,)
        As in :class:`RangeBankState`.
    contradicted : ndarray, shape (n_runs,)
        A pure number, as in :class:`RangeBankState`.
    measurement : TmaMeasurement
        Of each hypothesis, or what is the same for all.
    """

    rows: RunRows
    bank: HypothesisBank
    windows: InnovationWindows
    interval: FloatArray
    errors: ErrorEvidence
    refused: IntArray
    contradicted: FloatArray
    measurement: TmaMeasurement


def join_banks(
    states: Sequence[RangeBankState], measurements: Sequence[TmaMeasurement]
) -> BankBatch:
    """Return the runs of all states as one batch.

    Parameters
    ----------
    states : sequence of RangeBankState
        Each of runs of any shape (...), with any number of hypotheses.
    measurements : sequence of TmaMeasurement
        Of each state; with the same stamp, number of lines, height and speeds of sound.
    """
    banks, windows = [one.bank for one in states], [one.windows for one in states]
    n_components = [bank.log_weight.shape[-1] for bank in banks]
    n_runs = [
        bank.log_weight.size // count for bank, count in zip(banks, n_components, strict=True)
    ]
    n_rows = [bank.log_weight.size for bank in banks]
    rows = _rows_of_runs(tuple(n_components), tuple(n_runs))
    size, n_lines = banks[0].mean.shape[-1], banks[0].known.shape[-1]
    bank = HypothesisBank(
        _joined([bank.mean for bank in banks], n_rows, (1, size)),
        _joined([bank.covariance for bank in banks], n_rows, (1, size, size)),
        _joined([bank.log_weight for bank in banks], n_rows, (1,)),
        _joined([bank.known for bank in banks], n_runs, (n_lines,))[rows.owner],
    )
    intervals = [elapsed(one.stamp, measurements[0].stamp) for one in states]
    return BankBatch(
        rows=rows,
        bank=bank,
        windows=InnovationWindows(
            _joined([one.lines for one in windows], n_runs, (n_lines, WINDOW)),
            _joined([one.azimuth for one in windows], n_runs, (WINDOW,)),
        ),
        interval=np.repeat(intervals, n_runs),
        errors=ErrorEvidence(
            _joined([one.errors.table for one in states], n_runs, (1 + n_lines, 3, N_MODELS)),
            _joined([one.errors.stamp for one in states], n_runs, (1 + n_lines,)),
        ),
        refused=_joined([one.refused for one in states], n_runs, ()),
        contradicted=_joined([one.contradicted for one in states], n_runs, ()),
        measurement=_measurement_of_rows(measurements, banks, n_runs, rows),
    )


@lru_cache(maxsize=256)
def _rows_of_runs(n_components: tuple[int, ...], n_runs: tuple[int, ...]) -> RunRows:
    """Return which rows belong to which run, of states of so many runs of so many hypotheses."""
    return RunRows(np.repeat(n_components, n_runs))


def join_motions(banks: Sequence[HypothesisBank]) -> tuple[RunRows, HypothesisBank]:
    """Return the motion in all hypotheses of single runs, without their lines.

    Returns
    -------
    rows : RunRows
        Hypotheses of each bank.
    bank : HypothesisBank
        Every hypothesis a batch entry with one component of [x, y, vx, vy].
    """
    counts = [len(bank.log_weight) for bank in banks]
    motion = slice(KINEMATIC)
    bank = HypothesisBank(
        np.concatenate([bank.mean[:, motion] for bank in banks])[:, None],
        np.concatenate([bank.covariance[:, motion, motion] for bank in banks])[:, None],
        np.concatenate([bank.log_weight for bank in banks])[:, None],
        np.zeros((sum(counts), 0), dtype=bool),
    )
    return RunRows(np.array(counts)), bank


def separate_banks(
    states: Sequence[RangeBankState], batch: BankBatch, stamp: int
) -> list[RangeBankState]:
    """Return a batch as the states it was joined from, all at a stamp, ns."""
    parts = []
    known = batch.bank.known[batch.rows.starts]
    row = run = 0
    for state in states:
        shape = state.bank.log_weight.shape
        n_rows, n_runs = prod(shape), prod(shape[:-1])
        own, runs = slice(row, row + n_rows), slice(run, run + n_runs)
        row, run = row + n_rows, run + n_runs
        bank = HypothesisBank(
            batch.bank.mean[own].reshape(state.bank.mean.shape),
            batch.bank.covariance[own].reshape(state.bank.covariance.shape),
            batch.bank.log_weight[own].reshape(shape),
            known[runs].reshape(state.bank.known.shape),
        )
        windows = InnovationWindows(
            batch.windows.lines[runs].reshape(state.windows.lines.shape),
            batch.windows.azimuth[runs].reshape(state.windows.azimuth.shape),
        )
        errors = ErrorEvidence(
            batch.errors.table[runs].reshape(state.errors.table.shape),
            batch.errors.stamp[runs].reshape(state.errors.stamp.shape),
        )
        refused = batch.refused[runs].reshape(shape[:-1])
        contradicted = batch.contradicted[runs].reshape(shape[:-1])
        left = refused, contradicted, state.beginning
        parts.append(RangeBankState(stamp, bank, windows, errors, *left))
    return parts


def _measurement_of_rows(
    measurements: Sequence[TmaMeasurement],
    banks: Sequence[HypothesisBank],
    n_runs: Sequence[int],
    rows: RunRows,
) -> TmaMeasurement:
    """Return what was measured of the run of each hypothesis."""
    if len(measurements) == 1 and _is_of_one_run(measurements[0]):
        return measurements[0]
    batches = [bank.log_weight.shape[:-1] for bank in banks]

    def column(values: Sequence[FloatArray], *shape: int) -> FloatArray:
        if len(values) == 1 and values[0].shape == shape:
            return values[0]
        spread = [
            value if value.shape == (*batch, *shape) else np.broadcast_to(value, (*batch, *shape))
            for value, batch in zip(values, batches, strict=True)
        ]
        return _joined(spread, n_runs, shape)[rows.owner]

    first = measurements[0]
    n_sides = max(one.azimuth.shape[-1] for one in measurements)
    return TmaMeasurement(
        stamp=first.stamp,
        position=column([one.position for one in measurements], 2),
        velocity=column([one.velocity for one in measurements], 2),
        # A single azimuth is nearest to a hypothesis whichever of two equal ones it takes.
        azimuth=column([one.azimuth for one in measurements], n_sides),
        azimuth_variance=column([one.azimuth_variance for one in measurements]),
        frequency=column([one.frequency for one in measurements], first.n_lines),
        frequency_deviation=column(
            [one.frequency_deviation for one in measurements], first.n_lines
        ),
        elevation=column([one.elevation for one in measurements]),
        elevation_variance=column([one.elevation_variance for one in measurements]),
        height=first.height,
        height_deviation=first.height_deviation,
        sensor_z=first.sensor_z,
        sound_speed=first.sound_speed,
        propagation_speed=first.propagation_speed,
    )


def _is_of_one_run(measurement: TmaMeasurement) -> bool:
    """Return whether no column has a dimension for runs."""
    single = measurement.azimuth_variance, measurement.elevation, measurement.elevation_variance
    several = (
        *(measurement.position, measurement.velocity, measurement.azimuth),
        *(measurement.frequency, measurement.frequency_deviation),
    )
    return all(not one.ndim for one in single) and all(one.ndim == 1 for one in several)


def _joined(parts: Sequence[AnyArray], counts: Sequence[int], shape: tuple[int, ...]) -> AnyArray:
    """Return arrays of so many entries of a shape each, as one array of all entries."""
    if len(parts) == 1:
        return cast(AnyArray, parts[0].reshape(counts[0], *shape))
    flat = [part.reshape(count, *shape) for part, count in zip(parts, counts, strict=True)]
    return cast(AnyArray, np.concatenate(flat))
