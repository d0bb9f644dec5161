"""The live page of a graph: where it is, and what it listens to (no ROS import)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any

from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.shown_types import SHOWN_TYPES
from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES
from sonar_tracking.graph.catalogue.page_nodes import OPERATOR_DISPLAY
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.topics import DIAGNOSTICS, Topic
from sonar_tracking.records.datum import Datum


@dataclass(frozen=True)
class PageOptions:
    """What a person asks of the live page.

    Attributes
    ----------
    port : int
        Where it is.
    address : str
        To listen at.
    browser : bool
        Whether it is opened in the browser of this machine.
    """

    port: int
    address: str
    browser: bool


def planned_page(
    options: PageOptions | None,
    topics: Iterable[Topic],
    settings: Mapping[str, Mapping[str, Any]],
    title: str,
    datum: Datum | None = None,
) -> tuple[PlannedNode, ...]:
    """Return the node that serves the page, if there is to be one.

    Parameters
    ----------
    options : PageOptions or None
        None = no page.
    topics : iterable of Topic
        All data topics of the graph by full names, published or played.
    settings : mapping
        Node name, parameter name, value; of the scene: where the sensors are on own ship.
    title : str
        Of the page.
    datum : Datum or None
        Of ``map``.
    """
    if options is None:
        return ()
    shown = {ROOT_NAMES.of(topic): topic for topic in topics if topic.message_type in SHOWN_TYPES}
    known = {field.name for field in fields(PageConfiguration)}
    scene = settings.get(SCENE_PUBLISHER.name, {})
    parameters = {name: value for name, value in scene.items() if name in known}
    parameters |= {
        "port": options.port,
        "address": options.address,
        "open_browser": options.browser,
        "title": title,
        "datum": datum.to_text() if datum is not None else "",
        "topics": tuple(shown),
        "types": tuple(topic.message_type for topic in shown.values()),
    }
    return (
        PlannedNode(
            name=OPERATOR_DISPLAY.name,
            module=OPERATOR_DISPLAY.module,
            subscriptions=(*shown.values(), DIAGNOSTICS),
            parameters=parameters,
            needs_clock=False,
            comes_back=True,
            parameters_again={"open_browser": False},
        ),
    )
