"""The doctor says what is missing and what to do, and ends with 1 only where no graph can run."""

from __future__ import annotations

import io
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import pytest
from rich.console import Console

from sonar_tracking.graph.verbs import doctor, machine_state
from sonar_tracking.graph.verbs.doctor import Finding, Verdict, all_findings
from sonar_tracking.graph.verbs.machine_state import (
    MESSAGE_PACKAGE,
    OPTIONAL,
    REQUIRED,
    TRANSFORM_PACKAGE,
    MachineState,
)

HASHES = {
    f"{MESSAGE_PACKAGE}/msg/Contacts": "RIHS01_1",
    f"{MESSAGE_PACKAGE}/msg/Tracks": "RIHS01_2",
}
NAMES = {*REQUIRED, *(name for names in OPTIONAL.values() for name in names)}
WHOLE = MachineState(
    python=(3, 12),
    versions=dict.fromkeys((*NAMES, "rclpy", MESSAGE_PACKAGE, TRANSFORM_PACKAGE), "1.2"),
    ros_origin="/opt/ros/jazzy/lib/python3.12/site-packages/rclpy",
    installed_hashes=HASHES,
    shipped_hashes=HASHES,
    middlewares=("rmw_fastrtps_cpp",),
    shared_memory=(2**30, 2**30),
    compiler="/usr/bin/c++",
    browser="/usr/bin/chromium",
    python_headers=True,
)


def not_fine(machine: MachineState) -> list[Finding]:
    return [each for each in all_findings(machine) if each.verdict is not Verdict.FINE]


def with_environment(**variables: str) -> MachineState:
    return replace(WHOLE, environment=variables)


def without_packages(*names: str) -> MachineState:
    there = {name: text for name, text in WHOLE.versions.items() if name not in names}
    return replace(WHOLE, versions=there)


def test_a_machine_that_has_everything_needs_no_remedy() -> None:
    assert not not_fine(WHOLE)
    assert not [each for each in all_findings(WHOLE) if each.remedy]


@pytest.mark.parametrize(
    ("machine", "subject", "remedy"),
    [
        (replace(WHOLE, python=(3, 9)), "Python", "3.10 to 3.13"),
        (replace(WHOLE, python=(3, 14)), "Python", "3.10 to 3.13"),
        (without_packages("yaml"), "Python packages", "pip install PyYAML"),
        (replace(WHOLE, ros_origin=""), "ROS 2", "sonar_tracking[ros]"),
        (replace(WHOLE, import_error="ImportError: librcl.so"), "ROS 2", "new shell"),
        (without_packages(MESSAGE_PACKAGE), "messages", "build msg_defs"),
        (without_packages(TRANSFORM_PACKAGE), "messages", "ros-jazzy-tf2-msgs"),
        (
            replace(WHOLE, installed_hashes=HASHES | {f"{MESSAGE_PACKAGE}/msg/Tracks": "RIHS01_3"}),
            "messages",
            "build them again",
        ),
        (replace(WHOLE, middlewares=()), "RMW", "source your ROS 2"),
        (with_environment(RMW_IMPLEMENTATION="rmw_other_cpp"), "RMW", "unset RMW_IMPLEMENTATION"),
        (with_environment(ROS_DOMAIN_ID="233"), "domain", "0 to 232"),
        (with_environment(ROS_DOMAIN_ID="-1"), "domain", "0 to 232"),
        (with_environment(ROS_AUTOMATIC_DISCOVERY_RANGE="OFF"), "discovery range", "LOCALHOST"),
    ],
)
def test_what_keeps_a_graph_from_running_is_named_with_its_remedy(
    machine: MachineState, subject: str, remedy: str
) -> None:
    (finding,) = not_fine(machine)
    assert (finding.subject, finding.verdict) == (subject, Verdict.MISSING)
    assert remedy in finding.remedy


@pytest.mark.parametrize(
    ("machine", "subject"),
    [
        (with_environment(ROS_DISTRO="kilted"), "ROS 2"),
        (replace(WHOLE, middlewares=("rmw_cyclonedds_cpp",)), "RMW"),
        (with_environment(ROS_AUTOMATIC_DISCOVERY_RANGE="localhost"), "discovery range"),
        (replace(WHOLE, shared_memory=(64 * 2**20, 64 * 2**20)), "shared memory"),
        (replace(WHOLE, shared_memory=()), "shared memory"),
        (replace(WHOLE, compiler=""), "compiler"),
        (replace(WHOLE, python_headers=False), "compiler"),
        (replace(WHOLE, browser=""), "Chromium"),
        (without_packages("stonesoup"), "for test"),
    ],
)
def test_what_a_graph_does_without_is_a_note(machine: MachineState, subject: str) -> None:
    (finding,) = not_fine(machine)
    assert (finding.subject, finding.verdict) == (subject, Verdict.OPTIONAL)
    assert finding.remedy


def test_the_hash_of_the_messages_tells_any_type_apart() -> None:
    other = dict(HASHES, **{f"{MESSAGE_PACKAGE}/msg/Contacts": "RIHS01_9"})
    assert doctor.package_hash(HASHES) == doctor.package_hash(dict(reversed(HASHES.items())))
    assert doctor.package_hash(HASHES) != doctor.package_hash(other)


def test_compiled_messages_tell_the_hashes_of_their_definitions() -> None:
    prefixes = machine_state.ros_prefixes({})
    if not machine_state.installed_hashes(prefixes):
        pytest.skip("needs the compiled messages")
    # rosbags computes the one, the ROS message generator the other.
    assert machine_state.installed_hashes(prefixes) == machine_state.shipped_hashes()


def test_workspaces_go_before_the_environment_of_python(tmp_path: Path) -> None:
    prefixes = machine_state.ros_prefixes({"AMENT_PREFIX_PATH": f"{tmp_path}:/opt/ros/jazzy"})
    assert prefixes[:2] == (tmp_path, Path("/opt/ros/jazzy"))


@pytest.mark.parametrize(("machine", "code"), [(WHOLE, 0), (MachineState(python=(3, 12)), 1)])
def test_exit_code_and_table(
    machine: MachineState, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = io.StringIO()
    monkeypatch.setattr(doctor, "examined_machine", lambda: machine)
    monkeypatch.setattr(doctor, "Console", lambda highlight: Console(file=said, width=400))
    assert doctor.examine() == code
    for finding in all_findings(machine):
        assert finding.found in said.getvalue() and finding.remedy in said.getvalue()


def test_a_machine_without_ros_can_be_examined(monkeypatch: pytest.MonkeyPatch) -> None:
    absent = {"rclpy", MESSAGE_PACKAGE}
    monkeypatch.setattr(
        machine_state, "find_spec", lambda name: None if name in absent else find_spec(name)
    )
    machine = machine_state.examined_machine()
    missing = {f.subject for f in all_findings(machine) if f.verdict is Verdict.MISSING}
    assert {"ROS 2", "messages"} <= missing and "Python packages" not in missing
