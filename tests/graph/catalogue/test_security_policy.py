"""The example of a security policy allows what the contact tracker does, and nobody else that."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

from sonar_tracking.graph.catalogue.active_nodes import HPDA_TRACKER

POLICY = Path(__file__).resolve().parents[3] / "config" / "security" / "contacts.policy.xml"


def topics(node: str, verb: str) -> set[str]:
    """Return the topics that a node may publish or subscribe to."""
    found = ElementTree.parse(POLICY).findall(f".//profile[@node='{node}']/topics[@{verb}='ALLOW']")
    return {topic.text or "" for group in found for topic in group}


def test_the_tracker_may_do_what_it_does() -> None:
    taken = {topic.name for topic in (*HPDA_TRACKER.inputs, *HPDA_TRACKER.optional_inputs)}
    assert taken < topics("hpda_tracker", "subscribe")
    given = {topic.name for topic in (*HPDA_TRACKER.outputs, *HPDA_TRACKER.markers)}
    assert given < topics("hpda_tracker", "publish")


def test_nobody_else_publishes_tracks() -> None:
    tracks = {topic.name for topic in HPDA_TRACKER.outputs}
    assert not tracks & topics("sonar", "publish")
    assert not topics("reader", "publish")
