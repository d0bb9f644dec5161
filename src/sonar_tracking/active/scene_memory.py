"""What a tracker remembers of one scene from ping to ping, and what it reports of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_checks import (
    PingOrigin,
    origin_of,
    sensor_jump,
)
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.clutter_monitor import ClutterMonitor
from sonar_tracking.active.detection.detection_levels import (
    contradiction,
    prior_weights,
    scene_weights,
)
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.active.lasting_error import LastingErrorMonitor
from sonar_tracking.active.particle_tracks import ParticleTracks
from sonar_tracking.active.tracks.contact_track_list import ContactTrackRows, shown_tracks
from sonar_tracking.active.tracks.gate_thresholds import check_thresholds
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.active.tracks.track_bank import TrackBank, empty_bank
from sonar_tracking.errors import Notice
from sonar_tracking.records.arrays import BoolArray, IntArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate, GateThresholds
from sonar_tracking.records.picture_parts import picture_parts
from sonar_tracking.records.positions import PositionTracks


@dataclass(frozen=True)
class AdmittedPing:
    """A ping that can be used, and what is known of it.

    Attributes
    ----------
    contacts : Contacts
        The usable ones.
    model : DetectionModel
        Detection, clutter and amplitudes.
    notices : tuple of Notice
        What a user should know.
    reach : float
        Beyond which a track is out of range, m.
    """

    contacts: Contacts
    model: DetectionModel
    notices: tuple[Notice, ...]
    reach: float = np.inf


class SceneMemory:
    """State of a tracker between two pings.

    Parameters
    ----------
    configuration : ContactTrackerConfiguration
        Parameters.
    n_modes : int
        Motion modes of a track.
    has_particles : bool
        Whether confirmed tracks are followed with particles.

    Attributes
    ----------
    bank : TrackBank
        All tracks.
    particles : ParticleTracks
        Clouds of confirmed ones.
    clutter : ClutterMonitor
        Whether there is as much clutter as is claimed.
    lasting : LastingErrorMonitor
        Which part of the errors of contacts lasts.
    new_detection : ndarray, shape (n_levels,)
        Probabilities of the levels of P_D of a new target.
    next_id : int
        Identifier the next track will get.
    shown : ndarray of int, shape (n_shown,)
        Identifiers of the tracks in the last picture.
    last : PingOrigin or None
        The ping before.
    ended : list of ContactTrackRows
        Tracks that an operator has ended, which are to be reported once more.
    """

    def __init__(
        self, configuration: ContactTrackerConfiguration, n_modes: int, has_particles: bool
    ) -> None:
        self.bank = empty_bank(n_modes)
        self.particles = ParticleTracks(configuration, used=has_particles)
        self.clutter = ClutterMonitor()
        self.lasting = LastingErrorMonitor()
        self.new_detection = prior_weights(np.nan)
        self.next_id = configuration.first_id
        self.shown: IntArray = np.zeros(0, dtype=np.int64)
        self.last: PingOrigin | None = None
        self.ended: list[ContactTrackRows] = []

    def admit(
        self, contacts: Contacts, configuration: ContactTrackerConfiguration, shared: SharedPings
    ) -> AdmittedPing:
        """Check a ping and find out what is known of it.

        Parameters
        ----------
        contacts : Contacts
            As received.
        configuration : ContactTrackerConfiguration
            Fills in what the ping does not carry.
        shared : SharedPings
            Of trackers that are given the same pings.

        Raises
        ------
        InputError
            If it cannot be used.
        """
        contacts, notices = shared.check(contacts, self.last)
        model, guesses = shared.model(contacts, configuration)
        check_thresholds(model, configuration)
        return AdmittedPing(contacts, model, (*notices, *guesses))

    def learn(self, ping: AdmittedPing) -> AdmittedPing:
        """Count the contacts of a ping, and return it with what is believed of it."""
        bank, model = self.bank, ping.model
        n_confirmed = int(np.count_nonzero(bank.confirmed))
        self.clutter = self.clutter.after(len(ping.contacts.range), n_confirmed, model)
        found = (bank.detection_weight, bank.confirmed, model.told_detection_probability)
        self.new_detection = scene_weights(*found)
        return AdmittedPing(
            self.lasting.without_it(ping.contacts),
            self.clutter.corrected(model),
            (*ping.notices, *contradiction(*found)),
            # A sensor that has jumped may be back at the next ping: no track ends for its place.
            np.inf if sensor_jump(ping.contacts, self.last) else model.maximum_range,
        )

    def were_shown(self, ids: IntArray) -> BoolArray:
        """Return which tracks, shape (n,), those shown among them, were in the last picture."""
        shown = np.zeros(len(ids), dtype=bool)
        shown[ids.searchsorted(self.shown)] = True
        return shown

    def keep(self, bank: TrackBank, last: PingOrigin | None) -> None:
        """Remember the tracks after a ping, and where it was sent from."""
        self.bank, self.last = bank, last
        self.particles.keep(bank)

    def remember(
        self, bank: TrackBank, next_id: int, lasting: LastingErrorMonitor, contacts: Contacts
    ) -> None:
        """Remember what a ping has changed."""
        self.next_id, self.lasting = next_id, lasting
        self.keep(bank, origin_of(contacts))

    def completed(self, rows: ContactTrackRows) -> ContactTrackRows:
        """Return the tracks to be shown with their lasting errors, and with those ended by hand.

        They are remembered as shown.
        """
        rows = self.lasting.with_it(rows)
        self.shown = rows.id[rows.status != int(TrackStatus.TERMINATED)]
        for each in self.ended:
            rows = rows.append(each)
        self.ended = []
        return rows

    def report(
        self,
        tracks: PositionTracks,
        thresholds: GateThresholds,
        notices: tuple[Notice, ...] = (),
    ) -> ContactTrackerUpdate:
        """Return what is reported of a ping.

        Parameters
        ----------
        tracks : PositionTracks
            That are shown.
        thresholds : GateThresholds
            In force in their gates.
        notices : tuple of Notice
            What a user should know of the ping.
        """
        return ContactTrackerUpdate(
            tracks=tracks,
            target_count=float(np.count_nonzero(self.bank.confirmed)),
            thresholds=thresholds,
            notices=(*notices, *self.clutter.notices(), *self.lasting.notices()),
        )


def pictures_of(
    scenes: Sequence[SceneMemory],
    shown: ContactTrackRows,
    rows: SceneRows,
    stamps: tuple[int, int],
) -> list[PositionTracks]:
    """Return the picture of each scene at a ping.

    Parameters
    ----------
    scenes : sequence of SceneMemory
        What is shown is remembered in them.
    shown : ContactTrackRows
        Tracks of all scenes.
    rows : SceneRows
        Whose they are.
    stamps : tuple of int
        Of the ping and of the next one, ns.
    """
    parts = rows.parts(shown)
    completed = [scene.completed(own) for scene, own in zip(scenes, parts, strict=True)]
    if rows.single:
        return [shown_tracks(completed[0], *stamps)]
    # Mostly nothing is to be added, and all pictures are made at once.
    pictures = picture_parts(shown_tracks(shown, *stamps), rows.counts)
    return [
        picture if more is own else shown_tracks(more, *stamps)
        for picture, own, more in zip(pictures, parts, completed, strict=True)
    ]
