"""The waterfalls in a real browser: power where it was received, when it was, and none lost."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.track_frames import StationPlaces
from sonar_tracking.display.page.waterfall_frames import WaterfallFrames
from sonar_tracking.display.waterfalls.beam_power import beam_power_row
from tests.display.page.chromium import Chromium, Tab
from tests.display.page.page_scene import START
from tests.display.page.waterfall_scene import (
    TONE,
    VIEW,
    brightest,
    frames,
    show,
    show_spectrum,
    snapshots,
    take_samples,
    wait_selected,
)

Start = Callable[..., PageServer]


@pytest.fixture
def tab(start: Start, chromium: Chromium) -> Iterator[tuple[PageServer, Tab]]:
    """Yield a server and a page of it, which must not have complained at the end."""
    server = start()
    page = chromium.open(server.address)
    yield server, page
    complaints = page.complaints
    chromium.leave(page)
    assert not complaints


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
    show_spectrum(server, page)
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
        server.do(take_samples, server, second)
    page.wait_for("(page.draw(), page.history.names('waterfall').length)")
    wait_selected(server, page)
    complaints = page.complaints
    chromium.leave(page)
    assert not complaints


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
    chromium.leave(page)
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
    chromium.leave(page)
    np.testing.assert_allclose(np.delete(levels, [200, 215]), 0.0, atol=0.2)
    assert levels[200] == pytest.approx(50.0, abs=0.3)
    assert levels[215] == pytest.approx(10.0, abs=0.3)
