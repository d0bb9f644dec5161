"""Bearings that may be of two targets at once, since the array does not tell them apart.

Two sources nearer to each other than an array resolves make one bearing, somewhere between theirs.
It looks like one of an array that is turned, for as long as they are near: nothing is learnt from
it. That it may be of two is found by counting: more targets are near it that the array does not
report than bearings are of which it is open whose they are. A target that has not been heard where
nothing else was near it is silent, and disturbs no bearing.

A line array resolves differences of the cosine of the angle from its axis, and takes both sides for
one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.errors import Notice, Severity, shown
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.time import seconds

LONGEST_UNTOLD = 60.0
"""An array of which nothing is learnt for so long is told of, s."""

SILENT_AFTER = 60.0
"""A target that is not heard for so long while nothing else is near it is silent, s."""


class UnresolvedBearings:
    """Which bearings of one array may be of two targets.

    Parameters
    ----------
    sensor_id : str
        Of the array.
    resolution : float
        At broadside, rad.
    """

    def __init__(self, sensor_id: str, resolution: float) -> None:
        self._sensor, self._resolution = sensor_id, resolution
        self.keys: frozenset[BearingKey] = frozenset()
        self._alone: dict[FusedTarget, float] = {}
        self._stamp = self._learnt = 0

    def take(
        self,
        found: Sequence[HeardBearing],
        targets: Sequence[FusedTarget],
        expect: Callable[[], FloatArray],
        stamp: int,
    ) -> tuple[Notice, ...]:
        """Find the bearing tracks, :attr:`keys`, that may be of more than one target now.

        Parameters
        ----------
        found : sequence of HeardBearing
            What the array measured.
        targets : sequence of FusedTarget
            All of known position.
        expect : callable
            Returns their azimuths, shape (n_targets,), as the array would tell them, rad; it is
            asked only where some target is not reported.
        stamp : int
            Of the bearings, ns.

        Returns
        -------
        tuple of Notice
            What to tell of the array.
        """
        interval = seconds(stamp - self._stamp) if self._stamp else 0.0
        self._stamp, told = stamp, {one.key for one in found}
        missing = [row for row, one in enumerate(targets) if told.isdisjoint(one.heard)]
        self._alone = {
            targets[row]: self._alone.get(targets[row], 0.0)
            for row in missing
            if _is_certain(targets[row])
        }
        self.keys = frozenset()
        if self._alone:
            self.keys = self._mixed(found, targets, expect(), interval)
        return self._notices(len(self.keys) < len(found))

    def _mixed(
        self,
        found: Sequence[HeardBearing],
        targets: Sequence[FusedTarget],
        expected: FloatArray,
        interval: float,
    ) -> frozenset[BearingKey]:
        azimuths, axis = np.array([one.azimuths[0] for one in found]), _axis(found)
        near = _near(azimuths, expected, axis, self._resolution)
        beside = _near(expected, expected, axis, self._resolution)
        for row, target in enumerate(targets):
            if target in self._alone and not near[:, row].any() and beside[row].sum() == 1:
                self._alone[target] += interval
        may_be_heard = [self._alone.get(one, np.inf) < SILENT_AFTER for one in targets]
        owned = {key for one in targets for key in one.heard}
        free = [row for row, one in enumerate(found) if one.key not in owned]
        explained = _near(azimuths, azimuths[free], axis, self._resolution).sum(axis=1)
        mixed = np.flatnonzero(near[:, may_be_heard].sum(axis=1) > explained)
        return frozenset(found[row].key for row in mixed.tolist())

    def _notices(self, learning: bool) -> tuple[Notice, ...]:
        if learning or not self._learnt:
            self._learnt = self._stamp
        if seconds(self._stamp - self._learnt) <= LONGEST_UNTOLD:
            return ()
        name = shown(self._sensor)
        text = (
            f"{name}: for more than {LONGEST_UNTOLD:.0f} s it has reported fewer bearings than "
            "there are targets near them, so that nothing is learnt of its alignment; if it tells "
            "apart what is so near, lower bearing_resolution_deg."
        )
        return (Notice(Severity.WARN, f"resolution of {name}", text),)


def _is_certain(target: FusedTarget) -> bool:
    return target.status == TrackStatus.CONFIRMED and bool(target.echoes)


def _axis(found: Sequence[HeardBearing]) -> float | None:
    """Return the azimuth of the axis of a line array, rad; None = it is none."""
    for one in found:
        if len(one.azimuths) > 1:
            first, second = one.azimuths[:2]
            return float(first + 0.5 * wrap_angle(second - first))
    return None


def _near(
    azimuth: FloatArray, other: FloatArray, axis: float | None, resolution: float
) -> BoolArray:
    """Return which of some azimuths are not resolved from others, shape (n, n_others)."""
    if axis is None:
        return np.asarray(np.abs(wrap_angle(azimuth[:, None] - other)) <= resolution)
    apart = np.cos(azimuth - axis)[:, None] - np.cos(other - axis)
    return np.asarray(np.abs(apart) <= np.sin(resolution))
