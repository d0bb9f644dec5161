"""Tests where ROS 2 is not installed, as in the environment of ``./scripts/test.sh --quick``.

What turns out to need a package of ROS is skipped: a file that imports one, a test that asks for
one while it runs. Where ROS is installed nothing is skipped.
"""

from __future__ import annotations

from collections.abc import Generator
from importlib.util import find_spec
from pathlib import Path
from xml.etree.ElementTree import parse

import pytest

WITHOUT_ROS = find_spec("rclpy") is None
PROJECT = Path(__file__).resolve().parents[1]
ROS_PACKAGES = {
    "ament_index_python",
    *(entry.text for entry in parse(PROJECT / "package.xml").findall("exec_depend")),
}
REASON = "needs ROS 2, which ./scripts/test.sh without --quick installs"


def needs_ros(call: pytest.CallInfo[object] | None) -> bool:
    """Say whether a call failed because ROS is not there."""
    if not WITHOUT_ROS or call is None or call.excinfo is None:
        return False
    error = call.excinfo.value.__cause__ or call.excinfo.value
    name = getattr(error, "name", None) if isinstance(error, ModuleNotFoundError) else None
    return (name or "").partition(".")[0] in ROS_PACKAGES


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Skip a file that imports a package of ROS."""
    report = yield
    if needs_ros(getattr(report, "call", None)):
        report.outcome = "skipped"
        report.longrepr = (__file__, 1, REASON)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    call: pytest.CallInfo[None],
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Skip a test that needs a package of ROS while it runs."""
    report = yield
    if needs_ros(call):
        report.outcome = "skipped"
        report.longrepr = (__file__, 1, REASON)
    return report
