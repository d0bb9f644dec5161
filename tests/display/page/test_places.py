"""Places on the page: polynomials that agree with the geodesy, shown of tracks and the cursor."""

from __future__ import annotations

import json
import re
from collections.abc import Callable

import numpy as np
import pytest

from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_feed import PageFeed
from sonar_tracking.display.page.page_frames import Frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.place_frames import datum_frame
from sonar_tracking.geodesy import surface_positions
from sonar_tracking.records.datum import Datum
from tests.display.page.chromium import Tab
from tests.display.page.page_scene import START, show, tracks

DATUM = Datum(54.18, 7.89)
ROWS = "document.querySelectorAll('#view-tracks tbody tr')"
DEGREES = r"(\d+)°(\d+\.\d+)'([NSEW])"


@pytest.mark.parametrize(
    "datum", [DATUM, Datum(0.0, 0.0), Datum(-45.0, 179.9), Datum(70.0, -20.0, 50.0)]
)
def test_the_polynomials_are_as_exact_as_what_is_shown(datum: Datum) -> None:
    said = json.loads(datum_frame(datum).data)
    positions = np.random.default_rng(1).uniform(-1.0, 1.0, (500, 2)) * 100_000.0
    u, v = (positions / said["reach"]).T
    products = np.stack([u**i * v**j for i, j in said["powers"]], axis=-1)
    latitude, longitude = (products @ np.array(said[name]) for name in ("latitude", "longitude"))
    error = np.hypot(*(surface_positions(latitude, longitude, datum) - positions).T)
    assert error.max() < 0.5  # m; the page shows steps of 1.9 m


def test_the_datum_is_told_at_once_and_again_when_the_data_begin_anew() -> None:
    sent: list[Frame] = []
    feed = PageFeed(PageConfiguration(datum="54.18,7.89"), sent.append)
    assert [frame.kind for frame in sent] == ["datum"]
    feed.begin_anew(0.0)
    assert [frame.kind for frame in sent] == ["datum", "datum", "begin"]
    assert [frame.kind for frame in feed.history.latest.values()] == ["datum"]
    other = PageFeed(PageConfiguration(), sent.append)
    other.take_datum(DATUM)
    assert sent[-1] == sent[0]


def position(text: str, datum: Datum) -> np.ndarray:
    """Return x and y of a place as the page shows it."""
    (d, m, ns), (e, n, ew) = re.findall(DEGREES, text)
    latitude = (int(d) + float(m) / 60.0) * (1 if ns == "N" else -1)
    longitude = (int(e) + float(n) / 60.0) * (1 if ew == "E" else -1)
    return surface_positions(np.array(latitude), np.array(longitude), datum)


@pytest.mark.slow
@pytest.mark.parametrize("datum", [DATUM, Datum(-33.5, -179.999)])
def test_a_page_with_a_datum_shows_places(
    start: Callable[..., PageServer], opened: Callable[..., Tab], datum: Datum
) -> None:
    server = start(datum=datum.to_text())
    show(server, 0, 10)
    tab = opened(server.address)
    tab.wait_for(f"page.history.newest >= {START + 9} && (page.draw(), {ROWS}.length)")
    told = tab.value(f"[...{ROWS}].map(r => [...r.cells].at(-1).textContent)")
    states = tracks(9).state
    assert len(told) == len(states)
    for text, state in zip(told, states, strict=True):
        assert position(text, datum) == pytest.approx(state[:2], abs=1.5)
    plan = "page.layout.views.get('plan').view"
    tab.value(f"({plan}.hover = {{x: 200, y: 150}}, {plan}.draw(page.time.now))")
    x, y = tab.value(f"(p => [p.x, p.y])({plan}.nearest(200, 150) ?? {plan}.toMap(200, 150))")
    readout = tab.value("document.querySelector('#view-plan .readout').textContent")
    assert position(readout, datum) == pytest.approx([x, y], abs=1.5)


@pytest.mark.slow
def test_without_a_datum_there_is_no_column_of_places(
    start: Callable[..., PageServer], opened: Callable[..., Tab]
) -> None:
    server = start()
    show(server, 0, 10)
    tab = opened(server.address)
    tab.wait_for(f"page.history.newest >= {START + 9} && (page.draw(), {ROWS}.length)")
    shown = "getComputedStyle(document.querySelector('#view-tracks td.place')).display"
    assert tab.value(shown) == "none"
    server.do(server.feed.take_datum, DATUM)
    tab.wait_for(f"page.datum && (page.draw(), {shown} !== 'none')")
