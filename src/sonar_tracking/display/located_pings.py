"""Pings of a recording with the place of their sensor known, from own ship's motion if need be."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from typing import Any

from sonar_tracking.active.contacts.sensor_location import (
    MountingConfiguration,
    located,
    with_pose_judged,
)
from sonar_tracking.errors import InputError
from sonar_tracking.own_ship_interpolation import motion_at
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState


def located_pings(
    pings: Iterable[Contacts],
    own_ship: Sequence[OwnShipState],
    mounting: MountingConfiguration,
    rejected: list[str],
) -> tuple[Contacts, ...]:
    """Return the pings that can be placed, with azimuths in ``map``, in order of time.

    Parameters
    ----------
    pings : iterable of Contacts
        As they came.
    own_ship : sequence of OwnShipState
        Own ship's motion, in order of time; may be empty.
    mounting : MountingConfiguration
        Where the sensor is on own ship.
    rejected : list of str
        Takes a sentence for each ping that cannot be placed.
    """
    placed = []
    stamps = [state.stamp for state in own_ship]
    for ping in sorted(pings, key=lambda ping: ping.stamp):
        own = motion_at(own_ship, stamps, ping.stamp)
        told, _ = with_pose_judged(ping, own, mounting, odometry=bool(stamps))
        try:
            placed.append(located(told, own, mounting))
        except InputError as error:
            rejected.append(str(error))
    return tuple(placed)


def recorded_mounting(parameters: Mapping[str, Any]) -> MountingConfiguration:
    """Return the mounting among the recorded parameters of a node; the default where it is not.

    Parameters
    ----------
    parameters : mapping
        Name and value.
    """
    names = {item.name for item in fields(MountingConfiguration)}
    return MountingConfiguration(
        **{name: float(value) for name, value in parameters.items() if name in names}
    )
