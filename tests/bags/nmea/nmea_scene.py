"""A log of NMEA 0183 with known truth: own ship on a straight course, two ships with AIS."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone

import numpy as np

from sonar_tracking.geodesy import surface_places
from sonar_tracking.records.datum import Datum
from sonar_tracking.scene.nmea_format import KNOT, checksum, with_checksum

DATUM = Datum(54.18, 7.89)
BEGIN = datetime(2026, 5, 1, 23, 59, 30, tzinfo=timezone.utc)
"""A midnight is passed after half a minute."""

OWN_VELOCITY = (5.0, 2.0)
"""Of own ship from the datum on, east and north, m/s."""


@dataclass(frozen=True)
class Ship:
    """A ship that goes straight."""

    mmsi: int
    position: tuple[float, float]
    velocity: tuple[float, float]
    interval: int = 10

    def at(self, time: float) -> tuple[float, float]:
        (x, y), (vx, vy) = self.position, self.velocity
        return x + vx * time, y + vy * time


FERRY = Ship(211_000_001, (1000.0, 2000.0), (-3.0, 4.0))
ANCHORED = Ship(636_000_002, (-800.0, 300.0), (0.0, 0.0), 180)


def dm(angle_deg: float, digits: int, sides: str) -> str:
    """Return degrees and minutes to 1e-6 of a minute."""
    whole = int(abs(angle_deg))
    minutes = 60.0 * (abs(angle_deg) - whole)
    return f"{whole:0{digits}d}{minutes:09.6f},{sides[int(angle_deg < 0.0)]}"


def place_fields(position: tuple[float, float]) -> str:
    latitude, longitude = surface_places(np.array(position), DATUM)
    return f"{dm(latitude, 2, 'NS')},{dm(longitude, 3, 'EW')}"


def compass(velocity: tuple[float, float]) -> float:
    return math.degrees(math.atan2(*velocity)) % 360.0


def clock(time: float) -> datetime:
    return BEGIN + timedelta(seconds=time)


def gga(time: float, position: tuple[float, float]) -> str:
    place = place_fields(position)
    return with_checksum(f"GPGGA,{clock(time):%H%M%S}.00,{place},1,08,0.9,5.4,M,46.9,M,,")


def rmc(time: float, position: tuple[float, float], velocity: tuple[float, float]) -> str:
    motion = f"{math.hypot(*velocity) / KNOT:.3f},{compass(velocity):.2f}"
    at = clock(time)
    return with_checksum(
        f"GPRMC,{at:%H%M%S}.00,A,{place_fields(position)},{motion},{at:%d%m%y},,,A"
    )


def hdt(heading_deg: float) -> str:
    return with_checksum(f"HEHDT,{heading_deg:.2f},T")


def position_bits(ship: Ship, time: float, kind: int = 1, second: int | None = None) -> str:
    """Return a position report, ITU-R M.1371 table 48 or 70, bit by bit."""
    latitude, longitude = surface_places(np.array(ship.at(time)), DATUM)
    speed = round(math.hypot(*ship.velocity) / KNOT * 10.0)
    course = round(10.0 * compass(ship.velocity)) if speed else 3600
    begin = [(kind, 6), (0, 2), (ship.mmsi, 30)]
    begin += [(0, 4), (128, 8)] if kind <= 3 else [(0, 8)]
    rest = [
        (speed, 10), (1, 1), (round(longitude * 600_000) % 2**28, 28),
        (round(latitude * 600_000) % 2**27, 27), (course, 12), (511, 9),
        (clock(time).second if second is None else second, 6),
    ]  # fmt: skip
    bits = "".join(f"{value:0{count}b}" for value, count in begin + rest)
    return bits.ljust(168, "0")


def payload(bits: str) -> str:
    values = [int(bits[i : i + 6].ljust(6, "0"), 2) for i in range(0, len(bits), 6)]
    return "".join(chr(v + 48 if v < 40 else v + 56) for v in values)


def encapsulated(body: str) -> str:
    return f"!{body}*{checksum(body.encode('ascii'))}"


def vdm(ship: Ship, time: float, kind: int = 1, second: int | None = None) -> str:
    return encapsulated(f"AIVDM,1,1,,A,{payload(position_bits(ship, time, kind, second))},0")


def log_lines(duration: int = 120, ships: tuple[Ship, ...] = (FERRY, ANCHORED)) -> list[str]:
    """Return a log with a burst a second."""
    lines = []
    for time in range(duration):
        position = (OWN_VELOCITY[0] * time, OWN_VELOCITY[1] * time)
        lines += [gga(time, position), rmc(time, position, OWN_VELOCITY)]
        lines.append(hdt(compass(OWN_VELOCITY)))
        for number, ship in enumerate(ships):
            if (time - 3 * number) % ship.interval == 0:
                lines.append(vdm(ship, time, 1 if number == 0 else 18))
    return lines
