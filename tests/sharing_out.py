"""How tests are shared out among processes.

``./scripts/test.sh`` runs workers of pytest-xdist on all processors. A file of tests stays with one
worker, since its tests share fixtures; where they share none, long tests are shared out singly.
"""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from xdist.scheduler import LoadScopeScheduling
    from xdist.workermanage import WorkerController

TOGETHER = {
    "tests/display/": "pictures",  # what draws takes long to import
    "tests/evaluation/offline/test_smoothed_bag.py": "smoothing",
    "tests/tma/tracker/test_track_smoothing.py": "smoothing",
    "tests/test_docstrings.py": "source",
    "tests/test_layers.py": "source",
    "tests/test_sizes.py": "source",
}
"""Files that stay with one worker as if they were one, by how they begin."""
PATIENCE = 10.0
"""Longest wait for the end of a worker that is gone, s."""

SHARED_OUT_SINGLY = ("tests/system/", "tests/docs/test_tutorials.py", "tests/regression/")


def scope(nodeid: str) -> str:
    """Return the name of all that one worker gets at once with a test."""
    file = nodeid.partition("::")[0]
    if file.startswith(SHARED_OUT_SINGLY):
        return nodeid
    return next((name for start, name in TOGETHER.items() if file.startswith(start)), file)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> LoadScopeScheduling:
    """Return what hands out the tests: whole files, but long tests singly."""
    from xdist.scheduler import LoadScopeScheduling

    class FilesAndSingleTests(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return scope(nodeid)

        def _reschedule(self, node: WorkerController) -> None:
            """Give a worker work until it has two tests: it begins one when it knows the next.

            That of LoadScopeScheduling gives one unit. One that takes the place of a worker that
            has crashed may then have a single test, and all would wait for it for good.
            """
            # One that has just crashed takes nothing: its end is the next that is heard of it, and
            # what it was given goes to others.
            with contextlib.suppress(OSError):
                super()._reschedule(node)
                while not node.shutting_down and self._pending_of(self.assigned_work[node]) < 2:
                    super()._reschedule(node)

    config.option.loadscopereorder = False  # the order of the tests is meant as it is
    return FilesAndSingleTests(config, log)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: WorkerController, error: object) -> None:
    """Say how a worker that is gone has ended: a minus and the signal that killed it, or a code."""
    if error:
        print(f"\n{node.gateway.id} has ended with {node.gateway._io.popen.wait(PATIENCE)}")
