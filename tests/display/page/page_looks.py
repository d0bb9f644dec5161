"""What a page is asked in tests: the views it has, the texts of its track table."""

from __future__ import annotations

from tests.display.page.chromium import Tab
from tests.display.page.page_scene import START

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
