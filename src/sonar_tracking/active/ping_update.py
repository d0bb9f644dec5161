"""One ping of a tracker of several targets: from its contacts to the tracks after it.

The scenes of several runs are computed at once. What is computed of a track does not depend on the
tracks of other scenes, so that all arrays hold those of one scene after the other; a node has one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.active.association.association_rule import AssociationRule
from sonar_tracking.active.association.lm_ipda import BankAssociation
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_levels import forget, mean_probability, weigh
from sonar_tracking.active.detection.detection_model import amplitude_ratios
from sonar_tracking.active.lasting_error import monitors_after
from sonar_tracking.active.particle_tracks import (
    ParticleTracks,
    predict_particles,
    update_particles,
)
from sonar_tracking.active.ping_gating import PingGating, PlacedPing, gate_ping, place_ping
from sonar_tracking.active.scene_memory import AdmittedPing, SceneMemory, pictures_of
from sonar_tracking.active.tracks.measured_positions import measured_positions
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.active.tracks.pair_updates import mix_updates
from sonar_tracking.active.tracks.scene_rows import SceneRows, joined, joined_tables
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.active.tracks.track_bank import (
    TrackBank,
    new_target_modes,
    predict_bank,
    scene_changes,
)
from sonar_tracking.active.tracks.track_management import (
    ListedTracks,
    duplicates,
    limit_tracks,
    list_tracks,
    listed_rows,
    start_candidates,
    survivors,
)
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate

LARGEST_CLAIM_OF_A_NEW_CONTACT = 0.5
"""A contact that tracks explain with more than this probability starts no candidate."""


@dataclass(frozen=True)
class TrackingMethod:
    """How contacts become tracks.

    Attributes
    ----------
    configuration : ContactTrackerConfiguration
        Parameters.
    rule : AssociationRule
        How contacts are associated with tracks.
    modes : MotionModel
        How targets move.
    """

    configuration: ContactTrackerConfiguration
    rule: AssociationRule
    modes: MotionModel


def update_scenes(
    method: TrackingMethod,
    scenes: Sequence[SceneMemory],
    pings: Sequence[Contacts],
    shared: SharedPings | None = None,
) -> list[ContactTrackerUpdate]:
    """Return the tracks of several scenes after one ping.

    Scenes with pings at other times are computed one after the other.

    Parameters
    ----------
    method : TrackingMethod
        The same for all.
    scenes : sequence of SceneMemory
        What is remembered of each; changed.
    pings : sequence of Contacts
        One a scene.
    shared : SharedPings, optional
        Of trackers that are given the same pings.

    Raises
    ------
    InputError
        If a ping cannot be used; nothing is then changed.
    """
    configuration, shared = method.configuration, shared or SharedPings()
    admitted = [
        scene.admit(contacts, configuration, shared)
        for scene, contacts in zip(scenes, pings, strict=True)
    ]
    if len(scenes) == 1 or _alike(scenes, admitted):
        return _update_at_once(method, scenes, admitted, shared)
    return [
        update
        for scene, ping in zip(scenes, admitted, strict=True)
        for update in _update_at_once(method, [scene], [ping], shared)
    ]


def predict_scenes(method: TrackingMethod, scenes: Sequence[SceneMemory], stamp: int) -> TrackBank:
    """Return the tracks of all scenes, moved to the transmit time of a ping.

    Parameters
    ----------
    method : TrackingMethod
        Its motion model and parameters.
    scenes : sequence of SceneMemory
        With the same ping before.
    stamp : int
        Of the ping, ns.
    """
    last = scenes[0].last
    interval = 0.0 if last is None else last.interval(stamp)
    survival = method.configuration.survival_probability(interval)
    tracks = SceneRows(tuple(len(scene.bank) for scene in scenes))
    bank = joined_tables([scene.bank for scene in scenes])
    pooled = tracks.spread([scene_changes(scene.bank) for scene in scenes])
    bank = predict_bank(bank, method.modes, interval, survival, pooled)
    levels = tracks.spread([scene.new_detection for scene in scenes])
    bank = replace(bank, detection_weight=forget(bank.detection_weight, levels))
    particles = [scene.particles for scene in scenes]
    return predict_particles(particles, bank, tracks, interval) if particles[0].used else bank


def _alike(scenes: Sequence[SceneMemory], pings: Sequence[AdmittedPing]) -> bool:
    """Return whether scenes can be computed at once."""
    times = {
        (ping.contacts.stamp, ping.contacts.next_stamp, scene.last and scene.last.stamp)
        for scene, ping in zip(scenes, pings, strict=True)
    }
    levels = {ping.model.signal_to_noise_ratio_linear for ping in pings}
    return len(times) == len(levels) == 1


def _update_at_once(
    method: TrackingMethod,
    scenes: Sequence[SceneMemory],
    admitted: Sequence[AdmittedPing],
    shared: SharedPings,
) -> list[ContactTrackerUpdate]:
    configuration = method.configuration
    known = [scene.learn(ping) for scene, ping in zip(scenes, admitted, strict=True)]
    ping = place_ping(
        [each.contacts for each in known],
        [each.model for each in known],
        configuration.sound_speed,
        [each.reach for each in known],
        shared,
    )
    tracks = SceneRows(tuple(len(scene.bank) for scene in scenes))
    predicted = predict_scenes(method, scenes, ping.stamp)
    particles = [scene.particles for scene in scenes]
    gating = gate_ping(predicted, tracks, ping, configuration, particles, method.modes)
    association = method.rule.associate(predicted, gating.of_ping(ping))
    bank = _update_states(particles, tracks, association, gating)
    bank = _confirmed(configuration, predicted, bank, association, gating, ping)
    listed = _which_end(configuration, scenes, tracks, bank, association, gating, ping)
    candidates, new = _start_candidates(method, scenes, association, gating, ping)
    next_ids = [scene.next_id + count for scene, count in zip(scenes, new.counts, strict=True)]
    most = configuration.maximum_tracks
    listed, candidates, new = _limited(listed, tracks, candidates, new, most)
    received = [each.contacts for each in admitted]
    monitors = [scene.lasting for scene in scenes]
    lasting = monitors_after(
        monitors, listed, tracks, gating.pairs, association, received, ping.placed
    )
    banks = _banks_of_scenes(listed, tracks, candidates, new)
    for number, scene in enumerate(scenes):
        scene.remember(banks[number], next_ids[number], lasting[number], received[number])
    rows = listed_rows(listed, method.configuration.tentative_probability)
    shown = list_tracks(listed, rows, method.modes.static_mode)
    if not particles[0].used:
        pairs = gating.pairs
        found = association.bank.contact_probabilities(pairs.track, association.weights)
        measured = measured_positions(predicted, ping.placed, pairs, found, rows)
        shown = replace(shown, measured=measured)
    pictures = pictures_of(scenes, shown, tracks.of(rows), (ping.stamp, ping.next_stamp))
    return [
        scene.report(own, applied.published, each.notices)
        for scene, own, applied, each in zip(
            scenes, pictures, gating.thresholds, known, strict=True
        )
    ]


def _update_states(
    particles: Sequence[ParticleTracks],
    tracks: SceneRows,
    association: BankAssociation,
    gating: PingGating,
) -> TrackBank:
    """Update all tracks by their contacts, confirmed ones with particles if there are any."""
    weights, pairs = association.weights, gating.pairs
    bank = mix_updates(association.bank, pairs, gating.updates, weights)
    levels = bank.detection_weight
    mean = joined([mean_probability(own) for own in tracks.split(levels)])
    bank = replace(bank, detection_weight=weigh(levels, mean, association.likelihood_ratio))
    if not particles[0].used:
        return bank
    return update_particles(particles, bank, tracks, gating.clouds, weights[:, 0])


def _confirmed(
    configuration: ContactTrackerConfiguration,
    predicted: TrackBank,
    bank: TrackBank,
    association: BankAssociation,
    gating: PingGating,
    ping: PlacedPing,
) -> TrackBank:
    """Return the tracks, those that exist confirmed."""
    bank = replace(
        bank,
        confirmed=bank.confirmed | (bank.existence >= configuration.confirmation_probability),
        updated=np.where(association.detected > 0.5, ping.stamp, bank.updated),
    )
    # Most tracks are candidates without a contact: what they were predicted to be, they are.
    bank.remember_moments(predicted, gating.pairs.track[gating.pairs.first_of_each_track()])
    return bank


def _which_end(
    configuration: ContactTrackerConfiguration,
    scenes: Sequence[SceneMemory],
    tracks: SceneRows,
    bank: TrackBank,
    association: BankAssociation,
    gating: PingGating,
    ping: PlacedPing,
) -> ListedTracks:
    """Find out which tracks go on."""
    mean, _ = bank.position_moments()
    separation = mean[:, :2] - tracks.spread([sensor.position for sensor in ping.sensors])
    distance = np.hypot(separation[:, 0], separation[:, 1])
    detection = tracks.spread([float(mean_probability(scene.new_detection)) for scene in scenes])
    alive = survivors(bank, distance, tracks.spread(ping.reaches), detection, configuration)
    alive &= ~duplicates(bank, gating.pairs, association.weights)
    ids = tracks.split(bank.id)
    shown = [scene.were_shown(own) for scene, own in zip(scenes, ids, strict=True)]
    return ListedTracks(bank, alive, joined(shown), association.detected)


def _start_candidates(
    method: TrackingMethod,
    scenes: Sequence[SceneMemory],
    association: BankAssociation,
    gating: PingGating,
    ping: PlacedPing,
) -> tuple[TrackBank, SceneRows]:
    """Start a candidate at each contact that no track explains, and return whose they are, too.

    Most of them are clutter.
    """
    contacts, modes = ping.contact_rows, method.modes
    threshold = contacts.spread([applied.search_threshold for applied in gating.thresholds])
    free = association.claimed <= LARGEST_CLAIM_OF_A_NEW_CONTACT
    columns = (free, ping.amplitudes, ping.placed.distance)
    for scene, model, own, loud, distance in zip(
        scenes, ping.models, *map(contacts.split, columns), strict=True
    ):
        excess = loud[own] - model.threshold
        scene.clutter = scene.clutter.with_unexplained(excess, distance[own], model)
    rows = np.flatnonzero(free & ~(ping.amplitudes < threshold))
    new = contacts.of(rows)
    firsts = zip(scenes, new.starts.tolist(), strict=True)
    thresholds = (np.zeros(len(ping.amplitudes)) + threshold)[rows]
    candidates = start_candidates(
        ping.placed.select(rows),
        _initial_existence(method, ping, rows, thresholds),
        ping.stamp,
        new.spread([scene.next_id - first for scene, first in firsts]),
        modes,
        new.spread([new_target_modes(scene.bank, modes) for scene in scenes]),
        new.spread([scene.new_detection for scene in scenes]),
    )
    return candidates, new


def _initial_existence(
    method: TrackingMethod, ping: PlacedPing, rows: IndexArray, thresholds: FloatArray
) -> FloatArray:
    initial = method.configuration.initial_existence
    if not method.rule.weighs_amplitudes:
        return np.full(len(rows), initial)
    scene = ping.contact_rows.scene[rows]
    ratio = amplitude_ratios(ping.models, scene, ping.amplitudes[rows], thresholds)
    odds = initial / (1.0 - initial) * ratio
    return np.minimum(odds / (1.0 + odds), 0.5 * method.configuration.confirmation_probability)


def _limited(
    listed: ListedTracks,
    tracks: SceneRows,
    candidates: TrackBank,
    new: SceneRows,
    maximum_tracks: int,
) -> tuple[ListedTracks, TrackBank, SceneRows]:
    """Return tracks and candidates of which the least probable end if a scene has too many."""
    if max(tracks.counts) + max(new.counts) <= maximum_tracks:
        return listed, candidates, new
    parts = zip(tracks.parts(listed), new.parts(candidates), strict=True)
    limited = [limit_tracks(*scene, maximum_tracks) for scene in parts]
    alive = joined([own.alive for own, _ in limited])
    counts = tuple(len(started) for _, started in limited)
    started = joined_tables([started for _, started in limited])
    return replace(listed, alive=alive), started, SceneRows(counts)


def _banks_of_scenes(
    listed: ListedTracks, tracks: SceneRows, candidates: TrackBank, new: SceneRows
) -> list[TrackBank]:
    """Return the tracks that go on and those that begin, of each scene."""
    rows = np.flatnonzero(listed.alive)
    if tracks.single:
        return [listed.bank.select(rows).append(candidates)]
    left = tracks.of(rows)
    order = np.argsort(np.concatenate([left.scene, new.scene]), kind="stable")
    rows = np.concatenate([rows, len(listed.bank) + np.arange(len(candidates))])[order]
    counts = [old + begun for old, begun in zip(left.counts, new.counts, strict=True)]
    return SceneRows(tuple(counts)).parts(listed.bank.append(candidates).select(rows))
