"""What run.sh and test.sh do before they start anything: set up once, or say what is missing.

Each test works in a copy of the files the set-up reads, without network, and with programs on
PATH that make up the machine it is about.
"""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[2]
PYTHON_VERSION = f"{sys.version_info[0]}.{sys.version_info[1]}"
SHELL_PROGRAMS = (
    "bash",
    "cat",
    "cut",
    "dirname",
    "find",
    "getconf",
    "head",
    "sha256sum",
    "sort",
    "uname",
)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Copy what the set-up reads into a folder with a space in its name."""
    copy = tmp_path / "a project"
    copy.mkdir()
    for name in ("scripts", "requirements", "msg_defs", "resource", "config", "launch"):
        shutil.copytree(PROJECT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "src").mkdir()
    for name in ("setup.py", "setup.cfg", "package.xml"):
        shutil.copy(PROJECT / name, copy)
    return copy


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """Make a folder of programs, the only one on PATH: a machine without Python and compiler."""
    programs = tmp_path / "programs"
    programs.mkdir()
    for name in SHELL_PROGRAMS:
        found = shutil.which(name)
        assert found is not None
        (programs / name).symlink_to(found)
    return programs


def add_program(machine: Path, name: str, script: str) -> None:
    """Add (or replace) a program of the made-up machine."""
    (machine / name).unlink(missing_ok=True)
    (machine / name).write_text(f"#!/bin/sh\n{script}\n")
    (machine / name).chmod(0o755)


def add_this_python(machine: Path, name: str = "python3") -> None:
    """Add the Python the tests run with, outside of its virtual environment."""
    add_program(machine, name, f'exec {shlex.quote(this_python())} "$@"')


def this_python() -> str:
    """Return the Python the tests run with, outside of its virtual environment."""
    return str(Path(sys.base_prefix) / "bin" / f"python{PYTHON_VERSION}")


def start(
    project: Path, machine: Path, *arguments: str, script: str = "run.sh", **variables: str
) -> subprocess.CompletedProcess[str]:
    """Start a script of the project on the made-up machine."""
    return subprocess.run(
        ["bash", str(project / "scripts" / script), *arguments],
        env={"PATH": str(machine), "HOME": str(project), **variables},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def assert_refused(finished: subprocess.CompletedProcess[str], project: Path, *parts: str) -> None:
    """Check that one sentence with these parts was printed, and nothing was made."""
    assert finished.returncode == 1
    assert finished.stdout == ""
    lines = finished.stderr.splitlines()
    assert len(lines) == 1, finished.stderr
    for part in parts:
        assert part in lines[0]
    assert not (project / ".venv").exists()


def test_other_processor_is_refused(project: Path, machine: Path) -> None:
    add_program(machine, "uname", "echo Linux aarch64")
    assert_refused(start(project, machine), project, "x86-64", "Linux aarch64", "colcon")


@pytest.mark.parametrize(
    ("answer", "named"),
    [("echo glibc 2.17", "glibc 2.17"), ("exit 1", "no glibc")],
    ids=["old", "another library"],
)
def test_old_c_library_is_refused(project: Path, machine: Path, answer: str, named: str) -> None:
    add_program(machine, "getconf", answer)
    assert_refused(start(project, machine), project, "glibc 2.28 or newer", named)


def test_missing_python_is_named_with_remedy(project: Path, machine: Path) -> None:
    assert_refused(start(project, machine), project, "No Python 3.10 to 3.13", "sudo apt install")


@pytest.mark.parametrize("version", ["3.9.18", "3.14.0"])
@pytest.mark.parametrize(
    "command", [("run.sh",), ("docs.sh",), ("test.sh",), ("test.sh", "--quick")], ids=" ".join
)
def test_unsupported_python_is_named(
    project: Path, machine: Path, version: str, command: tuple[str, ...]
) -> None:
    add_program(
        machine, "python3", f'[ "$1" = --version ] && echo Python {version} && exit; exit 1'
    )
    finished = start(project, machine, *command[1:], script=command[0])
    assert_refused(finished, project, f"python3 is Python {version}", "PYTHON=/path/to/python")


def test_missing_compiler_is_named_with_remedy(project: Path, machine: Path) -> None:
    add_this_python(machine)
    assert_refused(start(project, machine), project, "compiler", "sudo apt install g++")


def test_test_script_refuses_in_the_same_way(project: Path, machine: Path) -> None:
    add_this_python(machine)
    finished = start(project, machine, script="test.sh")
    assert_refused(finished, project, "compiler", "sudo apt install g++")


def test_broken_compiler_is_named_with_its_reason(project: Path, machine: Path) -> None:
    add_this_python(machine)
    for name in ("cc", "c++"):
        add_program(machine, name, "echo fatal error: stdlib.h: No such file >&2; exit 1")
    assert_refused(start(project, machine), project, "stdlib.h", "libc6-dev")


def test_next_python_is_taken_where_the_first_is_unsupported(project: Path, machine: Path) -> None:
    """python3 may be too old or too new on a machine that has another one."""
    add_program(machine, "python3", "exit 1")
    add_this_python(machine, f"python{PYTHON_VERSION}")
    assert_refused(start(project, machine), project, "compiler")


@pytest.mark.parametrize(
    ("optimised", "asked_for", "taken"),
    [
        ((True, True), "", "first"),
        ((False, True), "", "second"),
        ((False, False), "", "first"),
        ((False, True), "python3", "first"),
    ],
)
def test_an_optimised_python_is_taken_before_a_plain_one(
    project: Path,
    machine: Path,
    tmp_path: Path,
    optimised: tuple[bool, bool],
    asked_for: str,
    taken: str,
) -> None:
    """One that was built from source may come first on PATH, and is slower."""
    folders = [tmp_path / "first", tmp_path / "second"]
    for folder, fast in zip(folders, optimised, strict=True):
        folder.mkdir()
        answer = f'case "$*" in *enable-optimizations*) exit {int(not fast)};; esac'
        add_program(folder, "python3", f'{answer}; exec {shlex.quote(this_python())} "$@"')
    finished = subprocess.run(
        ["bash", "-c", 'source "$project/scripts/set_up.sh"; choose_python quick; echo "$python"'],
        env={
            "PATH": os.pathsep.join(map(str, (*folders, machine))),
            "PYTHON": asked_for,
            "project": str(project),
        },
        capture_output=True,
        text=True,
        check=True,
    )
    chosen = asked_for or str(tmp_path / taken / "python3")
    assert finished.stdout == f"{chosen}\n"
    assert ("is built without optimisation" in finished.stderr) == (taken == "second")


def test_unsupported_choice_of_the_user_is_told(project: Path, machine: Path) -> None:
    add_this_python(machine)
    finished = start(project, machine, PYTHON="python2")
    assert finished.returncode == 1
    assert finished.stderr.startswith("PYTHON=python2 is no Python 3.10 to 3.13")


@pytest.mark.parametrize("first", [True, False])
def test_environment_is_not_made_from_itself(project: Path, machine: Path, first: bool) -> None:
    """With .venv activated, python3 on PATH is the one that may have to be replaced."""
    programs = project / ".venv" / "bin"
    programs.mkdir(parents=True)
    add_program(programs, "python3", "exit 0")
    path = [str(programs), str(machine)]
    finished = start(project, machine, PATH=os.pathsep.join(path if first else path[::-1]))
    assert "No Python 3.10 to 3.13 was found" in finished.stderr


def test_full_disk_is_a_sentence(project: Path, machine: Path) -> None:
    """Anything the system refuses is reported without a traceback."""
    add_this_python(machine)
    for name in ("cc", "c++"):
        add_program(machine, name, "exit 0")
    (project / ".cache").write_text("no folder can be made here")
    finished = start(project, machine)
    assert finished.returncode == 1
    assert finished.stderr.startswith("The set-up failed (")
    assert len(finished.stderr.splitlines()) == 1


def finished_set_up(project: Path, kinds: tuple[str, ...] = ("run",), python: str = "") -> None:
    """Leave behind what a complete set-up leaves, with a Python that prints its arguments."""
    fingerprint = subprocess.run(
        ["bash", "-c", 'source "$project/scripts/set_up.sh"; fingerprint'],
        env={**os.environ, "project": str(project)},
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    folder = project / ".venv" / ".set_up"
    folder.mkdir(parents=True)
    (folder / "python").write_text(python)
    for kind in kinds:
        (folder / kind).write_text(fingerprint)
    (project / ".venv" / "bin").mkdir()
    add_program(project / ".venv" / "bin", "python", 'echo "$@"')


def test_second_start_goes_straight_to_the_pipeline(project: Path, machine: Path) -> None:
    """No Python is asked and no package is looked at: this machine has none."""
    finished_set_up(project)
    finished = start(project, machine, "replay", "a bag", "--rate", "max")
    assert finished.returncode == 0, finished.stderr
    assert finished.stdout == f"{project}/scripts/run_pipeline.py replay a bag --rate max\n"


@pytest.mark.parametrize(
    "path",
    [
        "requirements/run.txt",
        "setup.py",
        "msg_defs/msg/Tracks.msg",
        "msg_defs/msg/New.msg",
        "msg_defs/tf2_msgs/msg/TFMessage.msg",
        "launch/new.launch.py",
        "src/new.c",
    ],
)
def test_change_of_an_ingredient_is_noticed(project: Path, machine: Path, path: str) -> None:
    finished_set_up(project)
    with (project / path).open("a") as file:
        file.write("# changed\n")
    finished = start(project, machine)
    assert finished.returncode == 1
    assert "No Python" in finished.stderr


def test_tests_need_more_than_running(project: Path, machine: Path) -> None:
    finished_set_up(project, kinds=("run",))
    assert "No Python" in start(project, machine, script="test.sh").stderr


def test_another_python_asked_for_is_noticed(project: Path, machine: Path) -> None:
    finished_set_up(project, python="python3.11")
    assert start(project, machine, PYTHON="python3.11").returncode == 0
    assert "No Python" in start(project, machine, PYTHON="python3.12").stderr


def test_paths_of_another_ros_are_forgotten(project: Path, machine: Path) -> None:
    """A sourced ROS installation must not lend its libraries to the wheels."""
    finished_set_up(project)
    add_program(project / ".venv" / "bin", "python", 'echo "[$LD_LIBRARY_PATH$PYTHONPATH]"')
    other = "/opt/ros/jazzy"
    variables = ("AMENT_PREFIX_PATH", "LD_LIBRARY_PATH", "PYTHONPATH")
    finished = start(project, machine, **dict.fromkeys(variables, other))
    assert finished.stdout == "[]\n"
