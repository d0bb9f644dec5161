"""Contacts tracked by Stone Soup, the peer of the bench: joint probabilistic data association.

Tracks start from three contacts joined by global nearest neighbours and end after four scans
without one. That initiator compares every track with every contact in Python; the gated one
is given the contacts near the track only, which is the fair peer. Needs Stone Soup installed.

References
----------
Stone Soup 1.9, https://stonesoup.readthedocs.io.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from typing import Any

import numpy as np

from sonar_tracking.active.contacts.contact_positions import place_contacts
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts

POSITION = (0, 2)
"""Of x and y in a state x, vx, y, vy."""

GATE_DEVIATIONS = 5.0
MISSES = 4
POINTS = 3


@dataclass(frozen=True)
class PeerParameters:
    """What Stone Soup is given of the scene.

    Attributes
    ----------
    detection_probability : float
        P_D.
    gate_probability : float
        P_G.
    clutter_density : float
        1/m^2.
    acceleration_deviation : float
        Of white acceleration from scan to scan, m/s^2.
    interval : float
        Between scans, s.
    speed_deviation : float
        Per axis of a new track, m/s.
    """

    detection_probability: float
    gate_probability: float
    clutter_density: float
    acceleration_deviation: float
    interval: float
    speed_deviation: float


def stone_soup_positions(
    pings: Sequence[Contacts], parameters: PeerParameters, gated: bool
) -> tuple[list[FloatArray], FloatArray]:
    """Track contacts with Stone Soup.

    Parameters
    ----------
    pings : sequence of Contacts
        In order of time, with known position of the sensor, without propagation delay.
    parameters : PeerParameters
        Of the scene.
    gated : bool
        Whether its initiator and associator see only the contacts near a track.

    Returns
    -------
    positions : list of ndarray, shape (n_tracks, 2)
        Of the tracks after each ping, m.
    seconds : ndarray, shape (n_pings,)
        Processor time of each ping, s.

    Raises
    ------
    ModuleNotFoundError
        If Stone Soup is not installed.
    """
    tracker = _tracker(_detections(pings), parameters, gated)
    positions, finished = [], [time.process_time()]
    for _, tracks in tracker:
        states = [track.state_vector[POSITION, 0] for track in tracks]
        positions.append(np.array(states, dtype=np.float64).reshape(-1, 2))
        finished.append(time.process_time())
    return positions, np.diff(finished)


def _detections(pings: Sequence[Contacts]) -> list[tuple[datetime, set[Any]]]:
    from stonesoup.models.measurement.linear import LinearGaussian
    from stonesoup.types.detection import Detection

    scans = []
    for ping in pings:
        placed = place_contacts(ping, 0.0)
        instant = _instant(ping.stamp)
        detections = {
            Detection(
                position[:, None],
                timestamp=instant,
                measurement_model=LinearGaussian(4, POSITION, noise_covar=covariance),
            )
            for position, covariance in zip(placed.position, placed.covariance, strict=True)
        }
        scans.append((instant, detections))
    return scans


def _instant(stamp: int) -> datetime:
    return datetime(1970, 1, 1, tzinfo=timezone.utc) + timedelta(microseconds=stamp // 1000)


def _tracker(
    scans: list[tuple[datetime, set[Any]]], parameters: PeerParameters, gated: bool
) -> Iterator[tuple[datetime, set[Any]]]:
    from stonesoup.dataassociator.neighbour import GNNWith2DAssignment
    from stonesoup.dataassociator.probability import JPDAwithEHM2
    from stonesoup.deleter.time import UpdateTimeStepsDeleter
    from stonesoup.hypothesiser.distance import DistanceHypothesiser
    from stonesoup.hypothesiser.probability import PDAHypothesiser
    from stonesoup.initiator.simple import MultiMeasurementInitiator
    from stonesoup.measures import Mahalanobis
    from stonesoup.models.transition.linear import (
        CombinedLinearGaussianTransitionModel,
        ConstantVelocity,
    )
    from stonesoup.predictor.kalman import KalmanPredictor
    from stonesoup.tracker.simple import MultiTargetMixtureTracker
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import KalmanUpdater

    # The velocity gains the same variance in an interval as by white acceleration of that step.
    density = parameters.acceleration_deviation**2 * parameters.interval
    predictor = KalmanPredictor(
        CombinedLinearGaussianTransitionModel([ConstantVelocity(density)] * 2)
    )
    updater = KalmanUpdater(None)
    nearest = DistanceHypothesiser(predictor, updater, Mahalanobis(), missed_distance=4)
    probable = PDAHypothesiser(
        predictor,
        updater,
        clutter_spatial_density=parameters.clutter_density,
        prob_detect=parameters.detection_probability,
        prob_gate=parameters.gate_probability,
    )
    if gated:
        nearest, probable = _gated(nearest, predictor), _gated(probable, predictor)
    speed = parameters.speed_deviation**2
    initiator = MultiMeasurementInitiator(
        prior_state=GaussianState([[0.0]] * 4, np.diag([0.0, speed, 0.0, speed])),
        deleter=UpdateTimeStepsDeleter(MISSES - 1),
        data_associator=GNNWith2DAssignment(nearest),
        updater=updater,
        min_points=POINTS,
    )
    tracker: Iterator[tuple[datetime, set[Any]]] = iter(
        MultiTargetMixtureTracker(
            initiator=initiator,
            deleter=UpdateTimeStepsDeleter(MISSES),
            detector=scans,
            data_associator=JPDAwithEHM2(probable),
            updater=updater,
        )
    )
    return tracker


def _gated(hypothesiser: Any, predictor: Any) -> Any:
    """Return a hypothesiser that is only asked about the contacts near a track."""
    from stonesoup.gater.base import Gater

    class NearContacts(Gater):
        def hypothesise(self, track: Any, detections: Any, timestamp: Any, **options: Any) -> Any:
            prediction = predictor.predict(track, timestamp=timestamp)
            mean = prediction.state_vector[POSITION, 0]
            variance = np.diag(prediction.covar)[list(POSITION)]
            near = {
                detection
                for detection in detections
                if np.all(
                    (detection.state_vector[:, 0] - mean) ** 2
                    < GATE_DEVIATIONS**2
                    * (variance + np.diag(detection.measurement_model.noise_covar))
                )
            }
            return self.hypothesiser.hypothesise(track, near, timestamp, **options)

    return NearContacts(hypothesiser)
