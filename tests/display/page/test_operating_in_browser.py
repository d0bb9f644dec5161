"""Operating the live page in a real browser: the past, cursors, keys, names, commands."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import pytest

from sonar_tracking.display.page.page_server import PageServer
from tests.display.page.chromium import Tab
from tests.display.page.page_looks import ROWS, cells, shows
from tests.display.page.page_scene import START, TOPIC, own_ship, show, tracks

Start = Callable[..., PageServer]


def five_seconds(start: Start, opened: Callable[..., Tab]) -> tuple[PageServer, Tab]:
    """Return a server of five seconds of data, and a page that shows them."""
    server = start()
    show(server, 0, 5)
    tab = opened(server.address)
    shows(tab, 4)
    return server, tab


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
    _, tab = five_seconds(start, opened)
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


def test_keys_do_what_a_mouse_does(start: Start, opened: Callable[..., Tab]) -> None:
    _, tab = five_seconds(start, opened)
    plan = "page.layout.views.get('plan').view"
    tab.value(f"{plan}.canvas.element.focus()")
    middle = tab.value(f"[{plan}.canvas.width / 2, {plan}.canvas.height / 2]")
    tab.value(f"{plan}.zoom(6000 / {plan}.span), page.draw(), 0")
    place = tab.value(f"(p => [p.x, p.y])({plan}.toScreen({plan}.rows[0].x, {plan}.rows[0].y))")
    steps = [round((there - here) / 8) for here, there in zip(middle, place, strict=True)]
    for keys, count in zip(
        (("ArrowLeft", "ArrowRight"), ("ArrowUp", "ArrowDown")), steps, strict=True
    ):
        for _ in range(abs(count)):
            tab.key(keys[count > 0], control=True)
    tab.key("Enter")
    assert tab.value("page.selection.track") == {"topic": TOPIC, "id": 1}
    tab.key("Enter", shift=True)
    assert tab.value("Math.abs(page.time.marks.A.azimuth)") < 0.05
    tab.key("m")
    assert tab.text(".menu[role=menu] strong") == "Track 1"
    tab.key("Escape")
    assert not tab.value("Boolean(document.querySelector('.menu[role=menu]'))")
    assert tab.value("document.querySelectorAll('.menu.more').length") == 2


def test_a_double_click_opens_the_menu(start: Start, opened: Callable[..., Tab]) -> None:
    _, tab = five_seconds(start, opened)
    box = tab.value(
        "(b => [b.left, b.top])(document.querySelector('#view-plan').getBoundingClientRect())"
    )
    tab.click(box[0] + 60, box[1] + 60, count=2)
    plan = "page.layout.views.get('plan').view"
    azimuth = tab.value(f"{plan}.placeOf({{offsetX: 60, offsetY: 60}}).azimuth")
    words = tab.text(".menu[role=menu]")
    assert words.startswith(f"Bearing {(90.0 - math.degrees(azimuth)) % 360.0:05.1f}°")
    assert "Cursor A here" in words


def test_a_target_has_one_name_in_every_view(start: Start, opened: Callable[..., Tab]) -> None:
    """A bearing track of a track of the picture is called as that is; another has a letter."""
    _, tab = five_seconds(start, opened)
    tab.value(f"page.selection.rename({TOPIC!r}, 1, 'ferry')")
    names = tab.value(
        """(async () => {
          const { Identities } = await import('/identity.js');
          const who = new Identities(page.history, page.selection, page.time.now);
          const topic = '/passive/bearing_tracks';
          return [7, 2].map(id => who.nameOf({ topic, id, sensor: 'array' }))
            .concat(who.nameOf({ topic: '/active/tracks', id: 9 }));
        })()"""
    )
    assert names == ["ferry", "b2", "e9"]


def test_names_are_those_of_one_run(start: Start, opened: Callable[..., Tab]) -> None:
    server, tab = five_seconds(start, opened)
    tab.value(f"page.selection.rename({TOPIC!r}, 1, 'ferry')")
    for run, name in ((server.run, "ferry"), ("another", "1")):
        tab.value(f"page.selection.run = null, page.selection.enter({run!r}), 0")
        assert tab.value(f"page.selection.nameOf({TOPIC!r}, 1)") == name
