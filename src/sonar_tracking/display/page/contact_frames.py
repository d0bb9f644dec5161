"""Frames of the active sonar: contacts, and the thresholds in the gates of the tracks."""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import (
    Frame,
    rounded,
    seconds_of,
    text_frame,
    upper_triangle,
)
from sonar_tracking.records.contacts import Contacts, GateThresholds
from sonar_tracking.scene.scene_hearing import located_contacts
from sonar_tracking.scene.told_mountings import sonar_as_told


class ContactFrames:
    """Frames of pings, whose contacts are placed as the tracker places them.

    Parameters
    ----------
    configuration : PageConfiguration
        Mounting of a sonar that does not tell its pose, and the sound speed.
    own_ship : OwnShipLog
        Own ship.
    """

    def __init__(self, configuration: PageConfiguration, own_ship: OwnShipLog) -> None:
        self._sound_speed = configuration.sound_speed
        self._own_ship = own_ship
        self._mounting = sonar_as_told(configuration)

    def frame(self, topic: str, contacts: Contacts) -> Frame:
        """Return the frame of one ping; amplitudes are decibels over the mean noise power."""
        own_ship = self._own_ship.motion_at(contacts.stamp)
        placed, positions = located_contacts(
            contacts, own_ship, self._mounting, self._own_ship.is_known, self._sound_speed
        )
        x, y = placed.sensor_position
        return text_frame(
            "contacts",
            seconds_of(contacts.stamp),
            topic,
            topic=topic,
            range=placed.range,
            azimuth=placed.azimuth,
            amplitude_db=rounded(_decibels(placed.amplitude)),
            x=np.round(positions[:, 0], 1),
            y=np.round(positions[:, 1], 1),
            detection_threshold_db=float(_decibels(np.array(placed.detection_threshold))),
            maximum_range=placed.maximum_range,
            minimum_azimuth=placed.minimum_azimuth,
            azimuth_width=placed.azimuth_width,
            ping_interval=placed.ping_interval,
            sensor={"id": placed.sensor_id, "x": x, "y": y},
        )


def threshold_frame(topic: str, thresholds: GateThresholds) -> Frame:
    """Return the frame of the thresholds in the gates of one ping, in decibels."""
    return text_frame(
        "threshold",
        seconds_of(thresholds.stamp),
        topic,
        topic=topic,
        track_id=thresholds.track_id,
        threshold_db=rounded(_decibels(thresholds.threshold)),
        false_alarm_probability=rounded(thresholds.false_alarm_probability),
        x=np.round(thresholds.predicted_position[:, 0], 1),
        y=np.round(thresholds.predicted_position[:, 1], 1),
        gate_covariance=rounded(upper_triangle(thresholds.gate_covariance)),
        search_threshold_db=float(_decibels(np.array(thresholds.search_threshold))),
        search_false_alarm_probability=thresholds.search_false_alarm_probability,
        method=thresholds.method,
    )


def _decibels(power: np.ndarray) -> np.ndarray:
    """Return a linear power ratio as decibels; what is not positive has none."""
    with np.errstate(all="ignore"):
        return np.where(power > 0.0, 10.0 * np.log10(power), math.nan)
