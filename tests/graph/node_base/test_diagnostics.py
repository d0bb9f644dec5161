"""A problem must be seen at once, must not flood, and must fade when it is over."""

from __future__ import annotations

import time
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from sonar_tracking.errors import Severity
from sonar_tracking.graph.node_base.diagnostics import REPEAT_AFTER, Diagnostics, kind_of

SECOND = 1_000_000_000


class Log:
    """Takes the place of a logger."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def error(self, sentence: str) -> None:
        self.lines.append(f"E {sentence}")

    def warning(self, sentence: str) -> None:
        self.lines.append(f"W {sentence}")


@pytest.fixture
def log() -> Log:
    return Log()


@pytest.fixture
def published() -> list[DiagnosticArray]:
    return []


@pytest.fixture
def diagnostics(log: Any, published: list[DiagnosticArray]) -> Diagnostics:
    diagnostics = Diagnostics("node", log, published.append)
    diagnostics.add("input /a", lambda: {"received": 7})
    diagnostics.advance(100 * SECOND)
    return diagnostics


def status(message: DiagnosticArray, name: str) -> DiagnosticStatus:
    (found,) = [each for each in message.status if each.name == name]
    return found


def test_a_new_problem_is_logged_and_published_at_once(
    diagnostics: Diagnostics, log: Log, published: list[DiagnosticArray]
) -> None:
    diagnostics.report("input /a", "x", Severity.ERROR, "A is bad; mend it.")
    assert log.lines == ["E A is bad; mend it."]
    found = status(published[-1], "node: input /a")
    assert found.level == DiagnosticStatus.ERROR
    assert found.message == "A is bad; mend it."
    assert [(value.key, value.value) for value in found.values] == [("received", "7")]
    assert published[-1].header.stamp.sec == 100


def test_the_same_problem_again_is_not_repeated_until_later(
    diagnostics: Diagnostics, log: Log, published: list[DiagnosticArray]
) -> None:
    for number in range(50):
        diagnostics.report("input /a", "x", Severity.ERROR, f"bad {number}")
    assert log.lines == ["E bad 0"] and len(published) == 1
    diagnostics.publish()
    assert status(published[-1], "node: input /a").message == "bad 49"
    diagnostics.advance(100 * SECOND + REPEAT_AFTER)
    diagnostics.report("input /a", "x", Severity.ERROR, "bad again")
    assert log.lines[-1] == "E bad again" and len(published) == 3


def test_problems_of_different_culprits_are_all_said(
    diagnostics: Diagnostics, published: list[DiagnosticArray]
) -> None:
    diagnostics.report("input /a", "x", Severity.ERROR, "First.")
    diagnostics.report("input /a", "y", Severity.WARN, "Second.")
    found = status(published[-1], "node: input /a")
    assert found.message == "Second. First." and found.level == DiagnosticStatus.ERROR


def test_a_problem_fades_in_data_time(
    diagnostics: Diagnostics, published: list[DiagnosticArray]
) -> None:
    diagnostics.report("input /a", "x", Severity.ERROR, "bad")
    diagnostics.advance(100 * SECOND + REPEAT_AFTER)
    diagnostics.publish()
    assert status(published[-1], "node: input /a").level == DiagnosticStatus.OK


def test_a_lasting_problem_stays_until_withdrawn(
    diagnostics: Diagnostics, published: list[DiagnosticArray]
) -> None:
    diagnostics.report("parameters", "x", Severity.ERROR, "bad", lasting=True)
    diagnostics.advance(10_000 * SECOND)
    diagnostics.forget()
    diagnostics.publish()
    assert status(published[-1], "node: parameters").level == DiagnosticStatus.ERROR
    diagnostics.report("parameters", "x", Severity.OK, "", lasting=True)
    assert status(published[-1], "node: parameters").level == DiagnosticStatus.OK


def test_a_reset_clears_what_belongs_to_the_old_data(
    diagnostics: Diagnostics, published: list[DiagnosticArray]
) -> None:
    diagnostics.report("input /a", "x", Severity.ERROR, "bad")
    diagnostics.forget()
    diagnostics.publish()
    assert status(published[-1], "node: input /a").level == DiagnosticStatus.OK


def test_numbers_do_not_make_a_new_kind_of_problem() -> None:
    assert kind_of("0.3 s back at 12.500 s") == kind_of("1 s back at 99.125 s")
    assert kind_of("element 3 is bad") != kind_of("snapshot 3 is bad")


def test_what_is_no_news_is_published_now_and_then(
    log: Any, published: list[DiagnosticArray], monkeypatch: pytest.MonkeyPatch
) -> None:
    diagnostics = Diagnostics("node", log, published.append, least_pause=0.2)
    wall = [1000.0]
    monkeypatch.setattr(time, "monotonic", lambda: wall[0])
    for _ in range(100):
        diagnostics.publish_if_due()
        wall[0] += 0.0625
    assert len(published) == 25, "every quarter of a second at this step"
    diagnostics.publish_if_due()
    diagnostics.report("input /a", "x", Severity.ERROR, "A is bad; mend it.")
    assert len(published) == 27, "a problem does not wait"
