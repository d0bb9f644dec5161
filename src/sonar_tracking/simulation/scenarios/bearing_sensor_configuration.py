"""Parameters of a simulated station that reports bearings and frequency lines directly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import Trajectory
from sonar_tracking.simulation.scenarios.namespaces import check_namespace
from sonar_tracking.simulation.scenarios.platforms import CONSORT, FIXED, OWN_SHIP, Platforms

CONE, AZIMUTH = "cone", "azimuth"
DELAYED, INSTANTANEOUS = "delayed", "instantaneous"


@dataclass(frozen=True)
class BearingSensorConfiguration:
    """A station: an array on own ship or its consort, or one that stays where it is."""

    sensor_id: str = parameter("array", "name of the sensor in the messages")
    namespace: str = parameter(
        "", "of its topics; every station but one needs its own, e.g. station_2"
    )
    platform: str = parameter("own_ship", "what carries it", choices=(OWN_SHIP, FIXED, CONSORT))
    position: tuple[float, ...] = parameter((0.0, 0.0), "x, y in map of a fixed one", unit="m")
    course_deg: float = parameter(0.0, "compass heading of a fixed one", unit="deg")
    mounting_yaw_deg: float = parameter(
        0.0, "direction of the array axis, anticlockwise from the heading", unit="deg"
    )
    misalignment_deg: float = parameter(
        0.0,
        "by how much the array is really turned anticlockwise from what its data tell",
        unit="deg",
        minimum=-180.0,
        maximum=180.0,
    )
    angle_kind: str = parameter(
        "cone",
        "cone: a line array, which cannot tell its two sides apart; azimuth: true directions",
        choices=(CONE, AZIMUTH),
    )
    frame_interval: float = parameter(1.0, "between frames", unit="s", minimum=1e-3)
    angle_standard_deviation_deg: float = parameter(
        0.5, "of a bearing", unit="deg", minimum=1e-9, maximum=90.0
    )
    frequency_standard_deviation: float = parameter(
        0.1, "of a received frequency", unit="Hz", minimum=1e-9
    )
    outlier_share: float = parameter(
        0.0, "of the bearings, uniform over all angles then", minimum=0.0, maximum=1.0
    )
    line_outlier_share: float = parameter(
        0.0, "of the frequencies, off by up to line_outlier_width", minimum=0.0, maximum=1.0
    )
    line_outlier_width: float = parameter(50.0, "either way", unit="Hz", minimum=0.0)
    missing_share: float = parameter(
        0.0, "of the frames, which are not reported at all", minimum=0.0, maximum=0.99
    )
    attribute_lines: bool = parameter(
        True, "lines name the bearing track they belong to; otherwise they have an angle only"
    )
    propagation: str = parameter(
        "delayed",
        "sound arrives with its travel time, or at once",
        choices=(DELAYED, INSTANTANEOUS),
    )
    sound_speed: float = parameter(1500.0, "in the water", unit="m/s", minimum=1.0, maximum=1e5)

    def trajectory(self, platforms: Platforms) -> Trajectory:
        """Return the motion of the station; its heading is that of what carries it."""
        return platforms.trajectory(self.platform, self.position, self.course_deg)

    def number_of_frames(self, duration: float) -> int:
        """Return how many frames begin within a duration, s."""
        return max(1, int(np.ceil(duration / self.frame_interval - 1e-9)))

    @property
    def ambiguous(self) -> bool:
        """Whether it measures a cone."""
        return self.angle_kind == CONE

    @property
    def mounting_yaw(self) -> float:
        """In rad."""
        return float(np.radians(self.mounting_yaw_deg))

    @property
    def misalignment(self) -> float:
        """In rad."""
        return float(np.radians(self.misalignment_deg))

    @property
    def angle_deviation(self) -> float:
        """In rad."""
        return float(np.radians(self.angle_standard_deviation_deg))


def check_bearing_sensors(sensors: Sequence[BearingSensorConfiguration], where: str) -> None:
    """Refuse stations that cannot be told apart, or cannot be placed.

    Parameters
    ----------
    sensors : sequence of BearingSensorConfiguration
        All stations of a scenario.
    where : str
        Their section, named in errors.

    Raises
    ------
    ConfigurationError
        With a sentence that names the station and what to do.
    """
    for index, sensor in enumerate(sensors):
        name = f"{where}[{index}]"
        if len(sensor.position) != 2:
            raise ConfigurationError(
                f"{name}.position has {len(sensor.position)} entries; give x and y in m."
            )
        if sensor.namespace:
            check_namespace(sensor.namespace, name)
        for other in sensors[:index]:
            for what in ("sensor_id", "namespace"):
                if getattr(other, what) == getattr(sensor, what):
                    raise ConfigurationError(
                        f"{name}.{what} {getattr(sensor, what)!r} is used twice; give every "
                        "station its own."
                    )
