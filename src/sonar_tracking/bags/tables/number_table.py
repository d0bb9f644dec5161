"""Columns of numbers from a CSV file with a header, or from the arrays of an npz file.

A line that cannot be read is left out and named, an unknown column is named; columns that
are missing refuse the whole file. Cells of a CSV file stand between commas, semicolons, tabs or
blanks, as its first line shows; between all but the first a decimal comma is read too. Headings,
times and angles may be written in the ways of
:mod:`sonar_tracking.bags.tables.table_headings`.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.bags.tables.line_notes import LineNotes, place
from sonar_tracking.bags.tables.npz_file import read_npz
from sonar_tracking.bags.tables.table_headings import canonical_columns, number_in
from sonar_tracking.bags.tables.written_angles import written_angle
from sonar_tracking.errors import ConfigurationError, shown, unknown_name_text
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray

EMPTY = frozenset(("", "-", "na", "n/a", "nan", "null", "none"))
"""Cells that say nothing, in small letters."""

_NUMERIC = re.compile(r"[\d\s.,:+\-°'′’\"″”NSEWe]+", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)|^,(?=\d)")

_Cells = tuple[dict[str, list[str]], list[int]]


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
    notes : LineNotes
        What was said of lines that were left out and columns not used; who uses the table adds
        to it.
    """

    path: Path
    numbers: Mapping[str, FloatArray]
    names: Mapping[str, tuple[str, ...]]
    rows: IntArray
    notes: LineNotes

    def __len__(self) -> int:
        return len(self.rows)

    def place(self, index: int) -> str:
        """Return how a person finds a row of the table."""
        return place(self.path, int(self.rows[index]))

    def column(self, name: str) -> FloatArray:
        """Return a column, shape (n_rows,), in units of the file; all NaN where there is none."""
        return self.numbers.get(name, np.full(len(self), np.nan))

    def passing(self, checks: Mapping[str, BoolArray], among: BoolArray | None = None) -> BoolArray:
        """Return which rows pass all checks; of each other row the first that fails is noted.

        Parameters
        ----------
        checks : mapping of str to ndarray of bool, shape (n_rows,)
            By the sentence that says what is wrong with a row that does not pass.
        among : ndarray of bool, shape (n_rows,), optional
            Rows to look at; all if not given.

        Returns
        -------
        ndarray of bool, shape (n_rows,)
        """
        good = np.ones(len(self), dtype=bool) if among is None else among.copy()
        for sentence, passed in checks.items():
            self.notes.lines(self.rows[good & ~passed], sentence)
            good &= passed
        return good

    def nothing_usable(self) -> ConfigurationError:
        """Return the error that says that no line can be used, and why."""
        told = " ".join(self.notes.sentences()[:3])
        return ConfigurationError(f"The file {self.path} holds no usable line. {told}".strip())


def read_number_table(
    path: Path | str,
    required: Sequence[str],
    optional: Sequence[str] = (),
    names: Sequence[str] = (),
    spared: Sequence[str] = (),
) -> NumberTable:
    """Read a table.

    Parameters
    ----------
    path : Path or str
        ``.npz`` is read as arrays, everything else as CSV.
    required, optional : sequence of str
        Columns of numbers.
    names : sequence of str
        Those of the columns that hold names.
    spared : sequence of str
        Those of the optional columns whose unreadable cells count as empty: they do not cost the
        rest of their line.

    Raises
    ------
    ConfigurationError
        If the file cannot be read, lacks a column, or has one twice.
    """
    path = Path(path)
    known = (*required, *optional)
    notes = LineNotes(path)
    cells, rows = table_cells(path, notes)
    missing = [name for name in required if name not in cells]
    if missing:
        raise ConfigurationError(
            f"The file {path} has no column {', '.join(missing)}; it has "
            f"{', '.join(shown(name) for name in list(cells)[:20]) or 'none'} and needs "
            f"{', '.join(required)}."
        )
    for name in [name for name in cells if name not in known]:
        notes.say(f"{unknown_name_text(f'column {shown(name)}', name, known)} It is not used.")
        del cells[name]
    return _as_numbers(path, cells, rows, notes, names, spared)


def table_cells(path: Path, notes: LineNotes) -> _Cells:
    """Return the cells of each column as text, and the line of each row in the file.

    Parameters
    ----------
    path : Path
        CSV or npz.
    notes : LineNotes
        Told of the lines that do not fit under the headings.

    Raises
    ------
    ConfigurationError
        If it cannot be read.
    """
    if path.suffix == ".npz":
        cells, rows = _npz_cells(path)
        return canonical_columns(cells, notes), rows
    try:
        cells, rows = _csv_cells(path, notes)
        return canonical_columns(cells, notes), rows
    except (OSError, ValueError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise ConfigurationError(f"The file {path} cannot be read ({reason}).") from error


def _csv_cells(path: Path, notes: LineNotes) -> _Cells:
    text, skipped = _text_of_table(path, notes)
    delimiter = _delimiter(text.partition("\n")[0])
    reader = csv.reader(
        io.StringIO(text, newline=""), delimiter=delimiter, skipinitialspace=delimiter == " "
    )
    header = [name.strip() for name in next(reader, [])]
    twice = [name for name in header if header.count(name) > 1]
    if twice:
        raise ValueError(f"it has the column {shown(twice[0]) or 'without a name'} twice")
    if header and all(number_in(name) is not None for name in header):
        raise ValueError(
            "its first line holds numbers; write the names of the columns there, as time_s"
        )
    lines: list[list[str]] = []
    rows = []
    for line in reader:
        cells = [cell.strip() for cell in line]
        if cells[-1:] == [""] and len(cells) == len(header) + 1:
            cells.pop()  # a delimiter at the end
        if not any(cells):
            continue
        if cells[0].startswith("#"):
            notes.line(reader.line_num + skipped, "it begins with # and is taken for a comment")
            continue
        if len(cells) == len(header):
            lines.append(cells)
            rows.append(reader.line_num + skipped)
        else:
            sentence = f"{{}} values under {len(header)} headings"
            notes.line(reader.line_num + skipped, sentence, str(len(cells)))
    if delimiter != ",":
        lines = [[_with_point(cell) for cell in line] for line in lines]
    columns = {name: [line[place] for line in lines] for place, name in enumerate(header)}
    return columns, rows


def _with_point(cell: str) -> str:
    """Return a cell with a point for the comma of a number, or of an angle."""
    if "," not in cell or not _NUMERIC.fullmatch(cell):
        return cell
    return _DECIMAL_COMMA.sub(".", cell)


def _text_of_table(path: Path, notes: LineNotes) -> tuple[str, int]:
    """Return the text from the headings on, and how many lines are ahead of them."""
    data = path.read_bytes()
    encoding = "utf-16" if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE) else "utf-8-sig"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
        notes.say("the file is no UTF-8; it is read as Windows text (cp1252).")
    lines = text.splitlines(keepends=True)
    ahead = 0
    while ahead < len(lines) and (not lines[ahead].strip() or lines[ahead][:4].lower() == "sep="):
        ahead += 1
    while ahead < len(lines) and lines[ahead].startswith("#"):
        following = "".join(lines[ahead + 1 : ahead + 2]).lstrip()
        if following and (following[0].isdecimal() or following[0] in "-+."):
            lines[ahead] = lines[ahead].lstrip("# ")  # headings behind the sign of a comment
            break
        ahead += 1
    return "".join(lines[ahead:]), ahead


def _delimiter(header: str) -> str:
    """Return what stands between the headings; a comma where nothing else does."""
    found = max(",;\t", key=lambda delimiter: (header.count(delimiter), delimiter == ","))
    blanks = len(header.split()) > 1 and not header.count(found) and "(" not in header
    return " " if blanks and "[" not in header else found


def _npz_cells(path: Path) -> _Cells:
    arrays = read_npz(path)
    lengths = {name: array.shape for name, array in arrays.items()}
    if len(set(lengths.values())) > 1 or any(len(shape) != 1 for shape in lengths.values()):
        told = ", ".join(f"{shown(name)} {shape}" for name, shape in list(lengths.items())[:20])
        raise ConfigurationError(
            f"The file {path} cannot be read (its arrays must have one dimension and one length, "
            f"not {told}); write one array a column, as numpy.savez(FILE, time_s=..., range_m=..., "
            "bearing_deg=...)."
        )
    # repr of a float is exact, and one path for cells serves both kinds of files.
    cells = {name: [str(value) for value in array.tolist()] for name, array in arrays.items()}
    count = len(next(iter(cells.values()), []))
    return cells, list(range(count))


def _value(name: str, cell: str) -> float | None:
    """Return a cell as a number; None = it is none."""
    number = number_in(cell)
    if number is not None:
        return number
    if name.endswith("latitude_deg"):
        return written_angle(cell, "NS")
    return written_angle(cell, "EW") if name.endswith("longitude_deg") else None


def _as_numbers(
    path: Path,
    cells: Mapping[str, list[str]],
    rows: list[int],
    notes: LineNotes,
    names: Sequence[str],
    spared: Sequence[str],
) -> NumberTable:
    numbers = {name: np.full(len(rows), np.nan) for name in cells if name not in names}
    good = np.ones(len(rows), dtype=bool)
    for name, column in numbers.items():
        for index, cell in enumerate(cells[name]):
            if not good[index] or cell.lower() in EMPTY:
                continue
            value = _value(name, cell)
            if value is not None:
                column[index] = value
            else:
                left = ", not a number; the cell is taken as empty"
                sentence = f"{name} is {{}}{left if name in spared else ', not a number'}"
                notes.line(rows[index], sentence, repr(shown(cell)))
                good[index] = name in spared
    kept = np.flatnonzero(good)
    return NumberTable(
        path=path,
        numbers={n: np.where(np.isfinite(c), c, np.nan)[kept] for n, c in numbers.items()},
        names={n: tuple(cells[n][i] for i in kept) for n in names if n in cells},
        rows=np.array(rows, dtype=np.int64)[kept],
        notes=notes,
    )
