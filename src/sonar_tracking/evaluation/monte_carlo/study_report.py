"""Terminal report of a study: tables with the published figures beside the measured ones.

A table that is wider than the terminal is continued below with its other columns: no figure and no
name is cut off.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sonar_tracking.evaluation.monte_carlo.study import Study, StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

_PUBLISHED_STYLE = "cyan"


@dataclass(frozen=True)
class _Cells:
    """One column of a table as text: heading, one cell a row, style."""

    heading: str
    cells: tuple[str, ...]
    style: str = ""

    @property
    def width(self) -> int:
        return max(len(text) for text in (self.heading, *self.cells))


def print_study(study: Study, layouts: Sequence[TableLayout], console: Console) -> None:
    """Print all tables of a study.

    Parameters
    ----------
    study : Study
        What to print.
    layouts : sequence of TableLayout
        Tables, in order; one without rows is not printed.
    console : rich.console.Console
        Where to print.
    """
    print_tables(study.rows, layouts, console)
    console.print(
        f"\n{study.study}: {study.runs} runs, seed {study.seed}, {study.seconds:.1f} s",
        highlight=False,
    )


def print_tables(
    all_rows: Sequence[StudyRow], layouts: Sequence[TableLayout], console: Console
) -> None:
    """Print tables.

    Parameters
    ----------
    all_rows : sequence of StudyRow
        Of all tables.
    layouts : sequence of TableLayout
        Tables, in order; one without rows is not printed.
    console : rich.console.Console
        Where to print.
    """
    for layout in layouts:
        rows = [row for row in all_rows if layout.shows(row)]
        if not rows:
            continue
        console.print(f"\n{layout.title}", style="italic", highlight=False)
        systems = _Cells("system", tuple(f" {row.system}" for row in rows))
        conditions = [row.condition for row in rows]
        for columns in _parts(_columns(layout, rows), console.width - systems.width):
            for line in _lines(systems, columns, conditions):
                console.print(line, soft_wrap=True)
        if layout.note:
            console.print(layout.note, style="dim", highlight=False)


def _columns(layout: TableLayout, rows: Sequence[StudyRow]) -> list[list[_Cells]]:
    """Return the columns of figures, each with that of the published ones if there are any."""
    columns = []
    for column in layout.columns:
        measured = tuple(_number(row.metrics.get(column.metric), column) for row in rows)
        group = [_Cells(column.heading, measured)]
        if any(column.metric in row.published for row in rows):
            published = tuple(_number(row.published.get(column.metric), column) for row in rows)
            group.append(_Cells("paper", published, _PUBLISHED_STYLE))
        columns.append(group)
    return columns


def _parts(groups: Sequence[list[_Cells]], width: int) -> Iterator[list[_Cells]]:
    """Yield the columns that fit beside each other; measured and published stay together."""
    part: list[_Cells] = []
    for group in groups:
        if part and sum(column.width + 2 for column in (*part, *group)) > width:
            yield part
            part = []
        part = [*part, *group]
    yield part


def _lines(systems: _Cells, columns: Sequence[_Cells], conditions: Sequence[str]) -> Iterator[Text]:
    """Yield the lines of one part of a table: a line for each condition above its rows."""
    from rich.text import Text

    heading = Text(systems.heading.ljust(systems.width), style="bold")
    for column in columns:
        heading.append("  " + column.heading.rjust(column.width), style=column.style)
    yield heading
    yield Text("─" * heading.cell_len)
    for index, (system, condition) in enumerate(zip(systems.cells, conditions, strict=True)):
        if index == 0 or conditions[index - 1] != condition:
            yield Text(condition, style="bold")
        line = Text(system.ljust(systems.width))
        for column in columns:
            line.append("  " + column.cells[index].rjust(column.width), style=column.style)
        yield line
    yield Text()


def _number(value: float | None, column: Column) -> str:
    if value is None:
        return ""
    return format(value, column.format) if math.isfinite(value) else "-"
