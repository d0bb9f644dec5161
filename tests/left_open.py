"""What a failed test has left open is closed before the tests of another file begin.

A participant that stays in the domain of a worker would fail every run of a graph in it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator

import pytest

_closing: list[Callable[[], None]] = []


def opened(close: Callable[[], None]) -> None:
    """Remember how something is closed that was opened."""
    _closing.append(close)


def closed(close: Callable[[], None]) -> None:
    """Forget something that has been closed."""
    _closing.remove(close)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(
    item: pytest.Item, nextitem: pytest.Item | None
) -> Generator[None, None, None]:
    """Close what is open after the last test of a file."""
    yield
    if nextitem is None or nextitem.path != item.path:
        for close in _closing.copy():
            close()
