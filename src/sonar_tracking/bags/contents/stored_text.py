"""YAML and JSON that stand in a bag: read within bounds, whoever wrote them.

What is nested too deeply, too long, or made to grow when it is read is refused, not followed.
"""

from __future__ import annotations

import json
from typing import Any

import yaml

from sonar_tracking.yaml_reading import DUMPER, read_yaml

LARGEST_YAML = 1 << 20
LARGEST_JSON = 16 << 20
"""Most characters of a text; YAML takes seconds for a million."""


class StoredTextError(ValueError):
    """A text cannot be read; the error says why."""


class _WithoutMerging(yaml.constructor.SafeConstructor):
    """Builds plain values, without merge keys: a few lines of them grow without bound."""

    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        """Leave merge keys to the constructor, which knows none."""


def yaml_value(text: str) -> Any:
    """Return what a text of YAML says.

    Raises
    ------
    StoredTextError
        If it cannot be read.
    """
    if len(text) > LARGEST_YAML:
        raise StoredTextError(f"it has {len(text)} characters, more than {LARGEST_YAML}")
    try:
        return read_yaml(text, _WithoutMerging)
    except RecursionError:
        raise StoredTextError("it is nested too deeply") from None
    except (yaml.YAMLError, ValueError, TypeError, LookupError, ArithmeticError) as error:
        raise StoredTextError(_one_line(error)) from error


def yaml_text(value: object) -> str:
    """Return a value as YAML, its names in their order."""
    text: str = yaml.dump(value, Dumper=DUMPER, sort_keys=False)
    return text


def json_value(text: str) -> Any:
    """Return what a text of JSON says.

    Raises
    ------
    StoredTextError
        If it cannot be read.
    """
    if len(text) > LARGEST_JSON:
        raise StoredTextError(f"it has {len(text)} characters, more than {LARGEST_JSON}")
    try:
        return json.loads(text)
    except RecursionError:
        raise StoredTextError("it is nested too deeply") from None
    except ValueError as error:
        raise StoredTextError(_one_line(error)) from error


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:200]
