"""Names made of the namespace of a station."""

from __future__ import annotations


def station_name(namespace: str) -> str:
    """Return a namespace as a part of a name.

    Examples
    --------
    >>> station_name("consort/bow")
    'consort_bow'
    """
    return namespace.replace("/", "_")
