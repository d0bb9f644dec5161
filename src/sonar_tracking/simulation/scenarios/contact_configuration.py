"""Parameters of a simulated active sonar: ping, errors, level, threshold and clutter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import Trajectory
from sonar_tracking.simulation.scenarios.platforms import CONSORT, FIXED, OWN_SHIP, Platforms


@dataclass(frozen=True)
class ContactSensorConfiguration:
    """An active sonar that sees all round and reports contacts above a threshold."""

    sensor_id: str = parameter("sonar", "name of the sensor in the messages")
    platform: str = parameter("own_ship", "what carries it", choices=(OWN_SHIP, FIXED, CONSORT))
    position: tuple[float, ...] = parameter((0.0, 0.0), "x, y in map of a fixed one", unit="m")
    ping_interval: float = parameter(10.0, "between pings", unit="s", minimum=1e-3, maximum=1e4)
    sound_speed: float = parameter(1500.0, "0 = a ping takes no time", unit="m/s", minimum=0.0)
    range_standard_deviation: float = parameter(50.0, "of a contact", unit="m", minimum=1e-6)
    azimuth_standard_deviation_deg: float = parameter(0.1, "of a contact", unit="deg", minimum=1e-9)
    misalignment_deg: float = parameter(
        0.0,
        "by how much the sonar is really turned anticlockwise from what its data tell",
        unit="deg",
        minimum=-180.0,
        maximum=180.0,
    )
    maximum_range: float = parameter(7000.0, "of the survey", unit="m", minimum=1.0)
    signal_to_noise_ratio_db: float = parameter(
        10.0, "of a target, at reference_range if that is given", unit="dB"
    )
    reference_range: float = parameter(
        0.0,
        "the level falls by 40 log r + 2 absorption r from here; 0 = the same at all ranges",
        unit="m",
        minimum=0.0,
    )
    absorption_db_per_km: float = parameter(0.0, "one way", unit="dB/km", minimum=0.0)
    detection_probability: float = parameter(
        0.0,
        "of every target, whatever its level; 0 = by the threshold",
        minimum=0.0,
        maximum=1.0,
    )
    false_alarm_probability: float = parameter(
        1e-3, "per resolution cell, sets the threshold", minimum=1e-12, maximum=0.5
    )
    clutter: str = parameter(
        "cell", "uniform per square metre or per cell", choices=("area", "cell")
    )
    clutter_per_ping: float = parameter(
        0.0, "mean number of false contacts; 0 = by the threshold", minimum=0.0
    )
    clutter_shape: float = parameter(
        0.0,
        "of K-distributed clutter by the threshold, small = heavy tails; 0 = exponential",
        minimum=0.0,
    )

    def trajectory(self, platforms: Platforms) -> Trajectory:
        """Return the motion of the sonar."""
        return platforms.trajectory(self.platform, self.position)

    @property
    def reception_time(self) -> float:
        """From the transmission to the last echo of a ping, s."""
        return 2.0 * self.maximum_range / self.sound_speed if self.sound_speed > 0.0 else 0.0

    @property
    def azimuth_standard_deviation(self) -> float:
        """In rad."""
        return float(np.radians(self.azimuth_standard_deviation_deg))

    @property
    def misalignment(self) -> float:
        """In rad."""
        return float(np.radians(self.misalignment_deg))

    @property
    def range_resolution(self) -> float:
        """Width of a uniform distribution of the same deviation, m."""
        return float(np.sqrt(12.0) * self.range_standard_deviation)

    @property
    def azimuth_resolution(self) -> float:
        """Width of a uniform distribution of the same deviation, rad."""
        return float(np.sqrt(12.0) * self.azimuth_standard_deviation)

    @property
    def n_cells(self) -> int:
        """Resolution cells of the survey."""
        area = self.maximum_range * 2.0 * np.pi
        return int(np.ceil(area / (self.range_resolution * self.azimuth_resolution)))


def check_contact_sensor(configuration: ContactSensorConfiguration) -> None:
    """Refuse parameters that do not fit together.

    Raises
    ------
    ConfigurationError
        With a sentence that names the parameters.
    """
    if len(configuration.position) != 2:
        raise ConfigurationError(
            f"position has {len(configuration.position)} entries; give x and y in m."
        )
    if configuration.reception_time > configuration.ping_interval:
        raise ConfigurationError(
            f"Sound takes {configuration.reception_time:.1f} s to maximum_range and back, longer "
            f"than ping_interval ({configuration.ping_interval:g} s); ping less often, or lower "
            "maximum_range."
        )
    by_threshold = configuration.clutter_per_ping == 0.0
    if configuration.clutter_shape > 0.0 and not by_threshold:
        raise ConfigurationError(
            "clutter_shape needs clutter by the threshold; set clutter_per_ping to 0."
        )
    if by_threshold and configuration.clutter == "area":
        raise ConfigurationError(
            "clutter area needs clutter_per_ping; clutter by the threshold is uniform per cell."
        )
    if configuration.detection_probability > 0.0 and by_threshold:
        raise ConfigurationError(
            "A given detection_probability needs clutter_per_ping; by the threshold both follow "
            "from false_alarm_probability."
        )


def number_of_pings(sensor: ContactSensorConfiguration, duration: float) -> int:
    """Return how many pings are sent and received within a duration (s).

    Raises
    ------
    ConfigurationError
        If not a single one is.
    """
    if duration < sensor.reception_time:
        raise ConfigurationError(
            f"duration is {duration:g} s, but the last echo of a ping takes "
            f"{sensor.reception_time:.1f} s; give a longer duration or a smaller maximum_range."
        )
    return 1 + int(np.floor((duration - sensor.reception_time) / sensor.ping_interval + 1e-9))
