"""Which tests are of which kind, and how they are shared out among processes.

``./scripts/test.sh`` runs workers of pytest-xdist on all processors. A file of tests stays with one
worker, since its tests share fixtures; where they share none, long tests are shared out singly. The
long ones come first, so that all workers end at about the same time: those that compute among those
with processes, which wait for one another now and then and leave the processors to others.
"""

from __future__ import annotations

import gc
import os
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import HealthCheck, settings

from sonar_tracking.one_thread import ONE_THREAD
from tests.without_ros import (  # noqa: F401  (hooks)
    pytest_make_collect_report,
    pytest_runtest_makereport,
)

if TYPE_CHECKING:
    from xdist.scheduler import LoadScopeScheduling

for _variable, _value in ONE_THREAD.items():
    os.environ.setdefault(_variable, _value)  # as in the nodes; the workers share the processors
os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")

# How long something takes is never asserted: machines may be busy.
settings.register_profile(
    "busy_machine", deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("busy_machine")

MARKS = {
    "tests/system/": pytest.mark.system,
    "tests/docs/test_tutorials.py": pytest.mark.system,
    "tests/docs/test_build.py": pytest.mark.slow,
    "tests/graph/nodes/": pytest.mark.graph,
    "tests/evaluation/offline/": pytest.mark.slow,
    "tests/evaluation/studies/": pytest.mark.slow,
}
"""Marks of all tests below a directory; single files and tests carry theirs themselves."""

LONG = ({"system", "graph"}, {"slow"})
"""Marks of the tests that come first, of both kinds in turn."""
TOGETHER = {
    "tests/display/": "pictures",  # what draws takes long to import
    "tests/test_docstrings.py": "source",
    "tests/test_layers.py": "source",
    "tests/test_sizes.py": "source",
}
"""Files that stay with one worker as if they were one, by how they begin."""
SHARED_OUT_SINGLY = ("tests/system/", "tests/docs/test_tutorials.py", "tests/regression/")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark tests by their directory, and let workers begin with the long ones."""
    for item in items:
        for directory, mark in MARKS.items():
            if item.nodeid.startswith(directory):
                item.add_marker(mark)
    if hasattr(config, "workerinput"):
        _put_long_ones_first(items)


def pytest_collection_finish() -> None:
    """Let the collector of garbage look seldom, and not at what has been imported: it stays."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(10_000, 20, 20)


def _put_long_ones_first(items: list[pytest.Item]) -> None:
    """Let what one worker gets at once stay together, and both kinds of long ones end together."""
    kinds: dict[str, int] = {}
    for item in items:
        marks = {mark.name for mark in item.iter_markers()}
        kind = next((number for number, names in enumerate(LONG) if names & marks), len(LONG))
        kinds[_scope(item.nodeid)] = min(kind, kinds.get(_scope(item.nodeid), kind))
    places: dict[str, float] = {}
    for kind in range(len(LONG) + 1):
        scopes = [scope for scope, own in kinds.items() if own == kind]
        last = float(kind == len(LONG))
        places |= {scope: last + number / len(scopes) for number, scope in enumerate(scopes)}
    items.sort(key=lambda item: places[_scope(item.nodeid)])


def _scope(nodeid: str) -> str:
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
            return _scope(nodeid)

    config.option.loadscopereorder = False  # the order of the tests is meant as it is
    return FilesAndSingleTests(config, log)
