"""Particle clouds of the confirmed tracks, beside the Gaussian bank.

The bank stays the one list of tracks: a confirmed track's mean and covariance are those of its
cloud, so that gates, existence and management are the same with and without particles. Candidates
stay Gaussian: a cloud for each false contact would cost a hundred times more and gain nothing.

References
----------
Kim, Song (2007), equations 13-16: the association uses the likelihood of the whole cloud, the
weights those of the single particles, with both the target's and the clutter's term.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.tracks.contact_gating import GatePairs, SensorGeometry
from sonar_tracking.active.tracks.pair_updates import PairUpdates
from sonar_tracking.active.tracks.particle_cloud import (
    ParticleCloud,
    ParticleMotion,
    gaussian_cloud,
    predict_cloud,
    resample_cloud,
)
from sonar_tracking.active.tracks.particle_densities import particle_densities
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import FloatArray


class ParticleTracks:
    """Clouds by track identifier.

    Parameters
    ----------
    configuration : ContactTrackerConfiguration
        Parameters.
    used : bool
        Whether there are particles at all.
    """

    def __init__(self, configuration: ContactTrackerConfiguration, used: bool) -> None:
        self.used = used
        self._count = configuration.n_particles
        self._motion = ParticleMotion.configured(configuration)
        self._seed = configuration.seed
        self._clouds: dict[int, ParticleCloud] = {}
        self._densities: dict[int, FloatArray] = {}

    @cached_property
    def _generator(self) -> np.random.Generator:
        # Most trackers have no particles, and do without 3 MB of generators.
        return np.random.default_rng(self._seed)

    def predict(self, bank: TrackBank, interval: float) -> TrackBank:
        """Move all clouds and return the bank with their moments.

        Parameters
        ----------
        bank : TrackBank
            Predicted.
        interval : float
            s.
        """
        for identifier, cloud in self._clouds.items():
            self._clouds[identifier] = predict_cloud(cloud, self._motion, interval, self._generator)
        return self._with_moments(bank)

    def pair_densities(
        self,
        bank: TrackBank,
        pairs: GatePairs,
        updates: PairUpdates,
        contacts: PlacedContacts,
        sensor: SensorGeometry,
    ) -> PairUpdates:
        """Return the updates with the clouds' densities where there is a cloud."""
        density = updates.density.copy()
        self._densities = {}
        first = np.searchsorted(pairs.track, np.arange(len(bank) + 1))
        for row in self._rows(bank):
            own = slice(first[row], first[row + 1])
            cloud = self._clouds[int(bank.id[row])]
            single = particle_densities(
                cloud.state,
                contacts.select(pairs.contact[own]),
                sensor,
            )
            self._densities[int(bank.id[row])] = single
            density[own, 0] = np.maximum(cloud.weight @ single / np.sum(cloud.weight), 1e-30)
        return replace(updates, density=density)

    def update(self, bank: TrackBank, pairs: GatePairs, weights: FloatArray) -> TrackBank:
        """Weigh all clouds by their contacts and return the bank with their moments.

        Parameters
        ----------
        bank : TrackBank
            With Gaussian updates.
        pairs : GatePairs
            Contacts in the gates.
        weights : ndarray, shape (n_pairs,)
            Probabilities of association.
        """
        first = np.searchsorted(pairs.track, np.arange(len(bank) + 1))
        for row in self._rows(bank):
            identifier = int(bank.id[row])
            cloud, single = self._clouds[identifier], self._densities[identifier]
            share = cloud.weight / np.sum(cloud.weight)
            beta = weights[first[row] : first[row + 1]]
            relative = single / np.maximum(share @ single, 1e-30)
            factor = 1.0 - np.sum(beta) + relative @ beta
            weighed = ParticleCloud(cloud.state, cloud.mode, share * factor)
            self._clouds[identifier] = resample_cloud(weighed, self._generator)
        return self._with_moments(bank)

    def keep(self, bank: TrackBank) -> None:
        """Start clouds of newly confirmed tracks and forget those of ended ones."""
        if not self.used:
            return
        kept = {}
        for row in np.flatnonzero(bank.confirmed):
            identifier = int(bank.id[row])
            cloud = self._clouds.get(identifier)
            if cloud is None:
                mean, covariance = bank.mean[row, 0], bank.covariance[row, 0]
                cloud = gaussian_cloud(mean, covariance, self._count, self._generator)
            kept[identifier] = cloud
        self._clouds = kept

    def _rows(self, bank: TrackBank) -> list[int]:
        """Return the rows of the tracks with a cloud, in ascending order."""
        followed = np.array(sorted(self._clouds), dtype=np.int64)
        rows = bank.id.searchsorted(followed)
        there = rows < len(bank)
        there[there] = bank.id[rows[there]] == followed[there]
        return [int(row) for row in rows[there]]

    def _with_moments(self, bank: TrackBank) -> TrackBank:
        mean, covariance = bank.mean.copy(), bank.covariance.copy()
        for row in self._rows(bank):
            mean[row, 0], covariance[row, 0] = self._clouds[int(bank.id[row])].moments()
        return replace(bank, mean=mean, covariance=covariance)
