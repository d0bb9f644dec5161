"""Where a run shows what happens: what may be asked, and what becomes of it."""

from __future__ import annotations

import sys

import pytest

from sonar_tracking.display.page.page_address import TOKEN_VARIABLE, listening_socket
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.verbs import display_choice
from sonar_tracking.graph.verbs.display_choice import NONE, PAGE, TERMINAL, DisplayChoice


def choose(asked: str | None, no_display: bool = False, port: int = 8080) -> DisplayChoice:
    return display_choice.display_choice(asked, no_display, True, port, "127.0.0.1")


def test_where_nobody_looks_at_a_terminal_there_is_no_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: False)
    assert choose(None).kind == NONE
    assert choose(PAGE).kind == PAGE


def test_in_a_terminal_the_page_is_there_if_it_can_be(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert choose(None).kind == PAGE
    assert choose(None, no_display=True).kind == NONE
    monkeypatch.setattr(display_choice, "find_spec", lambda name: None)
    assert choose(None).kind == TERMINAL
    with pytest.raises(ModuleNotFoundError, match="tornado"):
        choose(PAGE)


@pytest.mark.parametrize(
    ("asked", "no_display", "port", "words"),
    [
        ("window", False, 8080, "give one of terminal, page, none"),
        (PAGE, True, 8080, "exclude one another"),
        (PAGE, False, 70000, "from 0 to 65535"),
    ],
)
def test_what_cannot_be_is_refused(asked: str, no_display: bool, port: int, words: str) -> None:
    with pytest.raises(ConfigurationError, match=words):
        choose(asked, no_display, port)


def test_the_address_is_said_first_and_a_taken_port_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, "abc")
    with listening_socket("127.0.0.1", 0) as taken:
        port = taken.getsockname()[1]
        options, said = DisplayChoice(PAGE, port).page()
    assert options is not None
    assert options.port > port
    assert said[0] == f"page: http://localhost:{options.port}/#token=abc"
    assert said[1].startswith(f"port {port} is taken")
    assert DisplayChoice(NONE).page() == (None, ())
