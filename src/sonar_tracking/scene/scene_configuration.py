"""Parameters of the scene."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter


@dataclass(frozen=True)
class SceneConfiguration:
    """Parameters of the node ``scene_publisher``."""

    bearing_topics: tuple[str, ...] = parameter(
        ("passive/bearing_tracks",), "bearing tracks whose sensors are shown, one topic per station"
    )
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
    marker_size: float = parameter(
        100.0,
        "diameter of the dot at a position; names, lines and contacts are in proportion",
        unit="m",
        minimum=0.01,
        changeable=True,
    )
    ray_length: float = parameter(
        6000.0, "how far a bearing is drawn", unit="m", minimum=0.1, changeable=True
    )
