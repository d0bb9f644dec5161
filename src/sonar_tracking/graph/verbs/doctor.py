"""``sonar-tracking doctor``: whether a graph can run here, what is missing, and the remedy.

Each check looks at a :class:`~sonar_tracking.graph.verbs.machine_state.MachineState` alone.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum

from rich.console import Console
from rich.table import Table

import sonar_tracking
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.discovery_range import RANGE, default_range, range_in_words
from sonar_tracking.graph.catalogue.discovery_server import check_discovery_server
from sonar_tracking.graph.catalogue.transport_profile import SEGMENT_BYTES, SHARED_MEMORY
from sonar_tracking.graph.orchestration.domain_lock import LARGEST_DOMAIN
from sonar_tracking.graph.verbs.machine_state import (
    MESSAGE_PACKAGE,
    OPTIONAL,
    REQUIRED,
    TRANSFORM_PACKAGE,
    MachineState,
    examined_machine,
)

OLDEST_PYTHON, NEWEST_PYTHON = (3, 10), (3, 13)
DEFAULT_MIDDLEWARE = "rmw_fastrtps_cpp"
RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT", "NOT_SET")
"""Values of ROS_AUTOMATIC_DISCOVERY_RANGE."""

ROS_REMEDY = (
    "use ./scripts/run.sh, or source your ROS 2 installation first, or, on Linux on x86-64, "
    "pip install 'sonar_tracking[ros]'"
)
MEGABYTE = 2**20


class Verdict(Enum):
    """What a finding means for a graph."""

    FINE = "ok"
    """As it should be."""
    OPTIONAL = "note"
    """A graph runs, but something else does not, or it runs more slowly."""
    MISSING = "missing"
    """No graph can run."""


@dataclass(frozen=True)
class Finding:
    """What one check has found.

    Attributes
    ----------
    subject : str
        What was looked at.
    verdict : Verdict
        What that means for a graph.
    found : str
        What is there.
    remedy : str
        What to do; empty = nothing.
    """

    subject: str
    verdict: Verdict
    found: str
    remedy: str = ""


def examine() -> int:
    """Examine this machine, print the table, return the exit code: 0 if a graph can run, else 1."""
    findings = all_findings(examined_machine())
    console = Console(highlight=False)
    console.print(findings_table(findings))
    missing = [finding.subject for finding in findings if finding.verdict is Verdict.MISSING]
    if missing:
        console.print(f"no graph can run here: see {', '.join(missing)}.", markup=False)
        return 1
    console.print("a graph can run here.", markup=False)
    return 0


def all_findings(machine: MachineState) -> tuple[Finding, ...]:
    """Return the findings of all checks."""
    return (
        Finding("sonar_tracking", Verdict.FINE, str(sonar_tracking.__version__)),
        check_python(machine),
        check_required_packages(machine),
        check_ros(machine),
        check_messages(machine),
        check_middleware(machine),
        check_domain(machine),
        check_discovery(machine),
        check_shared_memory(machine),
        check_compiler(machine),
        check_browser(machine),
        *check_optional_packages(machine),
    )


def findings_table(findings: Iterable[Finding]) -> Table:
    """Return the findings as a table for the terminal."""
    table = Table("", "state", "found", "remedy", show_edge=False)
    colours = {Verdict.FINE: "green", Verdict.OPTIONAL: "yellow", Verdict.MISSING: "red"}
    for finding in findings:
        state = f"[{colours[finding.verdict]}]{finding.verdict.value}[/]"
        texts = (text.replace("[", r"\[") for text in (finding.found, finding.remedy))
        table.add_row(finding.subject, state, *texts)
    return table


def check_python(machine: MachineState) -> Finding:
    """Check the version of Python."""
    found = f"{machine.python[0]}.{machine.python[1]}, {machine.executable}"
    if OLDEST_PYTHON <= machine.python <= NEWEST_PYTHON:
        return Finding("Python", Verdict.FINE, found)
    return Finding("Python", Verdict.MISSING, found, "install Python 3.10 to 3.13 and use that one")


def check_required_packages(machine: MachineState) -> Finding:
    """Check the Python packages without which no graph runs."""
    return _packages("Python packages", REQUIRED, machine, Verdict.MISSING, "")


def check_ros(machine: MachineState) -> Finding:
    """Check that rclpy is there, from where, and that nodes can load it."""
    if not machine.ros_origin:
        return Finding("ROS 2", Verdict.MISSING, "no rclpy", ROS_REMEDY)
    kind = "wheels" if machine.ros_wheels else "system packages or a workspace"
    found = f"rclpy {machine.versions.get('rclpy', 'unknown')}, {kind}, {machine.ros_origin}"
    distribution = machine.environment.get("ROS_DISTRO", "jazzy")
    if machine.import_error:
        remedy = "start a new shell that sources no other ROS; else install ROS or .venv again"
        return Finding("ROS 2", Verdict.MISSING, f"{found}: {machine.import_error}", remedy)
    if distribution != "jazzy":
        remedy = "only Jazzy is tested: source that one"
        return Finding("ROS 2", Verdict.OPTIONAL, f"{found}; ROS_DISTRO={distribution}", remedy)
    return Finding("ROS 2", Verdict.FINE, found)


def check_messages(machine: MachineState) -> Finding:
    """Check that the compiled messages are those this version of the package defines."""
    subject = "messages"
    if MESSAGE_PACKAGE not in machine.versions:
        remedy = "use ./scripts/run.sh, or build msg_defs with colcon and source the workspace"
        return Finding(subject, Verdict.MISSING, f"no {MESSAGE_PACKAGE}", remedy)
    if TRANSFORM_PACKAGE not in machine.versions:
        remedy = "use ./scripts/run.sh, or sudo apt install ros-jazzy-tf2-msgs"
        return Finding(subject, Verdict.MISSING, f"no {TRANSFORM_PACKAGE}, of /tf", remedy)
    version = machine.versions[MESSAGE_PACKAGE]
    found = f"{MESSAGE_PACKAGE} {version}, {len(machine.installed_hashes)} types, hash "
    found += package_hash(machine.installed_hashes)
    shipped = machine.shipped_hashes
    if not (machine.installed_hashes and shipped):
        remedy = "hashes could not be compared: build msg_defs again if nodes do not connect"
        return Finding(subject, Verdict.OPTIONAL, found, remedy)
    different = [
        name.rpartition("/")[2]
        for name in sorted({*shipped, *machine.installed_hashes})
        if shipped.get(name) != machine.installed_hashes.get(name)
    ]
    if different:
        found += f" instead of {package_hash(shipped)}: {', '.join(different)} differ"
        remedy = (
            "build them again: ./scripts/run.sh does, or colcon build, and source the workspace"
        )
        return Finding(subject, Verdict.MISSING, found, remedy)
    return Finding(subject, Verdict.FINE, found)


def package_hash(hashes: Mapping[str, str]) -> str:
    """Return a short hash of all message types: equal where all of them are."""
    lines = "\n".join(f"{name} {hashes[name]}" for name in sorted(hashes))
    return hashlib.sha256(lines.encode()).hexdigest()[:12]


def check_middleware(machine: MachineState) -> Finding:
    """Check that there is an RMW implementation, the one that is asked for if any."""
    asked = machine.environment.get("RMW_IMPLEMENTATION", "")
    there = ", ".join(machine.middlewares) or "none"
    if asked and asked not in machine.middlewares:
        remedy = f"install {asked}, or unset RMW_IMPLEMENTATION"
        found = f"RMW_IMPLEMENTATION={asked}; there is {there}"
        return Finding("RMW", Verdict.MISSING, found, remedy)
    if not machine.middlewares:
        return Finding("RMW", Verdict.MISSING, "none", ROS_REMEDY)
    used = asked or DEFAULT_MIDDLEWARE
    if used != DEFAULT_MIDDLEWARE or used not in machine.middlewares:
        remedy = f"transport and discovery are tuned for {DEFAULT_MIDDLEWARE} only"
        return Finding("RMW", Verdict.OPTIONAL, there if used not in there else used, remedy)
    return Finding("RMW", Verdict.FINE, used)


def check_domain(machine: MachineState) -> Finding:
    """Check the ROS domain."""
    domain = machine.environment.get("ROS_DOMAIN_ID") or "0"
    if domain.isdecimal() and int(domain) <= LARGEST_DOMAIN:
        return Finding("domain", Verdict.FINE, domain)
    remedy = f"set ROS_DOMAIN_ID to a number from 0 to {LARGEST_DOMAIN}, or unset it"
    return Finding("domain", Verdict.MISSING, f"ROS_DOMAIN_ID={domain}", remedy)


def check_discovery(machine: MachineState) -> Finding:
    """Check how far nodes look for each other, and that a discovery server is there."""
    subject = "discovery range"
    try:
        check_discovery_server(machine.environment)
    except ConfigurationError as error:
        return Finding(subject, Verdict.MISSING, range_in_words(machine.environment), str(error))
    asked = machine.environment.get(RANGE) or default_range(machine.environment).get(RANGE, "")
    if asked == "OFF":
        remedy = "nodes do not find each other: export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"
        return Finding(subject, Verdict.MISSING, asked, remedy)
    if asked and asked not in RANGES:
        remedy = f"ROS takes SUBNET instead: give one of {', '.join(RANGES[:-1])}"
        return Finding(subject, Verdict.OPTIONAL, asked, remedy)
    found = range_in_words(machine.environment).removeprefix("discovery: ")
    return Finding(subject, Verdict.FINE, found)


def check_shared_memory(machine: MachineState) -> Finding:
    """Check that there is room for messages of arrays."""
    needed = 2 * SEGMENT_BYTES
    if not machine.shared_memory:
        remedy = "messages of large arrays go by UDP, which is slower: mount a tmpfs there"
        return Finding("shared memory", Verdict.OPTIONAL, f"no {SHARED_MEMORY}", remedy)
    size, free = (count / MEGABYTE for count in machine.shared_memory)
    found = f"{SHARED_MEMORY}: {size:.0f} MB, {free:.0f} MB free"
    if machine.shared_memory[1] >= needed:
        return Finding("shared memory", Verdict.FINE, found)
    remedy = (
        f"messages of large arrays want {needed / MEGABYTE:.0f} MB, else they go by UDP, which is "
        "slower: enlarge it (in Docker: --shm-size=512m)"
    )
    return Finding("shared memory", Verdict.OPTIONAL, found, remedy)


def check_compiler(machine: MachineState) -> Finding:
    """Check that the messages could be compiled."""
    if machine.compiler and machine.python_headers:
        return Finding("compiler", Verdict.FINE, machine.compiler)
    lacking = [
        text
        for text, there in (
            ("no C++ compiler", machine.compiler),
            ("no headers of Python", machine.python_headers),
        )
        if not there
    ]
    remedy = "only to compile the messages: sudo apt install g++ python3-dev"
    return Finding("compiler", Verdict.OPTIONAL, ", ".join(lacking), remedy)


def check_browser(machine: MachineState) -> Finding:
    """Check for the browser in which Foxglove and Lichtblick show a graph."""
    if machine.browser:
        return Finding("Chromium", Verdict.FINE, machine.browser)
    remedy = "only to look at a graph in Foxglove or Lichtblick: sudo apt install chromium"
    return Finding("Chromium", Verdict.OPTIONAL, "none", remedy)


def check_optional_packages(machine: MachineState) -> tuple[Finding, ...]:
    """Check the Python packages of each extra of pip."""
    return tuple(
        _packages(f"for {extra}", names, machine, Verdict.OPTIONAL, f"only for {extra}: ")
        for extra, names in OPTIONAL.items()
    )


def _packages(
    subject: str, names: Mapping[str, str], machine: MachineState, lacking: Verdict, use: str
) -> Finding:
    there = [f"{names[n]} {machine.versions[n]}" for n in names if n in machine.versions]
    absent = [names[name] for name in names if name not in machine.versions]
    if not absent:
        return Finding(subject, Verdict.FINE, ", ".join(there))
    found = f"no {', '.join(absent)}" + (f"; {', '.join(there)}" if there else "")
    return Finding(subject, lacking, found, f"{use}pip install {' '.join(absent)}")
