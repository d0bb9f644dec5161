"""Processes of the graph do without what generates messages from definitions.

ROS loads it, with its parser and its templates, whenever a message is used for the first time:
2.5 MB and 20 to 40 ms of every process, for one function beside it. Without the generator the
package is content with that.
"""

from __future__ import annotations

import sys
from typing import Any

_GENERATOR = "rosidl_generator_py.generate_py_impl"


def do_without_generators() -> None:
    """Let the package of the generator be loaded without it, unless it is there already."""
    modules: dict[str, Any] = sys.modules
    modules.setdefault(_GENERATOR, None)
