"""Errors and notices of the package: sentences that name the culprit and the remedy."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum


class SonarTrackingError(Exception):
    """Base of all errors a user may see as one sentence, without a traceback."""


class ConfigurationError(SonarTrackingError):
    """A parameter, scenario or file given by the user cannot be used as it is."""


class InputError(SonarTrackingError):
    """One input datum cannot be used; the receiver rejects it and lives on."""


class Severity(IntEnum):
    """Severity of a notice; the values are those of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2


@dataclass(frozen=True)
class Notice:
    """Something a user should know about the data that were nevertheless used.

    Attributes
    ----------
    severity : Severity
        How bad it is.
    culprit : str
        What it is about, e.g. ``"element 3"``; one status line per culprit.
    text : str
        One sentence: what is wrong and what to do.
    """

    severity: Severity
    culprit: str
    text: str


LONGEST_TEXT = 64
"""Characters of a text of a message that are shown."""

LONGEST_SENTENCE = 1000
"""The same of a whole sentence of somebody else."""


def shown(text: str, longest: int = LONGEST_TEXT) -> str:
    r"""Return a text of a message as it may stand in a sentence: escaped, and shortened.

    A terminal obeys some characters, and others change the order of what it shows: a name could
    forge lines of its own.

    Parameters
    ----------
    text : str
        E.g. a frame, or the name of a sensor.
    longest : int
        Characters of it, of which the rest is left out.

    Examples
    --------
    >>> shown("bow\x1b[2J")
    'bow\\x1b[2J'
    """
    kept = text if len(text) <= longest else text[:longest] + "..."
    return "".join(
        each if each.isprintable() else each.encode("unicode_escape").decode() for each in kept
    )


def unknown_name_text(full_name: str, name: str, known: Iterable[str]) -> str:
    """Return the sentence for a name that is not known, with the nearest known one.

    Parameters
    ----------
    full_name : str
        The name and where it was given, e.g. ``"nodes.bearing_tracker.methd"``.
    name : str
        The name itself.
    known : iterable of str
        Names that are known.
    """
    names = sorted(known)
    near = difflib.get_close_matches(str(name), names, n=1)
    hint = f"did you mean {near[0]}?" if near else f"known are {', '.join(names)}."
    return f"{full_name} is not known; {hint}"
