"""Terminal report of a study: tables with the published figures beside the measured ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from sonar_tracking.evaluation.study import Study, StudyRow
from sonar_tracking.evaluation.study_definition import Column, TableLayout

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table


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
    for layout in layouts:
        rows = [row for row in study.rows if layout.shows(row)]
        if not rows:
            continue
        console.print()
        console.print(_table(layout, rows))
        if layout.note:
            console.print(layout.note, style="dim", highlight=False)
    console.print(
        f"\n{study.study}: {study.runs} runs, seed {study.seed}, {study.seconds:.1f} s",
        highlight=False,
    )


def _table(layout: TableLayout, rows: Sequence[StudyRow]) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(
        title=layout.title,
        box=box.SIMPLE_HEAD,
        title_justify="left",
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )
    table.add_column("system")
    published = [any(column.metric in row.published for row in rows) for column in layout.columns]
    for column, has_published in zip(layout.columns, published, strict=True):
        table.add_column(column.heading, justify="right", no_wrap=True)
        if has_published:
            table.add_column("paper", justify="right", no_wrap=True, style="cyan")
    for index, row in enumerate(rows):
        if index == 0 or rows[index - 1].condition != row.condition:
            table.add_row(row.condition, style="bold")
        cells = [f" {row.system}"]
        for column, has_published in zip(layout.columns, published, strict=True):
            cells.append(_number(row.metrics.get(column.metric), column))
            if has_published:
                cells.append(_number(row.published.get(column.metric), column))
        last = index + 1 == len(rows) or rows[index + 1].condition != row.condition
        table.add_row(*cells, end_section=last)
    return table


def _number(value: float | None, column: Column) -> str:
    if value is None:
        return ""
    return format(value, column.format) if math.isfinite(value) else "-"
