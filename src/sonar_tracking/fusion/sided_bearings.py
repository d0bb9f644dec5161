"""Of the two azimuths of a line array, those that are of known targets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.alignment.aligned_targets import AlignedTargets
from sonar_tracking.alignment.target_updates import Bearings, expected_azimuths
from sonar_tracking.fusion.fusion_records import HeardBearing


def sided_bearings(
    found: Sequence[HeardBearing], targets: AlignedTargets, propagation_speed: float
) -> Bearings:
    """Return the bearings that one station has of targets, on the sides where these are.

    Parameters
    ----------
    found : sequence of HeardBearing
        One a target.
    targets : AlignedTargets
        Predicted to the instant of the bearings.
    propagation_speed : float
        Of sound, m/s.
    """
    station, array, lag = found[0].station, found[0].array, found[0].lag
    told = targets.collapsed()
    expected, _ = expected_azimuths(*told, station, array, propagation_speed, lag)
    sides = np.array(
        [one.sides(float(azimuth)) for one, azimuth in zip(found, expected, strict=True)]
    )
    variance = np.array([one.variance for one in found])
    near, other = sides.reshape(-1, 2).T
    return Bearings(near, variance, station, array, propagation_speed, other, lag)
