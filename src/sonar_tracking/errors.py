"""Errors and notices of the package: sentences that name the culprit and the remedy."""

from __future__ import annotations

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
