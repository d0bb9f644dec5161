"""The command ``sonar-tracking inspect``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sonar_tracking.cli_loading import needs


def inspect(
    file: Annotated[Path, typer.Argument(help="Table, geometry, audio, NMEA log or bag.")],
) -> None:
    """Say what a file is, what is wrong with it and the command to import it."""
    module = needs("sonar_tracking.bags.importers.file_inspection")
    print(module.inspect_file(file))
