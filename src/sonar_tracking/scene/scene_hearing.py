"""What is heard, and where: contacts and bearing tracks, with the places of their sensors in map.

Sensors are located as the trackers locate them: where their data say, else on own ship. What nobody
can locate is not shown.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.active.contacts import sensor_location
from sonar_tracking.active.contacts.contact_positions import place_contacts
from sonar_tracking.active.contacts.sensor_location import MountingConfiguration
from sonar_tracking.errors import InputError
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.targets import station_view
from sonar_tracking.tma.targets.station_view import StationView
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

SILENCE = nanoseconds(60.0)
"""A station that has told nothing for so long is no longer shown, ns."""


def contacts_need_own_ship(contacts: Contacts) -> bool:
    """Return whether own ship's motion may decide where the sensor of a ping is."""
    return contacts.unset_pose or sensor_location.needs_own_ship(contacts)


def located_contacts(
    contacts: Contacts,
    own_ship: KinematicState | None,
    mounting: MountingConfiguration,
    odometry: bool,
    sound_speed: float,
) -> tuple[Contacts, FloatArray]:
    """Return a ping with its azimuths in ``map``, and the positions of its contacts.

    Parameters
    ----------
    contacts : Contacts
        As received.
    own_ship : KinematicState or None
        At the stamp of the ping; None = unknown.
    mounting : MountingConfiguration
        Where the sensor is on own ship.
    odometry : bool
        Whether own ship's motion is known at some stamps, or will be.
    sound_speed : float
        m/s; 0 = the ping takes no time.

    Returns
    -------
    contacts : Contacts
        The ping.
    positions : ndarray, shape (n_contacts, 2)
        In ``map``, m; NaN = unknown.
    """
    judged, _ = sensor_location.with_pose_judged(contacts, own_ship, mounting, odometry)
    try:
        placed = sensor_location.located(judged, own_ship, mounting)
    except InputError:
        return contacts, np.full((len(contacts.range), 2), np.nan)
    with np.errstate(all="ignore"):  # a contact that is no number is not shown
        return placed, place_contacts(placed, sound_speed).position


class HeardStations:
    """What each station has heard last.

    Parameters
    ----------
    configuration : TmaTrackerConfiguration
        Tells where on own ship an array is that does not tell its pose.
    """

    def __init__(self, configuration: TmaTrackerConfiguration) -> None:
        self._configuration = configuration
        self._heard: dict[str, tuple[BearingTracks, StationView]] = {}

    @property
    def heard(self) -> list[tuple[BearingTracks, StationView]]:
        """Bearing tracks of every station, and where it was."""
        return list(self._heard.values())

    def needs_own_ship(self, tracks: BearingTracks) -> bool:
        """Return whether own ship's motion may decide where the sensor is."""
        sensor = tracks.sensor
        unset = station_view.may_be_unset(sensor)
        return unset or station_view.needs_own_ship(sensor, self._configuration)

    def take(self, tracks: BearingTracks, own_ship: KinematicState | None, odometry: bool) -> None:
        """Take what a station has heard.

        Parameters
        ----------
        tracks : BearingTracks
            As received.
        own_ship : KinematicState or None
            At their stamp; None = unknown.
        odometry : bool
            Whether own ship's motion is known at some stamps, or will be.
        """
        sensor, _ = station_view.with_pose_judged(
            tracks.sensor, own_ship, self._configuration, odometry
        )
        self._heard = {
            name: entry
            for name, entry in self._heard.items()
            if name != sensor.sensor_id and abs(entry[0].stamp - tracks.stamp) <= SILENCE
        }
        try:
            view = station_view.station_view(sensor, own_ship, self._configuration)
        except InputError:
            return
        self._heard[sensor.sensor_id] = (tracks, view)
