"""Which methods a study compares: those it names, and every other one of the stage."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from sonar_tracking.method_registry import MethodEntry


def compared_methods(entries: Iterable[MethodEntry], named: Mapping[str, str]) -> dict[str, str]:
    """Return the name of the method behind each system of a study.

    Parameters
    ----------
    entries : iterable of MethodEntry
        Methods that can be compared: a registry, or part of it.
    named : mapping of str to str
        Methods by the names the study has for its systems, in the order of its tables.

    Returns
    -------
    dict of str to str
        After the named ones the others, under their labels: a method that is registered is
        compared from then on.
    """
    known = set(named.values())
    return {**named, **{entry.label: entry.name for entry in entries if entry.name not in known}}
