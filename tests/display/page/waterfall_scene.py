"""What a line array hears, as rows for the page, and where a page shows it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator

import numpy as np

from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import Frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.track_frames import StationPlaces, own_ship_frame
from sonar_tracking.display.page.waterfall_frames import WaterfallFrames
from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.records.bearings import AngleKind, ArraySnapshots, BearingTracks, Sensor
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS
from tests.display.page.chromium import PATIENCE, Tab
from tests.display.page.page_scene import START

POSITIONS = line_array(16, 0.5)
SOURCE = math.radians(30.0)
TONE = 310.0
LOFAR = "page.layout.views.get('lofar').view"
VIEW = "page.layout.views.get('bearing_time').view"
SENSOR = Sensor(
    position=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.0, 1.0), velocity=(4.0, 0.0, 0.0)
)
"""Its axis points east, as the bow does: 30 degrees from broadside are 060 or 120."""


def still(second: float) -> float:
    """Return the direction of a source at rest, radians from broadside."""
    return SOURCE


def snapshots(
    second: float, duration: float = 0.5, source: Callable[[float], float] = still
) -> ArraySnapshots:
    """Return a block of a source over noise."""
    generator = np.random.default_rng(round(1000 * second))
    vector = steering_vectors(POSITIONS, [source(second)], wavenumber(1000.0, 1500.0))
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
    """Return own ship going east with 4 m/s."""
    stamp = round((START + second) * NANOSECONDS)
    return OwnShipState(stamp, (4.0 * second, 0.0), 0.0, (4.0, 0.0), 0.0)


def tracked(second: float, source: Callable[[float], float]) -> BearingTracks:
    """Return the bearing track of the source."""
    one, none = np.ones(1), np.full(1, np.nan)
    return BearingTracks(
        stamp=round((START + second) * NANOSECONDS),
        id=np.array([1], np.uint64),
        status=np.ones(1, np.uint8),
        arrival_angle=source(second) * one,
        arrival_angle_rate=0.0 * one,
        covariance=np.diag([1e-4, 1e-6])[None],
        measurement=none,
        measurement_variance=none,
        innovation=none,
        signal_to_noise_ratio=one,
        existence_probability=one,
        ambiguous=np.ones(1, bool),
        angle_kind=AngleKind.CONE,
        sensor=SENSOR,
    )


def frames(
    seconds: Iterable[float], duration: float = 0.5, source: Callable[[float], float] = still
) -> Iterator[Frame]:
    """Yield own ship and the rows of beam power."""
    log = OwnShipLog()
    waterfalls = WaterfallFrames(log, StationPlaces(PageConfiguration(), log), 600.0)
    for second in seconds:
        log.add(own_ship(second))
        yield own_ship_frame(own_ship(second))
        yield from waterfalls.snapshots("/array/snapshots", snapshots(second, duration, source))


def show(server: PageServer, page: Tab, made: Iterator[Frame]) -> None:
    """Let a page show frames in a large bearing-time record."""
    last = 0.0
    for frame in made:
        server.do(server.feed.emit, frame)
        last = max(last, frame.time)
    page.wait_for(f"page.history.newest >= {last}")
    page.value("page.layout.select('bearing_time', true), page.layout.enlarge('bearing_time'), 0")
    page.wait_for(f"(page.draw(), {VIEW}.canvas.width === {VIEW}.canvas.parent.clientWidth)")


def show_spectrum(server: PageServer, page: Tab) -> None:
    """Let a page show ten seconds of the spectrum of the source, alone and large."""
    for second in range(4):
        server.do(take_samples, server, second)
    page.wait_for("page.history.names('waterfall').length")
    page.value(
        "page.layout.select('lofar', true), page.layout.enlarge('lofar'),"
        f"page.selection.choose({{ sensor: 'array', beam: {SOURCE} }}), page.draw(), 0"
    )
    wait_selected(server, page)
    for second in range(4, 10):
        server.do(take_samples, server, second)
    page.wait_for("page.history.names('lofar').length")
    page.wait_for("page.history.stream(page.history.names('lofar')[0]).frames.length >= 4")
    page.wait_for(f"(page.draw(), {LOFAR}.canvas.width === {LOFAR}.canvas.parent.clientWidth)")


def take_samples(server: PageServer, second: int) -> None:
    """Let a server have a second of samples."""
    for frame in server.feed._waterfalls.samples("/array/samples", samples(second)):
        server.feed.emit(frame)


def wait_selected(server: PageServer, page: Tab) -> None:
    """Wait until a page has asked for a spectrum."""
    deadline = time.monotonic() + PATIENCE
    while not server.feed._waterfalls._lofar_selected:
        assert time.monotonic() < deadline
        page.value("page.draw(), 0")


def brightest(page: Tab, t: float) -> list[float]:
    """Return where along the axis the 1 s panel is loudest at a time, by colour: shares."""
    script = f"""(() => {{
      const view = {VIEW}; page.draw();
      const {{ box, ring }} = view.panels[0];
      const y = Math.round(box.y + ring.yOf({START + t}, box, view.wrap.isOn));
      const line = view.canvas.pen.getImageData(box.x, y, box.width, 1).data;
      const light = [...Array(line.length / 4).keys()]
        .map(i => line[4 * i] + line[4 * i + 1] + line[4 * i + 2]);
      const most = Math.max(...light);
      return light.flatMap((v, i) => v > 0.97 * most ? [(i + 0.5) / light.length] : []);
    }})()"""
    shares: list[float] = page.value(script)
    return shares
