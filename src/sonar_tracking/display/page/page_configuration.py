"""Parameters of the live page."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter


@dataclass(frozen=True)
class PageConfiguration:
    """Parameters of the node ``operator_display``."""

    port: int = parameter(
        8080, "TCP port of the page; if it is taken, the next free one", minimum=0, maximum=65535
    )
    address: str = parameter(
        "127.0.0.1", "address to listen at; 0.0.0.0 lets other machines look, too"
    )
    remote_commands: bool = parameter(
        False, "whether other machines may send commands if they have the token of the page"
    )
    open_browser: bool = parameter(False, "open the page in the browser of this machine")
    title: str = parameter("", "what the page shows, e.g. the name of the scenario")
    topics: tuple[str, ...] = parameter(
        (), "full names of the topics to show; empty = all below the namespace of the node"
    )
    types: tuple[str, ...] = parameter((), "the message type of each of these topics")
    history_minutes: float = parameter(
        45.0, "data time a new page can scroll back", unit="min", minimum=1.0, maximum=600.0
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
