"""A node as the orchestration is going to start it (no ROS import)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sonar_tracking.graph.catalogue.topics import Topic


@dataclass(frozen=True)
class PlannedNode:
    """One node of the graph.

    Attributes
    ----------
    name, module : str
        Node name and the Python module that runs it.
    subscriptions, publishers : tuple of Topic
        Its data topics.
    parameters : mapping
        Its ROS parameters, checked.
    gives_identifiers : bool
        Whether it has a parameter ``first_id``.
    needs_clock : bool
        Whether it listens to ``/clock``; to hear every tick costs more than to draw a picture.
    remaps : mapping of str to str
        Full name of a topic in the namespace of the node to its name in the graph.
    comes_back : bool
        Of a display: whether it is started again when it has died.
    parameters_again : mapping
        Its parameters that are others then.
    """

    name: str
    module: str
    subscriptions: tuple[Topic, ...] = ()
    publishers: tuple[Topic, ...] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    gives_identifiers: bool = False
    needs_clock: bool = True
    remaps: Mapping[str, str] = field(default_factory=dict)
    comes_back: bool = False
    parameters_again: Mapping[str, Any] = field(default_factory=dict)
