"""``sonar-tracking run`` as a user types it: real nodes, real processes."""

from __future__ import annotations

import dataclasses
import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from sonar_tracking import cli
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.offline.offline_bearing_chain import run_offline_chain
from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS, SNAPSHOTS
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.orchestration.run_observer import tracks_from_bytes
from sonar_tracking.graph.verbs import run_command as run_command_module
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from tests.made_once import made_once
from tests.system.command_line import (
    PATIENCE,
    RunningCommand,
    digests,
    environment,
    refused,
    report_of,
    run_command,
)
from tests.system.conftest import DURATION, RecordedRun

TRACKS = "/passive/bearing_tracks"
FLOWING = "data flow"
RUN = ("run", "doa_fusion", "--duration", str(DURATION))


@pytest.fixture
def running(tmp_path: Path) -> Iterator[list[RunningCommand]]:
    commands: list[RunningCommand] = []
    yield commands
    for command in commands:
        command.clean_up()


@dataclasses.dataclass(frozen=True)
class RefusedRun:
    """Report of a short run, and what a second run in its domain has said."""

    first: dict[str, Any]
    said: str


@pytest.fixture(scope="session")
def refused_run(tmp_path_factory: pytest.TempPathFactory) -> RefusedRun:
    def make(folder: Path) -> None:
        short = ("run", "doa_fusion", "--duration", "4.05", "--json", folder / "report.json")
        first = RunningCommand(folder, *short)
        try:
            first.wait_for_text(FLOWING)
            second = run_command(folder, "run", "doa_fusion", "--rate", "max")
            assert second.returncode == 2
            (folder / "said.txt").write_text(second.stdout)
            assert first.wait() == 0, first.output
        finally:
            first.clean_up()

    folder = made_once(tmp_path_factory, "refused_run", make)
    return RefusedRun(report_of(folder / "report.json"), (folder / "said.txt").read_text())


def recorded_count(bag: Path, topic: str) -> int:
    """Return how many messages of a topic have reached the file of a running recorder."""
    try:
        return sum(1 for _ in read_bag(bag).messages([topic]))
    except ConfigurationError:  # not begun yet
        return 0


def test_summary_and_report(recorded_run: RecordedRun) -> None:
    report = recorded_run.report
    assert report["scenario"] == "doa_fusion"
    assert report["data_seconds"] == pytest.approx(DURATION)
    assert set(report["nodes"]) == {
        "world_simulator",
        "array_simulator",
        "subspace_estimator",
        "bearing_tracker",
        "recorder",
    }
    for node in report["nodes"].values():
        assert node["exit_code"] == node["restarts"] == 0
        assert node["cpu_seconds"] > 0.0
    # Nothing is lost: 14.1 s in blocks of 0.1 s, an estimate at -1, 0, 1, ... 12 s.
    assert report["nodes"]["subspace_estimator"]["messages_in"] == 141
    assert report["topics"]["/array/snapshots"]["messages"] == 141
    assert report["topics"][TRACKS]["messages"] == report["nodes"]["bearing_tracker"]["messages_in"]
    assert all(topic["comparable"] for topic in report["topics"].values())
    assert 0.0 < report["latency_ms"]["p50"] <= report["latency_ms"]["p99"]
    assert report["latency_ms"]["algorithmic"] == pytest.approx(15.0)
    assert report["score"]["rmse_deg"] < 1.0
    assert report["score"]["lost_tracks"] == 0
    for words in ("bearing RMSE", "identity swaps", "lost tracks", "ros2 bag play"):
        assert words in recorded_run.output


def test_graph_and_offline_chain_give_the_same_bits(recorded_run: RecordedRun) -> None:
    scenario = dataclasses.replace(load_scenario("doa_fusion"), duration=DURATION)
    offline = run_offline_chain(scenario).tracks
    live = [
        tracks_from_bytes(message.data) for message in read_bag(recorded_run.bag).messages([TRACKS])
    ]
    assert len(live) == len(offline) > 13
    for ours, theirs in zip(live, offline, strict=True):
        assert (ours.stamp, ours.next_stamp) == (theirs.stamp, theirs.next_stamp)
        for field in dataclasses.fields(ours):
            column = getattr(ours, field.name)
            if isinstance(column, np.ndarray):
                assert column.tobytes() == getattr(theirs, field.name).tobytes(), field.name


def test_a_second_run_at_another_rate_gives_the_same_digests(
    recorded_run: RecordedRun, tmp_path: Path
) -> None:
    json = tmp_path / "report.json"
    done = run_command(tmp_path, *RUN, "--rate", "20", "--json", json)
    assert done.returncode == 0, done.stdout
    assert digests(report_of(json)) == digests(recorded_run.report)


def test_duration_shortens_and_ends_the_data(refused_run: RefusedRun) -> None:
    report = refused_run.first
    assert report["data_seconds"] == pytest.approx(4.05)
    assert report["topics"]["/array/snapshots"]["messages"] == 41


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_a_healthy_run_in_order(
    tmp_path: Path, running: list[RunningCommand], number: int
) -> None:
    bag, json = tmp_path / "bag", tmp_path / "report.json"
    command = RunningCommand(tmp_path, "run", "doa_fusion", "--record", bag, "--json", json)
    running.append(command)
    command.wait_for_text(FLOWING)
    nodes = command.node_processes()
    assert len(nodes) == 5
    command.wait_for(lambda: recorded_count(bag, "/array/snapshots") > 5)
    command.interrupt(number)
    assert command.wait() == 128 + number, command.output
    assert not any((Path("/proc") / str(process)).exists() for process in nodes)
    report = report_of(json)
    assert report["interrupted"]
    assert report["exit_code"] == 128 + number
    assert report["failures"] == []
    recorded = read_bag(bag)
    assert recorded.recovery is None
    snapshots = recorded.topics["/array/snapshots"].message_count
    assert snapshots == report["topics"]["/array/snapshots"]["messages"] > 5
    # What was begun was finished: the recording replays to the same tracks.
    again = run_command(tmp_path, "replay", bag, "--rate", "max", "--json", json)
    assert again.returncode == 0, again.stdout
    compared = report_of(json)["comparison"]
    assert all(phrase.startswith("identical:") for phrase in compared.values())


def test_an_early_ctrl_c_is_an_interruption_and_no_failure(
    tmp_path: Path, running: list[RunningCommand]
) -> None:
    command = RunningCommand(tmp_path, "run", "doa_fusion")
    running.append(command)
    command.wait_for(lambda: len(command.node_processes()) == 4)
    command.interrupt()
    assert command.wait() == 128 + signal.SIGINT, command.output
    assert "failed" not in command.own_output


def test_a_killed_tracker_is_restarted_and_reported(
    tmp_path: Path, running: list[RunningCommand]
) -> None:
    bag, json = tmp_path / "bag", tmp_path / "report.json"
    command = RunningCommand(tmp_path, *RUN, "--rate", "6", "--record", bag, "--json", json)
    running.append(command)
    command.wait_for(lambda: recorded_count(bag, TRACKS) > 2)
    command.kill_node("bearing_tracker")
    assert command.wait() == 1
    assert "bearing_tracker was killed by SIGKILL; it was started again (1 of 3)" in command.output
    report = report_of(json)
    assert report["nodes"]["bearing_tracker"]["restarts"] == 1
    assert report["nodes"]["bearing_tracker"]["exit_code"] == 0
    assert not any(topic["comparable"] for topic in report["topics"].values())
    # The other nodes missed nothing, and tracks of the second life are those of the first.
    assert report["topics"]["/array/snapshots"]["messages"] == 141
    pictures = [tracks_from_bytes(message.data) for message in read_bag(bag).messages([TRACKS])]
    assert int(pictures[-1].id.min()) < 1 << 32


def test_a_killed_simulator_goes_on_where_it_was(
    recorded_run: RecordedRun, tmp_path: Path, running: list[RunningCommand]
) -> None:
    bag, json = tmp_path / "bag", tmp_path / "report.json"
    command = RunningCommand(tmp_path, *RUN, "--rate", "6", "--record", bag, "--json", json)
    running.append(command)
    command.wait_for(lambda: recorded_count(bag, TRACKS) > 2)
    command.kill_node("array_simulator")
    assert command.wait() == 1
    report = report_of(json)
    assert report["nodes"]["array_simulator"]["restarts"] == 1
    # The data are a function of the scenario: nothing is missing, the tracks are the same.
    assert digests(report)[TRACKS] == digests(recorded_run.report)[TRACKS]


LARGE_BLOCKS = """
duration: 8.2
array: {n_elements: 256, center_frequency: 1.0e+6, bandwidth: 500.0, snapshot_rate: 500.0,
        block_snapshots: 1024}
targets: [{level_db: 0.0, motion: {kind: linear, offset_deg: 10.0, rate_deg: 0.1}}]
nodes:
  subspace_estimator: {method: block_past, update_snapshots: 50, n_subspaces: 1, source_count: 1}
  bearing_tracker: {method: ryu, start: given, initial_bearings_deg: [10], initial_rates_deg: [0.1]}
"""


def test_large_blocks_pass_without_loss(tmp_path: Path) -> None:
    """Blocks of 2 MB and subspaces of 1 MB, four times what fits into default shared memory."""
    scenario, json, bag = tmp_path / "large.yaml", tmp_path / "report.json", tmp_path / "bag"
    scenario.write_text(LARGE_BLOCKS)
    arguments = ("--rate", "max", "--json", json, "--record", bag)
    done = run_command(tmp_path, "run", scenario, *arguments)
    assert done.returncode == 0, done.stdout
    report = report_of(json)
    assert report["topics"]["/array/snapshots"]["messages"] == 5
    assert report["nodes"]["subspace_estimator"]["messages_in"] == 5
    blocks = list(read_bag(bag).messages(["/array/snapshots"]))
    assert [len(block.data) > 2_000_000 for block in blocks] == [True] * 4 + [False]
    assert report["score"]["rmse_deg"] < 0.1


def test_a_stuck_node_is_named_and_waited_for(
    recorded_run: RecordedRun, tmp_path: Path, running: list[RunningCommand]
) -> None:
    json = tmp_path / "report.json"
    # Slow enough to make good, before the end, what the node has missed meanwhile.
    command = RunningCommand(tmp_path, *RUN, "--rate", "1.5", "--json", json)
    running.append(command)
    command.wait_for_text(FLOWING)
    (process,) = command.node_processes("subspace_estimator")
    os.kill(process, signal.SIGSTOP)
    command.wait_for_text("waiting for subspace_estimator: it has not finished")
    os.kill(process, signal.SIGCONT)
    assert command.wait() == 0, command.output
    assert digests(report_of(json)) == digests(recorded_run.report)


def test_nodes_do_not_outlive_a_killed_orchestration(
    tmp_path: Path, running: list[RunningCommand]
) -> None:
    command = RunningCommand(tmp_path, "run", "doa_fusion")
    running.append(command)
    command.wait_for_text(FLOWING)
    nodes = command.node_processes()
    assert len(nodes) == 4
    command.interrupt(signal.SIGKILL)
    command.wait()
    deadline = time.monotonic() + PATIENCE
    while any((Path("/proc") / str(process)).exists() for process in nodes):
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_a_second_run_in_the_domain_is_refused_and_harms_nobody(refused_run: RefusedRun) -> None:
    assert "another run" in refused_run.said and "ROS_DOMAIN_ID" in refused_run.said
    assert refused_run.first["topics"][TRACKS]["messages"] == 4


@pytest.fixture
def stranger(tmp_path: Path) -> Iterator[Node]:
    """Yield a node of somebody else in the domain of the runs."""
    context = Context()
    domain = int(environment(tmp_path)["ROS_DOMAIN_ID"])
    rclpy.init(args=[], context=context, domain_id=domain)
    node = Node("stranger", context=context, use_global_arguments=False)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def test_a_foreign_clock_is_refused(tmp_path: Path, stranger: Node) -> None:
    stranger.create_publisher(Clock, "/clock", 10)
    done = run_command(tmp_path, "run", "doa_fusion", "--rate", "max")
    assert done.returncode == 1
    assert "/clock by /orchestration, /stranger" in done.stdout
    assert "ROS_DOMAIN_ID" in done.stdout


def test_a_stranger_who_listens_at_bring_up_and_then_moves_the_clock_changes_nothing(
    tmp_path: Path, stranger: Node, running: list[RunningCommand], recorded_run: RecordedRun
) -> None:
    """He does not pass for a node that data wait for, nor do data follow him; he is named."""
    json = tmp_path / "report.json"
    for topic in (SNAPSHOTS, BEARING_TRACKS):
        kind = message_class(topic.message_type)
        stranger.create_subscription(kind, topic.name, lambda _message: None, 10)
    command = RunningCommand(tmp_path, *RUN, "--rate", "6", "--json", json)
    running.append(command)
    command.wait_for_text(FLOWING)
    clock = stranger.create_publisher(Clock, "/clock", 10)
    ahead = Clock()
    ahead.clock.sec = 2_000_000_000

    def is_named() -> bool:
        clock.publish(ahead)
        return "/stranger publishes the clock of this run, too" in command.output

    command.wait_for(is_named)
    assert command.wait() == 0, command.output
    assert digests(report_of(json)) == digests(recorded_run.report)


BAD_REQUESTS = [
    (["run", "doa_fusio"], "did you mean doa_fusion"),
    (["run", "--rate", "0"], "--rate is '0'"),
    (["run", "--rate", "fast"], "--rate is 'fast'"),
    (["run", "--duration", "-1"], "--duration is -1"),
    (["run", "--json", "/nowhere/report.json"], "--json"),
    (["replay", "nowhere"], "nowhere"),
]


@pytest.mark.parametrize(("arguments", "sentence"), BAD_REQUESTS)
def test_a_bad_request_is_one_sentence(arguments: list[str], sentence: str, tmp_path: Path) -> None:
    said = refused(tmp_path, *arguments)
    assert said.count("\n") == 1
    assert sentence in said


BAD_SCENARIOS = [
    ("nodes: {bearing_traker: {}}", "did you mean bearing_tracker"),
    ("nodes: {bearing_tracker: {metod: ryu}}", "did you mean method"),
    ("nodes: {bearing_tracker: {process_noise_deg2: -1.0}}", "process_noise_deg2 is -1"),
    ("nodes: {subspace_estimator: {method: music}}", "method is 'music'"),
    ("nodes: {subspace_estimator: {period: fast}}", "period is 'fast'"),
    ("nodes: {subspace_estimator: {n_subspaces: 4}}", "must be odd"),
    ("nodes: {bearing_tracker: {start: given}}", "initial_bearings_deg is empty"),
    ("array: {n_elements: [", "not valid YAML"),
]


@pytest.mark.parametrize(("text", "sentence"), BAD_SCENARIOS)
def test_a_bad_parameter_is_refused_before_anything_starts(
    text: str, sentence: str, tmp_path: Path
) -> None:
    scenario = tmp_path / "bad.yaml"
    array = "" if text.startswith("array") else "array: {n_elements: 8}\n"
    scenario.write_text(f"{array}{text}\n")
    said = refused(tmp_path, "run", scenario)
    assert sentence in said
    assert "bad.yaml" in said
    assert not list(tmp_path.glob("sonar_tracking/*"))


@pytest.mark.parametrize(
    ("package", "remedy"),
    [("rclpy", "source your ROS 2"), ("sonar_tracking_msgs", "./scripts/run.sh")],
)
def test_missing_ros_is_named_before_anything_starts(
    package: str, remedy: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(run_command_module, "find_spec", lambda name: name != package or None)
    said = refused(tmp_path, "run")
    assert package in said and remedy in said


def test_a_missing_package_of_a_verb_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(cli, "_needs", lambda name: __import__("a_package_nobody_has"))
    assert "pip install a_package_nobody_has" in refused(tmp_path, "doctor")
