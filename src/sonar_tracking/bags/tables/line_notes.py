"""What is said of the lines of a file: one sentence a kind, however many lines it is about."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

NAMED_LINES = 3
"""Lines of one kind that are named; the others are counted."""


@dataclass
class _Kind:
    rows: list[int] = field(default_factory=list)
    example: str = ""


class LineNotes:
    """Sentences about a file and its lines, those of one kind counted.

    Parameters
    ----------
    path : Path
        The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._sentences: dict[str, _Kind] = {}

    def say(self, sentence: str) -> None:
        """Note a sentence about the file as a whole."""
        self._sentences.setdefault(sentence, _Kind())

    def line(self, row: int, sentence: str, example: str = "") -> None:
        """Note what is wrong with a line.

        Parameters
        ----------
        row : int
            Its number in the file.
        sentence : str
            Without the final stop, the same for all lines of the kind; ``{}`` = the example.
        example : str
            What the line has there.
        """
        kind = self._sentences.setdefault(sentence, _Kind(example=example))
        kind.rows.append(row)

    def lines(self, rows: Iterable[int], sentence: str) -> None:
        """Note the same of several lines."""
        for row in rows:
            self.line(int(row), sentence)

    def sentences(self) -> list[str]:
        """Return one sentence a kind, in the order in which they were first noted."""
        return [self._text(sentence, kind) for sentence, kind in self._sentences.items()]

    def _text(self, sentence: str, kind: _Kind) -> str:
        if not kind.rows:
            return f"{self.path}: {sentence}"
        several = len(kind.rows) > 1
        example = f"{kind.example} (in the first of them)" if several else kind.example
        return f"{self._places(kind.rows)}: {sentence.replace('{}', example)}."

    def _places(self, rows: list[int]) -> str:
        if len(rows) == 1:
            return place(self.path, rows[0])
        word = "entries" if self.path.suffix == ".npz" else "lines"
        if len(rows) > NAMED_LINES:
            named = ", ".join(map(str, rows[:NAMED_LINES]))
            return f"{self.path}, {word} {named} and {len(rows) - NAMED_LINES} more"
        return f"{self.path}, {word} {', '.join(map(str, rows[:-1]))} and {rows[-1]}"


def place(path: Path, row: int) -> str:
    """Return how a person finds a line of a CSV file, or an entry of an npz file."""
    return f"{path}, {'entry' if path.suffix == '.npz' else 'line'} {row}"
