"""The command ``sonar-tracking``: one verb a function, thin; the work is done below."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from copy import copy
from math import inf
from pathlib import Path
from types import ModuleType
from typing import Annotated

import sonar_tracking
from sonar_tracking.errors import SonarTrackingError
from sonar_tracking.evaluation.metrics.cutoff import CUTOFF_M, FAR_LIMIT_M

try:
    import typer
except ModuleNotFoundError:
    sys.exit("sonar-tracking: the Python package typer is missing; pip install typer rich")
if tuple(map(int, typer.__version__.split(".")[:2])) < (0, 13):
    sys.exit(f"sonar-tracking: typer {typer.__version__} is too old; pip install --upgrade typer")

from sonar_tracking.cli_bench import bench_app
from sonar_tracking.cli_export import export
from sonar_tracking.cli_import import import_app
from sonar_tracking.cli_inspect import inspect
from sonar_tracking.cli_loading import load as _load
from sonar_tracking.cli_loading import needs as _needs
from sonar_tracking.cli_options import (
    CutoffOption,
    DisplayOption,
    FarLimitOption,
    FaultsOption,
    GraphNamespaceOption,
    GraphRemapOption,
    JsonOption,
    NamespaceOption,
    NoBrowserOption,
    NoDisplayOption,
    NoDisplayTopicsOption,
    PageAddressOption,
    PagePortOption,
    RateOption,
    RecordOption,
    RemapOption,
)
from sonar_tracking.cli_show import show
from sonar_tracking.cli_smooth import smooth

REFUSED = 2
"""Exit code: what was asked cannot be done, and nothing was started."""

app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)
app.add_typer(import_app, name="import")
app.add_typer(bench_app, name="bench")


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"sonar-tracking {sonar_tracking.__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print it and end."),
    ] = False,
) -> None:
    """Sonar tracking as a ROS 2 graph."""


@app.command()
def run(
    scenario: Annotated[
        str, typer.Argument(help="Scenario of config/scenarios, or path of a YAML file.")
    ] = "harbour_watch",
    duration: Annotated[float | None, typer.Option(help="Length of the data, s.")] = None,
    rate: RateOption = "1",
    record: RecordOption = None,
    parameters: Annotated[
        Path | None, typer.Option(help="YAML file: node, parameter, value; overrides the scenario.")
    ] = None,
    remap: GraphRemapOption = None,
    namespace: GraphNamespaceOption = "",
    display: DisplayOption = None,
    no_display: NoDisplayOption = False,
    no_browser: NoBrowserOption = False,
    page_port: PagePortOption = 8080,
    page_address: PageAddressOption = "127.0.0.1",
    json: JsonOption = None,
    cutoff: CutoffOption = CUTOFF_M,
    no_display_topics: NoDisplayTopicsOption = False,
) -> None:
    """Run a scenario through the live graph: every node a process of its own."""
    module, choice = _displayed(display, no_display, no_browser, page_port, page_address)
    names = _load("sonar_tracking.graph.catalogue.graph_names").graph_names(remap or (), namespace)
    raise typer.Exit(
        module.run(
            *(scenario, duration, rate, record, parameters),
            *(choice, json, cutoff, not no_display_topics, names),
        )
    )


@app.command()
def replay(
    bag: Annotated[Path, typer.Argument(help="rosbag2 directory, .mcap or .db3 file, or .zstd.")],
    rate: RateOption = "1",
    record: RecordOption = None,
    parameters: Annotated[
        Path | None, typer.Option(help="YAML file: node, parameter, value; overrides the bag's.")
    ] = None,
    repair: Annotated[
        bool,
        typer.Option("--repair", help="First rewrite a bag that is not whole or too old."),
    ] = False,
    remap: RemapOption = None,
    namespace: NamespaceOption = "",
    start_offset: Annotated[
        float, typer.Option(help="Where to begin, s after the first message of the bag.")
    ] = 0.0,
    duration: Annotated[
        float | None, typer.Option(help="How much of the recording, s; default: to its end.")
    ] = None,
    loop: Annotated[
        bool, typer.Option("--loop", help="Begin again at the end, until Ctrl-C.")
    ] = False,
    display: DisplayOption = None,
    no_display: NoDisplayOption = False,
    no_browser: NoBrowserOption = False,
    page_port: PagePortOption = 8080,
    page_address: PageAddressOption = "127.0.0.1",
    json: JsonOption = None,
    plots: Annotated[
        Path | None, typer.Option(help="Folder for pictures of the tracks, and for their bag.")
    ] = None,
    cutoff: CutoffOption = CUTOFF_M,
    no_display_topics: NoDisplayTopicsOption = False,
) -> None:
    """Replay a recording through the live graph and compare with what was recorded."""
    if plots is not None and record is None:
        record = plots / "replayed"
    module, choice = _displayed(display, no_display, no_browser, page_port, page_address)
    selected = _load("sonar_tracking.graph.verbs.replay_selection").Selection(
        _names(remap, namespace), start_offset, inf if duration is None else duration, loop
    )
    code = module.replay(
        *(bag, rate, record, parameters, repair, selected),
        *(choice, json, cutoff, not no_display_topics),
    )
    if plots is not None and record is not None and record.exists():
        _needs("sonar_tracking.display.plot_bag").plot_bag(record, plots)
    raise typer.Exit(code)


@app.command()
def evaluate(
    study: Annotated[str, typer.Argument(help="Name of a study, or all.")],
    runs: Annotated[int | None, typer.Option(help="Monte Carlo runs per condition.")] = None,
    seed: Annotated[int, typer.Option(help="Root of all randomness.")] = 1,
    workers: Annotated[int | None, typer.Option(help="Local worker processes.")] = None,
    scheduler: Annotated[str | None, typer.Option(help="Address of a dask scheduler.")] = None,
    json: JsonOption = None,
    plots: Annotated[Path | None, typer.Option(help="Folder for the pictures.")] = None,
    data: Annotated[
        Path | None, typer.Option(help="Measured data, for the studies that need them.")
    ] = None,
) -> None:
    """Repeat a published study, and show the published figures beside the measured ones."""
    studies = _needs("sonar_tracking.evaluation.studies.study_catalogue")
    studies.run_study(study, runs, seed, workers, scheduler, json, plots, data)


@app.command()
def score(
    bag: Annotated[Path, typer.Argument(help="Bag with tracks and truth.")],
    json: JsonOption = None,
    cutoff: CutoffOption = CUTOFF_M,
    far_limit: FarLimitOption = FAR_LIMIT_M,
    remap: RemapOption = None,
    namespace: NamespaceOption = "",
) -> None:
    """Score the bearing and position tracks in a bag against the truth in the bag."""
    _needs("sonar_tracking.evaluation.metrics.score_bag").score_bag(
        bag, json, cutoff, _names(remap, namespace), far_limit
    )


app.command()(smooth)
app.command()(export)
app.command()(show)
app.command()(inspect)


@app.command()
def plot(
    bag: Annotated[Path, typer.Argument(help="Bag with tracks.")],
    output: Annotated[Path, typer.Option(help="Folder for the pictures.")] = Path(),
    remap: RemapOption = None,
    namespace: NamespaceOption = "",
) -> None:
    """Draw what a bag holds: chart, records over time, table of the tracks."""
    _needs("sonar_tracking.display.plot_bag").plot_bag(bag, output, _names(remap, namespace))


@app.command()
def chaos(
    scenarios: Annotated[list[str], typer.Argument(help="Scenarios, which take turns.")],
    runs: Annotated[int, typer.Option(min=1, help="Of all scenarios and faults together.")] = 12,
    seed: Annotated[int, typer.Option(help="Of targets and times.")] = 1,
    faults: FaultsOption = "",
    rate: RateOption = "2",
    json: JsonOption = None,
) -> None:
    """Disturb runs on purpose, and report what came of it."""
    disturb = _needs("sonar_tracking.graph.verbs.chaos_command").chaos
    raise typer.Exit(disturb(scenarios, runs, seed, faults, rate, json))


@app.command()
def doctor() -> None:
    """Examine this machine: what a graph needs, what is missing, and the remedy.

    The exit code is 0 if a graph can run here, else 1. ROS need not be installed.
    """
    raise typer.Exit(_needs("sonar_tracking.graph.verbs.doctor").examine())


def _displayed(*options: object) -> tuple[ModuleType, object]:
    """Return the module of ``run`` and ``replay``, and where they show what happens."""
    choice = _load("sonar_tracking.graph.verbs.display_choice").display_choice(*options)
    return _load("sonar_tracking.graph.verbs.run_command"), choice


def _names(remap: list[str] | None, namespace: str) -> object:
    """Return the rules for the names of a bag's topics."""
    return _load("sonar_tracking.bags.contents.topic_names").topic_names(remap or (), namespace)


def _missing_package(error: ModuleNotFoundError) -> str:
    """Return the sentence for a Python package that is not installed."""
    name = (error.name or "").partition(".")[0]
    if name == "rclpy" or name.endswith("_msgs"):
        remedy = (
            "use ./scripts/run.sh, or source your ROS 2 installation first, or, on Linux on x86-64,"
            " pip install 'sonar_tracking[ros]'"
        )
    else:
        remedy = f"pip install {'PyYAML' if name == 'yaml' else name}"
    return f"the Python package {error.name} is missing: {remedy}."


def _unusable_file(error: OSError) -> str:
    """Return the sentence for a file or folder that cannot be read or written."""
    return f"{error.filename} cannot be used ({error.strerror}); give another path, or make room."


def _asked_for(words: Sequence[str]) -> typer.Typer:
    """Return the command with the one verb that is asked for, or all of it.

    Typer prepares the options of every verb it has before it looks for the one, which takes ten
    times as long.
    """
    narrow = copy(app)
    verb = words[0] if words else ""
    narrow.registered_commands = [each for each in app.registered_commands if _named(each, verb)]
    narrow.registered_groups = [each for each in app.registered_groups if each.name == verb]
    return narrow if narrow.registered_commands or narrow.registered_groups else app


def _named(command: typer.models.CommandInfo, verb: str) -> bool:
    return command.callback is not None and command.callback.__name__ == verb


def main() -> int:
    """Run the command; a wrong request is one sentence and exit code 2."""
    try:
        _asked_for(sys.argv[1:])(prog_name="sonar-tracking")
    except SonarTrackingError as error:
        print(f"sonar-tracking: {error}", file=sys.stderr)
        return REFUSED
    except ModuleNotFoundError as error:
        print(f"sonar-tracking: {_missing_package(error)}", file=sys.stderr)
        return REFUSED
    except OSError as error:
        if error.filename is None:
            raise
        print(f"sonar-tracking: {_unusable_file(error)}", file=sys.stderr)
        return REFUSED
    return 0


if __name__ == "__main__":
    sys.exit(main())
