"""Pairs of least total cost.

Shortest augmenting paths with duals: D. F. Crouse, "On implementing 2D rectangular assignment
algorithms", IEEE Transactions on Aerospace and Electronic Systems 52 (2016), algorithm of section
II. ``scipy.optimize`` has the same in C++, but takes longer to load than a whole node to start, and
26 MB: it is used where it is loaded already, and its solver alone for more than :data:`FEW_COSTS`,
or once that is loaded.
Both give the same pairs, of equal costs too: the steps, their order and their roundings are the
same.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import cache
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader, FileFinder
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.records.arrays import FloatArray, IndexArray

FEW_COSTS = 1200
"""Up to so many costs the pairs are found here, in half a millisecond."""

SOLVER = "_lsap"
"""Name of the module of the solver."""

_LOADED = {SOLVER, "scipy.optimize"}
"""Either of them is enough to solve with it."""


def least_cost_pairs(costs: FloatArray) -> tuple[IndexArray, IndexArray]:
    """Return the pairs of rows and columns whose costs have the least sum.

    Parameters
    ----------
    costs : ndarray, shape (n_rows, n_columns)
        Finite, in any unit.

    Returns
    -------
    rows, columns : ndarray of int, shape (min(n_rows, n_columns),)
        Each row and column at most once, rows rising.

    Raises
    ------
    ValueError
        If a cost is not a number.
    """
    if costs.size > FEW_COSTS or not sys.modules.keys().isdisjoint(_LOADED):
        rows, columns = _solver()(costs)
        return rows, columns
    n_rows, n_columns = costs.shape
    if n_rows <= n_columns:
        of_row = _assigned(costs.tolist(), n_columns)
        return np.arange(n_rows), np.array(of_row, np.intp)
    row_of = _assigned(costs.T.tolist(), n_rows)
    columns = np.argsort(np.array(row_of, np.intp))
    return np.array(row_of, np.intp)[columns], columns


def load_solver() -> None:
    """Load the solver of many costs now, so that the first of them need not wait for it."""
    _solver()


@cache
def _solver() -> Callable[[FloatArray], Any]:
    """Return the solver of scipy, from its own file unless the package is there already."""
    package = find_spec("scipy")
    if "scipy.optimize" not in sys.modules and package and package.submodule_search_locations:
        folder = Path(package.submodule_search_locations[0]) / "optimize"
        finder = FileFinder(str(folder), (ExtensionFileLoader, EXTENSION_SUFFIXES))
        found = finder.find_spec(SOLVER)
        if found is not None and found.loader is not None:
            module: Any = module_from_spec(found)
            found.loader.exec_module(module)
            sys.modules[SOLVER] = module
            if hasattr(module, "linear_sum_assignment"):
                return module.linear_sum_assignment
    from scipy.optimize import linear_sum_assignment

    return linear_sum_assignment


def _assigned(costs: list[list[float]], n_columns: int) -> list[int]:
    """Return the column of each row; there are no fewer columns than rows."""
    row_prices, column_prices = [0.0] * len(costs), [0.0] * n_columns
    column_of, row_of = [-1] * len(costs), [-1] * n_columns
    for begin in range(len(costs)):
        path, lengths, reached, end = _shortest_path(
            begin, costs, row_prices, column_prices, row_of
        )
        least = lengths[end]
        for column in reached:
            row = row_of[column]
            if row >= 0:
                row_prices[row] += least - lengths[column]
            column_prices[column] -= least - lengths[column]
        row_prices[begin] += least
        column = end
        while column >= 0:
            row = path[column]
            row_of[column] = row
            column, column_of[row] = column_of[row], column
    return column_of


def _shortest_path(
    row: int,
    costs: list[list[float]],
    row_prices: list[float],
    column_prices: list[float],
    row_of: list[int],
) -> tuple[list[int], list[float], list[int], int]:
    """Return the shortest path from a row to a free column.

    Returns
    -------
    path : list of int
        Row before each column.
    lengths : list of float
        Of the shortest path to each column.
    reached : list of int
        Columns to which no shorter path is possible, the last of them among them.
    end : int
        The free column.
    """
    path, lengths = [-1] * len(row_of), [math.inf] * len(row_of)
    remaining = list(range(len(row_of)))[::-1]
    reached: list[int] = []
    so_far = 0.0
    while True:
        place, least = -1, math.inf
        entries, price = costs[row], row_prices[row]
        for index, column in enumerate(remaining):
            length = so_far + entries[column] - price - column_prices[column]
            if length < lengths[column]:
                path[column], lengths[column] = row, length
            length = lengths[column]
            # Of equal paths one that ends is taken.
            if length < least or (length == least and row_of[column] < 0):
                place, least = index, length
        if least == math.inf:
            raise ValueError("a cost is infinite or not a number; give finite costs.")
        so_far, column = least, remaining[place]
        reached.append(column)
        if row_of[column] < 0:
            return path, lengths, reached, column
        row = row_of[column]
        last = remaining.pop()
        if place < len(remaining):
            remaining[place] = last
