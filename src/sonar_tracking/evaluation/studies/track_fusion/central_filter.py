"""The filter of all measurements that is told whose each of them is, and the bound by it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.active.contacts.contact_positions import place_contacts
from sonar_tracking.alignment.aligned_targets import MotionStrengths
from sonar_tracking.evaluation.offline.offline_fusion_chain import FusedMoment
from sonar_tracking.evaluation.studies.track_fusion.conditions import ACCELERATION
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.station_bearings import station_bearings
from sonar_tracking.fusion.target_filters import TargetFilters
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.time import seconds

TOLD = MotionStrengths(np.array([ACCELERATION**2]), np.ones(1), 1.0)
"""How the ships really move."""

SPEED_DEVIATION = 6.0
"""Of each component of the velocity of a ship of which nothing is known, m/s."""

CONTACT_GATE = 16.0
"""A contact is the ship's if it is the nearest to the truth within so many variances."""


class CentralFilter:
    """Follows the true ships, with their own contacts and bearings alone.

    Parameters
    ----------
    configuration : TrackFusionConfiguration
        Prior of the alignment, speed of sound.
    exact : bool
        Measurements are taken to be without errors, as they would be at the truth: the covariance
        is then the posterior Cramer-Rao bound.
    """

    def __init__(self, configuration: TrackFusionConfiguration, exact: bool = False) -> None:
        self._configuration = configuration
        self._exact = exact
        variance = configuration.alignment_variance
        self._filters = TargetFilters(TOLD, variance, configuration.propagation_speed)
        self._ships: dict[int, FusedTarget] = {}
        self._stamp: int | None = None

    def update(self, moment: FusedMoment) -> None:
        """Take in what was received at a stamp."""
        if self._stamp is not None:
            self._filters.predict(seconds(moment.frame.stamp - self._stamp))
        self._stamp = moment.frame.stamp
        if moment.contacts is not None and moment.frame.active:
            self._take_contacts(moment.contacts, moment)
        for bearings in moment.frame.bearings:
            array = self._filters.array_of(bearings.sensor.sensor_id)
            told = station_bearings(bearings, moment.own_ship, array, self._configuration)
            pairs = [
                (self._ships[one.key[1]], one) for one in told.found if one.key[1] in self._ships
            ]
            if pairs:
                targets = [target for target, _ in pairs]
                found = [one for _, one in pairs]
                self._filters.take_bearings(targets, self._heard(targets, found))

    def states(self) -> dict[int, tuple[FloatArray, FloatArray]]:
        """Return mean, shape (4,), and covariance, shape (4, 4), of each ship, m and m/s."""
        seen = self._filters.picture()
        rows = {target: row for row, target in enumerate(self._filters.targets)}
        return {
            number: (seen.mean[rows[target], :4], seen.covariance[rows[target], :4, :4])
            for number, target in self._ships.items()
        }

    def _heard(self, targets: list[FusedTarget], found: list[HeardBearing]) -> list[HeardBearing]:
        """Return the bearings, or where the ships are expected to be heard."""
        if not self._exact:
            return found
        expected, _ = self._filters.expected(found[0])
        rows = {target: row for row, target in enumerate(self._filters.targets)}
        return [
            replace(one, azimuths=(float(expected[rows[target]]),))
            for target, one in zip(targets, found, strict=True)
        ]

    def _take_contacts(self, contacts: Contacts, moment: FusedMoment) -> None:
        placed = place_contacts(contacts, self._configuration.sound_speed)
        truth = moment.truth
        for number, position, velocity in zip(
            truth.id, truth.position, truth.velocity, strict=True
        ):
            apart = placed.position - position - placed.delay[:, None] * velocity
            solved = np.linalg.solve(placed.covariance, apart[..., None])[..., 0]
            distance = np.sum(apart * solved, axis=1)
            if not distance.size or np.min(distance) > CONTACT_GATE:
                continue
            nearest = int(np.argmin(distance))
            noise = placed.covariance[nearest]
            # At the stamp: the ship has moved on until it reflected the ping.
            measured = position if self._exact else position + apart[nearest]
            target = self._ships.get(int(number))
            if target is not None:
                self._filters.take_positions([target], measured[None], noise[None])
                continue
            self._ships[int(number)] = target = FusedTarget(int(number), 0.0)
            spread = np.zeros((4, 4))
            spread[:2, :2], spread[2:, 2:] = noise, SPEED_DEVIATION**2 * np.eye(2)
            start = velocity if self._exact else np.zeros(2)
            self._filters.begin(target, np.concatenate([measured, start]), spread)
