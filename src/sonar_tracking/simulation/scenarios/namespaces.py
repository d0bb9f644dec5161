"""Namespaces of what a scenario has several of."""

from __future__ import annotations

import re

from sonar_tracking.errors import ConfigurationError

_NAMESPACE = re.compile(r"[A-Za-z][A-Za-z0-9_]*(/[A-Za-z][A-Za-z0-9_]*)*")


def check_namespace(namespace: str, where: str) -> None:
    """Refuse what cannot stand before the name of a topic.

    Raises
    ------
    ConfigurationError
        Naming the value, ``where`` and what to do.
    """
    if not _NAMESPACE.fullmatch(namespace):
        raise ConfigurationError(
            f"{where}.namespace is {namespace!r}; it must be made of letters, digits "
            "and underscores, e.g. station_2."
        )
