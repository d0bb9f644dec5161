"""What is decided of a replay before anything is started."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.display.run_display import LineDisplay
from sonar_tracking.graph.verbs.run_replay import opened_bag
from tests.bags.bag_fixtures import open_writer, write_messages, write_wrapped_record


def test_an_old_bag_is_rewritten_on_request_only_and_the_reason_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        write_wrapped_record(patch)
        writer = open_writer(tmp_path / "old")
        write_messages(writer, 3)
        writer.close()
    said = io.StringIO()
    display = LineDisplay(Console(file=said, width=1000))
    assert opened_bag(tmp_path / "old", False, display).path == tmp_path / "old"
    assert said.getvalue() == ""
    repaired = opened_bag(tmp_path / "old", True, display)
    assert repaired.path == tmp_path / "old_repaired" and repaired.outdated is None
    assert list(repaired.messages()) == list(read_bag(tmp_path / "old").messages())
    assert "cannot be opened by the stock ROS 2 tools" in said.getvalue()
    assert f"the repaired bag is {tmp_path / 'old_repaired'}" in said.getvalue()
