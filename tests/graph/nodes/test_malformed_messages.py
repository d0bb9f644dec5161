"""No message ends a node, makes it deaf or keeps it busy, however it is malformed.

A small part of what ``python -m tests.fuzzing NODE --count 100000`` tries.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.fuzzing.chains import CHAINS
from tests.ros_domain import ros_domain

PROJECT = Path(__file__).resolve().parents[3]
COUNT = 200


@pytest.mark.parametrize("node", CHAINS)
def test_after_any_message_the_third_good_one_is_answered(node: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzzing", node, "--count", str(COUNT), "--examples"],
        cwd=PROJECT,
        env={**os.environ, "ROS_DOMAIN_ID": str(ros_domain())},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    summary, _ = json.JSONDecoder().raw_decode(done.stdout)
    assert summary["malformed"] == COUNT
