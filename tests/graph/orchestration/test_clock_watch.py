"""Protects what a run says of other clocks: each by its name, once, as soon as it has one."""

from sonar_tracking.graph.orchestration.clock_watch import ClockWatch


def test_each_is_named_once() -> None:
    watch = ClockWatch()
    (sentence,) = watch.news(10.0, lambda: ["/player", "/_NODE_NAME_UNKNOWN_"])
    assert sentence.startswith("/player publishes the clock of this run, too")
    assert list(watch.news(10.5, lambda: ["/player", "/other"])) == [], "it looks now and then"
    assert [text.split()[0] for text in watch.news(12.0, lambda: ["/player", "/other"])] == [
        "/other"
    ]
