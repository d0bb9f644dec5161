"""One ping against the predicted tracks: its contacts in their gates, and what that says."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.active.association.association_rule import GatedPing
from sonar_tracking.active.association.lm_ipda import PairEvidence
from sonar_tracking.active.contacts.contact_positions import PlacedContacts, place_contacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.active.particle_tracks import ParticleTracks
from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
    SensorGeometry,
    TrackGates,
    predict_gates,
    sensor_geometry,
)
from sonar_tracking.active.tracks.gate_thresholds import AppliedThresholds, apply_thresholds
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.active.tracks.pair_search import find_pairs
from sonar_tracking.active.tracks.pair_updates import PairUpdates, update_pairs
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
    model : DetectionModel
        Detection, clutter and amplitudes.
    sensor : SensorGeometry
        Where the ping came from.
    reach : float
        Beyond which a track is out of range, m.
    """

    stamp: int
    next_stamp: int
    placed: PlacedContacts
    amplitudes: FloatArray
    model: DetectionModel
    sensor: SensorGeometry
    reach: float


@dataclass(frozen=True)
class PingGating:
    """Contacts of a ping in the gates of the predicted tracks.

    Attributes
    ----------
    gates : TrackGates
        Of the tracks.
    thresholds : AppliedThresholds
        In force in them.
    pairs : GatePairs
        Contacts in gates that pass the thresholds.
    updates : PairUpdates
        Of the pairs.
    """

    gates: TrackGates
    thresholds: AppliedThresholds
    pairs: GatePairs
    updates: PairUpdates

    def of_ping(self, ping: PlacedPing) -> GatedPing:
        """Return what a rule of association looks at."""
        pairs, thresholds = self.pairs, self.thresholds
        # Near the sensor all contacts point at a track: what counts is where it is, not they.
        distance = np.minimum(ping.placed.distance[pairs.contact], self.gates.distance[pairs.track])
        density = ping.model.clutter_density(distance)
        evidence = PairEvidence(
            density=self.updates.density,
            amplitude_ratio=ping.model.amplitude_ratio(
                ping.amplitudes[pairs.contact], thresholds.threshold[pairs.track]
            ),
            clutter_density=density * thresholds.clutter_share[pairs.track],
        )
        return GatedPing(
            pairs,
            evidence,
            ping.amplitudes,
            self.gates.volume,
            thresholds.detection_probability,
            ping.model.signal_to_noise_ratio_linear,
        )


def place_ping(
    contacts: Contacts, model: DetectionModel, sound_speed: float, reach: float
) -> PlacedPing:
    """Bring the contacts of a ping into ``map``.

    Parameters
    ----------
    contacts : Contacts
        The ping.
    model : DetectionModel
        What is known of it.
    sound_speed : float
        m/s; 0 = the ping takes no time.
    reach : float
        Beyond which a track is out of range, m.
    """
    measured = len(contacts.amplitude) > 0
    return PlacedPing(
        stamp=contacts.stamp,
        next_stamp=contacts.next_stamp,
        placed=place_contacts(contacts, sound_speed),
        amplitudes=contacts.amplitude if measured else np.full(len(contacts.range), np.nan),
        model=model,
        sensor=sensor_geometry(contacts, sound_speed),
        reach=reach,
    )


def gate_ping(
    bank: TrackBank,
    ping: PlacedPing,
    configuration: ContactTrackerConfiguration,
    particles: ParticleTracks,
    modes: MotionModel,
) -> PingGating:
    """Pair the tracks with the contacts in their gates that pass the thresholds.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks.
    ping : PlacedPing
        The contacts.
    configuration : ContactTrackerConfiguration
        Which thresholds are wanted.
    particles : ParticleTracks
        Clouds of confirmed tracks, if they are used.
    modes : MotionModel
        Of the targets.
    """
    gates = predict_gates(bank, ping.sensor)
    thresholds = apply_thresholds(
        bank, gates, ping.model, configuration, ping.stamp, ping.next_stamp
    )
    pairs = find_pairs(bank, gates, ping.placed, ping.amplitudes, thresholds.threshold)
    if modes.widest_mode is not None and bank.confirmed.any():
        pairs = _joined(pairs, _far_pairs(bank, ping, pairs, thresholds, modes.widest_mode))
    updates = update_pairs(bank, ping.placed, pairs)
    if particles.used:
        updates = particles.pair_densities(bank, pairs, updates, ping.placed, ping.sensor)
    return PingGating(gates, thresholds, pairs, updates)


def _far_pairs(
    bank: TrackBank,
    ping: PlacedPing,
    pairs: GatePairs,
    thresholds: AppliedThresholds,
    widest_mode: int,
) -> GatePairs:
    """Return pairs of confirmed tracks and contacts beyond all gates, as after a hard turn.

    However improbable it is, a hard turn leads out of the gate of the mixture at once; a contact
    there is judged by the probability of that mode like all else. One in the gate of another
    confirmed track is rather that one's.
    """
    rows = np.flatnonzero(bank.confirmed)
    in_mode = np.eye(bank.mode_probability.shape[1])[widest_mode]
    turning = replace(bank.select(rows), mode_probability=np.tile(in_mode, (len(rows), 1)))
    gates = predict_gates(turning, ping.sensor)
    found = find_pairs(turning, gates, ping.placed, ping.amplitudes, thresholds.threshold[rows])
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
