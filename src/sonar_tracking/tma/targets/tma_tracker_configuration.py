"""Parameters of the stage that turns bearing tracks and frequency lines into positions."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.targets.systematic_errors import SystematicErrors
from sonar_tracking.tma.targets.tma_method_registry import TMA_METHODS, TmaMethodEntry

UNKNOWN_HEIGHT = 1000.0
"""Standard deviation of the height of a target of which nothing is known, m."""


@dataclass(frozen=True)
class TmaTrackerConfiguration(RangeBankConfiguration):
    """Parameters of target motion analysis: its filter, its stations, its track list."""

    method: str = parameter(
        "range_bank",
        "how the motion of a target is estimated",
        methods=TMA_METHODS,
    )
    sound_speed: float = parameter(1500.0, "in the water", unit="m/s", minimum=1.0, maximum=1e5)
    travel_time: bool = parameter(
        True, "sound takes time: a target has moved on since; false = seen at once, as in the paper"
    )
    target_height: float = parameter(
        0.0,
        "of targets above the sensor, where it is known; 0 = it is estimated from elevations",
        unit="m",
    )
    target_height_standard_deviation: float = parameter(
        0.0,
        "how well that is known before elevations are taken in; 0 = exactly, or to 1000 m where "
        "target_height is 0",
        unit="m",
        minimum=0.0,
    )
    minimum_azimuth_deviation_deg: float = parameter(
        0.05, "no bearing is taken to be better", unit="deg", minimum=0.0, maximum=90.0
    )
    azimuth_deviation_deg: float = parameter(
        0.0,
        "of bearings that come without a variance; 0 = they are left out",
        unit="deg",
        minimum=0.0,
        maximum=90.0,
    )
    systematic_deviation_deg: float = parameter(
        0.5,
        "of the constant error of a station's directions, which is added to the covariance of "
        "positions: no array is aligned better; 0 = exactly",
        unit="deg",
        minimum=0.0,
        maximum=90.0,
    )
    alignment_deviation_deg: float = parameter(
        0.0,
        "of the misalignment of a station that is misaligned, to be set where stations are "
        "doubted; it is estimated where several stations hear the same two targets or more, and "
        "used once it is certain. 0 = none",
        unit="deg",
        minimum=0.0,
        maximum=45.0,
    )
    target_size: float = parameter(
        10.0,
        "standard deviation of where on a target what is heard comes from, which is added to the "
        "covariance of positions; 0 = a point",
        unit="m",
        minimum=0.0,
    )
    sound_speed_variation: float = parameter(
        25.0,
        "standard deviation of the difference of the speed of sound between target and station, "
        "which bends rays: elevations err by more the flatter they are; 0 = straight rays",
        unit="m/s",
        minimum=0.0,
        maximum=1e3,
    )
    mounting_x: float = parameter(
        0.0, "array origin ahead of own ship's reference, if data do not tell their pose", unit="m"
    )
    mounting_y: float = parameter(0.0, "array origin to port of it", unit="m")
    mounting_yaw_deg: float = parameter(
        0.0, "direction of the array axis, anticlockwise from the bow", unit="deg"
    )
    array_lag: float = parameter(
        0.0,
        "how long a towed array follows own ship's turns: bearings in a turn are worse by turn "
        "rate times this, and start nothing; 0 = on the hull",
        unit="s",
        minimum=0.0,
    )
    attribution_gate: float = parameter(
        4.0, "of lines without a track, standard deviations of the angle", minimum=1.0
    )
    association_odds: float = parameter(
        100.0, "to one, for taking the bearings of two stations to be of one target", minimum=1.0
    )
    confirm_observability: float = parameter(
        0.5, "a solution is confirmed from this on", minimum=0.0, maximum=1.0, changeable=True
    )
    confirm_relative_deviation: float = parameter(
        0.1,
        "and when its position is known to this part of its range",
        minimum=0.0,
        changeable=True,
    )
    coasted_after: float = parameter(
        10.0,
        "a track without a measurement for this long is coasted",
        unit="s",
        minimum=0.0,
        changeable=True,
    )
    coast_duration: float = parameter(
        0.0,
        "how long a track outlives its last bearing track",
        unit="s",
        minimum=0.0,
        changeable=True,
    )
    first_id: int = parameter(1, "first track identifier", minimum=1)

    @property
    def height_deviation(self) -> float:
        """Standard deviation of the height of targets above the sensor, m; 0 = it is known."""
        if self.target_height_standard_deviation > 0.0 or self.target_height != 0.0:
            return self.target_height_standard_deviation
        return UNKNOWN_HEIGHT

    @property
    def entry(self) -> TmaMethodEntry:
        """What is known of the method."""
        return TMA_METHODS[self.method]

    @property
    def propagation_speed(self) -> float:
        """Of what is heard, m/s; inf = at once."""
        return self.sound_speed if self.travel_time else math.inf

    @property
    def minimum_azimuth_deviation(self) -> float:
        """In rad."""
        return math.radians(self.minimum_azimuth_deviation_deg)

    @property
    def azimuth_deviation(self) -> float:
        """In rad."""
        return math.radians(self.azimuth_deviation_deg)

    @property
    def alignment_deviation(self) -> float:
        """In rad."""
        return math.radians(self.alignment_deviation_deg)

    @property
    def systematic_errors(self) -> SystematicErrors:
        """Errors of directions that never average out."""
        return SystematicErrors(
            math.radians(self.systematic_deviation_deg),
            self.sound_speed_variation / self.sound_speed,
            self.target_size,
        )

    @property
    def mounting_yaw(self) -> float:
        """In rad."""
        return math.radians(self.mounting_yaw_deg)


def check_tma_tracker(configuration: TmaTrackerConfiguration) -> None:
    """Refuse parameters that do not fit together.

    Raises
    ------
    ConfigurationError
        With a sentence that names the parameters.
    """
    if configuration.minimum_range >= configuration.maximum_range:
        raise ConfigurationError(
            f"minimum_range is {configuration.minimum_range:g} m and maximum_range "
            f"{configuration.maximum_range:g} m; the first must be smaller."
        )
    if configuration.manoeuvre_acceleration < configuration.acceleration:
        raise ConfigurationError(
            f"manoeuvre_acceleration is {configuration.manoeuvre_acceleration:g} m/s^2 and "
            f"acceleration {configuration.acceleration:g} m/s^2; the first must not be smaller."
        )
