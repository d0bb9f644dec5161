"""One ping against the predicted tracks: its contacts in their gates, and what that says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.active.association.association_rule import GatedPing
from sonar_tracking.active.association.lm_ipda import PairEvidence
from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_model import DetectionModel, amplitude_ratios
from sonar_tracking.active.particle_tracks import GatedClouds, ParticleTracks, pair_densities
from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
    SensorGeometry,
    TrackGates,
    predict_gates,
    sensor_geometry,
    sensors_of_tracks,
)
from sonar_tracking.active.tracks.gate_thresholds import AppliedThresholds, apply_thresholds
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.active.tracks.pair_search import find_pairs
from sonar_tracking.active.tracks.pair_updates import PairUpdates, update_pairs
from sonar_tracking.active.tracks.scene_rows import SceneRows, joined
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts


@dataclass(frozen=True)
class PlacedPing:
    """Contacts of a ping and all that is known before they are associated.

    Attributes
    ----------
    stamp, next_stamp : int
        Of the ping, ns.
    placed : PlacedContacts
        Where the contacts were reflected.
    amplitudes : ndarray, shape (n_contacts,)
        Linear powers; NaN where not measured.
    contact_rows : SceneRows
        Whose contacts they are.
    models : sequence of DetectionModel
        Detection, clutter and amplitudes in each scene.
    sensors : sequence of SensorGeometry
        Where the ping came from in each scene.
    reaches : sequence of float
        Beyond which a track is out of range in each scene, m.
    """

    stamp: int
    next_stamp: int
    placed: PlacedContacts
    amplitudes: FloatArray
    contact_rows: SceneRows
    models: Sequence[DetectionModel]
    sensors: Sequence[SensorGeometry]
    reaches: Sequence[float]


@dataclass(frozen=True)
class PingGating:
    """Contacts of a ping in the gates of the predicted tracks.

    Attributes
    ----------
    tracks : SceneRows
        Whose tracks they are.
    gates : TrackGates
        Of the tracks.
    thresholds : sequence of AppliedThresholds
        In force in them, in each scene.
    pairs : GatePairs
        Contacts in gates that pass the thresholds.
    updates : PairUpdates
        Of the pairs.
    clouds : sequence of GatedClouds
        Pairs of tracks with particles in each scene; empty if they are not used.
    """

    tracks: SceneRows
    gates: TrackGates
    thresholds: Sequence[AppliedThresholds]
    pairs: GatePairs
    updates: PairUpdates
    clouds: Sequence[GatedClouds]

    def of_ping(self, ping: PlacedPing) -> GatedPing:
        """Return what a rule of association looks at."""
        pairs, thresholds = self.pairs, self.thresholds
        of_pairs = self.tracks.of(pairs.track)
        # Near the sensor all contacts point at a track: what counts is where it is, not they.
        distance = np.minimum(ping.placed.distance[pairs.contact], self.gates.distance[pairs.track])
        distances = of_pairs.split(distance)
        density = [m.clutter_density(d) for m, d in zip(ping.models, distances, strict=True)]
        share = joined([each.clutter_share for each in thresholds])
        threshold = joined([each.threshold for each in thresholds])
        evidence = PairEvidence(
            density=self.updates.density,
            amplitude_ratio=amplitude_ratios(
                ping.models,
                of_pairs.scene,
                ping.amplitudes[pairs.contact],
                threshold[pairs.track],
            ),
            clutter_density=joined(density) * share[pairs.track],
        )
        return GatedPing(
            pairs,
            evidence,
            ping.amplitudes,
            self.gates.volume,
            joined([each.detection_probability for each in thresholds]),
            ping.models[0].signal_to_noise_ratio_linear,
        )


def place_ping(
    pings: Sequence[Contacts],
    models: Sequence[DetectionModel],
    sound_speed: float,
    reaches: Sequence[float],
    shared: SharedPings,
) -> PlacedPing:
    """Bring the contacts of a ping into ``map``.

    Parameters
    ----------
    pings : sequence of Contacts
        The ping in each scene.
    models : sequence of DetectionModel
        What is known of it.
    sound_speed : float
        m/s; 0 = the ping takes no time.
    reaches : sequence of float
        Beyond which a track is out of range, m.
    shared : SharedPings
        Of trackers that are given the same pings.
    """
    return PlacedPing(
        stamp=pings[0].stamp,
        next_stamp=pings[0].next_stamp,
        placed=shared.place_together(pings, sound_speed),
        amplitudes=joined([_amplitudes(contacts) for contacts in pings]),
        contact_rows=SceneRows(tuple(len(contacts.range) for contacts in pings)),
        models=models,
        sensors=[sensor_geometry(contacts, sound_speed) for contacts in pings],
        reaches=reaches,
    )


def _amplitudes(contacts: Contacts) -> FloatArray:
    if len(contacts.amplitude):
        return contacts.amplitude
    return np.full(len(contacts.range), np.nan)


def gate_ping(
    bank: TrackBank,
    tracks: SceneRows,
    ping: PlacedPing,
    configuration: ContactTrackerConfiguration,
    particles: Sequence[ParticleTracks],
    modes: MotionModel,
) -> PingGating:
    """Pair the tracks with the contacts in their gates that pass the thresholds.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks.
    tracks : SceneRows
        Whose tracks they are.
    ping : PlacedPing
        The contacts.
    configuration : ContactTrackerConfiguration
        Which thresholds are wanted.
    particles : sequence of ParticleTracks
        Clouds of confirmed tracks, if they are used, in each scene.
    modes : MotionModel
        Of the targets.
    """
    gates = predict_gates(bank, sensors_of_tracks(ping.sensors, tracks))
    stamps = (ping.stamp, ping.next_stamp)
    thresholds = apply_thresholds(bank, tracks, gates, ping.models, configuration, stamps)
    threshold = joined([each.threshold for each in thresholds])
    of_both = (tracks, ping.contact_rows)
    pairs = find_pairs(bank, gates, ping.placed, ping.amplitudes, threshold, of_both)
    if modes.widest_mode is not None and bank.confirmed.any():
        far = _far_pairs(bank, tracks, ping, pairs, threshold, modes.widest_mode)
        pairs = _joined(pairs, far)
    updates = update_pairs(bank, ping.placed, pairs)
    clouds: Sequence[GatedClouds] = ()
    if particles[0].used:
        clouds = pair_densities(particles, bank, tracks, pairs, ping.placed, ping.sensors)
        updates = _with_densities(updates, clouds)
    return PingGating(tracks, gates, thresholds, pairs, updates, clouds)


def _with_densities(updates: PairUpdates, clouds: Sequence[GatedClouds]) -> PairUpdates:
    """Return the updates of all pairs with the clouds' densities where there is a cloud."""
    density = updates.density.copy()
    for own in clouds:
        density[own.rows, 0] = own.pairs.mean
    return replace(updates, density=density)


def _far_pairs(
    bank: TrackBank,
    tracks: SceneRows,
    ping: PlacedPing,
    pairs: GatePairs,
    threshold: FloatArray,
    widest_mode: int,
) -> GatePairs:
    """Return pairs of confirmed tracks and contacts beyond all gates, as after a hard turn.

    However improbable it is, a hard turn leads out of the gate of the mixture at once; a contact
    there is judged by the probability of that mode like all else. One in the gate of another
    confirmed track is rather that one's.
    """
    rows = np.flatnonzero(bank.confirmed)
    of_rows = tracks.of(rows)
    turning = bank.select(rows).in_mode(widest_mode)
    gates = predict_gates(turning, sensors_of_tracks(ping.sensors, of_rows))
    of_both = (of_rows, ping.contact_rows)
    found = find_pairs(turning, gates, ping.placed, ping.amplitudes, threshold[rows], of_both)
    explained = np.zeros(len(ping.amplitudes), dtype=bool)
    explained[pairs.contact[bank.confirmed[pairs.track]]] = True
    found = found.keep(~explained[found.contact])
    return GatePairs(rows[found.track], found.contact)


def _joined(first: GatePairs, second: GatePairs) -> GatePairs:
    """Return both, in the order of the tracks."""
    both = GatePairs(
        np.concatenate((first.track, second.track)),
        np.concatenate((first.contact, second.contact)),
    )
    return both.keep(np.argsort(both.track, kind="stable"))
