"""The set-up program: when it starts anew, waits, compiles again, and what it says if it fails."""

import fcntl
import importlib.util
import re
import subprocess
import sys
import sysconfig
from pathlib import Path
from types import ModuleType

import pytest

PROJECT = Path(__file__).resolve().parents[2]
PROGRAM = PROJECT / "scripts" / "set_up.py"


@pytest.fixture
def set_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Load the program for an empty project in a temporary folder."""
    specification = importlib.util.spec_from_file_location("set_up", PROGRAM)
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    environment = tmp_path / ".venv"
    for name, path in {
        "PROJECT": tmp_path,
        "ENVIRONMENT": environment,
        "STATE": environment / ".set_up",
        "UNFINISHED": environment / ".set_up_unfinished",
        "CACHE": tmp_path / ".cache",
        "REQUIREMENTS": tmp_path / "requirements",
        "MESSAGES": tmp_path / "msg_defs",
    }.items():
        monkeypatch.setattr(module, name, path)
    for folder in (".cache", "requirements", "msg_defs/msg"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "requirements" / "build.txt").write_text("cmake==4\n")
    (tmp_path / "requirements" / "ros.txt").write_text("ros-jazzy-rclpy==7\n")
    (tmp_path / "msg_defs" / "msg" / "Tracks.msg").write_text("uint64[] id\n")
    return module


def test_missing_venv_is_named_with_remedy(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ensurepip", None)
    assert re.search(
        r"virtual environment.*sudo apt install python3\.\d+-venv", set_up.problem("quick")
    )


def test_missing_headers_are_named_with_remedy(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(sysconfig, "get_path", lambda _name: str(tmp_path))
    monkeypatch.setattr(set_up.shutil, "which", lambda name: f"/bin/{name}")
    sentence = set_up.problem("run")
    assert re.search(r"Python\.h.*sudo apt install python3\.\d+-dev", sentence)


def test_nothing_has_to_be_compiled_once_there_is_a_wheel(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(set_up.shutil, "which", lambda _name: None)
    assert "compiler" in set_up.problem("run")
    set_up.message_folder().mkdir(parents=True)
    (set_up.message_folder() / "sonar_tracking_msgs.whl").touch()
    assert set_up.problem("run") is None


@pytest.mark.parametrize("kind", ["quick", "docs"])
def test_quick_tests_and_documentation_need_no_compiler(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    monkeypatch.setattr(set_up.shutil, "which", lambda _name: None)
    assert set_up.problem(kind) is None


@pytest.mark.parametrize(
    ("path", "compiled_again"),
    [
        ("msg_defs/msg/Tracks.msg", True),
        ("msg_defs/CMakeLists.txt", True),
        ("requirements/build.txt", True),
        ("requirements/test.txt", False),
    ],
)
def test_messages_are_compiled_again_only_if_they_changed(
    set_up: ModuleType, tmp_path: Path, path: str, compiled_again: bool
) -> None:
    before = set_up.message_folder()
    with (tmp_path / path).open("a") as file:
        file.write("string name\n")
    assert (set_up.message_folder() != before) == compiled_again


def test_other_pins_compile_the_messages_again_only_for_ros(
    set_up: ModuleType, tmp_path: Path
) -> None:
    before = set_up.message_folder()
    (tmp_path / "requirements" / "run.txt").write_text("numpy==3\n")
    assert set_up.message_folder() == before
    (tmp_path / "requirements" / "ros.txt").write_text("ros-jazzy-rclpy==8\n")
    assert set_up.message_folder() != before


def test_environment_is_made_anew_if_it_cannot_be_trusted(set_up: ModuleType) -> None:
    assert set_up.environment_defect() == "it is not complete"
    programs = set_up.ENVIRONMENT / "bin"
    programs.mkdir(parents=True)
    (programs / "pip").write_text("#!/elsewhere/.venv/bin/python\n")
    assert set_up.environment_defect() == "it was made in another folder"
    (programs / "pip").write_text(f"#!{programs}/python\n")
    python = programs / "python"
    python.write_text("#!/bin/sh\nexit 127\n")
    python.chmod(0o755)
    assert set_up.environment_defect() == "its Python does not start"
    python.write_text("#!/bin/sh\necho 3.9\n")
    assert set_up.environment_defect() == f"it has Python 3.9 and not {set_up.PYTHON_VERSION}"
    python.write_text(f"#!/bin/sh\necho {set_up.PYTHON_VERSION}\n")
    assert set_up.environment_defect() is None
    set_up.UNFINISHED.touch()
    assert set_up.environment_defect() == "its set-up was interrupted"


def test_failed_command_shows_the_end_of_its_output(
    set_up: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    command = [sys.executable, "-c", "print('no route to host'); raise SystemExit(1)"]
    with pytest.raises(set_up.SetUpError, match=r"^It failed\. All output is in .*set_up\.log\.$"):
        set_up.run_logged(command, "It failed.")
    assert "no route to host" in capsys.readouterr().err


def test_failure_leaves_an_environment_that_can_be_gone_on_with(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only an interruption makes the environment untrustworthy; no network does not."""
    set_up.ENVIRONMENT.mkdir()
    monkeypatch.setattr(set_up, "make_environment", lambda: None)

    def fail(with_tests: bool) -> None:
        raise set_up.SetUpError("No network.")

    monkeypatch.setattr(set_up, "fill_environment", fail)
    assert set_up.main(["run", "0", ""]) == 1
    assert not set_up.UNFINISHED.exists()
    assert set_up.state_of("run") == ""

    def interrupt(with_tests: bool) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(set_up, "fill_environment", interrupt)
    assert set_up.main(["run", "0", ""]) == 130
    assert set_up.UNFINISHED.exists()


def test_set_up_for_tests_serves_running_and_documentation_too(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    set_up.ENVIRONMENT.mkdir()
    calls: list[tuple[str, ...]] = []
    monkeypatch.setattr(set_up, "make_environment", lambda: None)
    monkeypatch.setattr(set_up, "fill_environment", calls.append)
    for kind in ("test", "docs", "run", "quick", "test"):
        assert set_up.main([kind, "0", ""]) == 0
    assert calls == [["docs.txt", "ros.txt", "run.txt", "test.txt"]]


def test_set_up_for_quick_tests_leaves_running_set_up(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever runs and tests in turn waits for each once."""
    set_up.ENVIRONMENT.mkdir()
    calls: list[list[str]] = []
    monkeypatch.setattr(set_up, "make_environment", lambda: None)
    monkeypatch.setattr(set_up, "fill_environment", calls.append)
    for kind in ("quick", "run", "quick", "run"):
        assert set_up.main([kind, "0", ""]) == 0
    assert calls == [["run.txt", "test.txt"], ["ros.txt", "run.txt", "test.txt"]]
    assert set_up.main(["quick", "changed", ""]) == 0
    assert calls[2:] == [["run.txt", "test.txt"]]


def test_messages_are_left_out_of_an_environment_without_ros(
    set_up: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed: list[str] = []
    monkeypatch.setattr(set_up, "install", lambda *arguments: installed.extend(arguments))
    monkeypatch.setattr(set_up, "register", lambda: None)
    monkeypatch.setattr(set_up, "message_wheel", lambda: Path("messages.whl"))
    set_up.fill_environment(set_up.KINDS["quick"])
    assert "messages.whl" not in installed
    set_up.fill_environment(set_up.KINDS["run"])
    assert "messages.whl" in installed


def test_second_set_up_waits_for_the_first(tmp_path: Path) -> None:
    """Two first starts at once: the second finds the work done."""
    (tmp_path / "scripts").mkdir()
    (tmp_path / "scripts" / PROGRAM.name).write_bytes(PROGRAM.read_bytes())
    (tmp_path / ".cache").mkdir()
    with (tmp_path / ".cache" / "set_up.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        second = subprocess.Popen(
            [sys.executable, "-I", str(tmp_path / "scripts" / PROGRAM.name), "run", "1", ""],
            stderr=subprocess.PIPE,
            text=True,
        )
        assert second.stderr is not None
        assert "waiting" in second.stderr.readline()
        state = tmp_path / ".venv" / ".set_up"
        state.mkdir(parents=True)
        (state / "run").write_text("1")
    assert second.wait(timeout=30) == 0
    assert second.stderr.read() == ""
    second.stderr.close()


def test_build_requirements_are_the_same_in_both_places() -> None:
    """Plain pip builds the messages by their pyproject.toml, the set-up by build.txt."""
    project_file = (PROJECT / "msg_defs" / "pyproject.toml").read_text()
    block = re.search(r"^requires = \[(.*?)^\]", project_file, re.DOTALL | re.MULTILINE)
    assert block is not None
    isolated = set(re.findall(r'"(.+?)"', block[1]))

    def listed(name: str) -> set[str]:
        lines = (PROJECT / "requirements" / name).read_text().splitlines()
        return {line for line in lines if line and not line.startswith("#")}

    assert isolated == listed("build.txt") | listed("ros.txt")
