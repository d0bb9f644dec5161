"""What an estimate has made of the running tracks, before any of them ends or a new one starts."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.errors import Notice
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.steering_uncertainty import SteeringMisfit
from sonar_tracking.passive.bearings.track_existence import Evidence
from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class FollowedTracks:
    """The running tracks of one run, or of several that are alike, after an estimate.

    Attributes
    ----------
    filters : KalmanState
        After the estimate.
    targets : KalmanState
        Angle and rate of each track, (..., n_tracks, 2) and (..., n_tracks, 2, 2), rad and rad/s.
    existence : ndarray, shape (..., n_tracks)
        Probabilities; NaN = not estimated.
    measurement : BearingMeasurement or None
        What the estimate told of each track; None = nothing.
    signal_to_noise_ratio : ndarray, shape (..., n_tracks)
        Linear; NaN = not known.
    evidence : Evidence
        Of the existence of the tracks.
    notices : tuple of Notice
        Why nothing was measured.
    first : bool
        Whether the estimate only told the time.
    misfit : SteeringMisfit or None
        What the covariance leaves at the bearings; None = it was not judged.
    """

    filters: KalmanState
    targets: KalmanState
    existence: FloatArray
    measurement: BearingMeasurement | None
    signal_to_noise_ratio: FloatArray
    evidence: Evidence
    notices: tuple[Notice, ...]
    first: bool
    misfit: SteeringMisfit | None
