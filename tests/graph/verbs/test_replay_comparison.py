"""A replay is compared message by message with what was recorded."""

from collections.abc import Collection
from types import SimpleNamespace
from typing import Any

from rclpy.serialization import serialize_message
from std_msgs.msg import Header

from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.contents.message_definitions import installed_definition
from sonar_tracking.bags.contents.storage_file import BagMessage
from sonar_tracking.graph.orchestration.topic_record import TopicRecord
from sonar_tracking.graph.verbs.replay_comparison import ReplayComparison

OUTPUT, TRUTH, TYPE = "/passive/bearing_tracks", "/truth/bearing_tracks", "std_msgs/msg/Header"
DEFINITION = installed_definition(TYPE)


def topic(role: str, message_count: int) -> SimpleNamespace:
    """Return a topic of a bag."""
    return SimpleNamespace(
        type_name=TYPE, role=role, message_count=message_count, definition=DEFINITION
    )


def compared(
    recorded: list[str],
    replayed: list[str],
    losses: tuple[Loss, ...] = (),
    played: Collection[str] = (TRUTH,),
) -> str:
    """Return what is said of one output, given the frames of its messages."""
    topics = {
        OUTPUT: topic("output", len(recorded)),
        TRUTH: topic("truth", 1),
    }
    bag: Any = SimpleNamespace(topics=topics, losses=losses, recording=None)
    record = TopicRecord(TYPE, keep_steps=True)
    comparison = ReplayComparison(bag, {OUTPUT: record}, played)
    assert comparison.topics == {OUTPUT}
    for frame in recorded:
        comparison.take(BagMessage(OUTPUT, 1, serialize_message(Header(frame_id=frame))))
    for frame in replayed:
        record.add(serialize_message(Header(frame_id=frame)))
    phrase = comparison.result()[OUTPUT]
    assert comparison.differs() == phrase.startswith("different")
    return phrase


def test_equal() -> None:
    assert compared(["a", "b"], ["a", "b"]) == "identical: 2 messages"


def test_the_first_difference_is_numbered() -> None:
    assert compared(["a", "b", "c"], ["a", "x", "c"]) == "different from message 2 of 3 on"


def test_missing_messages_differ() -> None:
    assert compared(["a", "b"], ["a"]) == "different: 2 messages recorded, 1 replayed"
    assert compared(["a"], ["a", "b"]) == "different: 1 messages recorded, 2 replayed"


def test_a_cut_off_recording_is_compared_as_far_as_it_goes() -> None:
    phrase = compared(["a"], ["a", "b"], (Loss(intact_before={OUTPUT: 1}),))
    assert phrase == "identical as far as it was recorded: 1 of 2 messages"
    cut_off = (Loss(intact_before={OUTPUT: 2}),)
    assert compared(["a", "b"], ["a"], cut_off).startswith("different")


def test_behind_a_gap_in_the_recording_nothing_is_compared_but_before_it_all_is() -> None:
    gap = (Loss("/array/snapshots", 1, intact_before={OUTPUT: 1}),)
    played = {TRUTH, "/array/snapshots"}
    assert compared(["a", "b", "c"], ["a", "x"], gap, played) == (
        "identical for 1 of 3 messages, then not comparable: messages of /array/snapshots are "
        "missing in the recording"
    )
    assert compared(["a", "b"], ["x", "b"], gap, played) == "different from message 1 of 2 on"
    assert compared(["a", "b"], ["a", "b"], gap, played) == "identical: 2 messages"
    unknown = compared(["a", "b"], ["x"], (Loss(),), played)
    assert unknown == "not comparable: messages of any topic are missing in the recording"


def test_what_is_missing_of_a_topic_nobody_needs_changes_nothing() -> None:
    gap = (Loss("/clock", 1), Loss("/tf", 3))
    assert compared(["a", "b"], ["a", "x"], gap) == "different from message 2 of 2 on"


def comparison_of(message_count: int, recording: object, played: set[str]) -> ReplayComparison:
    """Return the comparison of one output of a bag."""
    topics = {OUTPUT: topic("output", message_count)}
    bag: Any = SimpleNamespace(topics=topics, losses=(), recording=recording)
    return ReplayComparison(bag, {OUTPUT: TopicRecord(TYPE, keep_steps=True)}, played)


def test_what_is_played_from_the_bag_is_not_compared_with_itself() -> None:
    comparison = comparison_of(40, None, {OUTPUT})
    assert comparison.result() == {} and not comparison.differs() and comparison.topics == set()


def test_a_topic_somebody_elses_recorder_heard_nothing_on_is_not_compared() -> None:
    assert comparison_of(0, None, set()).result() == {}
    # A recording of ours knows that the node had nothing to say.
    assert comparison_of(0, object(), set()).result() == {OUTPUT: "identical: 0 messages"}
