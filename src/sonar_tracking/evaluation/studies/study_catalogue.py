"""All studies by name, and the one function that runs them."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from sonar_tracking.errors import ConfigurationError, unknown_name_text
from sonar_tracking.evaluation.monte_carlo.batch_runner import Workers, compute
from sonar_tracking.evaluation.monte_carlo.study import Study, write_json
from sonar_tracking.evaluation.monte_carlo.study_definition import StudyDefinition
from sonar_tracking.evaluation.monte_carlo.study_report import print_study
from sonar_tracking.evaluation.studies.detection_threshold.study import DETECTION_THRESHOLD
from sonar_tracking.evaluation.studies.doa_coherent.study import DOA_COHERENT
from sonar_tracking.evaluation.studies.doa_fusion.study import DOA_FUSION
from sonar_tracking.evaluation.studies.doa_start.study import DOA_START
from sonar_tracking.evaluation.studies.maritime_contacts.study import (
    MARITIME_CONTACTS,
    maritime_contacts,
)
from sonar_tracking.evaluation.studies.mismatch_bearings.study import MISMATCH_BEARINGS
from sonar_tracking.evaluation.studies.mismatch_contacts.study import MISMATCH_CONTACTS
from sonar_tracking.evaluation.studies.mismatch_positions.study import MISMATCH_POSITIONS
from sonar_tracking.evaluation.studies.multi_target_clutter.study import MULTI_TARGET_CLUTTER
from sonar_tracking.evaluation.studies.room_array.study import ROOM_ARRAY, room_array
from sonar_tracking.evaluation.studies.scenario_seeds.study import SCENARIO_SEEDS
from sonar_tracking.evaluation.studies.ship_bearings.study import SHIP_BEARINGS, ship_bearings
from sonar_tracking.evaluation.studies.tma_frequency_fusion.study import TMA_FREQUENCY_FUSION
from sonar_tracking.evaluation.studies.track_fusion.study import TRACK_FUSION

if TYPE_CHECKING:
    from rich.console import Console

STUDIES = {
    definition.name: definition
    for definition in (
        DOA_FUSION,
        DOA_COHERENT,
        DOA_START,
        TMA_FREQUENCY_FUSION,
        DETECTION_THRESHOLD,
        MULTI_TARGET_CLUTTER,
        MISMATCH_BEARINGS,
        MISMATCH_CONTACTS,
        MISMATCH_POSITIONS,
        TRACK_FUSION,
        SCENARIO_SEEDS,
    )
}
"""Studies by the name typed on the command line, in the order of ``all``."""

DATA_STUDIES: Mapping[str, Callable[[Path], StudyDefinition]] = {
    ROOM_ARRAY: room_array,
    SHIP_BEARINGS: ship_bearings,
    MARITIME_CONTACTS: maritime_contacts,
}
"""Studies of measured data by name: what makes them from the file or folder of the data."""


def run_study(
    name: str,
    runs: int | None = None,
    seed: int = 1,
    workers: int | None = None,
    scheduler: str | None = None,
    json: Path | None = None,
    plots: Path | None = None,
    data: Path | None = None,
) -> tuple[Study, ...]:
    """Run a study, print its tables and write what was asked for.

    Parameters
    ----------
    name : str
        Name of a study, or ``"all"``.
    runs : int, optional
        Monte Carlo runs per condition; the study's own default if not given.
    seed : int
        Root of all randomness.
    workers : int, optional
        Local worker processes; as many as there are processors if not given.
    scheduler : str, optional
        Address of a dask scheduler to compute on instead.
    json : Path, optional
        File for the figures.
    plots : Path, optional
        Directory for the pictures.
    data : Path, optional
        Measured responses for ``"room-array"`` (and ``"all"``), measured bearings for
        ``"ship-bearings"``, a folder of recorded radar scans for ``"maritime-contacts"``.

    Returns
    -------
    tuple of Study
        One, or all of them for ``"all"``: those on data only where data are given.

    Raises
    ------
    ConfigurationError
        If the name is not known, or runs, seed, workers or the scheduler cannot be used.
    """
    from rich.console import Console

    definitions = _definitions(name, data)
    where = Workers(workers if workers is not None else os.cpu_count() or 1, scheduler or "")
    console = Console()
    studies = tuple(
        _run(definition, runs, seed, where, plots, console) for definition in definitions
    )
    if json is not None:
        write_json(studies, Path(json))
    return studies


def _definitions(name: str, data: Path | None) -> tuple[StudyDefinition, ...]:
    """Return the studies that a name stands for."""
    known = (*STUDIES, *DATA_STUDIES, "all")
    if name not in known:
        raise ConfigurationError(unknown_name_text(f"study {name}", name, known))
    if name in DATA_STUDIES and data is None:
        raise ConfigurationError(f"The study {name} needs measured data; give --data FILE.")
    available = dict(STUDIES)
    if data is not None:
        measured = name if name in DATA_STUDIES else ROOM_ARRAY
        available[measured] = DATA_STUDIES[measured](data)
    return tuple(available.values()) if name == "all" else (available[name],)


def _run(
    definition: StudyDefinition,
    runs: int | None,
    seed: int,
    workers: Workers,
    plots: Path | None,
    console: Console,
) -> Study:
    from rich.progress import Progress

    runs = definition.default_runs if runs is None else runs
    tasks = definition.tasks(runs, seed)
    started = time.perf_counter()
    with Progress(console=console, transient=True) as progress:
        bar = progress.add_task(definition.name, total=len(tasks))
        results = compute(tasks, workers, lambda: progress.advance(bar))
    rows = definition.rows(results)
    study = Study(definition.name, runs, seed, time.perf_counter() - started, rows)
    print_study(study, definition.layouts, console)
    if plots is not None:
        for path in definition.draw(results, rows, Path(plots)):
            console.print(f"wrote {path}", highlight=False, soft_wrap=True)
    return study
