"""Own ship at one instant."""

from __future__ import annotations

from dataclasses import dataclass

BASE_FRAME = "own_ship/base_link"
"""Frame of own ship, x forward and y to port, where odometry does not name another."""

OWN_SHIP_FRAMES = "own_ship/"
"""Frames whose names begin so are those of own ship and of what is aboard."""


@dataclass(frozen=True)
class OwnShipState:
    """State of own ship at one instant.

    Attributes
    ----------
    stamp : int
        ns.
    position : tuple of float
        x, y in ``map``, m.
    yaw : float
        Azimuth of the bow in ``map``, rad in [-pi, pi).
    velocity : tuple of float
        Forward and to port, in ``own_ship/base_link``, m/s.
    yaw_rate : float
        rad/s, positive anticlockwise.
    """

    stamp: int
    position: tuple[float, float]
    yaw: float
    velocity: tuple[float, float]
    yaw_rate: float
