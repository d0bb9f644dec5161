"""The live page in a real browser: it shows what the records hold, and survives what happens."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import text_frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.track_frames import (
    StationPlaces,
    bearings_frame,
    tracks_frame,
)
from tests.display.page.chromium import Tab
from tests.display.page.page_scene import (
    START,
    TOPIC,
    bearings,
    frames,
    own_ship,
    show,
    tracks,
)

Start = Callable[..., PageServer]

ROWS = "document.querySelectorAll('#view-tracks tbody tr')"
VIEWS = ("plan", "bearing_time", "lofar", "range_bearing", "stacked_dots", "health", "tracks")


def cells(tab: Tab) -> list[list[str]]:
    """Return the texts of the track table."""
    table: list[list[str]] = tab.value(
        f"[...{ROWS}].map(r => [...r.cells].map(c => c.textContent))"
    )
    return table


def shows(tab: Tab, second: float) -> None:
    """Wait until a page knows the scene up to a second."""
    # A tab behind another one is not drawn by itself.
    known = f"page.history.newest >= {START + second} && !page.incoming"
    tab.wait_for(f"{known} && (page.draw(), {ROWS}.length)")


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
    assert tab.value("document.documentElement.dataset.theme") == scheme
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


def test_the_past_can_be_looked_at(start: Start, opened: Callable[..., Tab]) -> None:
    server = start()
    show(server, 0, 60)
    tab = opened(server.address)
    shows(tab, 59)
    before = cells(tab)[0][5]
    tab.value("document.querySelector('#view-plan canvas').focus()")
    tab.key(" ")
    tab.key("ArrowLeft", shift=True)
    tab.wait_for("document.querySelector('#clock').textContent === '00:00:29'")
    assert tab.text("#state") == "paused"
    show(server, 60, 70)
    tab.wait_for(f"page.history.newest >= {START + 69}")
    tab.value("page.draw()")
    ship, picture = own_ship(29), tracks(29)
    then = math.hypot(*(picture.state[0, :2] - ship.position))
    assert cells(tab)[0][5].startswith(f"{then:.0f} m")
    assert cells(tab)[0][5] != before
    tab.key("End")
    tab.wait_for("document.querySelector('#clock').textContent === '00:01:09'")


def test_cursors_tell_differences(start: Start, opened: Callable[..., Tab]) -> None:
    server = start()
    show(server, 0, 20)
    tab = opened(server.address)
    shows(tab, 19)
    tab.value(f"page.time.markNext({{t: {START + 2}, azimuth: 0, frequency: 120}})")
    tab.value(f"page.time.markNext({{t: {START + 17}, azimuth: {math.pi / 6}, frequency: 121.5}})")
    tab.value("page.draw()")
    assert tab.text(".marks") == "B−A 15 s  −30.0°  1.50 Hz"


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


def test_nothing_known_is_shown_as_unknown(start: Start, opened: Callable[..., Tab]) -> None:
    server = start()
    picture, heard = tracks(5), bearings(5)
    unknown = {
        name: np.full_like(getattr(picture, name), np.nan)
        for name in ("state", "covariance", "existence_probability", "initiated", "updated")
    }
    nothing = {
        name: np.full_like(getattr(heard, name), np.nan) for name in ("arrival_angle", "covariance")
    }
    log = OwnShipLog()
    view = StationPlaces(PageConfiguration(), log).view(heard.sensor, heard.stamp)
    server.do(server.feed.emit, tracks_frame(TOPIC, replace(picture, **unknown)))
    topic = "/passive/bearing_tracks"
    server.do(server.feed.emit, bearings_frame(topic, replace(heard, **nothing), view))
    tab = opened(server.address)
    shows(tab, 5)
    for view_name in VIEWS:
        tab.value(f"page.layout.select({view_name!r}, true)")
        tab.value("page.draw()")
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


def test_commands_need_the_token(
    start: Start, opened: Callable[..., Tab], asked: list[Mapping[str, Any]]
) -> None:
    server = start()
    show(server, 0, 5)
    stranger = opened(server.address.partition("#")[0])
    shows(stranger, 4)
    assert not stranger.value("page.commands.possible")
    stranger.value("page.socket.command({command: 'end_track', topic: 'tracks', id: 1})")
    stranger.wait_for("document.querySelector('#toast').textContent.includes('token')")
    assert asked == []
    operator = opened(server.address)
    shows(operator, 4)
    assert operator.value("location.hash") == ""
    operator.value(f"{ROWS}[0].dispatchEvent(new MouseEvent('contextmenu', {{bubbles: true}}))")
    operator.value(
        "[...document.querySelectorAll('.menu button')]"
        ".find(b => b.textContent === 'End track').click()"
    )
    operator.wait_for("document.querySelector('#toast').textContent === 'sent.'")
    assert asked == [{"kind": "command", "command": "end_track", "topic": "tracks", "id": 1}]


def test_a_bearing_is_designated_as_the_array_hears_it(
    start: Start, opened: Callable[..., Tab], asked: list[Mapping[str, Any]]
) -> None:
    server = start()
    show(server, 0, 5)
    tab = opened(server.address)
    shows(tab, 4)
    # The array lies along own ship, which goes north: 30 degrees right of the bow is 60 from
    # broadside.
    tab.value(f"page.layout.views.get('plan').view.menuAt(400, 300, {math.radians(60)})")
    tab.value(
        "[...document.querySelectorAll('.menu button')]"
        ".find(b => b.textContent.startsWith('Start a bearing track at 030')).click()"
    )
    tab.wait_for("document.querySelector('#toast').textContent === 'sent.'")
    assert asked[0]["arrival_angle"] == pytest.approx(math.radians(60))
    assert asked[0]["topic"] == "passive/bearing_tracks"


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
