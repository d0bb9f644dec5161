"""Who is waited for is named; what was lost on the way is written off, so that the run ends."""

from pathlib import Path

from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.stall_watch import LOST_SECONDS, STALL_SECONDS, StallWatch


def test_a_stalled_node_is_named_and_what_it_lost_given_up() -> None:
    flow = FlowLedger({"/a": ("tracker",)}, {"/a": "source"})
    watch = StallWatch(flow, Path("logs"))
    flow.published("source", "/a", 2)
    assert list(watch.news(10.0)) == []
    assert list(watch.news(10.0 + STALL_SECONDS)) == []
    (sentence,) = watch.news(10.1 + STALL_SECONDS)
    assert sentence == (
        "waiting for tracker: it has not finished 2 messages of /a; its log is logs/tracker.log"
    )
    assert flow.largest_backlog() == 2
    list(watch.news(10.1 + LOST_SECONDS))
    assert flow.largest_backlog() == 0
    assert [lost.messages for lost in flow.lost()] == [2]


def test_nothing_is_said_of_data_that_move() -> None:
    flow = FlowLedger({"/a": ("tracker",)}, {"/a": "source"})
    watch = StallWatch(flow, Path("logs"))
    for second in range(100):
        flow.published("source", "/a", second + 2)
        flow.finished("tracker", "/a", second)
        assert list(watch.news(float(second))) == []
