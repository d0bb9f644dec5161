"""Axes in a real browser: bearings at their ends, a record that wraps, harmonics of a line."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import pytest

from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_commands import command_frame
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import Frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.track_frames import StationPlaces, bearings_frame
from sonar_tracking.records.commands import CommandKind, OperatorCommand, OwnShipLine
from sonar_tracking.records.time import NANOSECONDS
from tests.display.page.chromium import Tab
from tests.display.page.page_scene import START
from tests.display.page.waterfall_scene import (
    LOFAR,
    SOURCE,
    TONE,
    VIEW,
    brightest,
    frames,
    own_ship,
    show,
    show_spectrum,
    tracked,
)

Start = Callable[..., PageServer]
Open = Callable[..., Tab]

HALVES = [0.5 * k for k in range(80)]


def past_north(second: float) -> float:
    """Return a source that goes from 350 over north to 010; its image from 190 to 170."""
    return math.radians(-10.0 + 0.5 * second)


def past_the_bow(second: float) -> float:
    """Return a source that comes to the axis of the array, which is the bow, and goes again."""
    return math.radians(90.0 - abs(20.0 - second))


def with_track(source: Callable[[float], float]) -> Iterator[Frame]:
    """Yield what is heard of a source, and its track."""
    log = OwnShipLog()
    places = StationPlaces(PageConfiguration(), log)
    for second in HALVES:
        log.add(own_ship(second))
        heard = tracked(second, source)
        view = places.view(heard.sensor, heard.stamp)
        yield bearings_frame("/passive/bearing_tracks", heard, view)
    yield from frames(HALVES, source=source)


def shown(start: Start, opened: Open, made: Iterator[Frame]) -> tuple[PageServer, Tab]:
    """Return a server, and a dark page that shows frames in a large bearing-time record."""
    server = start()
    page = opened(server.address)
    page.colours("dark")
    show(server, page, made)
    return server, page


def seen(page: Tab, axis: str, t: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return the bearings at which an axis is brightest, degrees from its left end."""
    page.value(f"{VIEW}.axis.value = {axis!r}, {VIEW}.over.value = 'none', 0")
    return np.array(brightest(page, t)) * 360.0


def apart(first: Any, second: float) -> Any:
    """Return the distance of bearings, degrees."""
    return np.abs((np.asarray(first) - second + 180.0) % 360.0 - 180.0)


@pytest.mark.slow
def test_a_source_goes_through_north_without_a_break(start: Start, opened: Open) -> None:
    _, page = shown(start, opened, with_track(past_north))
    page.value(f"{VIEW}.range.value = '30', 0")
    for t in (5.2, 17.2, 20.2, 23.2, 35.2):
        bearing = math.degrees(past_north(t))
        for axis, left in (("north", 0.0), ("south", 180.0)):
            bearings = seen(page, axis, t) + left
            near = np.minimum(apart(bearings, bearing), apart(bearings, 180.0 - bearing))
            assert near.max() < 7.0, (axis, t)
            assert apart(bearings, bearing).min() < 2.0, (axis, t)
    # With north in the middle the source never comes near the ends.
    assert [each[1] for each in page.value(f"{VIEW}.bearings.ticks(900, {VIEW}.pose)")][::3] == [
        *("180", "270", "000", "090", "180")
    ]


@pytest.mark.slow
def test_the_line_of_a_track_does_not_cross_the_picture_at_north(
    start: Start, opened: Open
) -> None:
    _, page = shown(start, opened, with_track(past_north))
    strokes = f"""(() => {{
      const view = {VIEW}; page.draw();
      const {{ box }} = view.panels[0];
      const moves = []; let last = null;
      const pen = {{ setLineDash() {{}}, beginPath() {{}}, stroke() {{}},
        moveTo(x, y) {{ last = [x, y]; }},
        lineTo(x, y) {{ moves.push([Math.abs(x - last[0]) / box.width, y]); last = [x, y]; }} }};
      const [line] = view.tracks.linesOf(view.panels[0], page.time.now);
      for (const side of ['share', 'other']) view.tracks.drawLine(pen, view.panels[0], line, side);
      return [Math.max(...moves.map(([far]) => far)), moves.length, line.points[0].share];
    }})()"""
    # 350, with the bow at 090.
    for axis, place in (("north", 350.0), ("south", 170.0), ("relative", 80.0)):
        page.value(f"{VIEW}.axis.value = {axis!r}, 0")
        farthest, count, share = page.value(strokes)
        assert share * 360.0 == pytest.approx(place, abs=0.01), axis
        assert farthest < 0.02, axis
        assert count > 60, axis


@pytest.mark.slow
def test_a_source_on_the_axis_of_the_array_is_at_one_end_only(start: Start, opened: Open) -> None:
    _, page = shown(start, opened, with_track(past_the_bow))
    page.value(f"{VIEW}.range.value = '30', 0")
    for t in (5.2, 12.2, 20.2, 27.2):
        cone = seen(page, "cone", t) / 2.0 - 90.0
        assert cone.min() > 55.0 and cone.max() <= 90.0
        # Of beams near the axis the cone is broad; in relative bearings it lies about the bow.
        off = seen(page, "relative", t) - 180.0
        assert np.abs(off).max() < 35.0
        assert np.mean(off) == pytest.approx(0.0, abs=1.5)


def test_a_record_that_wraps_leaves_each_row_where_it_is(start: Start, opened: Open) -> None:
    server, page = shown(start, opened, frames(HALVES))
    page.value(f"{VIEW}.wrap.isOn || {VIEW}.wrap.click(), {VIEW}.axis.value = 'cone', 0")
    page.value(f"{VIEW}.range.value = '30', {VIEW}.over.value = 'none', page.draw(), 0")
    height = f"(({{box, ring}}) => ring.yOf({START + 10.2}, box, true))({VIEW}.panels[0])"
    before = page.value(height)
    assert np.mean(brightest(page, 10.2)) == pytest.approx(0.5 + 30.0 / 180.0, abs=0.01)
    span = page.value(f"{VIEW}.panels[0].ring.height * {VIEW}.panels[0].ring.span")
    later = [40.0 + 2.0 * k for k in range(round((span - 36.0) / 2.0))]
    show(server, page, frames(later, duration=2.0, source=lambda second: -SOURCE))
    page.value("page.draw(), 0")
    # The picture is nearly once round: the row stands, and what is newer is on the other side.
    assert page.value(height) == before
    newest = 30.0 * (later[-1] // 30.0)
    for t in (38.2, 72.5, newest - 17.5):  # beside the texts of times
        side = 1.0 if t < 40.0 else -1.0
        found = np.mean(brightest(page, t))
        assert found == pytest.approx(0.5 + side * 30.0 / 180.0, abs=0.01), t
    y = page.value(
        f"(({{box, ring}}) => [0, 0.3, 0.6, 0.95].map(part => {{"
        " const t = (ring.last - part * ring.height) * ring.span;"
        " return Math.abs(ring.timeAt(ring.yOf(t, box, true), box, true) - t); }))"
        f"({VIEW}.panels[0])"
    )
    assert max(y) < 1e-6 * START


@pytest.fixture
def spectrum(start: Start, opened: Open) -> tuple[PageServer, Tab]:
    """Return a server, and a page that shows the spectrum of the source, alone and large."""
    server = start()
    page = opened(server.address)
    show_spectrum(server, page)
    return server, page


def place_of(page: Tab, frequency: float) -> tuple[float, float]:
    """Return where a frequency is in the window, among the rows."""
    x, y = page.value(
        f"(v => {{ const b = v.canvas.element.getBoundingClientRect();"
        f" return [b.left + v.xOf({frequency}), b.top + v.box.y + 60]; }})({LOFAR})"
    )
    return x, y


def orange_columns(page: Tab) -> list[float]:
    """Return the frequencies at which the rows have a vertical line of the harmonic cursor."""
    found: list[float] = page.value(
        f"""(() => {{
          page.draw();
          const v = {LOFAR}, {{ box }} = v;
          const d = v.canvas.pen.getImageData(0, box.y, box.width, box.height).data;
          const w = Math.round(box.width), h = Math.round(box.height);
          const out = [];
          for (let x = 0; x < w; x++) {{
            let n = 0;
            for (let i = 4 * x; i < d.length; i += 4 * w) {{
              n += d[i] > d[i + 1] + 15 && d[i] > d[i + 2] + 50; // no colour of the ramp is so red
            }}
            if (n > 0.3 * h) out.push(v.frequencyAt(x + 0.5));
          }}
          return out;
        }})()"""
    )
    return found


def test_the_harmonic_cursor_shows_multiples_and_is_held(spectrum: tuple[PageServer, Tab]) -> None:
    _, page = spectrum
    page.colours("dark")
    page.value(f"{LOFAR}.canvas.element.focus(), {LOFAR}.order.value = '2', 0")
    page.key("h")
    assert page.value(f"{LOFAR}.harmonics.isOn")
    x, y = place_of(page, 2 * TONE)
    page.click(x, y)
    width = page.value(f"{LOFAR}.frequencyAt(1) - {LOFAR}.frequencyAt(0)")
    assert page.value(f"{LOFAR}.held") == pytest.approx(2 * TONE, abs=width)
    page.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + 111, y=y)
    found = np.array(orange_columns(page))
    assert sorted({round(f / TONE) for f in found}) == [1, 2, 3]
    assert np.abs(found / TONE - np.round(found / TONE)).max() < 3 * width / TONE
    page.click(x + 50, y)
    assert not page.value(f"Number.isFinite({LOFAR}.held)")
    page.key("h")
    assert orange_columns(page) == []


def test_a_line_that_is_marked_as_own_ships_is_shown_and_taken_back(
    spectrum: tuple[PageServer, Tab], asked: list[Mapping[str, Any]]
) -> None:
    server, page = spectrum
    x, y = place_of(page, TONE)

    def choose(words: str) -> Mapping[str, Any]:
        where = {"x": x, "y": y, "button": "right", "clickCount": 1}
        page.call("Input.dispatchMouseEvent", type="mousePressed", **where)
        page.call("Input.dispatchMouseEvent", type="mouseReleased", **where)
        page.wait_for("document.querySelector('.menu[role=menu]')")
        page.value(
            "[...document.querySelectorAll('.menu[role=menu] button')]"
            f".find(b => b.textContent.endsWith({words!r})).click()"
        )
        page.wait_for("document.querySelector('#toast').textContent === 'sent.'")
        page.value("document.querySelector('#toast').textContent = '', 0")
        return asked[-1]

    def takes_effect(kind: CommandKind, second: float, said: Mapping[str, Any]) -> None:
        line = OwnShipLine(said["frequency"], sensor_id=said["sensor_id"])
        stamp = round((START + second) * NANOSECONDS)
        command = OperatorCommand(kind, said["topic"], stamp=stamp, line=line)
        server.do(server.feed.emit, command_frame(command))

    said = choose("is a line of own ship")
    assert said["command"] == "mark_own_ship_line"
    assert said["frequency"] == pytest.approx(TONE, abs=1.0)
    assert said["sensor_id"] == "array"
    takes_effect(CommandKind.MARK_OWN_SHIP_LINE, 6.0, said)
    page.wait_for(f"(page.draw(), {LOFAR}.marked.length)")
    assert page.value(f"{LOFAR}.marked[0].bandwidth") == 1.0
    said = choose("is no line of own ship")
    assert said["command"] == "unmark_own_ship_line"
    takes_effect(CommandKind.UNMARK_OWN_SHIP_LINE, 8.0, said)
    page.wait_for(f"(page.draw(), !{LOFAR}.marked.length)")
    # It was marked for two seconds, whenever these are looked at.
    page.value(f"page.time.seek({START + 7.0}), page.draw(), 0")
    assert page.value(f"{LOFAR}.marked.length") == 1
