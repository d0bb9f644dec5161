"""A run that does not keep its rate says so, names who is slow, and fails if it ends behind."""

from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.rate_watch import SLACK_SECONDS, RateWatch

BLOCKS = "/array/snapshots"


def ledger() -> FlowLedger:
    return FlowLedger({BLOCKS: ("fast", "slow")}, {BLOCKS: "array_simulator"})


def test_the_node_that_was_waited_for_is_named_while_it_runs_and_at_the_end() -> None:
    flow = ledger()
    watch = RateWatch(flow, ["array_simulator"])
    flow.published("array_simulator", BLOCKS, 4)
    flow.finished("fast", BLOCKS, 4)
    said = [text for tenths in range(100) for text in watch.news(tenths / 10)]
    assert [text.split(" s behind")[0] for text in said] == [
        "the run is 2.1",
        "the run is 4.3",
        "the run is 8.7",
    ], "said again only when it has doubled"
    assert all(text.endswith("because of slow.") for text in said)
    failure = watch.failure(9.9, 30.0)
    assert failure.startswith("the run is 9.9 s behind the rate asked for, because of slow:")
    assert "--rate max" in failure


def test_a_source_is_named_if_nobody_else_is_behind() -> None:
    watch = RateWatch(ledger(), ["array_simulator"])
    (said,) = watch.news(3.0)
    assert said.endswith("because of array_simulator.")


def test_a_hiccup_that_is_made_good_is_none() -> None:
    watch = RateWatch(ledger(), ())
    list(watch.news(6.0))
    assert watch.failure(0.0, 30.0) == ""
    assert watch.failure(SLACK_SECONDS, 30.0) == ""
    assert watch.failure(SLACK_SECONDS + 1.0, 3600.0) == ""
