"""The command ``sonar-tracking smooth``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sonar_tracking.cli_loading import load, needs
from sonar_tracking.cli_options import NamespaceOption, RemapOption


def smooth(
    bag: Annotated[Path, typer.Argument(help="Bag with bearing tracks, and own ship or poses.")],
    output: Annotated[
        Path | None, typer.Option(help="The new bag; default: NAME_smoothed beside the old one.")
    ] = None,
    acceleration: Annotated[
        float | None,
        typer.Option(help="Of targets that go straight, m/s^2; default: that of the recording."),
    ] = None,
    systematic_deviation_deg: Annotated[
        float | None,
        typer.Option(help="Of direction errors that do not average out; default: 0.5."),
    ] = None,
    remap: RemapOption = None,
    namespace: NamespaceOption = "",
) -> None:
    """Add the tracks of target motion analysis with hindsight, in a new bag.

    Each track from all that was measured along its bearing tracks, before and after, of source
    SMOOTHED, in a topic beside the old one. A bag of bearings without positions is tracked first.
    """
    names = load("sonar_tracking.bags.contents.topic_names").topic_names(remap or (), namespace)
    needs("sonar_tracking.evaluation.offline.smoothed_bag").smooth_bag(
        bag, output, acceleration, systematic_deviation_deg, names
    )
