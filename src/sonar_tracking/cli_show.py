"""The command ``sonar-tracking show``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sonar_tracking.cli_loading import load, needs
from sonar_tracking.cli_options import (
    NamespaceOption,
    NoBrowserOption,
    PageAddressOption,
    PagePortOption,
    RemapOption,
)


def show(
    bag: Annotated[Path, typer.Argument(help="rosbag2 directory, .mcap or .db3 file, or .zstd.")],
    no_browser: NoBrowserOption = False,
    page_port: PagePortOption = 8080,
    page_address: PageAddressOption = "127.0.0.1",
    remap: RemapOption = None,
    namespace: NamespaceOption = "",
) -> None:
    """Open the live page on a recording, without the graph; Ctrl-C ends it."""
    names = load("sonar_tracking.bags.contents.topic_names").topic_names(remap or (), namespace)
    module = needs("sonar_tracking.display.page.show_bag")
    raise typer.Exit(module.show_bag(bag, names, page_port, page_address, not no_browser))
