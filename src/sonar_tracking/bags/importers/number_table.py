"""Columns of numbers from a CSV file with a header, or from the arrays of an npz file.

A line that cannot be read is left out and named, an unknown column is named; columns that
are missing refuse the whole file.
"""

from __future__ import annotations

import csv
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.errors import ConfigurationError, unknown_name_text
from sonar_tracking.records.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class NumberTable:
    """Columns of equal length.

    Attributes
    ----------
    path : Path
        Where they come from.
    numbers : mapping of str to ndarray, shape (n_rows,)
        Columns by name, in units of the file; an empty cell, or an infinite one, is NaN.
    names : mapping of str to tuple of str
        Columns of names instead of numbers.
    rows : ndarray of int, shape (n_rows,)
        Line of each row in the file, from 1; in an npz file the index, from 0.
    bad : tuple of str
        A sentence for each line that was left out and each column not used.
    """

    path: Path
    numbers: Mapping[str, FloatArray]
    names: Mapping[str, tuple[str, ...]]
    rows: IntArray
    bad: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.rows)

    def place(self, index: int) -> str:
        """Return how a person finds a row of the table."""
        return place(self.path, int(self.rows[index]))

    def column(self, name: str) -> FloatArray:
        """Return a column, shape (n_rows,), in units of the file; all NaN where there is none."""
        return self.numbers.get(name, np.full(len(self), np.nan))


def place(path: Path, row: int) -> str:
    """Return how a person finds a line of a CSV file, or an entry of an npz file."""
    return f"{path}, {'entry' if path.suffix == '.npz' else 'line'} {row}"


def read_number_table(
    path: Path | str,
    required: Sequence[str],
    optional: Sequence[str] = (),
    names: Sequence[str] = (),
) -> NumberTable:
    """Read a table.

    Parameters
    ----------
    path : Path or str
        ``.npz`` is read as arrays, everything else as CSV.
    required, optional : sequence of str
        Columns of numbers.
    names : sequence of str
        Those of the required columns that hold names.

    Raises
    ------
    ConfigurationError
        If the file cannot be read, lacks a column, or has one twice.
    """
    path = Path(path)
    known = (*required, *optional)
    try:
        if path.suffix == ".npz":
            cells, rows, bad = _npz_cells(path)
        else:
            cells, rows, bad = _csv_cells(path)
    except (OSError, ValueError, zipfile.BadZipFile, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise ConfigurationError(f"The file {path} cannot be read ({reason}).") from error
    missing = [name for name in required if name not in cells]
    if missing:
        raise ConfigurationError(
            f"The file {path} has no column {', '.join(missing)}; it has "
            f"{', '.join(cells) or 'none'} and needs {', '.join(required)}."
        )
    for name in [name for name in cells if name not in known]:
        bad.append(f"{path}: {unknown_name_text(f'column {name}', name, known)} It is not used.")
        del cells[name]
    return _as_numbers(path, cells, rows, bad, names)


def _csv_cells(path: Path) -> tuple[dict[str, list[str]], list[int], list[str]]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        reader = csv.reader(file)
        header = [name.strip() for name in next(reader, [])]
        twice = [name for name in header if header.count(name) > 1]
        if twice:
            raise ValueError(f"it has the column {twice[0]} twice")
        lines: list[list[str]] = []
        rows, bad = [], []
        for line in reader:
            if not any(cell.strip() for cell in line):
                continue
            if len(line) == len(header):
                lines.append([cell.strip() for cell in line])
                rows.append(reader.line_num)
            else:
                where = place(path, reader.line_num)
                bad.append(f"{where}: {len(line)} values under {len(header)} headings.")
    columns: dict[str, list[str]] = {name: [] for name in header}
    for line in lines:
        for name, cell in zip(header, line, strict=True):
            columns[name].append(cell)
    return columns, rows, bad


def _npz_cells(path: Path) -> tuple[dict[str, list[str]], list[int], list[str]]:
    with np.load(path, allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    lengths = {name: array.shape for name, array in arrays.items()}
    if len(set(lengths.values())) > 1 or any(len(shape) != 1 for shape in lengths.values()):
        told = ", ".join(f"{name} {shape}" for name, shape in lengths.items())
        raise ValueError(f"its arrays must have one dimension and one length, not {told}")
    # repr of a float is exact, and one path for cells serves both kinds of files.
    cells = {name: [str(value) for value in array.tolist()] for name, array in arrays.items()}
    count = len(next(iter(cells.values()), []))
    return cells, list(range(count)), []


def _as_numbers(
    path: Path,
    cells: Mapping[str, list[str]],
    rows: list[int],
    bad: list[str],
    names: Sequence[str],
) -> NumberTable:
    numbers = {name: np.empty(len(rows)) for name in cells if name not in names}
    good = np.ones(len(rows), dtype=bool)
    bad_rows = []
    for index, row in enumerate(rows):
        for name, column in numbers.items():
            try:
                column[index] = float(cells[name][index] or "nan")
            except ValueError:
                good[index] = False
                sentence = f"{place(path, row)}: {name} is {cells[name][index]!r}, not a number."
                bad_rows.append(sentence)
                break
    kept = np.flatnonzero(good)
    return NumberTable(
        path=path,
        numbers={n: np.where(np.isfinite(c), c, np.nan)[kept] for n, c in numbers.items()},
        names={name: tuple(cells[name][i] for i in kept) for name in names},
        rows=np.array(rows, dtype=np.int64)[kept],
        bad=(*bad, *bad_rows),
    )
