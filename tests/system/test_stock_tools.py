"""The tools of ROS 2 itself on a running graph, where they are installed.

None of them was written with this project in mind: what they print is what a user of ROS sees.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.ros_domain import ros_domain
from tests.system.command_line import PATIENCE

ROS2 = shutil.which("ros2")
pytestmark = [
    pytest.mark.graph,
    pytest.mark.system,
    pytest.mark.skipif(
        ROS2 is None, reason="no command ros2: it comes with the package ros-jazzy-ros2cli"
    ),
]

SCENARIO = """
duration: 100000.0
active_sonar: {ping_interval: 0.2, maximum_range: 140.0, false_alarm_probability: 0.0001}
targets:
  - motion: {kind: kinematic, position: [0.0, 80.0], course_deg: 90.0, speed: 0.01}
"""


@dataclass(frozen=True)
class Call:
    """What is typed after ``ros2``, and what is to be seen.

    Attributes
    ----------
    arguments : str
        The command line; {scenario} is a file.
    expected : str
        Regular expression that the output matches.
    exit_code : int
        Of the command.
    measures : bool
        Whether it goes on until it is interrupted, which ends it once the output is there.
    """

    arguments: str
    expected: str
    exit_code: int = 0
    measures: bool = False


TRACKER = "/hpda_tracker"
CALLS = (
    Call("pkg prefix sonar_tracking", r"/\w+"),
    Call("pkg executables sonar_tracking", r"sonar_tracking hpda_tracker"),
    Call("pkg xml sonar_tracking -t version", r"\d+\.\d+\.\d+"),
    Call("interface list -m", r"sonar_tracking_msgs/msg/Contacts"),
    Call("interface package sonar_tracking_msgs", r"sonar_tracking_msgs/msg/Tracks"),
    Call("interface show sonar_tracking_msgs/msg/Contacts", r"float64\[\] range\b"),
    Call("interface proto sonar_tracking_msgs/msg/Contacts", r"clutter_density"),
    Call(
        "node list --no-daemon --spin-time 2",
        r"/contact_simulator\n(.*\n)*/hpda_tracker\n(.*\n)*/scene_",
    ),
    Call(
        f"node info --no-daemon --spin-time 2 {TRACKER}",
        r"Subscribers:(.*\n)*.*/active/contacts: sonar_tracking_msgs/msg/Contacts"
        r"(.*\n)*.*Publishers:(.*\n)*.*/active/tracks: sonar_tracking_msgs/msg/Tracks",
    ),
    Call("topic list --no-daemon --spin-time 2 -t", r"/active/tracks \[sonar_tracking_msgs/msg/Tr"),
    Call("topic type --no-daemon --spin-time 2 /active/contacts", r"sonar_tracking_msgs/msg/Cont"),
    Call("topic find --no-daemon --spin-time 2 diagnostic_msgs/msg/DiagnosticArray", r"/diagnos"),
    Call(
        "topic info --no-daemon --spin-time 2 -v /active/tracks",
        r"Node name: hpda_tracker(.*\n)*.*RIHS01_\w+(.*\n)*.*Reliability: RELIABLE"
        r"(.*\n)*.*Durability: TRANSIENT_LOCAL",
    ),
    Call(
        "topic echo --once /active/contacts sonar_tracking_msgs/msg/Contacts",
        r"frame_id: map(.*\n)*range:",
    ),
    Call(
        "topic echo --once /active/tracks sonar_tracking_msgs/msg/Tracks --field status",
        r"array\('B'|\[\d*\]",
    ),
    Call(
        "topic echo --once /active/markers visualization_msgs/msg/MarkerArray --flow-style",
        r"markers:",
    ),
    Call(
        "topic echo --once /tf tf2_msgs/msg/TFMessage",
        r"frame_id: map(.*\n)*.*child_frame_id: own_ship/base_link",
    ),
    Call("topic hz /active/tracks", r"average rate: [345]\.\d", measures=True),
    Call("topic bw /active/contacts", r"KB/s|B/s from", measures=True),
    Call("topic delay /active/tracks", r"average delay: \d\.\d", measures=True),
    Call(
        "topic pub --once -w 0 /elsewhere/contacts sonar_tracking_msgs/msg/Contacts"
        " '{range: [500.0], azimuth: [0.1]}'",
        r"publishing #1",
    ),
    Call(f"param list --no-daemon --spin-time 2 {TRACKER}", r"confirmation_probability"),
    Call(f"param get --no-daemon --spin-time 2 {TRACKER} method", r"String value is: integrated"),
    Call(
        f"param describe --no-daemon --spin-time 2 {TRACKER} confirmation_probability",
        r"Type: double(.*\n)*.*Description: \w+(.*\n)*.*Max value: ",
    ),
    Call(
        f"param set --no-daemon --spin-time 2 {TRACKER} confirmation_probability 0.95",
        r"Set parameter successful",
    ),
    Call(
        f"param set --no-daemon --spin-time 2 {TRACKER} confirmation_probability 7.0",
        r"Setting parameter failed: .*confirmation_probability",
    ),
    Call(
        f"param dump --no-daemon --spin-time 2 {TRACKER}", r"ros__parameters:(.*\n)*.*method: int"
    ),
    Call("service list --no-daemon --spin-time 2", rf"{TRACKER}/set_parameters"),
    Call(
        "launch sonar_tracking pipeline.launch.py --show-args", r"'scenario':(.*\n)*.*'namespace'"
    ),
    Call("launch sonar_tracking trackers.launch.py --show-args", r"'chain':"),
    Call("launch sonar_tracking pipeline.launch.py scenario:=nowhere", r"nowhere", exit_code=1),
    Call(
        "run sonar_tracking hpda_tracker --ros-args -p method:=wrong",
        r"method is wrong|wrong",
        exit_code=1,
    ),
    Call("run sonar_tracking sonar-tracking --version", r"sonar_tracking \d|\d+\.\d+\.\d+"),
)


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Return the environment of the tools: the domain of the tests, logs below a folder."""
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(ros_domain()),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_HOME": str(tmp_path_factory.mktemp("ros_home")),
    }


@pytest.fixture(scope="module")
def graph(environment: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Launch the active chain with ``ros2 launch``; it ends by Ctrl-C, with exit code 0."""
    folder = tmp_path_factory.mktemp("launched")
    scenario = folder / "one_ship.yaml"
    scenario.write_text(SCENARIO)
    log = folder / "log"
    with log.open("w") as output:
        started = subprocess.Popen(
            [str(ROS2), "launch", "sonar_tracking", "pipeline.launch.py", f"scenario:={scenario}"],
            env=environment,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    try:
        first = Call("topic echo --once /active/tracks sonar_tracking_msgs/msg/Tracks", "header")
        code, text = _see(first, environment)
        assert code == 0, text + log.read_text()
        yield scenario
    finally:
        os.killpg(started.pid, signal.SIGINT)
        code = started.wait(PATIENCE)
    assert code == 0, log.read_text()
    assert "Traceback" not in log.read_text()


def _see(call: Call, environment: dict[str, str]) -> tuple[int, str]:
    """Run a tool to its end, or until it has printed what is expected; return code and output."""
    with subprocess.Popen(
        ["sh", "-c", f'exec "$0" {call.arguments}', str(ROS2)],
        env={**environment, "PYTHONUNBUFFERED": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as process:
        if not call.measures:
            text, _ = process.communicate(timeout=PATIENCE)
            return process.returncode, text
        assert process.stdout is not None
        lines = []
        for line in process.stdout:
            lines.append(line)
            if re.search(call.expected, line):
                process.send_signal(signal.SIGINT)
                break
        process.communicate(timeout=PATIENCE)
        return 0, "".join(lines)


@pytest.mark.parametrize("call", CALLS, ids=[call.arguments for call in CALLS])
def test_tool_shows_what_is_there(call: Call, environment: dict[str, str], graph: Path) -> None:
    code, text = _see(call, environment)
    assert re.search(call.expected, text), text
    assert code == call.exit_code, text
    assert "Traceback" not in text
