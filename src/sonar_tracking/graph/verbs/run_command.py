"""The verbs ``run`` and ``replay`` from options as typed to exit code."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from rich.console import Console

from sonar_tracking.display.run_display import LineDisplay, LiveDisplay, RunDisplay
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.discovery_range import default_range, range_in_words
from sonar_tracking.graph.catalogue.discovery_server import check_discovery_server
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.orchestration.domain_lock import domain_lock
from sonar_tracking.graph.orchestration.orphaned_shared_memory import remove_orphaned
from sonar_tracking.graph.orchestration.run_report import RunReport
from sonar_tracking.graph.verbs.display_choice import NONE, DisplayChoice
from sonar_tracking.graph.verbs.machine_state import MESSAGE_PACKAGE, TRANSFORM_PACKAGE
from sonar_tracking.graph.verbs.run_options import RunOptions, make_log_directory, rate_from_text
from sonar_tracking.stop_signals import interruptible, stop_code

if TYPE_CHECKING:
    from sonar_tracking.graph.verbs.replay_selection import Selection

Work = Callable[[RunDisplay, Path], RunReport]


class Shown(NamedTuple):
    """What is shown: whether the live table is, where there is a terminal; what is said first."""

    table: bool
    said: tuple[str, ...]


def run(
    scenario: str,
    duration: float | None,
    rate: str,
    record: Path | None,
    parameters: Path | None,
    display: DisplayChoice,
    json: Path | None,
    cutoff_m: float,
    display_topics: bool,
    names: GraphNames = ROOT_NAMES,
) -> int:
    """Run a scenario through the live graph and return the exit code.

    Raises
    ------
    ConfigurationError
        If what was asked cannot be done; nothing was started then.
    """
    options = RunOptions(rate_from_text(rate), record, json, cutoff_m, display_topics)
    options.check()
    page, said = display.page()
    options = replace(options, page=page)
    from sonar_tracking.graph.verbs.run_scenario import run_scenario

    return _shown(
        Shown(display.kind != NONE, said),
        json,
        lambda screen, log: run_scenario(
            scenario, duration, parameters, names, options, screen, log
        ),
        names.namespace,
    )


def replay(
    bag: Path,
    rate: str,
    record: Path | None,
    parameters: Path | None,
    repair: bool,
    selection: Selection,
    display: DisplayChoice,
    json: Path | None,
    cutoff_m: float,
    display_topics: bool,
) -> int:
    """Replay a recording through the live graph and return the exit code.

    Raises
    ------
    ConfigurationError
        If what was asked cannot be done; nothing was started then.
    """
    options = RunOptions(rate_from_text(rate), record, json, cutoff_m, display_topics)
    options.check()
    page, said = display.page()
    options = replace(options, page=page)
    from sonar_tracking.graph.verbs.run_replay import replay_bag

    return _shown(
        Shown(display.kind != NONE, said),
        json,
        lambda screen, log: replay_bag(bag, parameters, repair, selection, options, screen, log),
    )


def _shown(shown: Shown, json: Path | None, work: Work, namespace: str = "") -> int:
    for package in ("rclpy", MESSAGE_PACKAGE, TRANSFORM_PACKAGE):
        # Told before any process is started, which could only fail for the same reason.
        if find_spec(package) is None:
            raise ModuleNotFoundError(package, name=package)
    interruptible()
    return _reported(shown, json, work, namespace)


def _reported(shown: Shown, json: Path | None, work: Work, namespace: str) -> int:
    """Do the work, print its report, return the exit code."""
    console = Console()
    log_directory = make_log_directory()
    live = shown.table and console.is_terminal
    try:
        screens = LiveDisplay(console) if live else LineDisplay(console)
        check_discovery_server()
        os.environ.update(default_range())
        with domain_lock(namespace=namespace), screens as screen:
            for sentence in (*shown.said, range_in_words()):
                screen.say(sentence)
            remove_orphaned()
            report = work(screen, log_directory)
    except ConfigurationError:
        shutil.rmtree(log_directory)
        raise
    except KeyboardInterrupt:
        # From the first process on, the orchestration counts signals instead.
        shutil.rmtree(log_directory)
        return stop_code()
    for line in report.lines():
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    console.print(f"logs in {log_directory}", highlight=False, markup=False, soft_wrap=True)
    if json is not None:
        report.write_json(json)
    return report.exit_code
