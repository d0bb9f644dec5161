"""The command line: from the commands themselves."""

from __future__ import annotations

import inspect
from typing import Any

from docs.reference_writer.tables import table
from sonar_tracking.cli import app


def commands() -> dict[str, Any]:
    """Return every command by its words, e.g. ``import wav``."""
    import typer

    found: dict[str, Any] = {}

    def collect(group: Any, words: str) -> None:
        for name, command in group.commands.items():
            if hasattr(command, "commands"):
                if command.invoke_without_command:
                    found[f"{words}{name}"] = command
                collect(command, f"{words}{name} ")
            else:
                found[f"{words}{name}"] = command

    collect(typer.main.get_command(app), "")
    return found


def command_line() -> str:
    """Return one section a command."""
    return "\n\n".join(_command(words, command) for words, command in commands().items())


def _command(words: str, command: Any) -> str:
    rows = []
    for entry in command.params:
        is_option = entry.param_type_name == "option"
        name = ", ".join(entry.opts) if is_option else entry.name
        if name == "--help":
            continue
        default = entry.default
        if entry.required:
            default = "must be given"
        elif isinstance(default, bool) or default is None:
            default = ""
        else:
            default = f"`{default}`"
        rows.append((f"`{name}`", default, entry.help or ""))
    about = inspect.cleandoc(command.help or "")
    return f"## sonar-tracking {words}\n\n{about}\n\n{table(('', 'default', 'is'), rows)}"
