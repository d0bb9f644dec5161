"""The command ``sonar-tracking export``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sonar_tracking.cli_loading import load, needs
from sonar_tracking.cli_options import NamespaceOption, RemapOption


def export(
    bag: Annotated[Path, typer.Argument(help="Bag with tracks, truth, bearings or own ship.")],
    file_format: Annotated[str, typer.Option("--format", help="csv, geojson or kml.")] = "csv",
    output: Annotated[
        Path | None, typer.Option(help="The new file; default: NAME.FORMAT in this folder.")
    ] = None,
    topic: Annotated[
        list[str] | None, typer.Option(help="Only this topic; may be repeated.")
    ] = None,
    datum: Annotated[
        str,
        typer.Option(help="LATITUDE,LONGITUDE of the origin of map, degrees; default: the bag's."),
    ] = "",
    remap: RemapOption = None,
    namespace: NamespaceOption = "",
) -> None:
    """Write tracks, truth, bearings and own ship for other programs.

    csv is one table of everything, a row a track and instant, with covariances and the tracks each
    was made from. geojson and kml are charts with one line a target; they need a datum.
    """
    names = load("sonar_tracking.bags.contents.topic_names").topic_names(remap or (), namespace)
    needs("sonar_tracking.bags.exporters.export_bag").export_bag(
        bag, file_format, output, topic or (), datum, names
    )
