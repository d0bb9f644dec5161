"""Where ``run`` and ``replay`` show what happens: terminal, live page, or lines of text."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from importlib.util import find_spec

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.page_plan import PageOptions

TERMINAL, PAGE, NONE = "terminal", "page", "none"
KINDS = (TERMINAL, PAGE, NONE)

_NEEDED = {"tornado": "tornado", "uplot": "uplot-python"}
"""Packages the page needs, and what pip calls them."""


@dataclass(frozen=True)
class DisplayChoice:
    """Where to show what happens.

    Attributes
    ----------
    kind : str
        ``"terminal"``: the live table; ``"page"``: that and the live page; ``"none"``: lines.
    port : int
        Of the page; the next free one if it is taken.
    address : str
        The page listens at.
    browser : bool
        Whether to open the page in the browser of this machine.
    """

    kind: str = NONE
    port: int = 8080
    address: str = "127.0.0.1"
    browser: bool = False

    def page(self) -> tuple[PageOptions | None, tuple[str, ...]]:
        """Return the page to serve, at a port that is free now, and what to say of it.

        Raises
        ------
        ConfigurationError
            If the page cannot listen there.
        """
        if self.kind != PAGE:
            return None, ()
        from sonar_tracking.display.page.page_address import (
            TOKEN_VARIABLE,
            free_port,
            page_address,
            page_token,
        )

        port = free_port(self.address, self.port)
        token = os.environ.setdefault(TOKEN_VARIABLE, page_token())
        said = [f"page: {page_address(self.address, port, token)}"]
        if self.port not in (0, port):
            said.append(f"port {self.port} is taken: the page is at port {port}.")
        return PageOptions(port, self.address, self.browser), tuple(said)


def display_choice(
    asked: str | None, no_display: bool, no_browser: bool, port: int, address: str
) -> DisplayChoice:
    """Return the choice a person has typed.

    Without one the page is served and opened where a person looks at a terminal, and its packages
    are there.

    Raises
    ------
    ConfigurationError
        If there is no such display, or both options are given.
    ModuleNotFoundError
        If the page is asked for and cannot be served.
    """
    if asked is not None and no_display and asked != NONE:
        raise ConfigurationError("--no-display and --display exclude one another; give one.")
    if asked is not None and asked not in KINDS:
        raise ConfigurationError(f"--display is {asked!r}; give one of {', '.join(KINDS)}.")
    if not 0 <= port <= 65535:
        raise ConfigurationError(f"--page-port is {port}; give a number from 0 to 65535.")
    missing = [package for name, package in _NEEDED.items() if find_spec(name) is None]
    kind = NONE if no_display else asked
    if kind is None:
        kind = NONE if not sys.stdout.isatty() else TERMINAL if missing else PAGE
    if kind == PAGE and missing:
        raise ModuleNotFoundError(missing[0], name=missing[0])
    return DisplayChoice(kind, port, address, not no_browser)
