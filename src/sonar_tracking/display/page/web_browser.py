"""The browser of this machine."""

from __future__ import annotations

import os
import sys
import webbrowser


def open_browser(address: str) -> None:
    """Open an address in the browser of this machine, where there is a screen."""
    if sys.platform == "darwin" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        webbrowser.open(address)
