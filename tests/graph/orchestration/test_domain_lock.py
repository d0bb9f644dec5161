"""A ROS domain belongs to one run at a time, and is free when that is gone."""

import os
from pathlib import Path

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.orchestration.domain_lock import domain_lock


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
