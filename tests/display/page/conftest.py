"""One browser for all tests of the page; a server of its own for each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest

from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_server import PageServer
from tests.display.page.chromium import Chromium, Tab

TOKEN = "token_of_the_tests"

Start = Callable[..., PageServer]


@pytest.fixture(scope="session")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    """Yield a browser; skip where none is installed."""
    browser = Chromium(tmp_path_factory.mktemp("chromium"))
    try:
        yield browser
    finally:
        browser.close()


@pytest.fixture
def opened(chromium: Chromium) -> Iterator[Callable[..., Tab]]:
    """Yield what opens pages; none of them may have complained at the end."""
    tabs: list[Tab] = []

    def open_page(address: str, **size: int) -> Tab:
        tabs.append(chromium.open(address, **size))
        return tabs[-1]

    yield open_page
    complaints = [complaint for tab in tabs for complaint in tab.complaints]
    for tab in tabs:
        chromium.leave(tab)
    assert not complaints


@pytest.fixture
def asked() -> list[Mapping[str, Any]]:
    """Return the commands that servers have taken."""
    return []


@pytest.fixture
def start(asked: list[Mapping[str, Any]]) -> Iterator[Start]:
    """Yield what starts a server; all are stopped at the end."""
    started: list[PageServer] = []

    def command(fields: Mapping[str, Any]) -> tuple[bool, str]:
        asked.append(dict(fields))
        return True, "sent."

    def start_server(port: int = 0, **settings: Any) -> PageServer:
        configuration = PageConfiguration(port=port, title="scene", **settings)
        server = PageServer(configuration, TOKEN, command)
        server.start()
        started.append(server)
        return server

    yield start_server
    for server in started:
        server.stop()
