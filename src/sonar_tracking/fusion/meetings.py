"""Which targets are so near each other that one tracker may take them for each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.fusion.exchanges import ECHOES, Exchange
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.target_filters import TargetFilters
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray

NEAR = 3.0
"""Standard deviations of what a tracker sees of both, within which it may exchange them."""


def meetings_of_echoes(
    targets: Sequence[FusedTarget], noise: FloatArray, filters: TargetFilters
) -> list[Exchange]:
    """Return the exchanges of tracks of echoes to consider from now on.

    Parameters
    ----------
    targets : sequence of FusedTarget
        Whose positions were measured.
    noise : ndarray, shape (n, 2, 2)
        Covariances of the measurements, m^2.
    filters : TargetFilters
        Of all targets.
    """
    if not targets or len(filters.targets) < 2:
        return []
    seen = filters.picture()
    place = {target: row for row, target in enumerate(filters.targets)}
    found = []
    for target, own in zip(targets, noise, strict=True):
        row = place[target]
        apart = seen.mean[:, :2] - seen.mean[row, :2]
        spread = seen.covariance[:, :2, :2] + seen.covariance[row, :2, :2] + 2.0 * own
        solved = np.linalg.solve(spread, apart[..., None])[..., 0]
        near = np.sum(apart * solved, axis=1) <= NEAR**2
        found += [(target, filters.targets[other]) for other in np.flatnonzero(near)]
    heard = [pair for pair in found if pair[0].heard or pair[1].heard]
    return _new(heard, ECHOES, filters)


def meetings_of_bearings(
    targets: Sequence[FusedTarget],
    found: Sequence[HeardBearing],
    expected: tuple[FloatArray, FloatArray],
    filters: TargetFilters,
) -> list[Exchange]:
    """Return the exchanges of bearing tracks of one station to consider from now on.

    Parameters
    ----------
    targets : sequence of FusedTarget
        Which were heard.
    found : sequence of HeardBearing
        One a target.
    expected : tuple of two ndarray, shape (n_targets,)
        Azimuths that the station tells of all targets, and their variances, rad and rad^2.
    filters : TargetFilters
        Of all targets.
    """
    if len(targets) < 2:
        return []
    azimuth, variance = expected
    place = {target: row for row, target in enumerate(filters.targets)}
    rows = [place[target] for target in targets]
    noise = np.array([one.variance for one in found])
    apart = wrap_angle(azimuth[rows][:, None] - azimuth[rows])
    total = variance[rows] + noise
    near = apart**2 <= NEAR**2 * (total[:, None] + total)
    pairs = [(targets[one], targets[other]) for one, other in np.argwhere(np.triu(near, 1))]
    told = [pair for pair in pairs if pair[0].echoes or pair[1].echoes]
    return _new(told, found[0].key[0], filters)


def _new(
    pairs: Sequence[tuple[FusedTarget, FusedTarget]], source: str | None, filters: TargetFilters
) -> list[Exchange]:
    place = {target: row for row, target in enumerate(filters.targets)}
    ordered = {
        (one, other) if place[one] < place[other] else (other, one)
        for one, other in pairs
        if one is not other
    }
    rising = sorted(ordered, key=lambda pair: (place[pair[0]], place[pair[1]]))
    return [
        Exchange(pair, source)
        for pair in rising
        if not filters.exchanges.is_considered(pair, source)
    ]
