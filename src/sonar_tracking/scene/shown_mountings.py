"""Parameters of what shows data: where own ship's sensors are, if their data do not tell."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter


@dataclass(frozen=True)
class ShownMountings:
    """Mountings on own ship, and the speed of sound that contacts are placed with."""

    array_mounting_x: float = parameter(
        0.0,
        "array ahead of own ship's reference, where bearing tracks do not tell its pose",
        unit="m",
    )
    array_mounting_y: float = parameter(0.0, "array to port of it", unit="m")
    array_mounting_yaw_deg: float = parameter(
        0.0, "direction of +x of the array, anticlockwise from the bow", unit="deg"
    )
    sonar_mounting_x: float = parameter(
        0.0,
        "active sonar ahead of own ship's reference, where contacts do not tell its pose",
        unit="m",
    )
    sonar_mounting_y: float = parameter(0.0, "active sonar to port of it", unit="m")
    sonar_mounting_yaw_deg: float = parameter(
        0.0, "direction of +x of the active sonar, anticlockwise from the bow", unit="deg"
    )
    sound_speed: float = parameter(
        1500.0,
        "by which a moving sonar has gone on when echoes return; 0 = a ping takes no time",
        unit="m/s",
        minimum=0.0,
    )
