"""Options that several verbs of the command line have in common."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

RateOption = Annotated[
    str, typer.Option(help="Factor of real time, or max: as fast as the graph takes it.")
]
RecordOption = Annotated[
    Path | None, typer.Option(help="Record all data topics and /clock in this bag.")
]
JsonOption = Annotated[Path | None, typer.Option(help="Write the figures to this file.")]
CutoffOption = Annotated[
    float,
    typer.Option(help="Distance from which on a track is scored as none of a target, m."),
]
FarLimitOption = Annotated[
    float,
    typer.Option(help="Distance to the nearest target beyond which a row is far off, m."),
]
RemapOption = Annotated[
    list[str] | None,
    typer.Option(help="OLD:=NEW, a topic of the bag and its name in the graph; may be repeated."),
]
NamespaceOption = Annotated[
    str, typer.Option(help="Take topics of the bag below this namespace for those of the graph.")
]
GraphRemapOption = Annotated[
    list[str] | None,
    typer.Option(help="OLD:=NEW, a topic of the graph and its new name; may be repeated."),
]
GraphNamespaceOption = Annotated[
    str, typer.Option(help="Run the nodes, their topics and their clock below this namespace.")
]
DisplayOption = Annotated[
    str | None,
    typer.Option(
        help="terminal: the live table; page: that, and the live page in a browser; none: lines of "
        "text. Default: page in a terminal, none elsewhere."
    ),
]
NoDisplayOption = Annotated[bool, typer.Option("--no-display", help="The same as --display none.")]
NoBrowserOption = Annotated[
    bool, typer.Option("--no-browser", help="Serve the page, but do not open it.")
]
PagePortOption = Annotated[int, typer.Option(help="Port of the page; if taken, the next free one.")]
PageAddressOption = Annotated[
    str, typer.Option(help="Address of the page; 0.0.0.0 lets other machines look, too.")
]
NoDisplayTopicsOption = Annotated[
    bool, typer.Option("--no-display-topics", help="Without pictures for RViz and Foxglove.")
]
FaultsOption = Annotated[
    str,
    typer.Option(
        help="nothing, kill, stop, malformed, recorder, start, orchestration, interrupt (default: "
        "these), and, as root, delay, partition; commas between."
    ),
]
