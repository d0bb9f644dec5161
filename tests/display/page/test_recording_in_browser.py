"""The page of a recording in a real browser: played, and looked through however long it is."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.display.page import recorded_page
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_server import PageServer
from tests.bags.position_fixtures import POSITIONS
from tests.display.page.chromium import Tab
from tests.display.page.page_scene import START, show
from tests.display.test_plot_bag import bag


def test_a_recording_says_so_and_plays(opened: Callable[..., Tab]) -> None:
    configuration = PageConfiguration(port=0, title="bag")
    server = PageServer(configuration, "", recording="whole")
    server.start()
    try:
        show(server, 0, 30)
        tab = opened(server.address)
        state = "(page.draw(), document.querySelector('#state').textContent)"
        tab.wait_for(f"page.history.newest >= {START + 29} && {state} === 'recording'")
        tab.value("page.time.seek(page.history.oldest)")
        tab.value("page.time.play(60)")
        began = time.monotonic()
        tab.wait_for(f"page.time.now > {START + 10}")
        assert time.monotonic() >= began
        assert not tab.value("page.commands.possible")
    finally:
        server.stop()


@pytest.mark.slow
def test_a_recording_larger_than_memory_is_looked_through(
    opened: Callable[..., Tab], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bar spans all of it; what is not held is fetched, by hand and while it is played."""
    path = bag(tmp_path / "bag", {"/active/tracks": POSITIONS}, 600)
    monkeypatch.setattr(recorded_page, "LEAD", 20.0)
    monkeypatch.setattr(recorded_page, "LARGEST_PART", 50_000)
    page = recorded_page.RecordedPage(read_bag(path), 0, "127.0.0.1")
    page.server.start()
    try:
        page.feed()
        threading.Thread(target=page.follow, daemon=True).start()
        tab = opened(page.server.address)
        held = "[page.history.oldest, page.history.newest].map((t) => t - page.time.span[0])"
        tab.wait_for("page.time.recording === 'part' && page.history.newest > 0")
        assert tab.value(held)[1] < 500.0
        tab.value("page.time.resume()")
        tab.wait_for("page.time.recording === 'last part'")
        assert tab.value(held) == [579.0, 599.0]
        tab.value("page.time.seek(page.time.span[0] + 300)")
        tab.wait_for("page.time.recording === 'part'")
        assert tab.value("page.time.now - page.time.span[0]") == 300.0
        first, last = tab.value(held)
        assert first == 280.0
        assert 300.0 < last < 500.0
        tab.value("page.time.play(60)")
        tab.wait_for(f"page.time.now - page.time.span[0] > {last + 5.0}")
        assert tab.value(held)[1] > last
    finally:
        page.server.stop()
