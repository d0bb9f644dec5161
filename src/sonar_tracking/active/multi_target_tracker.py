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

from collections.abc import Sequence

import numpy as np

from sonar_tracking.active import operator_steps
from sonar_tracking.active.association.association_rule import (
    HPDA,
    HPDA_WITH_PARTICLES,
    LM_IPDA,
    AssociationRule,
)
from sonar_tracking.active.contact_tracker import ContactTracker
from sonar_tracking.active.contacts.contact_checks import check_order
from sonar_tracking.active.contacts.contact_tracker_configuration import (
    ContactTrackerConfiguration,
    check_configuration,
)
from sonar_tracking.active.detection.detection_levels import mean_probability
from sonar_tracking.active.ping_update import TrackingMethod, predict_scenes, update_scenes
from sonar_tracking.active.scene_memory import SceneMemory
from sonar_tracking.active.tracks.acceleration_levels import AccelerationLevels
from sonar_tracking.active.tracks.contact_track_list import shown_tracks, thresholds_without_gates
from sonar_tracking.active.tracks.motion_model import MotionModel
from sonar_tracking.active.tracks.motion_modes import MotionModes
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.active.tracks.track_management import (
    ListedTracks,
    list_tracks,
    listed_rows,
    survivors,
)
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate


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
        self._scene = SceneMemory(configuration, self._modes.n_modes, rule.has_particles)

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""
        self._scene.next_id = max(self._scene.next_id, first_id)

    @property
    def next_id(self) -> int:
        """Identifier the next track will get."""
        return self._scene.next_id

    @property
    def method(self) -> TrackingMethod:
        """How contacts become tracks."""
        return TrackingMethod(self.configuration, self._rule, self._modes)

    def warm_up(self) -> None:
        """Load what the first ping needs."""
        self._rule.warm_up()

    def update(self, contacts: Contacts, shared: SharedPings | None = None) -> ContactTrackerUpdate:
        """Return the tracks after one ping.

        Parameters
        ----------
        contacts : Contacts
            Of the ping; may be empty.
        shared : SharedPings, optional
            Of other trackers that are given the same ping.

        Raises
        ------
        InputError
            If the ping cannot be used; the state is then unchanged.
        """
        return update_scenes(self.method, [self._scene], [contacts], shared)[0]

    def start_track(self, position: tuple[float, float]) -> None:
        """Start a track at x and y in ``map``, m, since an operator says so.

        Raises
        ------
        InputError
            If that cannot be; see :mod:`sonar_tracking.active.operator_steps`.
        """
        operator_steps.start_track(self._scene, self.configuration, self._modes, position)

    def end_track(self, number: int) -> None:
        """End a track, by its identifier; it is reported once more, as terminated.

        Raises
        ------
        InputError
            If there is no such track.
        """
        operator_steps.end_track(self._scene, self._modes, number)

    def merge_tracks(self, number: int, other: int) -> None:
        """Let two tracks, by their identifiers, be one that has the first.

        Raises
        ------
        InputError
            If there is no such track.
        """
        operator_steps.merge_tracks(self._scene, self._modes, number, other)

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
        scene, model = self._scene, self.configuration
        check_order(stamp, scene.last)
        bank = predict_scenes(self.method, [scene], stamp)
        nowhere = np.zeros(len(bank))
        detection = float(mean_probability(scene.new_detection))
        alive = survivors(bank, nowhere, np.inf, detection, model)
        listed = ListedTracks(bank, alive, scene.were_shown(bank.id), detected=nowhere)
        scene.keep(bank.select(alive), scene.last and scene.last.moved_to(stamp))
        rows = list_tracks(
            listed, listed_rows(listed, model.tentative_probability), self._modes.static_mode
        )
        tracks = shown_tracks(scene.completed(rows), stamp, next_stamp)
        return scene.report(tracks, thresholds_without_gates(stamp, next_stamp))


def update_together(
    trackers: Sequence[MultiTargetTracker],
    pings: Sequence[Contacts],
    shared: SharedPings | None = None,
) -> list[ContactTrackerUpdate]:
    """Return the tracks of several independent scenes after one ping, as each tracker would.

    Parameters
    ----------
    trackers : sequence of MultiTargetTracker
        One a scene, all of the same method and configuration.
    pings : sequence of Contacts
        One a scene.
    shared : SharedPings, optional
        Of other trackers that are given the same pings, too.

    Raises
    ------
    InputError
        If a ping cannot be used; all states are then unchanged.
    """
    return update_scenes(trackers[0].method, [each._scene for each in trackers], pings, shared)


def trackers_together(
    trackers: Sequence[ContactTracker],
    pings: Sequence[Contacts],
    shared: SharedPings | None = None,
) -> list[ContactTrackerUpdate]:
    """Return the tracks of several independent scenes after one ping, whatever the method.

    Parameters
    ----------
    trackers : sequence of ContactTracker
        One a scene, all of the same method and configuration.
    pings : sequence of Contacts
        One a scene.
    shared : SharedPings, optional
        Of other trackers that are given the same pings, too.

    Raises
    ------
    InputError
        If a ping cannot be used.
    """
    together = [one for one in trackers if isinstance(one, MultiTargetTracker)]
    if len(together) == len(trackers):
        return update_together(together, pings, shared)
    shared = shared or SharedPings()
    return [tracker.update(ping, shared) for tracker, ping in zip(trackers, pings, strict=True)]


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
