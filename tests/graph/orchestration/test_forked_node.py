"""A node that is a copy of the orchestration is the process it would be from nothing.

The orchestrations are processes of their own: only one with a single thread makes copies.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("rclpy")

ORCHESTRATION = """
import json, os, sys, threading, time
from pathlib import Path
from sonar_tracking.graph.catalogue.transport_profile import node_environment
from sonar_tracking.graph.orchestration.forked_node import ForkedNode
from sonar_tracking.graph.orchestration.process_supervisor import ProcessPlan, ProcessSupervisor

if sys.argv[2] == "threads":
    threading.Thread(target=time.sleep, args=(60.0,), daemon=True).start()
kept = open(sys.argv[1] + "/kept", "w")
folder = Path(sys.argv[1])
environment = {**os.environ, **node_environment(), "ROS_LOG_DIR": str(folder), "OWN": "seen"}
supervisor = ProcessSupervisor(folder)
for name, arguments in (
    ("recorder", ()), ("hpda_tracker", ("--ros-args", "-p", "use_sim_time:=true"))
):
    module = "sonar_tracking.graph.nodes." + name
    supervisor.start(ProcessPlan(name, module, arguments, environment))
recorder, tracker = supervisor.processes.values()
while recorder.exit_code is None:
    time.sleep(0.02)
    supervisor.poll()
pid = tracker.popen.pid
deadline = time.monotonic() + 30.0
while not (folder / "hpda_tracker.log").exists() or time.monotonic() < deadline:
    handled = Path(f"/proc/{pid}/status").read_text().split("SigCgt:")[1].split()[0]
    if int(handled, 16) >> 14 & 1:  # it has handlers of its own: main() runs
        break
    time.sleep(0.02)
found = {
    "forked": isinstance(tracker.popen, ForkedNode),
    "command": Path(f"/proc/{pid}/cmdline").read_bytes().decode().rstrip(chr(0)).split(chr(0)),
    "session": os.getsid(pid) == pid,
    "files": sorted(os.readlink(each) for each in Path(f"/proc/{pid}/fd").glob("[0-2]")),
    "kept": str(folder / "kept") in [
        os.readlink(each) for each in Path(f"/proc/{pid}/fd").iterdir() if each.exists()
    ],
    "refused": (recorder.exit_code, supervisor.log_tail("recorder").splitlines()[-1]),
}
supervisor.stop(["hpda_tracker"])
found["exit"] = tracker.exit_code
print(json.dumps(found))
"""


@pytest.mark.slow
@pytest.mark.parametrize("way", ["alone", "threads"])
def test_a_copy_behaves_as_a_process_from_nothing(tmp_path: Path, way: str) -> None:
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    arguments = [sys.executable, "-c", ORCHESTRATION, str(tmp_path), way]
    done = subprocess.run(
        arguments, capture_output=True, text=True, check=True, env=environment, timeout=60
    )
    found = json.loads(done.stdout)
    assert found["forked"] == (way == "alone")
    assert found["command"][1:3] == ["-m", "sonar_tracking.graph.nodes.hpda_tracker"]
    assert found["session"]
    log = str(tmp_path / "hpda_tracker.log")
    assert found["files"] == ["/dev/null", log, log]
    assert not found["kept"], "files of the orchestration are not those of its nodes"
    code, sentence = found["refused"]
    assert code == 1
    assert "give the directory of a bag" in sentence
    assert found["exit"] == 0
