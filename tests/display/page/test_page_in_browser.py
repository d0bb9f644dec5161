"""The live page in a real browser: it shows what the records hold, and survives what happens."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sonar_tracking.display.page.page_frames import binary_frame, text_frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.track_frames import tracks_frame
from tests.display.page.chromium import Tab
from tests.display.page.page_looks import ROWS, VIEWS, cells, shows
from tests.display.page.page_scene import (
    START,
    TOPIC,
    frames,
    own_ship,
    show,
    tracks,
)

Start = Callable[..., PageServer]


def test_the_page_shows_what_the_records_hold(start: Start, opened: Callable[..., Tab]) -> None:
    server = start()
    show(server, 0, 40)
    tab = opened(server.address)
    shows(tab, 39)
    tab.wait_for("document.querySelector('#state').textContent === 'live'")
    ship, picture = own_ship(39), tracks(39)
    seen = [row[1:] for row in cells(tab)]
    assert [row[0] for row in seen] == ["1", "2", "3"]
    for row, (x, y, vx, vy) in zip(seen, picture.state, strict=True):
        dx, dy = x - ship.position[0], y - ship.position[1]
        distance = math.hypot(dx, dy)
        assert row[2] == "confirmed"
        assert row[3].split(" ")[0] == f"{90 - math.degrees(math.atan2(dy, dx)):05.1f}"
        assert row[4].split(" ")[0] == f"{distance:.0f}"
        assert row[5].startswith("270 ±")
        assert row[6].split(" ")[0] == f"{math.hypot(vx, vy) * 1.943844:.1f}"
        assert row[7] == "0.99"
        assert row[9] == "39 s"
    across = math.degrees(30.0 / 1811.0)  # the deviation north at a target that is nearly east
    assert seen[0][3].endswith(f"±{across:.1f}")
    assert seen[0][1] == "bearings"
    assert seen[0][11] == "array 7"
    assert tab.text("#clock") == "00:00:39"
    assert tab.text("#ship").startswith("own ship 000°")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_view_can_be_shown_large_and_fits(
    start: Start, opened: Callable[..., Tab], scheme: str
) -> None:
    server = start()
    show(server, 0, 30)
    tab = opened(server.address)
    tab.colours(scheme)
    shows(tab, 29)
    for width, height in ((1280, 720), (390, 844)):
        tab.resize(width, height)
        for view in VIEWS:
            tab.value(f"page.layout.select({view!r}, true)")
            tab.value(f"page.layout.enlarge({view!r})")
            tab.value("page.draw()")
            tab.wait_for(
                "document.documentElement.scrollWidth <= innerWidth"
                " && document.documentElement.scrollHeight <= innerHeight"
            )
            box = tab.value(
                f"(b => [b.left, b.top, b.right, b.bottom])"
                f"(document.querySelector('#view-{view}').getBoundingClientRect())"
            )
            assert box[2] - box[0] > 0.9 * width
            assert box[3] - box[1] > 0.5 * height
            assert box[2] <= width
            assert box[3] <= height
        tab.value("page.layout.enlarge(null)")


def test_two_browsers_see_the_same(start: Start, opened: Callable[..., Tab]) -> None:
    server = start()
    show(server, 0, 10)
    first, second = opened(server.address), opened(server.address, width=390, height=844)
    show(server, 10, 20)
    for tab in (first, second):
        tab.value("page.layout.select('tracks', true)")
        shows(tab, 19)
        tab.value("page.draw()")
    assert cells(first) == cells(second)


@pytest.mark.parametrize("opened_at", [0, 10, 30], ids=["before", "during", "after"])
def test_whenever_it_is_opened_a_page_shows_the_whole_run(
    start: Start, opened: Callable[..., Tab], opened_at: int
) -> None:
    server = start()
    show(server, 0, opened_at)
    tab = opened(server.address)
    if not opened_at:
        tab.wait_for("document.querySelector('#state').textContent === 'waiting for data'")
        assert "No tracks yet." in tab.text("#view-tracks")
    show(server, opened_at, 30)
    shows(tab, 29)
    assert len(cells(tab)) == 3
    assert tab.value("page.history.oldest") == START
    assert tab.value("page.history.stream('own_ship').frames.length") == 30
    # The run is at its end: what is shown stays, and the page says that nothing comes any more.
    server.do(server.feed.health.heard, TOPIC, START + 29.0)
    server.do(setattr, server.feed.health, "_wall", lambda: time.monotonic() + 60.0)
    tab.wait_for("document.querySelector('#state').textContent === 'stale'")
    assert "or the run has ended" in tab.text("#alarm")
    assert len(cells(tab)) == 3


def test_the_page_comes_back_with_its_server(start: Start, opened: Callable[..., Tab]) -> None:
    server = start()
    show(server, 0, 30)
    tab = opened(server.address)
    shows(tab, 29)
    server.stop()
    tab.wait_for("document.querySelector('#state').textContent === 'no connection'")
    assert "old" in tab.text("#alarm")
    again = start(server.port)
    assert again.port == server.port
    show(again, 30, 40)
    shows(tab, 39)
    tab.wait_for("document.querySelector('#state').textContent === 'live'")
    assert tab.value("page.history.oldest") == START
    assert tab.text("#alarm") == ""


def test_a_clock_that_goes_back_begins_anew(start: Start, opened: Callable[..., Tab]) -> None:
    server = start()
    show(server, 1000, 1010)
    tab = opened(server.address)
    shows(tab, 1009)

    def begin() -> None:
        for frame in frames(0, 5):
            if server.feed.history.begins_anew(frame):
                server.feed.begin_anew(frame.time)
            server.feed.emit(frame)

    server.do(begin)
    tab.wait_for(f"page.history.newest === {START + 4}")
    assert tab.value("page.history.oldest") == START


def test_500_tracks_are_shown(start: Start, opened: Callable[..., Tab]) -> None:
    server = start()
    show(server, 0, 2, count=500)
    tab = opened(server.address)
    shows(tab, 1)
    tab.wait_for(f"{ROWS}.length === 500")
    assert cells(tab)[499][1] == "500"


def unknown(value: Any) -> Any:
    """Return a value of JSON in which every real number is unknown; identifiers stay."""
    if isinstance(value, float):
        return None
    if isinstance(value, list):
        return [unknown(entry) for entry in value]
    if isinstance(value, dict):
        return {name: entry if name == "t" else unknown(entry) for name, entry in value.items()}
    return value


def test_nothing_known_is_shown_as_unknown(start: Start, opened: Callable[..., Tab]) -> None:
    """Tracks, bearings, lines, contacts, gates, own ship and beams: NaN in all they could tell."""
    server = start()
    for frame in frames(0, 31):
        data = json.dumps(unknown(json.loads(frame.data)))
        server.do(server.feed.emit, frame._replace(data=data))
    angles = {"first": -1.0, "step": 0.25, "count": 9, "of": "sine"}
    beams = {"content": "beams", "sensor": "", "scale": 1, "angles": angles}
    beams |= {"topic": "/array/samples", "axis_azimuth": np.nan, "heading": np.nan}
    for second in range(30):
        row = {**beams, "t0": START + second, "t1": START + second + 1.0}
        beam = binary_frame("waterfall", START + second + 1.0, "1", row, np.full(9, np.nan))
        server.do(server.feed.emit, beam)
    tab = opened(server.address)
    shows(tab, 30)
    tab.value(f"page.selection.choose({{topic: {TOPIC!r}, id: 1}})")
    for view in VIEWS:
        tab.value(f"page.layout.select({view!r}, true), page.draw(), 0")
        canvas = f"document.querySelector('#view-{view} canvas')"
        if tab.value(f"Boolean({canvas}) && ({canvas}.focus(), true)"):
            for _ in range(3):
                tab.key("ArrowDown", control=True)
            tab.key("Enter", shift=True)
            tab.key("m")
            tab.key("Escape")
        tab.value("page.draw(), 0")
    assert cells(tab)[0][4:11] == ["–"] * 7


def test_without_own_ship_tracks_are_shown_all_the_same(
    start: Start, opened: Callable[..., Tab]
) -> None:
    server = start()
    server.do(server.feed.emit, tracks_frame(TOPIC, tracks(5)))
    tab = opened(server.address)
    shows(tab, 5)
    row = cells(tab)[0]
    assert row[4:6] == ["–", "–"]
    assert row[6].startswith("270")


def test_stale_data_and_a_node_that_is_gone_are_told(
    start: Start, opened: Callable[..., Tab]
) -> None:
    server = start()
    show(server, 0, 5)
    tab = opened(server.address)
    shows(tab, 4)
    node = {"alive": False, "silent": 9.0, "level": "ok", "message": "", "received": 4}
    gone = {**node, "name": "tma_tracker", "backlog": 0, "rejected": 0, "lag": 0.0}
    known: dict[str, Any] = {"missed": 0, "topics": [], "nodes": [gone]}
    tab.value("page.on_health = () => {}")  # those of this server itself
    for stale, words in ((False, "tma_tracker"), (True, "clock stands")):
        frame = text_frame("health", START, quiet=9.0, stale=stale, **known)
        tab.value(f"page.health = {frame.data!s}; page.draw()")
        assert words in tab.text("#alarm")
    tab.value("page.layout.select('health', true); page.draw()")
    assert "gone for 9 s" in tab.text("#view-health")


def test_a_page_left_open_overnight_forgets(start: Start, opened: Callable[..., Tab]) -> None:
    tab = opened(start().address)
    kept = tab.value(
        """(async () => {
          const { History } = await import('./history.js');
          const history = new History(2700);
          for (let t = 0; t < 12 * 3600; t++) {
            history.add({ kind: 'own_ship', t, x: 0, y: 0, yaw: 0, vx: 0, vy: 0 });
            history.add({ kind: 'tracks', topic: '/tracks', t, id: [1], x: [null] });
          }
          return [history.size, history.newest - history.oldest];
        })()"""
    )
    assert kept[0] < 2 * 2702
    assert kept[1] == 2700
