"""What a study consists of: its tasks, its rows, its tables and its figures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sonar_tracking.evaluation.monte_carlo.batch_runner import Task
from sonar_tracking.evaluation.monte_carlo.study import StudyRow


@dataclass(frozen=True)
class Column:
    """One metric in a terminal table.

    Attributes
    ----------
    metric : str
        Name in :class:`StudyRow`.
    heading : str
        Over the column, with the unit.
    format : str
        Format specification of the number, e.g. ``".3f"``.
    """

    metric: str
    heading: str
    format: str


@dataclass(frozen=True)
class TableLayout:
    """One terminal table: the rows that have the metric of its first column.

    Attributes
    ----------
    title : str
        Over the table.
    columns : tuple of Column
        Metrics shown, in order; the published figure stands beside where there is one.
    note : str
        Under the table: what the columns mean.
    condition : str
        How the condition of its rows begins; empty = any.
    """

    title: str
    columns: tuple[Column, ...]
    note: str = ""
    condition: str = ""

    def shows(self, row: StudyRow) -> bool:
        """Return whether a row belongs to the table."""
        return self.columns[0].metric in row.metrics and row.condition.startswith(self.condition)


@dataclass(frozen=True)
class StudyDefinition:
    """How one study is computed and shown.

    Attributes
    ----------
    name : str
        As typed on the command line.
    description : str
        One line of what it answers.
    default_runs : int
        Monte Carlo runs per condition.
    tasks : callable
        ``tasks(runs, seed)`` returns what the workers compute.
    rows : callable
        ``rows(results)`` turns what the tasks returned, in their order, into rows.
    layouts : tuple of TableLayout
        Terminal tables.
    draw : callable
        ``draw(results, rows, directory)`` writes the figures and returns their paths.
    """

    name: str
    description: str
    default_runs: int
    tasks: Callable[[int, int], tuple[Task, ...]]
    rows: Callable[[Sequence[Any]], tuple[StudyRow, ...]]
    layouts: tuple[TableLayout, ...]
    draw: Callable[[Sequence[Any], Sequence[StudyRow], Path], tuple[Path, ...]]
