"""Several scenes in one table: whose rows are which.

Runs of a simulation have nothing to do with each other, but what is computed of a row does not
depend on the rows beside it: the tables of all runs, one after the other, cost little more than one
of them. A node has one scene, and everything here is then what it was.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonar_tracking.records.arrays import IndexArray


class Table(Protocol):
    """Columns of equally many rows."""

    def select(self, rows: Any) -> Any:
        """Return some of the rows."""


_PART_OF = "_part_of"
"""Name under which a part of a table keeps the table, its number and that of the parts."""

AnyTable = TypeVar("AnyTable", bound=Table)


@dataclass(frozen=True)
class SceneRows:
    """How many rows each scene has; those of the first scene come first.

    Attributes
    ----------
    counts : tuple of int
        One a scene.
    """

    counts: tuple[int, ...]

    @property
    def single(self) -> bool:
        """Whether there is but one scene."""
        return len(self.counts) == 1

    @cached_property
    def starts(self) -> IndexArray:
        """First row of each scene, shape (n_scenes,)."""
        return np.array([0, *itertools.accumulate(self.counts[:-1])])

    @cached_property
    def scene(self) -> IndexArray:
        """Scene of each row, shape (n,)."""
        if self.single:
            return np.zeros(self.counts[0], dtype=np.intp)
        return np.arange(len(self.counts)).repeat(self.counts)

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """Rows of each scene."""
        ends = np.cumsum(self.counts).tolist()
        return tuple(slice(*both) for both in zip(self.starts.tolist(), ends, strict=True))

    def parts(self, table: AnyTable) -> list[AnyTable]:
        """Return the table of each scene; it keeps what it is part of, to be joined again."""
        if self.single:
            return [table]
        parts = [table.select(rows) for rows in self.slices]
        for number, part in enumerate(parts):
            vars(part)[_PART_OF] = (table, number, len(parts))
        return parts

    def split(self, column: NDArray[Any]) -> list[NDArray[Any]]:
        """Return what of a column, shape (n, ...), in any unit, belongs to each scene."""
        return [column] if self.single else [column[rows] for rows in self.slices]

    def spread(self, values: Sequence[ArrayLike]) -> Any:
        """Return a value of each scene at all of its rows; one for all if there is one scene.

        Parameters
        ----------
        values : sequence of array_like, shape (...)
            One a scene, in any unit.

        Returns
        -------
        ndarray, shape (n, ...) or (...)
            Broadcasts against the rows either way.
        """
        return values[0] if self.single else np.repeat(np.array(values), self.counts, axis=0)

    def of(self, rows: IndexArray) -> SceneRows:
        """Return whose some of the rows are, given in ascending order, shape (n_kept,)."""
        if self.single:
            return SceneRows((len(rows),))
        before = np.searchsorted(rows, (*self.starts.tolist(), len(self.scene)))
        return SceneRows(tuple(np.diff(before).tolist()))


def joined(columns: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return columns, shape (n, ...), in one unit, of all scenes: one after the other."""
    return columns[0] if len(columns) == 1 else np.concatenate(columns)


def joined_tables(tables: Sequence[AnyTable]) -> AnyTable:
    """Return the tables of all scenes, one after the other; dataclasses of columns."""
    if len(tables) == 1:
        return tables[0]
    whole = _whole(tables)
    if whole is not None:
        return whole
    first: Any = tables[0]
    names = [field.name for field in fields(first)]
    columns = [np.concatenate([getattr(table, name) for table in tables]) for name in names]
    return type(first)(*columns)


def _whole(tables: Sequence[AnyTable]) -> AnyTable | None:
    """Return the table of which these are all parts, if they are."""
    table = vars(tables[0]).get(_PART_OF, (None,))[0]
    for number, each in enumerate(tables):
        own, place, count = vars(each).get(_PART_OF, (None, 0, 0))
        if own is None or own is not table or place != number or count != len(tables):
            return None
    return cast("AnyTable", table)
