"""A ROS domain belongs to one run at a time, and is free when that is gone."""

import os
from pathlib import Path

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.orchestration.domain_lock import domain_lock, runtime_folder


def test_one_at_a_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "17")
    with domain_lock(tmp_path):
        with (
            pytest.raises(ConfigurationError, match=f"process {os.getpid()}.*domain 17"),
            domain_lock(tmp_path),
        ):
            pass
        monkeypatch.setenv("ROS_DOMAIN_ID", "18")
        with domain_lock(tmp_path):
            pass
    monkeypatch.setenv("ROS_DOMAIN_ID", "17")
    with domain_lock(tmp_path):
        pass


def test_namespaces_of_a_domain_are_held_one_by_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "17")
    with (
        domain_lock(tmp_path),
        domain_lock(tmp_path, "/shipA"),
        domain_lock(tmp_path, "/shipA/bow"),
        pytest.raises(ConfigurationError, match="domain 17, namespace /shipA: wait for its end"),
        domain_lock(tmp_path, "/shipA"),
    ):
        pass


def test_without_a_place_for_the_lock_the_run_goes_on(tmp_path: Path) -> None:
    with domain_lock(tmp_path / "nowhere"):
        pass


@pytest.mark.parametrize("domain", ["233", "-1", "one"])
def test_a_domain_that_does_not_exist_is_refused(
    domain: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    with pytest.raises(ConfigurationError, match="from 0 to 232"), domain_lock(tmp_path):
        pass


def test_a_link_in_the_place_of_the_lock_is_not_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "17")
    precious = tmp_path / "precious"
    precious.write_text("data")
    (tmp_path / "sonar_tracking-domain-17.lock").symlink_to(precious)
    with domain_lock(tmp_path):
        assert precious.read_text() == "data"


def test_the_folder_of_the_session_is_used_if_it_is_private(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = tmp_path / "session"
    session.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(session))
    assert runtime_folder() == session
    session.chmod(0o777)
    assert runtime_folder() != session


@pytest.fixture
def no_session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Take the folder of the session away; return the one for temporary files."""
    monkeypatch.delenv("XDG_RUNTIME_DIR", raising=False)
    monkeypatch.setattr(os, "getuid", lambda: 4_000_000_000)  # nobody: has no /run/user
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    return tmp_path


def test_a_folder_that_somebody_else_has_made_is_refused(no_session: Path) -> None:
    """It belongs to whoever runs this test, and not to the user it is for."""
    (no_session / "sonar_tracking-4000000000").mkdir(mode=0o700)
    with pytest.raises(ConfigurationError, match="XDG_RUNTIME_DIR"):
        runtime_folder()


def test_without_a_session_a_private_folder_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    monkeypatch.delenv("XDG_RUNTIME_DIR", raising=False)
    if Path(f"/run/user/{os.getuid()}").exists():
        pytest.skip("this user has a session, and so a folder of it")
    folder = runtime_folder()
    assert folder.parent == tmp_path
    assert folder.stat().st_mode & 0o777 == 0o700
    folder.rmdir()
    folder.symlink_to(tmp_path)
    with pytest.raises(ConfigurationError, match="not a folder of this user alone"):
        runtime_folder()
