"""No message ends a node, makes it deaf or keeps it busy, however it is malformed.

A small part of what ``python -m tests.fuzzing NODE --count 100000`` tries.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from tests.fuzzing.chains import CHAINS
from tests.process_source import CopiedProcess
from tests.ros_domain import ros_domain

PROJECT = Path(__file__).resolve().parents[3]
COUNT = 200
PATIENCE = 300.0
"""Longest wait, s: generous, because machines may be busy."""


@pytest.mark.parametrize("node", CHAINS)
def test_after_any_message_the_third_good_one_is_answered(tmp_path: Path, node: str) -> None:
    log = tmp_path / "log"
    arguments = [node, "--count", str(COUNT), "--examples"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(ros_domain())}
    process = CopiedProcess("tests.fuzzing", arguments, environment, log, PROJECT)
    try:
        code = process.wait(PATIENCE)
    finally:
        process.kill()
    said = log.read_text()
    assert code == 0, said
    summary, _ = json.JSONDecoder().raw_decode(said)
    assert summary["malformed"] == COUNT
