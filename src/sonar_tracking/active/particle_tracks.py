"""Particle clouds of the confirmed tracks, beside the Gaussian bank.

The bank stays the one list of tracks: a confirmed track's mean and covariance are those of its
cloud, so that gates, existence and management are the same with and without particles. Candidates
stay Gaussian: a cloud for each false contact would cost a hundred times more and gain nothing. The
clouds of all tracks of all scenes are computed together.

References
----------
Kim, Song (2007), equations 13-16: the association uses the likelihood of the whole cloud, the
weights those of the single particles, with both the target's and the clutter's term.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.tracks.cloud_pairs import CloudPairs, cloud_pairs, weigh_cloud
from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
    SensorGeometry,
)
from sonar_tracking.active.tracks.particle_cloud import (
    ParticleMotion,
    gaussian_cloud,
    no_clouds,
    predict_cloud,
    resample_cloud,
    stacked,
)
from sonar_tracking.active.tracks.scene_rows import SceneRows, joined_tables
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import FloatArray, IndexArray


class ParticleTracks:
    """Clouds of the confirmed tracks of a scene.

    Parameters
    ----------
    configuration : ContactTrackerConfiguration
        Parameters.
    used : bool
        Whether there are particles at all.

    Attributes
    ----------
    motion : ParticleMotion
        Of the particles.
    id : ndarray of int, shape (n,)
        Identifiers of the tracks, ascending.
    clouds : ParticleCloud
        One a track.
    """

    def __init__(self, configuration: ContactTrackerConfiguration, used: bool) -> None:
        self.used = used
        self.motion = ParticleMotion.configured(configuration)
        self.id = np.zeros(0, dtype=np.int64)
        self.clouds = no_clouds(configuration.n_particles)
        self._seed = configuration.seed

    @cached_property
    def generator(self) -> np.random.Generator:
        """Source of the randomness; most trackers do without it, and its 3 MB."""
        return np.random.default_rng(self._seed)

    def keep(self, bank: TrackBank) -> None:
        """Start clouds of newly confirmed tracks and forget those of ended ones."""
        if not self.used:
            return
        rows = np.flatnonzero(bank.confirmed)
        ids = bank.id[rows]
        if np.array_equal(ids, self.id):
            return
        known = np.isin(ids, self.id)
        kept = self.clouds.select(np.isin(self.id, ids))
        count = self.clouds.weight.shape[-1]
        started = [
            gaussian_cloud(bank.mean[row, 0], bank.covariance[row, 0], count, self.generator)
            for row in rows[~known]
        ]
        # Tracks are confirmed in any order.
        order = np.argsort(np.concatenate([np.flatnonzero(known), np.flatnonzero(~known)]))
        self.id, self.clouds = ids, joined_tables([kept, *map(stacked, started)]).select(order)


@dataclass(frozen=True)
class GatedClouds:
    """Contacts in the gates of the tracks of a scene that have clouds.

    Attributes
    ----------
    rows : ndarray of int, shape (n,)
        Of the pairs among all pairs.
    pairs : CloudPairs
        How well clouds and contacts explain each other.
    """

    rows: IndexArray
    pairs: CloudPairs


def predict_particles(
    particles: Sequence[ParticleTracks], bank: TrackBank, tracks: SceneRows, interval: float
) -> TrackBank:
    """Move all clouds and return the bank with their moments.

    Parameters
    ----------
    particles : sequence of ParticleTracks
        Of each scene; changed.
    bank : TrackBank
        Predicted.
    tracks : SceneRows
        Whose tracks they are.
    interval : float
        s.
    """
    for each in particles:
        each.clouds = predict_cloud(each.clouds, each.motion, interval, each.generator)
    return _with_moments(particles, bank, tracks)


def pair_densities(
    particles: Sequence[ParticleTracks],
    bank: TrackBank,
    tracks: SceneRows,
    pairs: GatePairs,
    contacts: PlacedContacts,
    sensors: Sequence[SensorGeometry],
) -> list[GatedClouds]:
    """Return the densities of the clouds at the contacts in their gates, in each scene.

    Parameters
    ----------
    particles : sequence of ParticleTracks
        Of each scene.
    bank : TrackBank
        Predicted.
    tracks : SceneRows
        Whose tracks they are.
    pairs : GatePairs
        Contacts in the gates.
    contacts : PlacedContacts
        Of the ping.
    sensors : sequence of SensorGeometry
        Where the ping came from in each scene.
    """
    rows = _rows(particles, bank, tracks)
    cloud_of_track = np.full(len(bank), -1, dtype=np.intp)
    cloud_of_track[np.concatenate(rows)] = np.concatenate([np.arange(len(own)) for own in rows])
    cloud = cloud_of_track[pairs.track]
    followed = np.flatnonzero(cloud >= 0)
    scenes = zip(particles, tracks.of(pairs.track[followed]).split(followed), sensors, strict=True)
    return [
        GatedClouds(
            own, cloud_pairs(each.clouds, cloud[own], contacts.select(pairs.contact[own]), sensor)
        )
        for each, own, sensor in scenes
    ]


def update_particles(
    particles: Sequence[ParticleTracks],
    bank: TrackBank,
    tracks: SceneRows,
    gated: Sequence[GatedClouds],
    weights: FloatArray,
) -> TrackBank:
    """Weigh all clouds by their contacts and return the bank with their moments.

    Parameters
    ----------
    particles : sequence of ParticleTracks
        Of each scene; changed.
    bank : TrackBank
        With Gaussian updates.
    tracks : SceneRows
        Whose tracks they are.
    gated : sequence of GatedClouds
        Contacts in the gates of tracks with clouds, in each scene.
    weights : ndarray, shape (n_pairs,)
        Probabilities of association of all pairs.
    """
    for each, own in zip(particles, gated, strict=True):
        weighed = weigh_cloud(each.clouds, own.pairs, weights[own.rows])
        each.clouds = resample_cloud(weighed, each.generator)
    return _with_moments(particles, bank, tracks)


def _rows(
    particles: Sequence[ParticleTracks], bank: TrackBank, tracks: SceneRows
) -> list[IndexArray]:
    """Return the row of the track of each cloud, in each scene."""
    scenes = zip(particles, tracks.split(bank.id), tracks.starts.tolist(), strict=True)
    return [ids.searchsorted(each.id) + first for each, ids, first in scenes]


def _with_moments(
    particles: Sequence[ParticleTracks], bank: TrackBank, tracks: SceneRows
) -> TrackBank:
    """Return the bank with the moments of the clouds."""
    mean, covariance = bank.mean.copy(), bank.covariance.copy()
    for each, rows in zip(particles, _rows(particles, bank, tracks), strict=True):
        mean[rows, 0], covariance[rows, 0] = each.clouds.moments()
    return replace(bank, mean=mean, covariance=covariance)
