"""Protects the exit code of what was stopped: it is the program's own, wherever the stop came."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

STOPPED_WHILE_A_TEXT_IS_EXECUTED = """
import signal, sys
from sonar_tracking.stop_signals import interruptible, never_end, stop_code
signal.signal(signal.SIGINT, signal.SIG_DFL)  # ignored where the tests run in the background
interruptible()
try:
    exec("signal.raise_signal(signal.SIGINT)")
except KeyboardInterrupt:
    pass
never_end()
sys.exit(stop_code())
"""


def test_a_stop_in_a_text_that_is_executed_leaves_the_exit_code_alone(tmp_path: Path) -> None:
    """A module, as nodes and ``python -m sonar_tracking`` are: a script would not be killed."""
    (tmp_path / "stopped.py").write_text(STOPPED_WHILE_A_TEXT_IS_EXECUTED)
    done = subprocess.run(
        [sys.executable, "-m", "stopped"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60.0,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")
