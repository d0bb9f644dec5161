"""``sonar-tracking show``: the live page on a recording, without the graph."""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.bags.contents.topic_names import TopicNames
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.display.page.recorded_page import RecordedPage
from sonar_tracking.display.page.web_browser import open_browser
from sonar_tracking.stop_signals import stop_code


def show_bag(path: Path, names: TopicNames, port: int, address: str, browser: bool) -> int:
    """Show a recording until Ctrl-C, and return the exit code of a command that was stopped.

    Parameters
    ----------
    path : Path
        The bag.
    names : TopicNames
        Names of its topics in the graph.
    port : int
        Of the page; the next free one if it is taken.
    address : str
        To listen at.
    browser : bool
        Whether to open a browser.

    Raises
    ------
    ConfigurationError
        If the bag holds nothing to show, or the page cannot be served.
    """
    page = RecordedPage(read_bag(path).named(names), port, address)
    page.server.start()
    try:
        print(f"{path} is shown at {page.server.address} (Ctrl-C ends it)", flush=True)
        if page.bag.recovery:
            print(page.bag.recovery, flush=True)
        if browser:
            open_browser(page.server.address)
        page.feed()
        page.follow()
    except KeyboardInterrupt:
        pass
    finally:
        page.server.stop()
    return stop_code()
