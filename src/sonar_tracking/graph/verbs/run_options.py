"""What a person asks of ``run`` and ``replay``."""

from __future__ import annotations

import math
import os
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.cutoff import CUTOFF_M, check_cutoff
from sonar_tracking.graph.catalogue.page_plan import PageOptions


@dataclass(frozen=True)
class RunOptions:
    """Options of both verbs.

    Attributes
    ----------
    rate : float
        Data seconds per wall second; infinity = as fast as the graph takes it.
    record : Path or None
        Bag to record into.
    json : Path or None
        Where to write the report.
    cutoff_m : float
        Distance from which on the score takes a position track for none of a target, m.
    display_topics : bool
        Start what shows the data to RViz and Foxglove, and record what is shown.
    page : PageOptions or None
        Of the live page; None = there is none.
    """

    rate: float = 1.0
    record: Path | None = None
    json: Path | None = None
    cutoff_m: float = CUTOFF_M
    display_topics: bool = True
    page: PageOptions | None = None

    def check(self) -> None:
        """Refuse what could only fail at the end of the run.

        Raises
        ------
        ConfigurationError
            If a file to write cannot be written, the bag exists or cannot be made, or the cut-off
            is no distance.
        """
        check_cutoff(self.cutoff_m)
        if self.record is not None and self.record.exists():
            raise ConfigurationError(
                f"--record: {self.record} exists already; give another name or remove it."
            )
        if self.record is not None:
            _check_can_be_made(self.record)
        if self.json is not None and not self.json.resolve().parent.is_dir():
            raise ConfigurationError(
                f"--json: the folder {self.json.resolve().parent} does not exist; make it first."
            )


def _check_can_be_made(bag: Path) -> None:
    try:
        bag.mkdir(parents=True)
        bag.rmdir()
    except OSError as error:
        raise ConfigurationError(
            f"--record: {bag} cannot be made ({error.strerror}); give another place."
        ) from error


def rate_from_text(text: str) -> float:
    """Return the rate a person has typed: a factor of real time, or ``max``.

    Raises
    ------
    ConfigurationError
        If it is neither.
    """
    if text == "max":
        return math.inf
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not (math.isfinite(rate) and rate > 0.0):
        raise ConfigurationError(
            f"--rate is {text!r}; give a factor of real time above 0, e.g. 5, or max."
        )
    return rate


def make_log_directory() -> Path:
    """Make the folder for the logs of one run: below ``$ROS_HOME`` or ``~/.ros``, or temporary."""
    home = Path(os.environ.get("ROS_HOME") or Path.home() / ".ros")
    name = time.strftime("run-%Y%m%d-%H%M%S") + f"-{os.getpid()}"
    directory = home / "sonar_tracking" / name
    try:
        directory.mkdir(parents=True)
    except OSError:
        return Path(tempfile.mkdtemp(prefix="sonar_tracking-"))
    return directory
