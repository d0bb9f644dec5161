"""State of a tracker on disk, so that a process in the place of a killed one goes on with it.

A checkpoint is a file in the directory of a run, written and read by the nodes of that run only,
and by the same version only. It is replaced as a whole: a node killed while it writes leaves the
one before.
"""

from __future__ import annotations

import os
import pickle
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import sonar_tracking
from sonar_tracking.errors import Severity
from sonar_tracking.graph.catalogue.resumption import CHECKPOINT
from sonar_tracking.graph.catalogue.run_identity import VARIABLE as RUN
from sonar_tracking.records.time import NANOSECONDS, UNKNOWN_STAMP

SHARE = 0.02
"""Of the time of a node that checkpoints may take."""

LEAST_PAUSE = 0.1
"""Between two of them, s of the wall clock: slow data have one after every datum."""

LONGEST_GAP = 60 * NANOSECONDS
"""Of data, after which tracks are not taken up again, ns."""


class Checkpoint:
    """The checkpoint of one node; without a path it does nothing.

    Parameters
    ----------
    state : callable
        Returns the state of the node; None = there is nothing to keep.
    take_state : callable
        Lets the node go on with a state.
    report : callable
        Told, as a concern of the node, if a checkpoint cannot be written.
    """

    def __init__(
        self,
        state: Callable[[], Any],
        take_state: Callable[[Any], None],
        report: Callable[[str, str, Severity, str], None],
    ) -> None:
        self._state, self._take_state, self._report = state, take_state, report
        self._begun = False
        path = os.environ.get(CHECKPOINT, "")
        self._path = Path(path) if path else None
        self._head = (sonar_tracking.__version__, os.environ.get(RUN, ""))
        self._due = 0.0

    def take_up(self, stamp: int) -> int:
        """Let the node go on, with its first data, with what the process before has left.

        Returns
        -------
        int
            Stamp up to which that holds all data, ns; 0 = nothing was taken up now.
        """
        if self._begun:
            return UNKNOWN_STAMP
        self._begun = True
        written, state = self._read(stamp)
        if state is not None:
            self._take_state(state)
        return written

    def keep(self, stamp: int) -> None:
        """Write the state after the data up to a stamp, ns, unless the last time was too costly."""
        begin = time.monotonic()
        if self._path is None or begin < self._due:
            return
        state = self._state()
        if state is None:
            return
        temporary = self._path.with_suffix(".part")
        try:
            temporary.write_bytes(pickle.dumps((*self._head, stamp, state)))
            temporary.replace(self._path)
        except OSError as error:
            sentence = f"the checkpoint cannot be written ({error}); restarted, tracks begin anew."
            self._report("checkpoint", "write", Severity.WARN, sentence)
        end = time.monotonic()
        self._due = end + max((end - begin) / SHARE, LEAST_PAUSE)

    def _read(self, stamp: int) -> tuple[int, Any]:
        """Return the state to go on with at a stamp, ns, and its own; None = there is none."""
        if self._path is None or not self._path.exists():
            return UNKNOWN_STAMP, None
        try:
            version, run, written, state = pickle.loads(self._path.read_bytes())
        except Exception:  # whatever is wrong with it, the node begins anew
            return UNKNOWN_STAMP, None
        if (version, run) != self._head or not 0 < stamp - written <= LONGEST_GAP:
            return UNKNOWN_STAMP, None
        return written, state
