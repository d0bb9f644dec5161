"""Parameters of the scene."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter
from sonar_tracking.scene.shown_mountings import ShownMountings


@dataclass(frozen=True)
class SceneConfiguration(ShownMountings):
    """Parameters of the node ``scene_publisher``."""

    bearing_topics: tuple[str, ...] = parameter(
        ("passive/bearing_tracks",), "bearing tracks whose sensors are shown, one topic per station"
    )
    station: str = parameter(
        "",
        "namespace of the ship or sensor that is shown: before the names of its topics and frames, "
        "but not of those in lists; empty = own ship",
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
