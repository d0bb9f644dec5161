"""Protects that a discovery server that is asked in vain is named, once, and only then."""

from sonar_tracking.graph.orchestration.server_watch import PATIENCE, ServerWatch


def test_a_server_is_named_once_after_the_patience() -> None:
    watch = ServerWatch(lambda: " They ask 10.0.0.5.")
    assert list(watch.news(1e9)) == [], "nobody waits yet"
    watch.begin(100.0)
    assert list(watch.news(100.0 + PATIENCE)) == []
    assert list(watch.news(100.1 + PATIENCE)) == [
        "the nodes do not find each other yet. They ask 10.0.0.5."
    ]
    assert list(watch.news(200.0)) == []
    watch.begin(300.0)
    watch.end()
    assert list(watch.news(400.0)) == []


def test_without_a_server_nothing_is_said() -> None:
    watch = ServerWatch(lambda: "")
    watch.begin(0.0)
    assert list(watch.news(100.0)) == []
