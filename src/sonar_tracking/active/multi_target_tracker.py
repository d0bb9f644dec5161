"""Automatic detection and tracking of several targets from contacts in clutter.

At each ping: all tracks are predicted to its transmit time; contacts are paired with gates;
association gives each track its contacts, its motion mode, its probability of existence and that of
its detection; the states are updated; tracks are confirmed and ended; contacts that no track
explains start candidates. All false contacts start candidates, too, so that everything is done on
arrays.

Association is by integrated multi-target PDA with amplitude likelihoods and interacting motion
modes (``integrated``, the most accurate), or by the published rule of the one contact best by
amplitude rank (``hpda_kalman``; ``hpda_particle`` follows confirmed targets with particles).

References
----------
Kim, Song (2007); Musicki, La Scala (2008); Jung, Shin (2002) for thresholds in the gates.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.active.association.association_rule import (
    HPDA,
    HPDA_WITH_PARTICLES,
    LM_IPDA,
    AssociationRule,
)
from sonar_tracking.active.association.lm_ipda import BankAssociation
from sonar_tracking.active.contacts.contact_checks import (
    PingOrigin,
    check_order,
    check_ping,
    origin_of,
    sensor_jump,
)
from sonar_tracking.active.contacts.contact_tracker_configuration import (
    ContactTrackerConfiguration,
    check_configuration,
)
from sonar_tracking.active.detection.clutter_monitor import ClutterMonitor
from sonar_tracking.active.detection.detection_levels import (
    contradiction,
    forget,
    mean_probability,
    prior_weights,
    scene_weights,
    weigh,
)
from sonar_tracking.active.detection.detection_model import make_detection_model
from sonar_tracking.active.lasting_error import LastingErrorMonitor
from sonar_tracking.active.particle_tracks import ParticleTracks
from sonar_tracking.active.ping_gating import (
    PingGating,
    PlacedPing,
    gate_ping,
    place_ping,
)
from sonar_tracking.active.tracks.acceleration_levels import AccelerationLevels
from sonar_tracking.active.tracks.contact_track_list import shown_tracks, thresholds_without_gates
from sonar_tracking.active.tracks.gate_thresholds import check_thresholds
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.active.tracks.motion_modes import MotionModes
from sonar_tracking.active.tracks.pair_updates import mix_updates
from sonar_tracking.active.tracks.track_bank import (
    TrackBank,
    empty_bank,
    new_target_modes,
    predict_bank,
)
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
        self._modes = motion_model(configuration, rule)
        self._bank = empty_bank(self._modes.n_modes)
        self._particles = ParticleTracks(configuration, used=rule.has_particles)
        self._clutter = ClutterMonitor()
        self._lasting = LastingErrorMonitor()
        self._new_detection = prior_weights(np.nan)
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
        gating = gate_ping(bank, ping, self.configuration, self._particles, self._modes)
        association = self._rule.associate(bank, gating.of_ping(ping))
        bank = self._update_states(association, gating)
        listed = self._confirm_and_end(bank, association, gating, ping)
        candidates = self._start_candidates(association, gating, ping)
        listed, candidates = limit_tracks(listed, candidates, self.configuration.maximum_tracks)
        self._lasting = self._lasting.after(
            listed, gating.pairs, association, contacts, ping.placed
        )
        self._bank = listed.bank.select(listed.alive).append(candidates)
        self._last = origin_of(contacts)
        self._particles.keep(self._bank)
        notices = (*notices, *guesses, *self._clutter.notices(), *self._lasting.notices())
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
        detection = float(mean_probability(self._new_detection))
        alive = survivors(bank, nowhere, np.inf, detection, model)
        listed = ListedTracks(bank, alive, self._was_shown(bank), detected=nowhere)
        self._bank = bank.select(alive)
        self._last = self._last and self._last.moved_to(stamp)
        self._particles.keep(self._bank)
        return self._report(listed, thresholds_without_gates(stamp, next_stamp), ())

    def _place(self, contacts: Contacts) -> tuple[PlacedPing, tuple[Notice, ...]]:
        """Bring the contacts into ``map`` and find out how dense false ones are."""
        model, guesses = make_detection_model(contacts, self.configuration)
        check_thresholds(model, self.configuration)
        n_confirmed = int(np.count_nonzero(self._bank.confirmed))
        self._clutter = self._clutter.after(len(contacts.range), n_confirmed, model)
        self._new_detection = scene_weights(
            self._bank.detection_weight, self._bank.confirmed, model.told_detection_probability
        )
        detection = contradiction(
            self._bank.detection_weight, self._bank.confirmed, model.told_detection_probability
        )
        ping = place_ping(
            self._lasting.without_it(contacts),
            self._clutter.corrected(model),
            self.configuration.sound_speed,
            # A sensor that has jumped may be back at the next ping: no track ends for its place.
            np.inf if sensor_jump(contacts, self._last) else model.maximum_range,
        )
        return ping, (*guesses, *detection)

    def _predict(self, stamp: int) -> TrackBank:
        """Move all tracks to the transmit time of a ping."""
        interval = 0.0 if self._last is None else self._last.interval(stamp)
        survival = self.configuration.survival_probability(interval)
        bank = predict_bank(self._bank, self._modes, interval, survival)
        weight = forget(bank.detection_weight, self._new_detection)
        bank = replace(bank, detection_weight=weight)
        return self._particles.predict(bank, interval) if self._particles.used else bank

    def _update_states(self, association: BankAssociation, gating: PingGating) -> TrackBank:
        """Update all tracks by their contacts, confirmed ones with particles if there are any."""
        weights = association.weights
        bank = mix_updates(association.bank, gating.pairs, gating.updates, weights)
        detection = weigh(bank.detection_weight, association.likelihood_ratio)
        bank = replace(bank, detection_weight=detection)
        if self._particles.used:
            bank = self._particles.update(bank, gating.pairs, weights[:, 0])
        return bank

    def _confirm_and_end(
        self, bank: TrackBank, association: BankAssociation, gating: PingGating, ping: PlacedPing
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
        detection = float(mean_probability(self._new_detection))
        alive = survivors(bank, distance, ping.reach, detection, self.configuration)
        alive &= ~duplicates(bank, gating.pairs, association.weights)
        return ListedTracks(bank, alive, self._was_shown(bank), detected)

    def _was_shown(self, bank: TrackBank) -> BoolArray:
        shown = np.zeros(len(bank), dtype=bool)
        shown[bank.id.searchsorted(self._shown)] = True
        return shown

    def _start_candidates(
        self, association: BankAssociation, gating: PingGating, ping: PlacedPing
    ) -> TrackBank:
        """Start a candidate at each contact that no track explains; most of them are clutter."""
        threshold = gating.thresholds.search_threshold
        free = association.claimed <= LARGEST_CLAIM_OF_A_NEW_CONTACT
        self._clutter = self._clutter.with_unexplained(ping.amplitudes[free] - ping.model.threshold)
        rows = np.flatnonzero(free & ~(ping.amplitudes < threshold))
        candidates = start_candidates(
            ping.placed.select(rows),
            self._initial_existence(ping, rows, threshold),
            ping.stamp,
            self._next_id,
            self._modes,
            new_target_modes(self._bank, self._modes),
            self._new_detection,
        )
        self._next_id += len(rows)
        return candidates

    def _initial_existence(
        self, ping: PlacedPing, rows: IndexArray, threshold: float
    ) -> FloatArray:
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
        rows = self._lasting.with_it(rows)
        self._shown = rows.id[rows.status != int(TrackStatus.TERMINATED)]
        return ContactTrackerUpdate(
            tracks=shown_tracks(rows, thresholds.stamp, thresholds.next_stamp),
            target_count=float(np.count_nonzero(self._bank.confirmed)),
            thresholds=thresholds,
            notices=notices,
        )


def motion_model(configuration: ContactTrackerConfiguration, rule: AssociationRule) -> MotionModel:
    """Return the motion model that is configured, without modes where the rule knows none."""
    speed = configuration.initial_speed_deviation
    if rule.has_motion_modes and configuration.motion == "adaptive":
        return AccelerationLevels(speed)
    turning = rule.has_motion_modes and configuration.motion == "turning"
    return MotionModes(
        n_modes=3 if turning else 1,
        acceleration_deviation=configuration.acceleration_deviation,
        lateral_acceleration=configuration.lateral_acceleration,
        turn_probability=configuration.turn_probability,
        stay_probability=configuration.stay_probability,
        initial_speed_deviation=speed,
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
