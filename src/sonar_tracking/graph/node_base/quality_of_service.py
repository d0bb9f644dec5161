"""Quality of service of every topic of the graph.

Data are reliable, volatile and keep-last: with flow control a depth of twice the flow window
loses nothing, and an acknowledged message is not yet a processed one. Track lists are in addition
kept for late readers. Nodes and the recorder subscribe volatile (they are matched before data
flow); displays subscribe with :data:`LATE_READER` and get the current picture at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.qos_overriding_options import QoSOverridingOptions

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.topics import TopicKind

DEFAULT_FLOW_DEPTH = 10
"""Messages kept per data topic; at least twice the flow window of the time master."""


def _profile(
    depth: int,
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE,
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE,
) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=reliability,
        durability=durability,
    )


def publisher_profile(kind: TopicKind, depth: int = DEFAULT_FLOW_DEPTH) -> QoSProfile:
    """Return the profile a producer of a data topic publishes with."""
    if kind is TopicKind.TRACKS:
        return _profile(depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    if kind is TopicKind.COMMANDS:
        return ALL_COMMANDS
    return _profile(depth)


def subscription_profile(depth: int = DEFAULT_FLOW_DEPTH) -> QoSProfile:
    """Return the profile nodes and the recorder subscribe with, whatever the kind of topic."""
    return _profile(depth)


def overridable() -> QoSOverridingOptions:
    """Return what parameters ``qos_overrides.<topic>.<side>.<policy>`` may change."""
    return QoSOverridingOptions(
        [
            QoSPolicyKind.DEPTH,
            QoSPolicyKind.DURABILITY,
            QoSPolicyKind.HISTORY,
            QoSPolicyKind.RELIABILITY,
        ]
    )


@contextmanager
def overriding(node: str, topic: str) -> Iterator[QoSOverridingOptions]:
    """Let an endpoint of a node be made with the overrides of the user; refuse what ROS cannot use.

    Raises
    ------
    ConfigurationError
        If it cannot be made so.
    """
    try:
        yield overridable()
    except Exception as error:
        raise ConfigurationError(
            f"{node}: a qos_overrides parameter of {topic} cannot be used: {error}"
        ) from error


LATE_READER = _profile(1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Subscription of displays and other late readers of a track list: the current picture."""

ALL_COMMANDS = _profile(1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Publishers of commands, and the trackers' subscriptions to them: one that is started again gets
what it was told before."""

PROGRESS = _profile(5000)
"""Publishers and subscriptions of ``flow/done``. All nodes share the queue of its reader: were it
short, a burst of one would push out the last word of another, and the run would wait for it."""

DIAGNOSTICS = _profile(100)
"""Publishers and subscriptions of ``/diagnostics``."""

CLOCK = _profile(100)
"""Publisher of ``/clock`` and the simulators' subscription to it: no tick is lost, so that a run
can always be finished. (The clocks inside rclpy subscribe best effort, which is compatible.)"""
