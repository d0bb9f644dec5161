"""Which tests are of which kind, and in which order they are run.

The long ones come first, so that all workers end at about the same time: those that compute among
those with processes, which wait for one another now and then and leave the processors to others.
"""

from __future__ import annotations

import gc
import os

import pytest
from hypothesis import HealthCheck, settings

from sonar_tracking.one_thread import ONE_THREAD
from tests.hanging import pytest_configure  # noqa: F401  (hook)
from tests.left_open import pytest_runtest_teardown  # noqa: F401  (hook)
from tests.sharing_out import (  # noqa: F401  (hooks)
    pytest_testnodedown,
    pytest_xdist_make_scheduler,
    scope,
)
from tests.without_ros import (  # noqa: F401  (hooks)
    pytest_make_collect_report,
    pytest_runtest_makereport,
)

gc.disable()  # until all tests are found: what is loaded meanwhile stays
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
    "tests/display/page/test_axes_in_browser.py": pytest.mark.slow,
    "tests/display/page/test_operating_in_browser.py": pytest.mark.slow,
    "tests/display/page/test_page_in_browser.py": pytest.mark.slow,
    "tests/display/page/test_waterfalls_in_browser.py": pytest.mark.slow,
    "tests/docs/test_build.py": pytest.mark.slow,
    "tests/graph/nodes/": pytest.mark.graph,
    "tests/evaluation/offline/": pytest.mark.slow,
    "tests/evaluation/studies/": pytest.mark.slow,
}
"""Marks of all tests below a directory; single files and tests carry theirs themselves."""

LONG = ({"system", "graph"}, {"slow"})
"""Marks of the tests that come first, of both kinds in turn."""


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
    gc.enable()


def _put_long_ones_first(items: list[pytest.Item]) -> None:
    """Let what one worker gets at once stay together, and both kinds of long ones end together."""
    kinds: dict[str, int] = {}
    for item in items:
        marks = {mark.name for mark in item.iter_markers()}
        kind = next((number for number, names in enumerate(LONG) if names & marks), len(LONG))
        kinds[scope(item.nodeid)] = min(kind, kinds.get(scope(item.nodeid), kind))
    places: dict[str, float] = {}
    for kind in range(len(LONG) + 1):
        scopes = [scope for scope, own in kinds.items() if own == kind]
        last = float(kind == len(LONG))
        places |= {scope: last + number / len(scopes) for number, scope in enumerate(scopes)}
    items.sort(key=lambda item: places[scope(item.nodeid)])
