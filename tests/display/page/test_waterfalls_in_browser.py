"""The waterfalls in a real browser: power where it was received, when it was, and none lost."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from sonar_tracking.display.page.beam_power import beam_power_row
from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import Frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.track_frames import StationPlaces, own_ship_frame
from sonar_tracking.display.page.waterfall_frames import WaterfallFrames
from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.records.bearings import ArraySnapshots, Sensor
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS
from tests.display.page.chromium import PATIENCE, Chromium, Tab
from tests.display.page.page_scene import START

Start = Callable[..., PageServer]

POSITIONS = line_array(16, 0.5)
SOURCE = math.radians(30.0)
TONE = 310.0
VIEW = "page.layout.views.get('bearing_time').view"
SENSOR = Sensor(
    position=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.0, 1.0), velocity=(4.0, 0.0, 0.0)
)
"""Its axis points east, as the bow does: 30 degrees from broadside are 060 or 120."""


@pytest.fixture
def tab(start: Start, chromium: Chromium) -> Iterator[tuple[PageServer, Tab]]:
    """Yield a server and a page of it, which must not have complained at the end."""
    server = start()
    page = chromium.open(server.address)
    yield server, page
    complaints = page.complaints
    page.close()
    assert not complaints


def snapshots(second: float, duration: float = 0.5) -> ArraySnapshots:
    """Return a block of a source over noise."""
    generator = np.random.default_rng(round(1000 * second))
    vector = steering_vectors(POSITIONS, [SOURCE], wavenumber(1000.0, 1500.0))
    count = 5
    noise = generator.normal(size=(count, 32)).view(np.complex128)
    return ArraySnapshots(
        stamp=round((START + second) * NANOSECONDS),
        data=3.0 * vector.T + 0.3 * noise,
        element_positions=POSITIONS,
        sample_period=duration / count,
        center_frequency=1000.0,
        bandwidth=10.0,
        sound_speed=1500.0,
        sensor=SENSOR,
    )


def samples(second: int) -> ArraySamples:
    """Return a second of a tone from the source over noise."""
    times = second + np.arange(2000) / 2000.0
    lead = POSITIONS[:, 0] * math.sin(SOURCE) / 1500.0
    noise = np.random.default_rng(second).normal(size=(2000, 16))
    data = noise + 2.0 * np.cos(2.0 * np.pi * TONE * (times[:, None] + lead))
    return ArraySamples((START + second) * NANOSECONDS, data, POSITIONS, 2000.0, 1500.0)


def own_ship(second: float) -> OwnShipState:
    stamp = round((START + second) * NANOSECONDS)
    return OwnShipState(stamp, (4.0 * second, 0.0), 0.0, (4.0, 0.0), 0.0)


def frames(seconds: list[float], duration: float = 0.5) -> Iterator[Frame]:
    """Yield own ship and the rows of beam power."""
    log = OwnShipLog()
    waterfalls = WaterfallFrames(log, StationPlaces(PageConfiguration(), log), 600.0)
    for second in seconds:
        log.add(own_ship(second))
        yield own_ship_frame(own_ship(second))
        yield from waterfalls.snapshots("/array/snapshots", snapshots(second, duration))


def show(server: PageServer, page: Tab, made: Iterator[Frame]) -> None:
    last = 0.0
    for frame in made:
        server.do(server.feed.emit, frame)
        last = max(last, frame.time)
    page.wait_for(f"page.history.newest >= {last}")
    page.value("page.layout.select('bearing_time', true), page.layout.enlarge('bearing_time'), 0")


def brightest(page: Tab, t: float) -> list[float]:
    """Return where along the axis the 1 s panel is loudest at a time, by colour: shares."""
    script = f"""(() => {{
      const view = {VIEW}; page.draw();
      const {{ box, ring }} = view.panels[0];
      const y = Math.round(box.y + ring.yOf({START + t}, box, false));
      const line = view.canvas.pen.getImageData(box.x, y, box.width, 1).data;
      const light = [...Array(line.length / 4).keys()]
        .map(i => line[4 * i] + line[4 * i + 1] + line[4 * i + 2]);
      const most = Math.max(...light);
      return light.flatMap((v, i) => v > 0.97 * most ? [(i + 0.5) / light.length] : []);
    }})()"""
    shares: list[float] = page.value(script)
    return shares


def test_power_is_drawn_at_its_bearing_on_every_axis(tab: tuple[PageServer, Tab]) -> None:
    server, page = tab
    page.colours("dark")
    show(server, page, frames([0.5 * k for k in range(40)]))
    page.value(f"{VIEW}.range.value = '30', {VIEW}.axis.value = 'cone', 0")
    assert np.mean(brightest(page, 10.2)) == pytest.approx(0.5 + 30.0 / 180.0, abs=0.01)
    page.value(f"{VIEW}.axis.value = 'north', 0")
    sides = np.array(brightest(page, 10.2)) * 360.0
    assert np.mean(sides[sides < 90.0]) == pytest.approx(30.0, abs=3.0)
    assert np.mean(sides[sides > 90.0]) == pytest.approx(150.0, abs=3.0)
    page.value(f"{VIEW}.axis.value = 'relative', 0")
    sides = np.array(brightest(page, 10.2)) * 360.0 - 180.0
    np.testing.assert_allclose(np.abs(sides), 60.0, atol=6.0)
    assert sides.min() < 0.0 < sides.max()


def test_the_value_under_the_pointer_is_that_of_the_row(tab: tuple[PageServer, Tab]) -> None:
    server, page = tab
    show(server, page, frames([0.5 * k for k in range(40)]))
    rows = [beam_power_row(snapshots(second)) for second in (10.0, 10.5)]
    power = np.mean([row.power for row in rows if row is not None], axis=0)
    axis = rows[0].axis if rows[0] is not None else None
    assert axis is not None
    level = np.interp(0.5, np.sin(axis.angles), 10.0 * np.log10(power))
    page.value(f"{VIEW}.axis.value = 'cone', page.draw(), 0")
    seen = page.value(
        f"(() => {{ const v = {VIEW}; const row = v.rowAt({{scale: 1}}, {START + 10.4});"
        f" return [row.t0, row.t1, v.levelAt(row, 0.5 + 30 / 180)]; }})()"
    )
    assert seen[:2] == [START + 10.0, START + 11.0]
    assert seen[2] == pytest.approx(level, abs=0.05)


def test_a_gap_stays_empty_and_twenty_rows_a_second_are_all_there(
    tab: tuple[PageServer, Tab],
) -> None:
    server, page = tab
    seconds = [0.05 * k for k in range(400)] + [40.0 + 0.05 * k for k in range(400)]
    log = OwnShipLog()
    waterfalls = WaterfallFrames(log, StationPlaces(PageConfiguration(), log), 600.0)
    show(
        server,
        page,
        (
            frame
            for second in seconds
            for frame in waterfalls.snapshots("/array/snapshots", snapshots(20.0 * second, 1.0))
        ),
    )
    # A block of a second each: at twenty times the speed of the clock these are 20 rows a second.
    name = "waterfall /array/snapshots 1"
    assert page.value(f"page.history.stream('{name}').frames.length") == len(seconds)
    filled = page.value(
        f"(() => {{ const v = {VIEW}; v.scales.value = '20'; page.draw();"
        " const {ring} = v.panels[2]; const c = ring.canvas;"
        " const d = ring.pen.getImageData(c.width >> 1, 0, 1, c.height).data;"
        " return [...Array(c.height).keys()].filter(i => d[4*i+3] > 0).length * ring.span; })()"
    )
    # 800 s of data, and a gap of 400 s that nothing fills.
    assert filled == pytest.approx(800.0, abs=45.0)


def test_a_spectrum_is_sent_when_it_is_chosen(start: Start, chromium: Chromium) -> None:
    server = start()
    page = chromium.open(server.address)
    for second in range(4):
        server.do(_take_samples, server, second)
    page.wait_for("page.history.names('waterfall').length")
    page.value(
        "page.layout.select('lofar', true), page.layout.enlarge('lofar'),"
        f"page.selection.choose({{ sensor: 'array', beam: {SOURCE} }}), page.draw(), 0"
    )
    deadline = time.monotonic() + PATIENCE
    while not server.feed._waterfalls._lofar_selected:
        assert time.monotonic() < deadline
        page.value("page.draw(), 0")
    for second in range(4, 10):
        server.do(_take_samples, server, second)
    page.wait_for("page.history.names('lofar').length")
    page.wait_for("page.history.stream(page.history.names('lofar')[0]).frames.length >= 4")
    loudest: Any = page.value(
        "(() => { const f = page.history.stream(page.history.names('lofar')[0]).frames.at(-1);"
        " let best = 0; f.row.forEach((v, i) => { if (v > f.row[best]) best = i; });"
        " return [f.frequency.first + best * f.frequency.step, f.row[best]]; })()"
    )
    assert loudest[0] == pytest.approx(TONE)
    # Amplitude 2 has power 2, over the noise bandwidth of a Hann window of 2 s.
    assert loudest[1] == pytest.approx(10.0 * math.log10(2.0 / 0.75), abs=0.3)
    page.value("page.draw(), 0")
    assert page.value("document.querySelector('#view-lofar .empty').hidden")
    assert page.value("document.querySelector('#view-lofar .curve canvas').width") > 500
    # Data that begin anew know of no choice: the page says it again.
    server.do(server.feed.begin_anew, float(START))
    for second in range(4):
        server.do(_take_samples, server, second)
    page.wait_for("(page.draw(), page.history.names('waterfall').length)")
    deadline = time.monotonic() + PATIENCE
    while not server.feed._waterfalls._lofar_selected:
        assert time.monotonic() < deadline
        page.value("page.draw(), 0")
    complaints = page.complaints
    page.close()
    assert not complaints


def _take_samples(server: PageServer, second: int) -> None:
    for frame in server.feed._waterfalls.samples("/array/samples", samples(second)):
        server.feed.emit(frame)


def test_spectra_of_several_seconds_are_means_of_power(start: Start, chromium: Chromium) -> None:
    page = chromium.open(start().address)
    levels = page.value(
        """(async () => {
          const { IntegratedRows, levelsOf } = await import('/integrated_rows.js');
          const frames = [...Array(10).keys()].map(k => ({
            t0: 1000 + k, t1: 1001 + k, t: 1001 + k,
            row: Float32Array.from([k % 2 ? 20 : -300, 10]),
          }));
          const stream = { frames, first: 0, after: t => frames.filter(f => f.t <= t).length };
          const rows = new IntegratedRows().between(stream, 5, 1000, 1010, 'key');
          return rows.map(row => [row.t0, row.t1, ...levelsOf(row)]);
        })()"""
    )
    page.close()
    # Two, then three seconds of five have the power 100 in the first column.
    expected = [[1000, 1005, 16.0206, 10.0], [1005, 1010, 17.7815, 10.0]]
    np.testing.assert_allclose(levels, expected, atol=1e-3)


def test_beside_a_strong_line_the_noise_stays_at_its_level(
    start: Start, chromium: Chromium
) -> None:
    page = chromium.open(start().address)
    levels = page.value(
        """(async () => {
          const { overBackground } = await import('/integrated_rows.js');
          const row = new Float32Array(400).fill(5);
          row[200] = 55;
          row[215] = 15;
          return [...overBackground(row, 40, new Float32Array(400))];
        })()"""
    )
    page.close()
    np.testing.assert_allclose(np.delete(levels, [200, 215]), 0.0, atol=0.2)
    assert levels[200] == pytest.approx(50.0, abs=0.3)
    assert levels[215] == pytest.approx(10.0, abs=0.3)
