"""Which of several topics of one kind is own ship's: stations and other ships are further below."""

from __future__ import annotations

from collections.abc import Iterable


def outermost_topic(names: Iterable[str]) -> str:
    """Return the name with the fewest parts, the first of several; empty if there is none.

    Examples
    --------
    >>> outermost_topic(["/consort/own_ship/odometry", "/own_ship/odometry"])
    '/own_ship/odometry'
    """
    return min(names, key=lambda name: name.count("/"), default="")


def station_of(topic: str) -> str:
    """Return what stands before the last two parts of a name, without slashes.

    Examples
    --------
    >>> station_of("/consort/active/contacts")
    'consort'
    """
    return topic.rsplit("/", 2)[0].strip("/")
