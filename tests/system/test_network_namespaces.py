"""What another machine can see of a graph, tried in network namespaces; that takes root."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator

import pytest

pytest.importorskip("rclpy")

from tests.ros_domain import ros_domain

HERE, THERE = "10.251.0.1", "10.251.0.2"
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
OUTSIDER = """
import time, rclpy
rclpy.init()
node = rclpy.create_node("outsider")
deadline = time.monotonic() + 8.0
while time.monotonic() < deadline and not node.count_publishers("/active/tracks"):
    time.sleep(0.1)
print("publishers:", node.count_publishers("/active/tracks"))
"""


def ip(*arguments: str) -> None:
    """Run a command of iproute2."""
    subprocess.run(["ip", *arguments], check=True, capture_output=True)


def command(namespace: str, *arguments: str) -> list[str]:
    """Return a command that runs in a namespace, with shared memory of its own."""
    alone = 'mount -t tmpfs none /dev/shm; exec "$@"'
    return ["ip", "netns", "exec", namespace, "unshare", "-m", "sh", "-c", alone, "sh", *arguments]


def environment(**variables: str) -> dict[str, str]:
    """Return the environment with the given words on discovery, and no others."""
    told = (RANGE, "ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER", "FASTRTPS_DEFAULT_PROFILES_FILE")
    kept = {name: value for name, value in os.environ.items() if name not in told}
    return {**kept, "ROS_DOMAIN_ID": str(ros_domain()), **variables}


@pytest.fixture(scope="module")
def machines() -> Iterator[tuple[str, str]]:
    """Yield the names of two namespaces that are joined by a cable."""
    if os.geteuid() != 0 or not all(shutil.which(tool) for tool in ("ip", "unshare")):
        pytest.skip("two network namespaces take root, and the programs ip and unshare")
    names = (f"sonar{os.getpid()}a", f"sonar{os.getpid()}b")
    ends = (f"s{os.getpid()}a", f"s{os.getpid()}b")
    try:
        for name in names:
            ip("netns", "add", name)
        ip("link", "add", ends[0], "type", "veth", "peer", "name", ends[1])
        for name, end, address in zip(names, ends, (HERE, THERE), strict=True):
            ip("link", "set", end, "netns", name)
            ip("-n", name, "addr", "add", f"{address}/24", "dev", end)
            for device in ("lo", end):
                ip("-n", name, "link", "set", device, "up")
        subprocess.run(command(names[0], "true"), check=True, capture_output=True)
    except subprocess.CalledProcessError as error:
        pytest.skip(f"this machine allows no network namespaces: {error.stderr.decode().strip()}")
    else:
        yield names
    finally:
        for name in names:
            subprocess.run(["ip", "netns", "del", name], check=False, capture_output=True)


@pytest.mark.parametrize(
    ("told", "seen"),
    [
        pytest.param({}, 0, id="nothing said"),
        pytest.param({RANGE: "LOCALHOST"}, 0, id="localhost"),
        pytest.param({"ROS_STATIC_PEERS": THERE}, 1, id="static peers"),
        pytest.param({RANGE: "SUBNET"}, 1, id="subnet"),
    ],
)
def test_another_machine_sees_what_its_user_opens(
    machines: tuple[str, str], told: dict[str, str], seen: int
) -> None:
    """The other machine looks everywhere, and names this one."""
    module = "sonar_tracking.graph.nodes.hpda_tracker"
    node = subprocess.Popen(
        command(machines[0], sys.executable, "-m", module), env=environment(**told)
    )
    try:
        outsider = subprocess.run(
            command(machines[1], sys.executable, "-c", OUTSIDER),
            env=environment(**{RANGE: "SUBNET", "ROS_STATIC_PEERS": HERE}),
            capture_output=True,
            text=True,
            check=True,
        )
    finally:
        node.terminate()
        node.wait(60)
    assert outsider.stdout.strip() == f"publishers: {seen}"
