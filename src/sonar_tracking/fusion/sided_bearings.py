"""Of the two azimuths of a line array, those that are of known targets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.alignment.aligned_targets import AlignedTargets
from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.alignment.target_updates import expected_azimuths
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.records.arrays import FloatArray


def expected_bearings(
    found: Sequence[HeardBearing], targets: AlignedTargets, propagation_speed: float
) -> tuple[FloatArray, FloatArray]:
    """Return the azimuths at which a station is expected to hear targets.

    Parameters
    ----------
    found : sequence of HeardBearing
        Of the station: tell which it is, and where.
    targets : AlignedTargets
        Predicted to the instant of the bearings.
    propagation_speed : float
        Of sound, m/s.

    Returns
    -------
    azimuth, variance : ndarray, shape (n_targets,)
        rad and, without the errors of the bearings, rad^2.
    """
    first = found[0]
    return expected_azimuths(
        *targets.collapsed(), first.station, first.array, propagation_speed, first.lag
    )


def sided_bearings(
    found: Sequence[HeardBearing], expected: FloatArray, propagation_speed: float
) -> Bearings:
    """Return the bearings that one station has of targets, on the sides where these are.

    Parameters
    ----------
    found : sequence of HeardBearing
        One a target.
    expected : ndarray, shape (n_targets,)
        Azimuths at which the targets are expected, rad.
    propagation_speed : float
        Of sound, m/s.
    """
    station, array, lag = found[0].station, found[0].array, found[0].lag
    sides = np.array(
        [one.sides(azimuth) for one, azimuth in zip(found, expected.tolist(), strict=True)]
    )
    variance = np.array([one.variance for one in found])
    near, other = sides.reshape(-1, 2).T
    return Bearings(near, variance, station, array, propagation_speed, other, lag)
