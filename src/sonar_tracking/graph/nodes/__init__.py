"""The nodes: one file an executable, each a thin shell around a stage.

This file is the first that runs when one of them is started, as ``python -m`` or by its executable:
from here on a stop signal ends the start in order.
"""

import sys
from pathlib import Path

from sonar_tracking.stop_signals import end_at_once


def _is_started() -> bool:
    """Tell whether a node is the program, and not just imported by another."""
    program = Path(sys.argv[0] if sys.argv else "").name
    if program == "-m":
        # So it is called until Python has found the module, which comes after its package.
        return any(argument.startswith(f"{__name__}.") for argument in sys.orig_argv)
    return Path(__file__).with_name(f"{program}.py").is_file()


if _is_started():
    end_at_once()
