"""Backlogs are counted rightly, also over restarts of producers and consumers."""

from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger

BLOCKS, TRACKS = "/array/snapshots", "/passive/bearing_tracks"


def ledger() -> FlowLedger:
    return FlowLedger(
        {BLOCKS: ("chain", "recorder"), TRACKS: ("recorder",)},
        {BLOCKS: "simulator", TRACKS: "chain"},
    )


def test_the_slowest_consumer_counts() -> None:
    flow = ledger()
    flow.published("simulator", BLOCKS, 5)
    flow.finished("chain", BLOCKS, 4)
    flow.finished("recorder", BLOCKS, 2)
    assert flow.largest_backlog() == 3
    worst = flow.backlogs()[0]
    assert (worst.node, worst.topic, worst.messages) == ("recorder", BLOCKS, 3)


def test_a_report_that_overtakes_the_announcement_is_no_backlog() -> None:
    flow = ledger()
    flow.finished("chain", BLOCKS, 1)
    flow.finished("recorder", BLOCKS, 1)
    assert flow.largest_backlog() == 0
    flow.published("simulator", BLOCKS, 1)
    assert flow.largest_backlog() == 0


def test_strangers_are_not_counted() -> None:
    flow = ledger()
    flow.published("simulator", "/elsewhere", 5)
    flow.finished("visitor", BLOCKS, 5)
    assert flow.largest_backlog() == 0
    assert flow.messages_in("visitor") == 0


def test_a_restarted_consumer_starts_from_what_is_there() -> None:
    flow = ledger()
    flow.published("simulator", BLOCKS, 10)
    flow.finished("recorder", BLOCKS, 10)
    flow.finished("chain", BLOCKS, 7)
    flow.leave("chain")
    assert flow.largest_backlog() == 0
    flow.finished("chain", BLOCKS, 8)  # a late report of the dead process
    flow.rejoin("chain")
    assert flow.largest_backlog() == 0
    flow.published("simulator", BLOCKS, 12)
    flow.finished("recorder", BLOCKS, 12)
    assert flow.largest_backlog() == 2
    flow.finished("chain", BLOCKS, 2)
    assert flow.largest_backlog() == 0
    assert flow.messages_in("chain") == 9
    assert [(lost.node, lost.messages) for lost in flow.lost()] == [("chain", 3)]


def test_a_restarted_producer_goes_on_counting() -> None:
    flow = ledger()
    flow.published("simulator", BLOCKS, 10)  # announced, then killed before publishing
    flow.finished("chain", BLOCKS, 9)
    flow.finished("recorder", BLOCKS, 9)
    flow.leave("simulator")
    flow.rejoin("simulator")
    assert flow.largest_backlog() == 0
    flow.published("simulator", BLOCKS, 2)
    assert flow.largest_backlog() == 2
    flow.finished("chain", BLOCKS, 11)
    flow.finished("recorder", BLOCKS, 11)
    assert flow.largest_backlog() == 0
    assert flow.messages_out("simulator") == 12


def test_lost_messages_are_waited_for_no_longer_and_still_told() -> None:
    flow = ledger()
    flow.published("simulator", BLOCKS, 5)
    flow.finished("chain", BLOCKS, 5)
    flow.finished("recorder", BLOCKS, 3)
    for backlog in flow.backlogs():
        flow.write_off(backlog)
    assert flow.largest_backlog() == 0
    flow.published("simulator", BLOCKS, 6)
    flow.finished("chain", BLOCKS, 6)
    assert flow.largest_backlog() == 1
    flow.finished("recorder", BLOCKS, 4)
    assert flow.largest_backlog() == 0
    assert [(lost.node, lost.messages) for lost in flow.lost()] == [("recorder", 2)]
