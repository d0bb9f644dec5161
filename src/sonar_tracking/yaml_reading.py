"""Reading and writing of YAML: by libyaml where it is there, which takes a fifth of the time.

What libyaml cannot read, or what may be nested deeper than its binding has room for, PyYAML reads
itself: it has a sentence for everything, and its depth is limited.
"""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from typing import Any

import yaml

DUMPER: type[Any] = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
"""For ``yaml.dump``: it writes what ``yaml.safe_dump`` does."""

DEEPEST = 1000
"""The binding of libyaml goes down one call a level, and ends the process where there are many."""

_REFUSED = (yaml.YAMLError, ValueError, TypeError, LookupError, ArithmeticError, RecursionError)


def read_yaml(text: str, constructor: type) -> Any:
    """Return what a text of YAML says.

    Parameters
    ----------
    text : str
        The text.
    constructor : type
        Methods that replace those of ``yaml.SafeLoader``.

    Raises
    ------
    yaml.YAMLError, ValueError, TypeError, LookupError, ArithmeticError, RecursionError
        What PyYAML raises where it cannot be read.
    """
    compiled: type | None = getattr(yaml, "CSafeLoader", None)
    if compiled and _deepest(text) <= DEEPEST:
        with suppress(*_REFUSED):
            return yaml.load(text, _loader(constructor, compiled))
    return yaml.load(text, _loader(constructor, yaml.SafeLoader))


@cache
def _loader(constructor: type, base: type) -> type:
    return type(constructor.__name__, (constructor, base), {})


def _deepest(text: str) -> int:
    """Return a number of levels that a text cannot exceed: brackets, and places in a line."""
    brackets = text.count("[") + text.count("{")
    return brackets + max(map(len, text.splitlines()), default=0)
