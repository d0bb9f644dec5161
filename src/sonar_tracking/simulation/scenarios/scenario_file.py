"""Scenario files: where they are and what their YAML says, without its meaning."""

from __future__ import annotations

from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from sonar_tracking.errors import ConfigurationError, unknown_name_text
from sonar_tracking.resources import find_resource
from sonar_tracking.yaml_reading import read_yaml

SCENARIO_FOLDER = "config/scenarios"


class _Strict(yaml.constructor.SafeConstructor):
    """Builds plain values, but a key given twice in one mapping is an error."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if isinstance(key, Hashable):
                if key in seen:
                    raise yaml.constructor.ConstructorError(
                        None, None, f"{key} is given twice", key_node.start_mark
                    )
                seen.add(key)
        return super().construct_mapping(node, deep=deep)


def scenario_names() -> list[str]:
    """Return the names of the scenarios that come with the package."""
    return sorted(path.stem for path in find_resource(SCENARIO_FOLDER).glob("*.yaml"))


def find_scenario(name_or_path: str | Path) -> Path:
    """Return the file of a scenario.

    Parameters
    ----------
    name_or_path : str or Path
        Name of a scenario of the package, or path of a YAML file.

    Raises
    ------
    ConfigurationError
        If there is none; the nearest known name is suggested.
    """
    path = Path(name_or_path)
    if path.is_file():
        return path
    if path.suffix in (".yaml", ".yml") or len(path.parts) > 1:
        raise ConfigurationError(
            f"The scenario file {path} does not exist; give the path of a YAML file or the name of "
            f"a scenario: {', '.join(scenario_names())}."
        )
    names = scenario_names()
    if path.name not in names:
        raise ConfigurationError(unknown_name_text(f"The scenario {path.name}", path.name, names))
    return find_resource(SCENARIO_FOLDER) / f"{path.name}.yaml"


def read_yaml_mapping(path: Path) -> dict[str, Any]:
    """Return what a YAML file says.

    Raises
    ------
    ConfigurationError
        If it cannot be read, is no YAML (file and line are named), or holds no mapping.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no UTF-8 text"
        raise ConfigurationError(f"The file {path} cannot be read: {reason}.") from error
    try:
        content = read_yaml(text, _Strict)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f", line {mark.line + 1}" if mark else ""
        raise ConfigurationError(
            f"{path}{line}: this is not valid YAML: {error.problem or error.context}."
        ) from error
    except yaml.reader.ReaderError as error:
        line_number = text.count("\n", 0, error.position) + 1
        raise ConfigurationError(
            f"{path}, line {line_number}: this is not valid YAML: {error.reason}."
        ) from error
    except RecursionError:
        raise ConfigurationError(f"{path}: this is not valid YAML: nested too deeply.") from None
    except (ValueError, TypeError, LookupError, ArithmeticError) as error:
        # Of a value that looks like a date, a number or a key, and is none.
        raise ConfigurationError(f"{path}: this is not valid YAML: {error}.") from error
    if not isinstance(content, dict):
        raise ConfigurationError(
            f"{path}: this must be a mapping of names to values, e.g. 'duration: 40'."
        )
    return content
