"""Two benches side by side: the ratio of each figure that both have."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sonar_tracking.evaluation.bench.bench_report import BenchReport

if TYPE_CHECKING:
    from rich.console import Console


NOT_COMPARED = {
    *("dgemm_percent", "copy_percent", "peer_over_ours", "speed_over_gated", "exponent"),
    *("frames", "estimates", "data_seconds", "node_count"),
}
"""What follows from other figures, or is the same in all benches."""


@dataclass(frozen=True)
class Change:
    """A figure in two benches.

    Attributes
    ----------
    part, condition, name, figure : str
        Which one.
    old, new : float
        Its values.
    """

    part: str
    condition: str
    name: str
    figure: str
    old: float
    new: float

    @property
    def ratio(self) -> float:
        """New over old; infinity where there was nothing."""
        return self.new / self.old if self.old else float("inf")


def changes(old: BenchReport, new: BenchReport) -> Iterator[Change]:
    """Yield the figures that both benches have, in the order of the new one."""
    before = {
        (part.name, row.condition, row.system): row.metrics
        for part in old.parts
        for row in part.rows
    }
    for part in new.parts:
        for row in part.rows:
            figures = before.get((part.name, row.condition, row.system), {})
            for figure, value in row.metrics.items():
                if figure in figures and figure not in NOT_COMPARED:
                    place = (part.name, row.condition, row.system, figure)
                    yield Change(*place, figures[figure], value)


def print_changes(old: BenchReport, new: BenchReport, console: Console) -> None:
    """Print the ratios, and which rows only one of the benches has.

    Parameters
    ----------
    old, new : BenchReport
        What to compare; parts that were not measured again are not shown.
    console : rich.console.Console
        Where to print.
    """
    console.print("\nbeside the other bench, new / old", style="italic", highlight=False)
    for label, machine in (("old", old.machine), ("new", new.machine)):
        words = f"{label}: {machine['cpu']}, version {machine['version']}, {machine['date']}"
        console.print(words, highlight=False, style="dim")
    heading = ""
    for change in changes(old, new):
        above = f"{change.part}: {change.condition}"
        if above != heading:
            console.print(above, style="bold", highlight=False)
            heading = above
        words = f"{change.ratio:8.3f}  {change.name}, {change.figure}"
        console.print(
            f"{words}: {change.old:.4g} -> {change.new:.4g}", highlight=False, soft_wrap=True
        )
    for label, rows in (("new", _names(new) - _names(old)), ("gone", _names(old) - _names(new))):
        for part, condition, name in sorted(rows):
            if part in {each.name for each in new.parts}:
                console.print(f"    {label}  {part}: {condition}, {name}", highlight=False)


def _names(report: BenchReport) -> set[tuple[str, str, str]]:
    return {(part.name, row.condition, row.system) for part in report.parts for row in part.rows}
