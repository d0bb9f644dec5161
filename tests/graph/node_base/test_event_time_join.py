"""Results must not depend on the order in which messages of different topics arrive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sonar_tracking.graph.node_base.event_time_join import EventTimeJoin, JoinedItem
from sonar_tracking.records.time import END_OF_DATA

Message = tuple[str, int, int, Any]


def linear(before: float, after: float, fraction: float) -> float:
    return before + fraction * (after - before)


def stream(topic: str, stamps: Sequence[int]) -> list[Message]:
    """Messages of one topic with true watermarks, the last one END_OF_DATA."""
    following = [*stamps[1:], END_OF_DATA]
    return [
        (topic, stamp, later, f"{topic}@{stamp}")
        for stamp, later in zip(stamps, following, strict=True)
    ]


def run(join: EventTimeJoin, messages: Sequence[Message]) -> list[JoinedItem]:
    return [item for message in messages for item in join.push(*message)]


def interleaved(draw: Callable[..., Any], streams: Sequence[list[Message]]) -> list[Message]:
    """Arrival order: any, but in order within a topic."""
    turns = draw(st.permutations([i for i, each in enumerate(streams) for _ in each]))
    rest = [iter(each) for each in streams]
    return [next(rest[turn]) for turn in turns]


stamp_lists = st.lists(st.integers(1, 40), min_size=1, max_size=8, unique=True).map(sorted)


@pytest.mark.slow
@given(st.data(), stamp_lists, stamp_lists, stamp_lists)
def test_arrival_order_does_not_matter(
    data: st.DataObject, first: list[int], second: list[int], third: list[int]
) -> None:
    streams = [stream("a", first), stream("b", second), stream("c", third)]
    items = run(EventTimeJoin(["a", "b", "c"]), interleaved(data.draw, streams))
    expected = sorted((stamp, topic) for each in streams for topic, stamp, _, _ in each)
    assert [(item.stamp, item.topic) for item in items] == expected


@pytest.mark.slow
@given(st.data(), stamp_lists, stamp_lists, stamp_lists)
def test_a_group_joins_equal_stamps_and_a_series_is_known_at_each(
    data: st.DataObject, first: list[int], second: list[int], third: list[int]
) -> None:
    samples: list[Message] = [("pose", stamp, 0, stamp * 10.0) for stamp in range(0, 50, 7)]
    streams = [stream("a", first), stream("b", second), stream("c", third), samples]
    join = EventTimeJoin(["c"], groups=[["a", "b"]], series={"pose": linear})
    items = run(join, interleaved(data.draw, streams))
    group = [item for item in items if item.topic == "a"]
    assert [item.stamp for item in group] == sorted({*first, *second})
    for item in group:
        assert ("a" in item.items) == (item.stamp in first)
        assert ("b" in item.items) == (item.stamp in second)
    for item in items:
        assert abs(item.series["pose"] - 10.0 * item.stamp) < 1e-9
    assert [(i.stamp, i.topic) for i in items] == sorted((i.stamp, i.topic) for i in items)


def test_a_single_input_never_waits() -> None:
    join = EventTimeJoin(["a"])
    for stamp in (3, 4, 9):
        assert [item.stamp for item in join.push("a", stamp, 0, None)] == [stamp]
    assert join.waits_for() == ()


def test_an_item_waits_for_the_watermark_of_the_other_stream() -> None:
    join = EventTimeJoin(["a", "b"])
    assert join.push("b", 5, 6, "b5") == ()
    assert join.waits_for() == ("a",)
    assert join.push("a", 3, 5, "a3")[0].topic == "a"
    assert join.waits_for() == ("a",), "a watermark of 5 may still bring an a at 5, which is first"
    assert [item.topic for item in join.push("a", 5, 8, "a5")] == ["a", "b"]


def test_stamps_of_a_topic_rise_so_that_an_item_rules_out_another_one_at_its_stamp() -> None:
    """Without a watermark an item at 5 still says that the next one of its topic is later."""
    join = EventTimeJoin(["a", "b"])
    assert join.push("a", 5, 0, "a5") == ()
    assert join.waits_for() == ("b",)
    assert [item.topic for item in join.push("b", 5, 0, "b5")] == ["a", "b"]
    group = EventTimeJoin(["c"], groups=[["a", "b"]])
    assert group.push("c", 5, 0, "c5") == ()
    assert group.push("a", 5, 0, "a5") == ()
    assert [item.topic for item in group.push("b", 5, 0, "b5")] == ["a", "c"]


def test_an_item_waits_for_a_series_at_or_after_it() -> None:
    join = EventTimeJoin(["a"], series={"pose": linear})
    join.push("pose", 0, 0, 0.0)
    assert join.push("a", 5, 6, "a5") == ()
    assert join.waits_for() == ("pose",)
    (item,) = join.push("pose", 10, 0, 100.0)
    assert item.series == {"pose": 50.0}


def test_before_the_first_sample_a_series_is_unknown() -> None:
    join = EventTimeJoin(["a"], series={"pose": linear})
    join.push("a", 5, 6, "a5")
    (item,) = join.push("pose", 10, 0, 100.0)
    assert item.series == {"pose": None}


def test_a_missing_member_of_a_group_is_left_out_once_its_watermark_has_passed() -> None:
    join = EventTimeJoin(groups=[["a", "b"]])
    assert join.push("a", 5, 10, "a5") == ()
    assert join.waits_for() == ("b",)
    (item,) = join.push("b", 10, 20, "b10")
    assert item.items == {"a": "a5"}


def test_the_end_of_data_releases_what_waits_for_that_input() -> None:
    join = EventTimeJoin(["a", "b"])
    join.push("b", 5, END_OF_DATA, "b5")
    assert len(join.push("a", 1, END_OF_DATA, "a1")) == 2


def test_flush_gives_the_rest_in_order_and_forgets() -> None:
    join = EventTimeJoin(["a", "b", "c"])
    join.push("b", 5, 6, "b5")
    join.push("a", 7, 8, "a7")
    assert [item.stamp for item in join.flush()] == [5, 7]
    assert join.waits_for() == ()
    assert join.push("a", 1, END_OF_DATA, "a1") == ()


def test_too_much_waiting_runs_without_what_it_waits_for() -> None:
    """A source that is never started must not fill the memory, nor silence the node for good."""
    join = EventTimeJoin(["a"], series={"pose": linear}, capacity=2)
    assert join.push("a", 1, 2, "a1") == ()
    assert join.push("a", 2, 3, "a2") == ()
    (item,) = join.push("a", 3, 4, "a3")
    assert (item.stamp, item.series, item.not_awaited) == (1, {"pose": None}, ("pose",))
    released = join.push("pose", 3, 0, 0.0)
    assert [(item.stamp, item.not_awaited) for item in released] == [(2, ()), (3, ())]


def test_only_what_needs_a_series_waits_for_it() -> None:
    """Items that know better run at once; the order stays that of the stamps."""
    join = EventTimeJoin(
        ["a"], series={"pose": linear}, needs_series=lambda items: items["a"] == "lost"
    )
    assert [item.stamp for item in join.push("a", 1, 2, "sure")] == [1]
    assert join.push("a", 2, 3, "lost") == ()
    assert join.waits_for() == ("pose",)
    assert join.push("a", 3, 4, "sure") == ()
    assert join.push("pose", 1, 0, 10.0) == ()
    released = join.push("pose", 3, 0, 30.0)
    assert [(item.stamp, item.series["pose"]) for item in released] == [(2, 20.0), (3, 30.0)]
