"""The pictures of the live page in README and documentation: of a recording of harbour_watch.

.. code-block:: console

    sonar-tracking run harbour_watch --rate max --no-display --record harbour_watch
    python -m tests.display.page.documentation_pictures harbour_watch
"""

from __future__ import annotations

import io
import sys
import tempfile
import threading
from pathlib import Path

from PIL import Image

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.display.page.recorded_page import RecordedPage
from tests.display.page.chromium import Chromium, Tab

FOLDER = Path(__file__).parents[3] / "docs" / "pictures"
INSTANT = 420.0
"""Of the pictures that do not move, s after the beginning."""

FIRST, LAST, STEP = 45.0, 895.0, 50.0
"""Of the one that moves, s after the beginning."""

FRAME_MS, FRAME_SIZE, COLOURS = 500, (800, 450), 128

CHOOSE = """page.selection.choose((({topic, id}) => ({topic, id}))(
  page.layout.views.get('plan').view.rows
    .filter(row => row.contributors.some(part => part[1] === 1 && part[2] === 'array'))
    .sort((a, b) => b.contributors.length - a.contributors.length)[0])), 0"""
"""Chooses the track that most sensors contribute to."""


def seen(tab: Tab, second: float) -> Image.Image:
    """Return what is seen at a time of the recording, s after its beginning."""
    tab.value(f"page.time.seek(page.time.span[0] + {second}), page.draw(), 0")
    tab.value("new Promise(done => setTimeout(done, 1500))")  # what it asks for has come
    tab.value("page.draw(), 0")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "seen.png"
        tab.picture(path)
        return Image.open(io.BytesIO(path.read_bytes())).convert("RGB")


def draw(tab: Tab) -> None:
    """Write all three pictures."""
    tab.colours("dark")
    moving = []
    second = FIRST
    while second <= LAST:
        moving.append(seen(tab, second).resize(FRAME_SIZE, Image.Resampling.LANCZOS))
        second += STEP
    # One palette for all: colours do not flicker.
    sheet = Image.new("RGB", (FRAME_SIZE[0], FRAME_SIZE[1] * len(moving)))
    for place, frame in enumerate(moving):
        sheet.paste(frame, (0, FRAME_SIZE[1] * place))
    palette = sheet.quantize(COLOURS, Image.Quantize.MAXCOVERAGE)
    first, *others = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in moving]
    first.save(
        FOLDER / "live_page.gif",
        save_all=True,
        append_images=others,
        duration=FRAME_MS,
        loop=0,
        optimize=True,
    )
    seen(tab, INSTANT)
    tab.value(CHOOSE)
    seen(tab, INSTANT).save(FOLDER / "live_page.png", optimize=True)
    tab.colours("light")
    tab.value("page.layout.select('lofar'), page.layout.select('stacked_dots'), 0")
    seen(tab, INSTANT)
    tab.wait_for("(page.draw(), document.querySelector('#view-stacked_dots .empty').hidden)")
    seen(tab, INSTANT).save(FOLDER / "live_page_light.png", optimize=True)


def main(path: str) -> None:
    """Show a recording in a browser, and take the pictures."""
    page = RecordedPage(read_bag(Path(path)), 0, "127.0.0.1")
    page.server.start()
    page.feed()
    threading.Thread(target=page.follow, daemon=True).start()
    with tempfile.TemporaryDirectory() as folder:
        browser = Chromium(Path(folder))
        try:
            tab = browser.open(page.server.address)
            tab.wait_for("page.history.newest > 0 && !page.incoming")
            draw(tab)
        finally:
            browser.close()
            page.server.stop()


if __name__ == "__main__":
    main(sys.argv[1])
