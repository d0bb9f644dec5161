"""Protects what a restarted source leaves out: what all that live have received, and no more."""

from sonar_tracking.graph.orchestration.finished_stamps import FinishedStamps

CONSUMERS = {"/contacts": ("tracker", "recorder"), "/odometry": ("tracker",)}


def test_the_slowest_consumer_of_any_topic_counts() -> None:
    stamps = FinishedStamps()
    for node, topic, stamp in (
        ("tracker", "/contacts", 30),
        ("tracker", "/odometry", 40),
        ("recorder", "/contacts", 20),
    ):
        stamps.finished(node, topic, stamp)
    assert stamps.everywhere(CONSUMERS, CONSUMERS) == 20
    assert stamps.everywhere(["/odometry"], CONSUMERS) == 40
    alive = {"/contacts": ("tracker",), "/odometry": ("tracker",)}
    assert stamps.everywhere(CONSUMERS, alive) == 30


def test_nothing_is_left_out_that_somebody_may_not_have() -> None:
    stamps = FinishedStamps()
    stamps.finished("tracker", "/contacts", 30)
    assert stamps.everywhere(["/contacts"], CONSUMERS) is None
    assert stamps.everywhere([], CONSUMERS) is None
