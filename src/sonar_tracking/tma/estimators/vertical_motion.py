"""Height of a target whose height is not known: two states, z and its rate, behind the lines.

They join the state with the first elevation, and stay with every hypothesis of the range: an
elevation e, measured at the horizontal range r, says z = r tan(e) + z of the station, so that what
is unknown of the range is unknown of the height, too, and the covariance holds both. What narrows
the range (own ship's turns, a second station) then narrows the height. The first elevation makes
the height of each hypothesis, with the derivative t = tan(e) by the range,

    z = z_s + r t,   P_z. = t u^T P,   P_zz = t^2 u^T P u + (r (1 + t^2) s_e)^2,

after which comes what is known beforehand: the height of the target above the station is h, with
standard deviation s_h. A hypothesis whose range would put the target far from there loses weight;
the same elevation near the horizontal is as probable at any range.

Between measurements the vertical speed is a Gauss-Markov process: a target sinks or climbs for
about a minute, then does something else.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.measurement_model import MINIMUM_RANGE
from sonar_tracking.tma.estimators.sensor_frame import VERTICAL, TmaMeasurement
from sonar_tracking.tma.estimators.travel_time import offset_seen
from sonar_tracking.tma.estimators.vertical_prediction import VERTICAL_SPEED

STEEPEST = 20.0
"""Tangents of elevations are taken to be no larger: overhead a range says nothing of the height."""


def with_vertical(bank: HypothesisBank) -> HypothesisBank:
    """Return a bank with columns for the height, of which nothing is known yet.

    Parameters
    ----------
    bank : HypothesisBank
        With or without them.
    """
    if bank.vertical:
        return bank
    # Right behind the lines, before whatever else there is.
    new = np.full(VERTICAL, bank.height)
    mean = np.insert(bank.mean, new, 0.0, axis=-1)
    covariance = np.insert(np.insert(bank.covariance, new, 0.0, axis=-1), new, 0.0, axis=-2)
    return replace(bank, mean=mean, covariance=covariance)


def seed_height(
    bank: HypothesisBank, measurement: TmaMeasurement
) -> tuple[HypothesisBank, BoolArray]:
    """Return the bank after the first elevation of each run, and which runs that was, shape (...).

    Parameters
    ----------
    bank : HypothesisBank
        Prediction, with columns for the height; its weights are not normalised afterwards.
    measurement : TmaMeasurement
        Whose elevation is taken in here, where nothing was known of the height.
    """
    place = bank.height
    unknown = bank.covariance[..., 0, place, place] == 0.0
    new = unknown & np.isfinite(measurement.elevation)
    if not new.any():
        return bank, new
    seeded = _seeded(bank, measurement)
    run = new[..., None]
    taken = HypothesisBank(
        np.where(run[..., None], seeded.mean, bank.mean),
        np.where(run[..., None, None], seeded.covariance, bank.covariance),
        np.where(run, seeded.log_weight, bank.log_weight),
        bank.known,
    )
    return taken, new


def _seeded(bank: HypothesisBank, measurement: TmaMeasurement) -> HypothesisBank:
    place = bank.height
    position = measurement.position[..., None, :]
    offset, _ = offset_seen(bank.mean, position, measurement.propagation_speed)
    distance = np.maximum(np.hypot(offset[..., 0], offset[..., 1]), MINIMUM_RANGE)
    elevation = np.where(np.isfinite(measurement.elevation), measurement.elevation, 0.0)
    slope = np.clip(np.tan(elevation), -STEEPEST, STEEPEST)[..., None]
    spread = (distance * (1.0 + slope**2)) ** 2 * measurement.elevation_variance[..., None]
    by_position = slope[..., None] * offset / distance[..., None]
    mean, covariance = bank.mean.copy(), bank.covariance.copy()
    cross = np.einsum("...i,...ij->...j", by_position, covariance[..., :2, :])
    mean[..., place] = measurement.sensor_z + distance * slope
    covariance[..., place, :] = cross
    covariance[..., :, place] = cross
    own = np.einsum("...i,...i->...", cross[..., :2], by_position) + spread
    covariance[..., place, place] = own
    covariance[..., place + 1, place + 1] = VERTICAL_SPEED**2
    expected = measurement.sensor_z + measurement.height
    return _with_prior(
        replace(bank, mean=mean, covariance=covariance), expected, measurement.height_deviation
    )


def _with_prior(bank: HypothesisBank, expected: float, deviation: float) -> HypothesisBank:
    """Take in what is known of the height beforehand, m: the mean of exp(-(z - h)^2 / 2 s^2)."""
    place = bank.height
    cross = bank.covariance[..., place]
    own = cross[..., place]
    total = own + deviation**2
    apart = expected - bank.mean[..., place]
    gain = cross / total[..., None]
    weight = -0.5 * (apart**2 / total + np.log(total / deviation**2))
    return replace(
        bank,
        mean=bank.mean + gain * apart[..., None],
        covariance=bank.covariance - gain[..., :, None] * cross[..., None, :],
        log_weight=bank.log_weight + weight,
    )
