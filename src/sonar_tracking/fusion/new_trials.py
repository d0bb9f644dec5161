"""Which bearing tracks are tried with which targets: those that may be heard there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.fusion.bearing_trials import GATE, Trial
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.target_filters import TargetFilters
from sonar_tracking.motion import wrap_angle


def new_trials(
    found: Sequence[HeardBearing],
    filters: TargetFilters,
    paused: Mapping[tuple[FusedTarget, BearingKey], int],
    stamp: int,
) -> list[Trial]:
    """Return what to try from now on.

    Parameters
    ----------
    found : sequence of HeardBearing
        Of one station, of which it is open of which target they are.
    filters : TargetFilters
        Of all targets, with the trials under way.
    paused : mapping of FusedTarget and BearingKey to int
        Stamp until which a pair that failed is not tried again, ns.
    stamp : int
        Of the bearings, ns.
    """
    if not found or not filters.targets:
        return []
    expected, variance = filters.expected(found[0])
    sensor = found[0].key[0]
    under_way = {(one.target, one.key) for one in filters.trials.trials}
    begun = []
    for one in found:
        azimuth = np.array([one.nearest(float(near)) for near in expected])
        near = wrap_angle(azimuth - expected) ** 2 <= GATE**2 * (variance + one.variance)
        for row in np.flatnonzero(near):
            pair = filters.targets[row], one.key
            if not pair[0].echoes or any(key[0] == sensor for key in pair[0].heard):
                continue
            if pair not in under_way and paused.get(pair, 0) <= stamp:
                begun.append(Trial(*pair))
    return begun
