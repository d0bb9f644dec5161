"""Automatic detection and tracking of several targets from contacts in clutter.

At each ping: all tracks are predicted to its transmit time; contacts are paired with gates;
association gives each track its contacts, its motion mode and its probability of existence; the
states are updated; tracks are confirmed and ended; contacts that no track explains start
candidates. All false contacts start candidates, too, so that everything is done on arrays.

Association is by integrated multi-target PDA with amplitude likelihoods and turning motion modes
(``integrated``, the most accurate), or by the published rule of the one contact best by amplitude
rank (``hpda_kalman``; ``hpda_particle`` follows confirmed targets with particles).

References
----------
Kim, Song (2007); Musicki, La Scala (2008); Jung, Shin (2002) for thresholds in the gates.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.active.association.association_rule import (
    HPDA,
    HPDA_WITH_PARTICLES,
    LM_IPDA,
    AssociationRule,
    GatedPing,
)
from sonar_tracking.active.association.lm_ipda import BankAssociation, PairEvidence
from sonar_tracking.active.contacts.contact_checks import (
    PingOrigin,
    check_order,
    check_ping,
    origin_of,
    sensor_jump,
)
from sonar_tracking.active.contacts.contact_positions import PlacedContacts, place_contacts
from sonar_tracking.active.contacts.contact_tracker_configuration import (
    ContactTrackerConfiguration,
    check_configuration,
)
from sonar_tracking.active.detection.clutter_monitor import ClutterMonitor
from sonar_tracking.active.detection.detection_model import DetectionModel, make_detection_model
from sonar_tracking.active.particle_tracks import ParticleTracks
from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
    SensorGeometry,
    TrackGates,
    predict_gates,
    sensor_geometry,
)
from sonar_tracking.active.tracks.contact_track_list import shown_tracks, thresholds_without_gates
from sonar_tracking.active.tracks.gate_thresholds import (
    AppliedThresholds,
    apply_thresholds,
    check_thresholds,
)
from sonar_tracking.active.tracks.motion_modes import MotionModes
from sonar_tracking.active.tracks.pair_search import find_pairs
from sonar_tracking.active.tracks.pair_updates import PairUpdates, mix_updates, update_pairs
from sonar_tracking.active.tracks.track_bank import TrackBank, empty_bank, predict_bank
from sonar_tracking.active.tracks.track_management import (
    ListedTracks,
    duplicates,
    limit_tracks,
    list_tracks,
    start_candidates,
    survivors,
)
from sonar_tracking.errors import Notice
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate, GateThresholds

LARGEST_CLAIM_OF_A_NEW_CONTACT = 0.5
"""A contact that tracks explain with more than this probability starts no candidate."""


@dataclass(frozen=True)
class _Ping:
    """Contacts of a ping and all that is known before they are associated."""

    stamp: int
    next_stamp: int
    placed: PlacedContacts
    amplitudes: FloatArray
    model: DetectionModel
    sensor: SensorGeometry
    reach: float
    """Beyond which a track is out of range, m."""


@dataclass(frozen=True)
class _Gating:
    """Contacts of a ping in the gates of the predicted tracks."""

    gates: TrackGates
    thresholds: AppliedThresholds
    pairs: GatePairs
    updates: PairUpdates


class MultiTargetTracker:
    """Tracks of several targets from contacts in clutter.

    Parameters
    ----------
    configuration : ContactTrackerConfiguration
        Parameters.
    rule : AssociationRule
        How contacts are associated with tracks.

    Raises
    ------
    ConfigurationError
        If parameters do not fit together.
    """

    def __init__(self, configuration: ContactTrackerConfiguration, rule: AssociationRule) -> None:
        check_configuration(configuration)
        self.configuration = configuration
        self._rule = rule
        turning = rule.has_motion_modes and configuration.motion == "turning"
        self._modes = MotionModes(
            n_modes=3 if turning else 1,
            acceleration_deviation=configuration.acceleration_deviation,
            lateral_acceleration=configuration.lateral_acceleration,
            turn_probability=configuration.turn_probability,
            stay_probability=configuration.stay_probability,
        )
        self._bank = empty_bank(self._modes.n_modes)
        self._particles = ParticleTracks(configuration, used=rule.has_particles)
        self._clutter = ClutterMonitor()
        self._next_id = configuration.first_id
        self._shown = np.zeros(0, dtype=np.int64)
        self._last: PingOrigin | None = None

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""
        self._next_id = max(self._next_id, first_id)

    @property
    def next_id(self) -> int:
        """Identifier the next track will get."""
        return self._next_id

    def warm_up(self) -> None:
        """Load what the first ping needs."""
        self._rule.warm_up()

    def update(self, contacts: Contacts) -> ContactTrackerUpdate:
        """Return the tracks after one ping.

        Parameters
        ----------
        contacts : Contacts
            Of the ping; may be empty.

        Raises
        ------
        InputError
            If the ping cannot be used; the state is then unchanged.
        """
        contacts, notices = check_ping(contacts, self._last)
        ping, guesses = self._place(contacts)
        bank = self._predict(ping.stamp)
        gating = self._gate(bank, ping)
        association = self._associate(bank, gating, ping)
        bank = self._update_states(association, gating)
        listed = self._confirm_and_end(bank, association, gating, ping)
        candidates = self._start_candidates(association, gating, ping)
        listed, candidates = limit_tracks(listed, candidates, self.configuration.maximum_tracks)
        self._bank = listed.bank.select(listed.alive).append(candidates)
        self._last = origin_of(contacts)
        self._particles.keep(self._bank)
        notices = (*notices, *guesses, *self._clutter.notices())
        return self._report(listed, gating.thresholds.published, notices)

    def coast(self, stamp: int, next_stamp: int) -> ContactTrackerUpdate:
        """Return the tracks predicted to a ping of which nothing else is known.

        Parameters
        ----------
        stamp, next_stamp : int
            Of the ping, ns.

        Raises
        ------
        InputError
            If the stamp is not later than that of the ping before.
        """
        check_order(stamp, self._last)
        bank = self._predict(stamp)
        model = self.configuration
        nowhere = np.zeros(len(bank))
        alive = survivors(bank, nowhere, np.inf, model.detection_probability, model)
        listed = ListedTracks(bank, alive, self._was_shown(bank), detected=nowhere)
        self._bank = bank.select(alive)
        self._last = self._last and self._last.moved_to(stamp)
        self._particles.keep(self._bank)
        return self._report(listed, thresholds_without_gates(stamp, next_stamp), ())

    def _place(self, contacts: Contacts) -> tuple[_Ping, tuple[Notice, ...]]:
        """Bring the contacts into ``map`` and find out how dense false ones are."""
        model, guesses = make_detection_model(contacts, self.configuration)
        check_thresholds(model, self.configuration)
        n_confirmed = int(np.count_nonzero(self._bank.confirmed))
        self._clutter = self._clutter.after(len(contacts.range), n_confirmed, model)
        sound_speed = self.configuration.sound_speed
        measured = len(contacts.amplitude) > 0
        ping = _Ping(
            stamp=contacts.stamp,
            next_stamp=contacts.next_stamp,
            placed=place_contacts(contacts, sound_speed),
            amplitudes=contacts.amplitude if measured else np.full(len(contacts.range), np.nan),
            model=self._clutter.corrected(model),
            sensor=sensor_geometry(contacts, sound_speed),
            # A sensor that has jumped may be back at the next ping: no track ends for its place.
            reach=np.inf if sensor_jump(contacts, self._last) else model.maximum_range,
        )
        return ping, guesses

    def _predict(self, stamp: int) -> TrackBank:
        """Move all tracks to the transmit time of a ping."""
        interval = 0.0 if self._last is None else self._last.interval(stamp)
        survival = self.configuration.survival_probability
        bank = predict_bank(self._bank, self._modes, interval, survival)
        return self._particles.predict(bank, interval) if self._particles.used else bank

    def _gate(self, bank: TrackBank, ping: _Ping) -> _Gating:
        """Pair the tracks with the contacts in their gates that pass the thresholds."""
        gates = predict_gates(bank, ping.sensor)
        thresholds = apply_thresholds(
            bank, gates, ping.model, self.configuration, ping.stamp, ping.next_stamp
        )
        pairs = find_pairs(bank, gates, ping.placed, ping.amplitudes, thresholds.threshold)
        updates = update_pairs(bank, ping.placed, pairs)
        if self._particles.used:
            updates = self._particles.pair_densities(bank, pairs, updates, ping.placed, ping.sensor)
        return _Gating(gates, thresholds, pairs, updates)

    def _associate(self, bank: TrackBank, gating: _Gating, ping: _Ping) -> BankAssociation:
        """Give each track its contacts, its motion mode and its probability of existence."""
        pairs, thresholds = gating.pairs, gating.thresholds
        density = ping.model.clutter_density(ping.placed.distance)[pairs.contact]
        evidence = PairEvidence(
            density=gating.updates.density,
            amplitude_ratio=ping.model.amplitude_ratio(
                ping.amplitudes[pairs.contact], thresholds.threshold[pairs.track]
            ),
            clutter_density=density * thresholds.clutter_share[pairs.track],
        )
        gated = GatedPing(
            pairs,
            evidence,
            ping.amplitudes,
            gating.gates.volume,
            thresholds.detection_probability,
            ping.model.signal_to_noise_ratio_linear,
        )
        return self._rule.associate(bank, gated)

    def _update_states(self, association: BankAssociation, gating: _Gating) -> TrackBank:
        """Update all tracks by their contacts, confirmed ones with particles if there are any."""
        weights = association.weights
        bank = mix_updates(association.bank, gating.pairs, gating.updates, weights)
        if self._particles.used:
            bank = self._particles.update(bank, gating.pairs, weights[:, 0])
        return bank

    def _confirm_and_end(
        self, bank: TrackBank, association: BankAssociation, gating: _Gating, ping: _Ping
    ) -> ListedTracks:
        """Confirm tracks that exist, and find out which go on."""
        detected = association.detected
        bank = replace(
            bank,
            confirmed=bank.confirmed
            | (bank.existence >= self.configuration.confirmation_probability),
            updated=np.where(detected > 0.5, ping.stamp, bank.updated),
        )
        mean, _ = bank.moments()
        separation = mean[:, :2] - ping.sensor.position
        distance = np.hypot(separation[:, 0], separation[:, 1])
        detection = ping.model.detection_probability
        alive = survivors(bank, distance, ping.reach, detection, self.configuration)
        alive &= ~duplicates(bank, gating.pairs, association.weights)
        return ListedTracks(bank, alive, self._was_shown(bank), detected)

    def _was_shown(self, bank: TrackBank) -> BoolArray:
        shown = np.zeros(len(bank), dtype=bool)
        shown[bank.id.searchsorted(self._shown)] = True
        return shown

    def _start_candidates(
        self, association: BankAssociation, gating: _Gating, ping: _Ping
    ) -> TrackBank:
        """Start a candidate at each contact that no track explains."""
        threshold = gating.thresholds.search_threshold
        free = association.claimed <= LARGEST_CLAIM_OF_A_NEW_CONTACT
        rows = np.flatnonzero(free & ~(ping.amplitudes < threshold))
        candidates = start_candidates(
            ping.placed.select(rows),
            self._initial_existence(ping, rows, threshold),
            ping.stamp,
            self._next_id,
            self._modes.mode_prior,
            self.configuration.initial_speed_deviation,
        )
        self._next_id += len(rows)
        return candidates

    def _initial_existence(self, ping: _Ping, rows: IndexArray, threshold: float) -> FloatArray:
        initial = self.configuration.initial_existence
        if not self._rule.weighs_amplitudes:
            return np.full(len(rows), initial)
        ratio = ping.model.amplitude_ratio(ping.amplitudes[rows], np.full(len(rows), threshold))
        odds = initial / (1.0 - initial) * ratio
        return np.minimum(odds / (1.0 + odds), 0.5 * self.configuration.confirmation_probability)

    def _report(
        self, listed: ListedTracks, thresholds: GateThresholds, notices: tuple[Notice, ...]
    ) -> ContactTrackerUpdate:
        rows = list_tracks(listed, self.configuration.tentative_probability)
        self._shown = rows.id[rows.status != int(TrackStatus.TERMINATED)]
        return ContactTrackerUpdate(
            tracks=shown_tracks(rows, thresholds.stamp, thresholds.next_stamp),
            target_count=float(np.count_nonzero(self._bank.confirmed)),
            thresholds=thresholds,
            notices=notices,
        )


def integrated_tracker(configuration: ContactTrackerConfiguration) -> MultiTargetTracker:
    """Return the tracker that uses all contacts (``integrated``)."""
    return MultiTargetTracker(configuration, LM_IPDA)


def hpda_kalman_tracker(configuration: ContactTrackerConfiguration) -> MultiTargetTracker:
    """Return the tracker of the one contact best by rank, with Kalman filters."""
    return MultiTargetTracker(configuration, HPDA)


def hpda_particle_tracker(configuration: ContactTrackerConfiguration) -> MultiTargetTracker:
    """Return the same with particles for confirmed targets."""
    return MultiTargetTracker(configuration, HPDA_WITH_PARTICLES)
