"""A weighted bank of extended Kalman filters on [x, y, vx, vy, f_S1 .. f_Sm, ...].

One filter a hypothesis of the initial range (and of the side of a line array). A bank of one is
the ordinary extended Kalman filter. A line that is absent has no row; a new line appends a state
with a diffuse variance. Nothing is ever restarted: "the dimension changes, so the covariance must
be reset" is false.

References
----------
Peach, "Bearings-only tracking using a set of range-parameterised extended Kalman filters",
IEE Proc. Control Theory Appl. 142(1), 1995.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.tma.estimators.conditioning import condition
from sonar_tracking.tma.estimators.measurement_model import (
    LinearisedRows,
    doppler_factor,
    has_height,
)
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC, TmaMeasurement
from sonar_tracking.tma.estimators.vertical_prediction import predict_vertical

SOURCE_FREQUENCY_SPREAD = 50.0 / 300.0
"""Standard deviation of a new source frequency relative to the received one: diffuse."""

LOG_TURN = float(np.log(2.0 * np.pi))


@dataclass(frozen=True)
class HypothesisBank:
    """Gaussian mixture over the state.

    Attributes
    ----------
    mean : ndarray, shape (..., n_components, at least 4 + n_lines)
        Component means, m, m/s and Hz; the frequency of a line never heard is 0. Two more states
        where the height is estimated: height and its rate, m and m/s. The last ones may be those
        of a deviation from a mean course, m and m/s, on which nothing that is measured depends.
    covariance : ndarray, shape (..., n_components, at least 4 + n_lines, at least 4 + n_lines)
        Component covariances, in the same units squared.
    log_weight : ndarray, shape (..., n_components)
        Logs of probabilities, normalised.
    known : ndarray of bool, shape (..., n_lines)
        Lines that have been heard.
    """

    mean: FloatArray
    covariance: FloatArray
    log_weight: FloatArray
    known: BoolArray

    @property
    def height(self) -> int:
        """Place of the height in the state, behind the lines."""
        return KINEMATIC + self.known.shape[-1]

    @property
    def lines(self) -> slice:
        """Places of the source frequencies in the state."""
        return slice(KINEMATIC, self.height)

    @property
    def vertical(self) -> bool:
        """Whether the state has a height."""
        return has_height(self.mean, self.known.shape[-1])


def start_bank(
    measurement: TmaMeasurement, range_edges: FloatArray, maximum_speed: float
) -> HypothesisBank:
    """Return one component a side and range interval, around the measured azimuth.

    The range is uniform within its interval and has mean (a + b) / 2 and variance (b - a)^2 / 12:
    the variance printed in the paper's eq. 25 is the second moment about the sensor. The
    covariance is laid along and across the line of sight, so that turning the scene turns it.

    Parameters
    ----------
    measurement : TmaMeasurement
        With at least a finite azimuth.
    range_edges : ndarray, shape (n_ranges + 1,)
        Bounds of the intervals, m.
    maximum_speed : float
        Each velocity component is uniform within this, m/s.
    """
    ranges = 0.5 * (range_edges[1:] + range_edges[:-1])
    along = np.diff(range_edges) ** 2 / 12.0
    n_components = measurement.azimuth.shape[-1] * len(ranges)
    azimuth = np.repeat(measurement.azimuth, len(ranges), axis=-1)
    distance = np.tile(ranges, measurement.azimuth.shape[-1])
    direction = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    normal = np.stack([-direction[..., 1], direction[..., 0]], axis=-1)
    across = distance**2 * measurement.azimuth_variance[..., None]
    n_lines = measurement.n_lines
    size = KINEMATIC + n_lines
    mean = np.zeros((*azimuth.shape, size))
    mean[..., :2] = measurement.position[..., None, :] + distance[:, None] * direction
    covariance = np.zeros((*azimuth.shape, size, size))
    covariance[..., :2, :2] = np.tile(along, measurement.azimuth.shape[-1])[:, None, None] * _outer(
        direction
    ) + across[..., None, None] * _outer(normal)
    covariance[..., 2, 2] = covariance[..., 3, 3] = maximum_speed**2 / 3.0
    # It was seen where it was a travel time ago: by now its velocity has carried it on.
    delay = distance / measurement.propagation_speed
    for axis in range(2):
        carried = delay * covariance[..., 2 + axis, 2 + axis]
        covariance[..., axis, axis] += delay * carried
        covariance[..., axis, 2 + axis] = covariance[..., 2 + axis, axis] = carried
    weight = np.full(azimuth.shape, -np.log(n_components))
    known = np.zeros((*azimuth.shape[:-1], n_lines), dtype=bool)
    return HypothesisBank(mean, covariance, weight, known)


def predict_bank(
    bank: HypothesisBank, interval: FloatArray | float, acceleration: FloatArray
) -> HypothesisBank:
    """Return the bank after constant velocity with random acceleration.

    The noise has the spectral density ``acceleration^2`` times 1 s, so that the prediction over
    an interval is the same in one step or in several.

    Parameters
    ----------
    bank : HypothesisBank
        Before.
    interval : float or ndarray, shape (...)
        s.
    acceleration : ndarray, shape (...)
        Standard deviation of an acceleration that lasts for 1 s, m/s^2.
    """
    mean, covariance = bank.mean.copy(), bank.covariance.copy()
    elapsed = np.asarray(interval)[..., None]
    move_straight(mean, covariance, elapsed, np.asarray(acceleration)[..., None] ** 2)
    if bank.vertical:
        mean, covariance = predict_vertical(mean, covariance, elapsed, bank.height)
    return replace(bank, mean=mean, covariance=covariance)


def move_straight(
    mean: FloatArray, covariance: FloatArray, elapsed: FloatArray, density: FloatArray
) -> None:
    """Move states with constant velocity and white acceleration, in place.

    Parameters
    ----------
    mean : ndarray, shape (..., n_components, at least 4)
        m, m/s; what comes after the motion stays.
    covariance : ndarray, shape (..., n_components, at least 4, at least 4)
        In the same units squared.
    elapsed : ndarray, shape (..., n_components) or (..., 1)
        s.
    density : ndarray, shape (..., n_components) or (..., 1)
        Of the acceleration, m^2/s^3.
    """
    step = elapsed[..., None]
    mean[..., :2] += step * mean[..., 2:KINEMATIC]
    covariance[..., :2, :] += step[..., None] * covariance[..., 2:KINEMATIC, :]
    covariance[..., :, :2] += step[..., None] * covariance[..., :, 2:KINEMATIC]
    between = density * elapsed**2 / 2.0
    for axis in range(2):
        covariance[..., axis, axis] += density * (elapsed**2 * elapsed) / 3.0
        covariance[..., axis, 2 + axis] += between
        covariance[..., 2 + axis, axis] += between
        covariance[..., 2 + axis, 2 + axis] += density * elapsed


def moved_places(
    mean: FloatArray, covariance: FloatArray, elapsed: FloatArray, density: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what :func:`move_straight` makes of the places, without the rest.

    Of many states, of which only where they will be is asked, the rest takes most of the time.

    Parameters
    ----------
    mean : ndarray, shape (n, at least 4)
        m, m/s.
    covariance : ndarray, shape (n, at least 4, at least 4)
        In the same units squared.
    elapsed : ndarray, shape (n,)
        s.
    density : ndarray, shape (n,)
        Of the acceleration, m^2/s^3.

    Returns
    -------
    motion : ndarray, shape (n, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (2, 2, n)
        Of x and y, m^2.
    """
    motion = mean[:, :KINEMATIC].copy()
    motion[:, :2] += elapsed[:, None] * motion[:, 2:]
    x_y, velocity = slice(2), slice(2, KINEMATIC)
    before = covariance.transpose(1, 2, 0).copy()
    place = before[x_y, x_y] + elapsed * before[velocity, x_y]
    place += elapsed * (before[x_y, velocity] + elapsed * before[velocity, velocity])
    noise = density * (elapsed**2 * elapsed) / 3.0
    place[0, 0] += noise
    place[1, 1] += noise
    return motion, place


def seed_lines(
    bank: HypothesisBank, measurement: TmaMeasurement, which: BoolArray
) -> HypothesisBank:
    """Give lines a new, diffuse source frequency from what is received now.

    The ordinary update with the same frequency that follows creates the correlation with the
    velocity.

    Parameters
    ----------
    bank : HypothesisBank
        Prediction.
    measurement : TmaMeasurement
        With the received frequencies.
    which : ndarray of bool, shape (..., n_lines)
        Lines to seed.
    """
    if not which.any():
        return bank
    factor = doppler_factor(bank.mean, measurement)
    received = np.where(which, measurement.frequency, 0.0)[..., None, :]
    mean, covariance = bank.mean.copy(), bank.covariance.copy()
    new = which[..., None, :]
    lines = KINEMATIC + np.arange(which.shape[-1])
    mean[..., lines] = np.where(new, received / factor[..., None], mean[..., lines])
    old = np.ones((*which.shape[:-1], mean.shape[-1]), dtype=bool)
    old[..., lines] = ~which
    covariance *= (old[..., :, None] & old[..., None, :])[..., None, :, :]
    covariance[..., lines, lines] += (SOURCE_FREQUENCY_SPREAD * received) ** 2
    return replace(bank, mean=mean, covariance=covariance, known=bank.known | which)


def innovation_covariance(bank: HypothesisBank, rows: LinearisedRows) -> FloatArray:
    """Return H P H^T + R of each component.

    Parameters
    ----------
    bank : HypothesisBank
        Prediction.
    rows : LinearisedRows
        Linearised at the components' means.

    Returns
    -------
    ndarray, shape (..., n_components, n_rows, n_rows)
        In units of the rows: rad and Hz.
    """
    size = rows.derivative.shape[-1]
    spread = (
        rows.derivative @ bank.covariance[..., :size, :size] @ np.swapaxes(rows.derivative, -1, -2)
    )
    index = np.arange(rows.variance.shape[-1])
    spread[..., index, index] += rows.variance
    return spread


def update_bank(
    bank: HypothesisBank, rows: LinearisedRows, log_penalty: FloatArray
) -> HypothesisBank:
    """Return the bank after the rows, weights by likelihood.

    Parameters
    ----------
    bank : HypothesisBank
        Prediction.
    rows : LinearisedRows
        Linearised at the components' means.
    log_penalty : ndarray, shape (..., n_components)
        Log likelihood of measurements that a component left out.
    """
    taken = condition_bank(bank, rows, log_penalty)
    total = np.logaddexp.reduce(taken.log_weight, axis=-1)
    return replace(taken, log_weight=taken.log_weight - total[..., None])


def condition_bank(
    bank: HypothesisBank,
    rows: LinearisedRows,
    log_penalty: FloatArray,
    further: BoolArray | bool = True,
    in_place: bool = False,
) -> HypothesisBank:
    """Return the bank after the rows, its weights not normalised.

    Parameters
    ----------
    bank : HypothesisBank
        Prediction.
    rows : LinearisedRows
        Linearised at the components' means.
    log_penalty : ndarray, shape (..., n_components)
        Log likelihood of measurements that a component left out.
    further : ndarray of bool, shape (n_first,), or bool
        Entries of the first dimension whose states that no row depends on are not zero for certain.
    in_place : bool
        Whether the covariance of the bank given may be overwritten.
    """
    whole = np.zeros(bank.log_weight.shape, dtype=bool)
    whole[further] = True
    covariance = bank.covariance if in_place else bank.covariance.copy()
    seen = condition(covariance, rows, whole)
    constant = LOG_TURN * np.count_nonzero(rows.present, axis=-1)
    weight = bank.log_weight - 0.5 * (seen.squared + seen.log_spread + constant) + log_penalty
    return HypothesisBank(bank.mean + seen.shift, seen.covariance, weight, bank.known)


def _outer(vector: FloatArray) -> FloatArray:
    return vector[..., :, None] * vector[..., None, :]
