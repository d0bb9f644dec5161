"""Steps common to all recursive estimators: time, gates, the report."""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    predict_bank,
    seed_lines,
    update_bank,
)
from sonar_tracking.tma.estimators.measurement_model import (
    AZIMUTH,
    ELEVATION,
    LinearisedRows,
    keep_rows,
    linearise,
)
from sonar_tracking.tma.estimators.mixture_moments import spread_of_means, weighted_sum
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaEstimate, TmaMeasurement


def elapsed(previous_stamp: int, stamp: int) -> float:
    """Return the interval between two stamps, s."""
    return (stamp - previous_stamp) / NANOSECONDS


def rows_of(bank: HypothesisBank, measurement: TmaMeasurement) -> LinearisedRows:
    """Return the measurement rows of each component.

    Of the two azimuths of a line array each component takes the nearer one: they are mirror
    images, so that it is the one on the component's own side of the array.
    """
    return linearise(bank.mean, measurement, bank.known)


def gate_rows(
    rows: LinearisedRows, variance: FloatArray, gate: float
) -> tuple[LinearisedRows, FloatArray]:
    """Leave out what lies beyond the gate of its component.

    A row left out counts with the likelihood at the edge of the gate: a component must not gain
    weight by refusing what it cannot explain. The elevation of a direction whose azimuth is left
    out is that of something else, and is left out, too.

    Parameters
    ----------
    rows : LinearisedRows
        All rows.
    variance : ndarray, shape (..., n_components, n_rows)
        Of the innovations, rad^2 and Hz^2.
    gate : float
        Standard deviations.

    Returns
    -------
    rows : LinearisedRows
        Those within.
    log_penalty : ndarray, shape (..., n_components)
        Log likelihood of those without.
    """
    outside = rows.present & (rows.innovation**2 > gate**2 * variance)
    if not outside.any():
        return rows, np.zeros(outside.shape[:-1])
    if outside.shape[-1] > ELEVATION:
        outside[..., ELEVATION] |= outside[..., AZIMUTH] & rows.present[..., ELEVATION]
    edge = -0.5 * (gate**2 + np.log(2.0 * np.pi * variance))
    return keep_rows(rows, rows.present & ~outside), np.sum(np.where(outside, edge, 0.0), axis=-1)


def extended_step(
    bank: HypothesisBank, measurement: TmaMeasurement, interval: float, acceleration: float
) -> HypothesisBank:
    """Return the bank after an ordinary extended Kalman step, without gates.

    Parameters
    ----------
    bank : HypothesisBank
        Posterior of the previous frame.
    measurement : TmaMeasurement
        The frame; new lines are seeded.
    interval : float
        Since the previous frame, s.
    acceleration : float
        Process noise, m/s^2.
    """
    predicted = predict_bank(bank, interval, np.asarray(acceleration))
    predicted = seed_lines(predicted, measurement, measurement.heard & ~predicted.known)
    rows = rows_of(predicted, measurement)
    return update_bank(predicted, rows, np.zeros(1))


def innovation_variance(bank: HypothesisBank, rows: LinearisedRows) -> FloatArray:
    """Return the variance of each innovation.

    Parameters
    ----------
    bank : HypothesisBank
        Prediction.
    rows : LinearisedRows
        Linearised at the components' means.

    Returns
    -------
    ndarray, shape (..., n_components, n_rows)
        rad^2 and Hz^2.
    """
    size = rows.derivative.shape[-1]
    spread = rows.derivative @ bank.covariance[..., :size, :size]
    return np.einsum("...rn,...rn->...r", spread, rows.derivative) + rows.variance


def estimate_of(
    bank: HypothesisBank,
    measurement: TmaMeasurement,
    reborn: BoolArray | None = None,
    manoeuvre: BoolArray | None = None,
    restarted: BoolArray | None = None,
) -> TmaEstimate:
    """Return the mixture's moments as the estimate of a frame.

    Parameters
    ----------
    bank : HypothesisBank
        Posterior.
    measurement : TmaMeasurement
        The frame.
    reborn : ndarray of bool, shape (..., n_lines), optional
        Lines that were started anew; none if not given.
    manoeuvre, restarted : ndarray of bool, shape (...), optional
        As in :class:`TmaEstimate`; none if not given.
    """
    mean, covariance, line_variance = _told_moments(bank)
    batch = bank.known.shape[:-1]
    return TmaEstimate(
        stamp=measurement.stamp,
        mean=mean[..., :KINEMATIC],
        covariance=covariance,
        source_frequency=np.where(bank.known, mean[..., bank.lines], np.nan),
        source_frequency_deviation=np.where(bank.known, np.sqrt(line_variance), np.nan),
        reborn=np.zeros(bank.known.shape, dtype=bool) if reborn is None else reborn,
        manoeuvre=np.zeros(batch, dtype=bool) if manoeuvre is None else manoeuvre,
        restarted=np.zeros(batch, dtype=bool) if restarted is None else restarted,
    )


def _told_moments(bank: HypothesisBank) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return what an estimate tells of ``mixture_moments``, without the rest.

    Of many runs together the rest takes longer than this.

    Returns
    -------
    mean : ndarray, shape (..., 4 + n_lines)
        m, m/s and Hz.
    covariance : ndarray, shape (..., 4, 4)
        Of position and velocity, m and m/s, squared.
    line_variance : ndarray, shape (..., n_lines)
        Of the source frequencies, Hz^2.
    """
    weight = np.exp(bank.log_weight)
    mean = weighted_sum(weight, bank.mean)
    deviation = bank.mean - mean[..., None, :]
    moving, off = deviation[..., :KINEMATIC], deviation[..., bank.lines]
    within = weighted_sum(weight, bank.covariance[..., :KINEMATIC, :KINEMATIC])
    own = bank.covariance.diagonal(axis1=-2, axis2=-1)[..., bank.lines]
    line_variance = weighted_sum(weight, own + off * off)
    return mean, within + spread_of_means(weight, moving), line_variance
