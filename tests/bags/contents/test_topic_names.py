"""Protects names of one's own: what a topic is called, which part of a bag is read."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from sonar_tracking.bags.contents.topic_names import topic_names
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.errors import ConfigurationError
from tests.bags.bag_fixtures import EPOCH, SECOND, TRACKS, open_writer, tracks_cdr, write_messages

RECORDED = ("/a/active/contacts", "/a/own_ship/odometry", "/b/active/contacts", "/clock")


def test_a_namespace_is_taken_off_and_a_rule_counts_more() -> None:
    names = topic_names(["/b/active/contacts:=other/contacts"], "a")
    assert names.all_of(RECORDED, "bag") == {
        "/a/active/contacts": "/active/contacts",
        "/a/own_ship/odometry": "/own_ship/odometry",
        "/b/active/contacts": "/other/contacts",
        "/clock": "/clock",
    }
    # What the recorder has noted counts more than the namespace, and less than a rule.
    noted = {"/a/active/contacts": "/echoes", "/b/active/contacts": "/active/contacts"}
    assert names.all_of(RECORDED, "bag", noted) == {
        "/a/active/contacts": "/echoes",
        "/a/own_ship/odometry": "/own_ship/odometry",
        "/b/active/contacts": "/other/contacts",
        "/clock": "/clock",
    }
    assert topic_names(["clock:=/time"], "").of("/clock") == "/time"
    assert topic_names([], "/a/").of("/ab/contacts") == "/ab/contacts"


@pytest.mark.parametrize(
    ("remaps", "namespace", "sentence"),
    [
        (["/a/active/contacts"], "", "give the recorded name"),
        ([":=/active/contacts"], "", "give the recorded name"),
        (["/a:=/"], "", "give the recorded name"),
        (["/a:=/b", "a:=/c"], "", "/a is given twice"),
        (["/c/contacts:=/active/contacts"], "", "holds no topic /c/contacts"),
        (["/b/active/contacts:=/my contacts"], "", "'/my contacts' is no name in ROS"),
        ([], "a//b", "'a//b' is no name in ROS"),
        ([], "/c", "holds no topic below /c"),
        (["/b/active/contacts:=/active/contacts"], "a", "would both be called /active/contacts"),
    ],
)
def test_a_rule_that_cannot_be_followed_is_refused(
    remaps: list[str], namespace: str, sentence: str
) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        topic_names(remaps, namespace).all_of(RECORDED, "bag")


@pytest.fixture
def bag(tmp_path: Path) -> Bag:
    writer = open_writer(tmp_path / "bag")
    write_messages(writer, 10)
    writer.close()
    return read_bag(writer.path)


def test_a_renamed_bag_holds_the_same_messages(bag: Bag) -> None:
    named = bag.named(topic_names(["/array/snapshots:=/port/snapshots"], ""))
    assert named.topics["/port/snapshots"].message_count == 10
    assert named.topics["/port/snapshots"].role == "input"
    assert "/array/snapshots" not in named.topics
    renamed = [m.topic.replace("/port/", "/array/") for m in named.messages()]
    assert renamed == [m.topic for m in bag.messages()]
    assert [m.data for m in named.messages()] == [m.data for m in bag.messages()]
    again = named.named(topic_names(["/port/snapshots:=/array/snapshots"], ""))
    assert list(again.messages()) == list(bag.messages())
    assert not list(named.messages(["/array/snapshots"]))


def test_somebody_elses_topic_gets_the_role_of_its_new_name(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "foreign")
    writer.add_topic("/gps/targets", TRACKS)
    writer.write("/gps/targets", EPOCH * SECOND, tracks_cdr(0))
    writer.close()
    named = read_bag(writer.path).named(topic_names(["/gps/targets:=/truth/bearing_tracks"], ""))
    assert named.topics["/truth/bearing_tracks"].role == "truth"


def test_a_part_begins_at_the_offset_and_ends_before_its_duration_is_over(bag: Bag) -> None:
    part = bag.part(3.0, 2.0)
    times = [m.log_time // SECOND - EPOCH for m in part.messages(["/array/snapshots"])]
    assert times == [3, 4]
    assert part.topics["/array/snapshots"].message_count == 2
    assert list(bag.part(0.0, math.inf).messages()) == list(bag.messages())
    named = part.named(topic_names(["/array/snapshots:=/port/snapshots"], ""))
    assert len(list(named.messages(["/port/snapshots"]))) == 2


def test_a_part_without_messages_is_refused(bag: Bag) -> None:
    with pytest.raises(ConfigurationError, match=r"it is 9\.0 s long"):
        bag.part(100.0, math.inf)
