"""The recorder must keep every byte, pace the clock, and leave a bag however it ends."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from sonar_tracking.bags.storage.reader import read_bag
from tests.bags.bag_fixtures import (
    CLOCK,
    EPOCH,
    SECOND,
    SNAPSHOTS,
    clock_cdr,
    information,
    snapshots_cdr,
)
from tests.ros_domain import ros_domain

rclpy = pytest.importorskip("rclpy")

TOPIC = "/array/snapshots"


@contextmanager
def recorder(bag: Path, *extra: str) -> Iterator[subprocess.Popen[str]]:
    """Run the recorder of one snapshot topic and the clock."""
    lists = {"topics": [TOPIC, "/clock"], "types": [SNAPSHOTS, CLOCK], "roles": ["input", "other"]}
    arguments = [word for n, v in lists.items() for word in ("-p", f"{n}:={json.dumps(v)}")]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(ros_domain())}
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "sonar_tracking.graph.nodes.recorder", "--ros-args"),
            *("-p", f"output:={bag}", *arguments, *extra),
        ],
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield process
    finally:
        process.terminate()
        process.communicate()


class Peer:
    """Publishes snapshots and the clock as bytes; listens to progress and diagnostics."""

    def __init__(self) -> None:
        from diagnostic_msgs.msg import DiagnosticArray
        from rclpy.executors import SingleThreadedExecutor
        from rosgraph_msgs.msg import Clock
        from sonar_tracking_msgs.msg import ArraySnapshots, Progress

        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=ros_domain())
        self.node = rclpy.create_node("peer", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.snapshots = self.node.create_publisher(ArraySnapshots, TOPIC, 10)
        self.clock = self.node.create_publisher(Clock, "/clock", 100)
        self.progress: list[Any] = []
        self.statuses: dict[str, Any] = {}
        self.node.create_subscription(Progress, "/flow/done", self.progress.append, 100)
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self._note, 100)

    def _note(self, message: Any) -> None:
        self.statuses.update({status.name: status for status in message.status})

    def wait(self, done: Any, seconds: float = 30.0) -> None:
        end = time.monotonic() + seconds
        while not done():
            assert time.monotonic() < end, (self.statuses, len(self.progress))
            self.executor.spin_once(timeout_sec=0.1)

    def matched(self, topic: str) -> int:
        status = self.statuses.get("recorder: matched")
        return int({v.key: v.value for v in status.values}.get(topic, 0)) if status else 0

    def wait_until_matched(self) -> None:
        self.wait(lambda: self.matched(TOPIC) and self.matched("/clock"))
        self.wait(lambda: self.matched("/flow/done"))

    def send(self, seconds: range) -> list[bytes]:
        """Publish a clock and a block a second, never more than four ahead of the recorder."""
        sent = []
        for second in seconds:
            self.clock.publish(clock_cdr(second))
            sent.append(snapshots_cdr(second))
            self.snapshots.publish(sent[-1])
            self.wait(lambda second=second: self.finished() > second - 4)
        self.wait(lambda: self.finished() == seconds.stop)
        return sent

    def finished(self) -> int:
        """Return how many blocks the recorder has reported."""
        return max((each.count for each in self.progress if each.topic == TOPIC), default=0)

    def close(self) -> None:
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()


def recorded(bag: Path) -> list[bytes]:
    """Return the blocks that have reached the file."""
    return [message.data for message in read_bag(bag).messages([TOPIC])]


@pytest.fixture
def peer() -> Iterator[Peer]:
    peer = Peer()
    yield peer
    peer.close()


def test_every_byte_is_kept_and_the_bag_finished_on_interrupt(tmp_path: Path, peer: Peer) -> None:
    (tmp_path / "information.json").write_text(information().to_json())
    with recorder(tmp_path / "run", "-p", f"recording:={tmp_path / 'information.json'}") as process:
        peer.wait_until_matched()
        sent = peer.send(range(60))
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 0
    bag = read_bag(tmp_path / "run")
    assert bag.recovery is None
    assert bag.recording == information()
    assert recorded(tmp_path / "run") == sent
    assert bag.topics["/clock"].message_count == 60
    last = peer.progress[-1]
    assert (last.node, last.topic, last.count) == ("recorder", TOPIC, 60)
    assert last.header.stamp.sec == EPOCH + 59
    assert not any(progress.topic == "/clock" for progress in peer.progress)
    assert [message.log_time for message in bag.messages([TOPIC])][-1] == (EPOCH + 59) * SECOND


def test_an_existing_bag_is_kept_and_a_kill_leaves_a_readable_one(
    tmp_path: Path, peer: Peer
) -> None:
    (tmp_path / "run").mkdir()
    with recorder(tmp_path / "run") as process:
        peer.wait_until_matched()
        sent = peer.send(range(20))
        peer.wait(lambda: recorded(tmp_path / "run_2") == sent)
        process.kill()
        process.wait()
    assert list((tmp_path / "run").iterdir()) == []
    bag = read_bag(tmp_path / "run_2")
    assert bag.recovery is not None
    assert recorded(tmp_path / "run_2") == sent
    assert "run_2 is recorded instead" in peer.statuses["recorder: recording"].message


def test_a_wrong_parameter_is_said_and_nothing_is_recorded(tmp_path: Path) -> None:
    with recorder(tmp_path / "run", "-p", 'roles:=["input"]') as process:
        assert "1 roles" in process.communicate(timeout=60)[1]
        assert process.returncode == 1
    assert not (tmp_path / "run").exists()
