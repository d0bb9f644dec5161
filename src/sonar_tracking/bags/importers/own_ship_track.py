"""Own ship's motion from positions at some instants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.bags.importers.contact_file import SurveyedPositions
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import seconds

COURSE_SPEED = 0.2
"""Slower than this the course made good says nothing of the heading, m/s."""


@dataclass(frozen=True)
class OwnShipMotion:
    """Own ship at the pings.

    Attributes
    ----------
    stamp : ndarray of int, shape (n,)
        ns.
    position, velocity : ndarray, shape (n, 2)
        In ``map``, m and m/s.
    azimuth, turn_rate : ndarray, shape (n,)
        Of the bow, rad (not wrapped) and rad/s.
    """

    stamp: IntArray
    position: FloatArray
    velocity: FloatArray
    azimuth: FloatArray
    turn_rate: FloatArray

    def state(self, index: int) -> OwnShipState:
        """Return the state at one ping."""
        azimuth = float(self.azimuth[index])
        cosine, sine = np.cos(azimuth), np.sin(azimuth)
        east, north = self.velocity[index]
        return OwnShipState(
            stamp=int(self.stamp[index]),
            position=(float(self.position[index, 0]), float(self.position[index, 1])),
            yaw=float(wrap_angle(azimuth)),
            velocity=(
                float(cosine * east + sine * north),
                float(cosine * north - sine * east),
            ),
            yaw_rate=float(self.turn_rate[index]),
        )


def own_ship_at(surveyed: SurveyedPositions, stamps: IntArray) -> OwnShipMotion:
    """Return own ship at the stamps of the pings, linear between the positions.

    Before the first and after the last position own ship goes on as there. Where the heading was
    not recorded it is the course made good, at rest the last one known.

    Parameters
    ----------
    surveyed : SurveyedPositions
        Positions, and headings or NaN.
    stamps : ndarray of int, shape (n,)
        Of the pings, ns.
    """
    first = surveyed.stamp[0]
    known, wanted = seconds(surveyed.stamp - first), seconds(stamps - first)
    position, velocity = interpolated(known, surveyed.position, wanted)
    if np.isnan(surveyed.azimuth).any():
        _, speeds = interpolated(known, surveyed.position, known)
        azimuth = _course(speeds)
    else:
        azimuth = np.unwrap(surveyed.azimuth)
    heading, rate = interpolated(known, azimuth[:, None], wanted)
    return OwnShipMotion(stamps, position, velocity, heading[:, 0], rate[:, 0])


def interpolated(
    known: FloatArray, values: FloatArray, wanted: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return values and their rates at some times, linear between the known ones and beyond.

    Parameters
    ----------
    known : ndarray, shape (n,)
        Ascending times, s.
    values : ndarray, shape (n, k)
        At these times, in any unit.
    wanted : ndarray, shape (m,)
        Times asked for, s.

    Returns
    -------
    values, rates : ndarray, shape (m, k)
        In units of the values, and per s.
    """
    if len(known) == 1:
        return np.repeat(values, len(wanted), axis=0), np.zeros((len(wanted), values.shape[1]))
    rates = np.gradient(values, known, axis=0)
    slopes = np.diff(values, axis=0) / np.diff(known)[:, None]
    row = np.clip(np.searchsorted(known, wanted, side="right") - 1, 0, len(known) - 2)
    value = values[row] + (wanted - known[row])[:, None] * slopes[row]
    rate = np.stack([np.interp(wanted, known, column) for column in rates.T], axis=1)
    return value, rate


def _course(velocity: FloatArray) -> FloatArray:
    """Return the azimuths of velocities, at rest that before, ahead of the first that after."""
    moving = np.flatnonzero(np.hypot(velocity[:, 0], velocity[:, 1]) >= COURSE_SPEED)
    if not len(moving):
        return np.zeros(len(velocity))
    last = np.searchsorted(moving, np.arange(len(velocity)), side="right") - 1
    chosen = velocity[moving[np.maximum(last, 0)]]
    return np.unwrap(np.arctan2(chosen[:, 1], chosen[:, 0]))
