"""Parameters of the stage that makes one track list of all others."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError, shown


@dataclass(frozen=True)
class TrackFusionConfiguration:
    """Parameters of track fusion: arrays, association, its track list."""

    alignment_deviation_deg: float = parameter(
        2.0,
        "of the misalignment of an array, before anything is measured; it is estimated. 0 = none",
        unit="deg",
        minimum=0.0,
        maximum=45.0,
    )
    heading_standard_deviation_deg: float = parameter(
        0.2,
        "of own ship's heading: turns all that it hears alike, cannot be observed, and is added to "
        "the covariance of positions",
        unit="deg",
        minimum=0.0,
        maximum=45.0,
    )
    association_odds: float = parameter(
        20.0, "to one, for taking a bearing track and a position to be of one target", minimum=1.0
    )
    clutter_area: float = parameter(
        1e9,
        "in which a new track may be anywhere, if it is not of a known target",
        unit="m^2",
        minimum=1.0,
    )
    sound_speed: float = parameter(1500.0, "in the water", unit="m/s", minimum=1.0, maximum=1e5)
    travel_time: bool = parameter(
        True, "sound takes time: a target has moved on since it was heard; false = heard at once"
    )
    minimum_azimuth_deviation_deg: float = parameter(
        0.05, "no bearing is taken to be better", unit="deg", minimum=0.0, maximum=90.0
    )
    bearing_resolution_deg: float = parameter(
        12.0,
        "within which an array may report one bearing of two targets, at broadside: of such a "
        "bearing nothing is learnt; 0 = it tells apart whatever it hears",
        unit="deg",
        minimum=0.0,
        maximum=90.0,
    )
    mounting_x: float = parameter(
        0.0, "array origin ahead of own ship's reference, if data do not tell their pose", unit="m"
    )
    mounting_y: float = parameter(0.0, "array origin to port of it", unit="m")
    mounting_yaw_deg: float = parameter(
        0.0, "direction of the array axis, anticlockwise from the bow", unit="deg"
    )
    clock_offsets: tuple[str, ...] = parameter(
        ("",),
        "by how many seconds the stamps of stations are late, by their sensor_id, e.g. pier=0.4; "
        "of those that are not named: none",
    )
    coast_duration: float = parameter(
        30.0, "how long a target outlives the last track it is made of", unit="s", minimum=0.0
    )
    ship: int = parameter(
        0,
        "number of own ship among those that exchange tracks: identifiers begin at it times 2^48",
        minimum=0,
        maximum=32767,
    )
    first_id: int = parameter(1, "first track identifier of own ship", minimum=1)

    def __post_init__(self) -> None:
        """Raise a :class:`ConfigurationError` if a clock offset cannot be read."""
        for text in filter(None, self.clock_offsets):
            _offset(text)

    def clock_offset(self, sensor_id: str) -> float:
        """Return by how much the stamps of a station are late, s."""
        return dict(map(_offset, filter(None, self.clock_offsets))).get(sensor_id, 0.0)

    @property
    def first_of_all(self) -> int:
        """First track identifier, different from those of other ships."""
        return (self.ship << 48) + self.first_id

    @property
    def alignment_variance(self) -> float:
        """In rad^2."""
        return math.radians(self.alignment_deviation_deg) ** 2

    @property
    def heading_variance(self) -> float:
        """In rad^2."""
        return math.radians(self.heading_standard_deviation_deg) ** 2

    @property
    def bearing_resolution(self) -> float:
        """At broadside, rad."""
        return math.radians(self.bearing_resolution_deg)

    @property
    def propagation_speed(self) -> float:
        """Of what is heard, m/s; inf = at once."""
        return self.sound_speed if self.travel_time else np.inf


def _offset(text: str) -> tuple[str, float]:
    """Return the station and the offset that a text tells."""
    sensor, _, value = text.rpartition("=")
    try:
        offset = float(value)
    except ValueError:
        offset = np.nan
    if not sensor or not np.isfinite(offset):
        raise ConfigurationError(
            f"clock_offsets has {shown(text)}; write the sensor_id and seconds, e.g. pier=0.4."
        )
    return sensor, offset
