"""Parameters of the live page."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter
from sonar_tracking.scene.shown_mountings import ShownMountings


@dataclass(frozen=True)
class PageConfiguration(ShownMountings):
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
    datum: str = parameter(
        "",
        "latitude and longitude of the origin of map, degrees, to show places; empty = that on "
        "map/datum",
    )
    topics: tuple[str, ...] = parameter(
        (), "full names of the topics to show; empty = all below the namespace of the node"
    )
    types: tuple[str, ...] = parameter((), "the message type of each of these topics")
    history_minutes: float = parameter(
        45.0, "data time a new page can scroll back", unit="min", minimum=1.0, maximum=600.0
    )
