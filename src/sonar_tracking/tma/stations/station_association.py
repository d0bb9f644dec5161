"""Which bearing of another station belongs to which target.

The likelihood of an azimuth is that of the mixture over range: a target whose range is unknown can
be anywhere along its bearing, and so can its azimuth from elsewhere. Pairs outside every gate are
forbidden; among the others the most likely assignment is taken, and a bearing that no target
explains better than chance stays free.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.filtering.assignment import least_cost_pairs
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.tma.estimators.bank_batch import join_motions
from sonar_tracking.tma.estimators.hypothesis_bank import (
    HypothesisBank,
    innovation_covariance,
    moved_places,
    predict_bank,
)
from sonar_tracking.tma.estimators.recursion import rows_of
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.estimators.travel_time import offset_seen

FREE = -1
"""In place of a target: none."""

CHANCE_DENSITY = 1.0 / (2.0 * np.pi)
"""Of a bearing that belongs to no target: from anywhere, rad^-1."""

CHANCE_DENSITY_WITH_ELEVATION = CHANCE_DENSITY * 2.0 / np.pi
"""The same of an azimuth with an elevation: from anywhere above, rad^-2."""


@dataclass(frozen=True)
class WeighedAzimuths:
    """Azimuths against targets.

    Attributes
    ----------
    log_likelihood : ndarray, shape (n_targets, n_bearings)
        Of the density per rad; -inf = outside the gate of every hypothesis.
    innovation, spread : ndarray, shape (n_targets, n_bearings)
        Measured less expected, rad, and its variance, rad^2: means over the hypotheses, by how
        well each explains the azimuth; 0 = none does.
    """

    log_likelihood: FloatArray
    innovation: FloatArray
    spread: FloatArray


def weigh_azimuths(
    banks: Sequence[HypothesisBank],
    intervals: FloatArray,
    accelerations: FloatArray,
    positions: FloatArray,
    azimuths: FloatArray,
    variances: FloatArray,
    gate: float = 4.0,
    propagation_speed: FloatArray | float = np.inf,
) -> WeighedAzimuths:
    """Return how well azimuths measured from anywhere fit, if they are of these targets.

    Parameters
    ----------
    banks : sequence of HypothesisBank
        Of each target, a single run.
    intervals : ndarray, shape (n_targets,)
        From each bank's time to the azimuths', s.
    accelerations : ndarray, shape (n_targets,)
        Process noise in between, m/s^2.
    positions : ndarray, shape (n_targets, 2)
        Of the station that measured those of a target, m.
    azimuths, variances : ndarray, shape (n_targets, n_bearings)
        rad and rad^2; an azimuth that is NaN is none.
    gate : float
        Standard deviations within which a hypothesis may explain an azimuth.
    propagation_speed : float or ndarray, shape (n_targets,)
        Of sound, m/s; inf = the target is seen where it is.

    Returns
    -------
    WeighedAzimuths
        Of each target and azimuth.
    """
    rows, bank = join_motions(banks)
    owner = rows.owner
    speed = np.broadcast_to(propagation_speed, intervals.shape)
    expected, own = _seen_from(
        bank, intervals[owner], accelerations[owner], positions[owner], speed[owner]
    )
    spread = own[:, None] + variances[owner]
    innovation = wrap_angle(azimuths[owner] - expected[:, None])
    squared = innovation**2 / spread
    density = -0.5 * (squared + np.log(2.0 * np.pi * spread)) + bank.log_weight
    admitted = np.where(squared <= gate**2, density, -np.inf)
    likelihood = rows.log_sums(admitted)
    known = np.isfinite(likelihood)[owner]
    share = np.where(known, np.exp(admitted - np.where(known, likelihood[owner], 0.0)), 0.0)
    return WeighedAzimuths(
        likelihood,
        rows.sums(share * np.where(known, innovation, 0.0)),
        rows.sums(share * np.where(known, spread, 0.0)),
    )


def _seen_from(
    bank: HypothesisBank,
    elapsed: FloatArray,
    acceleration: FloatArray,
    position: FloatArray,
    propagation_speed: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the azimuth of each hypothesis after a time, rad, and its variance, rad^2."""
    mean, place = moved_places(bank.mean[:, 0], bank.covariance[:, 0], elapsed, acceleration**2)
    x, y = offset_seen(mean, position, propagation_speed)[0].T.copy()
    distance = np.maximum(np.hypot(x, y), 1.0)
    across = -y / distance**2, x / distance**2
    variance = np.zeros(len(mean))
    for i, j in np.ndindex(2, 2):
        variance += across[i] * place[i, j] * across[j]
    return np.arctan2(y, x), variance


def direction_log_likelihoods(
    banks: Sequence[HypothesisBank],
    intervals: FloatArray,
    acceleration: float,
    measurements: Sequence[TmaMeasurement],
    gate: float = 4.0,
) -> FloatArray:
    """Return how well azimuths with their elevations fit, if they are of these targets.

    Parameters
    ----------
    banks : sequence of HypothesisBank
        Of each target, a single run.
    intervals : ndarray, shape (n_targets,)
        From each bank's time to the measurements', s.
    acceleration : float
        Process noise in between, m/s^2.
    measurements : sequence of TmaMeasurement
        Of one station at one instant, without lines, with one azimuth each; an elevation that is
        NaN does not count.
    gate : float
        Standard deviations within which a hypothesis may explain both angles.

    Returns
    -------
    ndarray, shape (n_targets, n_directions)
        Of the density per rad^2 (per rad without elevation); -inf = outside every gate.
    """
    n_targets, n_directions = len(banks), len(measurements)
    pairs, bank = join_motions([bank for bank in banks for _ in measurements])
    target, own = np.divmod(pairs.owner, max(n_directions, 1))
    moved = predict_bank(bank, intervals[target], np.asarray(acceleration))
    told = replace(
        measurements[0],
        azimuth=np.array([one.azimuth for one in measurements])[own],
        azimuth_variance=np.array([one.azimuth_variance for one in measurements])[own],
        elevation=np.array([one.elevation for one in measurements])[own],
        elevation_variance=np.array([one.elevation_variance for one in measurements])[own],
    )
    rows = rows_of(moved, told)
    spread = innovation_covariance(moved, rows)
    solved = np.linalg.solve(spread, rows.innovation[..., None])[..., 0]
    squared = np.sum(rows.innovation * solved, axis=-1)
    constant = np.log(2.0 * np.pi) * np.sum(rows.present, axis=-1)
    density = -0.5 * (squared + np.linalg.slogdet(spread)[1] + constant) + moved.log_weight
    found = pairs.log_sums(np.where(squared <= gate**2, density, -np.inf))
    return found.reshape(n_targets, n_directions)


def associate(log_likelihood: FloatArray, chance_density: float = CHANCE_DENSITY) -> IntArray:
    """Return the target of each bearing.

    Parameters
    ----------
    log_likelihood : ndarray, shape (n_targets, n_bearings)
        Logs of densities, rad^-1 or rad^-2: of one scan, or summed over scans of bearings
        that keep their identity; then less ``(n_scans - 1) * log(chance_density)``. -inf =
        forbidden.
    chance_density : float
        Of a bearing of no target, in the units of the likelihood.

    Returns
    -------
    ndarray of int, shape (n_bearings,)
        Index of the target, each at most once; :data:`FREE` where chance explains it better.
    """
    n_targets, n_bearings = log_likelihood.shape
    gain = log_likelihood - np.log(chance_density)
    # One place for chance a bearing: it costs nothing and gains nothing.
    cost = np.concatenate([np.where(gain > 0.0, -gain, 1.0), np.zeros((n_bearings, n_bearings))])
    rows, columns = least_cost_pairs(cost)
    target = np.full(n_bearings, FREE)
    taken = rows < n_targets
    target[columns[taken]] = rows[taken]
    return target
