"""``sonar-tracking run`` in a namespace: same data by other names, and several runs in a domain."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from sonar_tracking.bags.storage.reader import read_bag
from tests.made_once import made_once
from tests.system.command_line import RunningCommand, digests, refused, report_of, run_command

RUN = ("run", "active", "--duration", "60", "--rate", "max", "--no-display")
NAMES = ("--namespace", "shipA", "--remap", "active/tracks:=picture")
PICTURE = "/shipA/picture"


def in_root(topic: str) -> str:
    """Return the name that a topic of the run below has without namespace and rule."""
    return "/active/tracks" if topic == PICTURE else topic.removeprefix("/shipA")


@dataclasses.dataclass(frozen=True)
class NamedRun:
    """A run in a namespace, its bag and its report, and the report of the same run in the root."""

    bag: Path
    report: dict[str, Any]
    root: dict[str, Any]


@pytest.fixture(scope="session")
def named_run(tmp_path_factory: pytest.TempPathFactory) -> NamedRun:
    def make(folder: Path) -> None:
        for name, more in (("root", ()), ("named", (*NAMES, "--record", folder / "bag"))):
            arguments = (*RUN, "--json", folder / f"{name}.json", *more)
            done = run_command(folder, *arguments, pictures=True)
            assert done.returncode == 0, done.stdout

    folder = made_once(tmp_path_factory, "named_run", make)
    named, root = (report_of(folder / f"{name}.json") for name in ("named", "root"))
    return NamedRun(folder / "bag", named, root)


def test_only_the_names_differ(named_run: NamedRun) -> None:
    named, root = named_run.report, named_run.root
    assert named["namespace"] == "/shipA" and root["namespace"] == ""
    assert all(topic.startswith("/shipA/") for topic in named["topics"])
    assert {in_root(topic): digest for topic, digest in digests(named).items()} == digests(root)
    assert {name: node["messages_in"] for name, node in named["nodes"].items()} | {
        "recorder": 0
    } == {name: node["messages_in"] for name, node in root["nodes"].items()} | {"recorder": 0}
    assert named["score"]["positions"][PICTURE] == root["score"]["positions"]["/active/tracks"]
    assert named["true_positions"] == "/shipA/truth/tracks"
    assert named["latency_ms"]["count"] == root["latency_ms"]["count"] > 0


def test_the_bag_holds_the_names_of_the_run_and_knows_those_of_the_graph(
    named_run: NamedRun,
) -> None:
    bag = read_bag(named_run.bag)
    below = set(bag.topics) - {"/diagnostics", "/tf", "/tf_static"}
    assert below > {*named_run.report["topics"], "/shipA/active/markers", "/shipA/clock"}
    assert all(topic.startswith("/shipA/") for topic in below)
    assert bag.topics["/shipA/clock"].message_count > 0
    assert bag.recording is not None
    assert bag.recording.topic_names == {name: in_root(name) for name in below}


@pytest.mark.parametrize(
    "names",
    [
        (),
        ("--namespace", "shipA"),
        ("--namespace", "shipA", "--remap", f"{PICTURE}:=/active/tracks"),
        ("--remap", "/shipA/own_ship/odometry:=/own_ship/odometry"),
    ],
)
def test_the_recording_replays_with_the_same_digests(
    named_run: NamedRun, tmp_path: Path, names: tuple[str, ...]
) -> None:
    json = tmp_path / "replay.json"
    done = run_command(
        tmp_path, "replay", named_run.bag, "--rate", "max", "--no-display", "--json", json, *names
    )
    assert done.returncode == 0, done.stdout
    assert digests(report_of(json)) == digests(named_run.root)
    comparison = report_of(json)["comparison"]
    assert comparison["/active/tracks"].startswith("identical")
    assert comparison["/active/threshold"].startswith("identical")


def test_a_replay_may_leave_the_names_of_an_output_to_others(
    named_run: NamedRun, tmp_path: Path
) -> None:
    json = tmp_path / "replay.json"
    rule = f"{PICTURE}:=/theirs"
    done = run_command(
        tmp_path, "replay", named_run.bag, "--rate", "max", "--json", json, "--remap", rule
    )
    assert done.returncode == 0, done.stdout
    assert set(report_of(json)["comparison"]) == {"/active/threshold"}


def test_score_and_plot_find_the_topics(named_run: NamedRun, tmp_path: Path) -> None:
    json = tmp_path / "score.json"
    done = run_command(tmp_path, "score", named_run.bag, "--json", json)
    assert done.returncode == 0, done.stdout
    (score,) = report_of(json)["topics"].values()
    live = named_run.root["score"]["positions"]["/active/tracks"]
    assert score["rmse_m"] == pytest.approx(live["rmse_m"])
    done = run_command(tmp_path, "plot", named_run.bag, "--output", tmp_path / "pictures")
    assert done.returncode == 0, done.stdout


@pytest.fixture
def running(tmp_path: Path) -> Iterator[dict[str, RunningCommand]]:
    """Start runs of two ships in the domain of these tests."""
    commands = {}
    for ship in ("shipA", "shipB"):
        home = tmp_path / ship
        home.mkdir()
        commands[ship] = RunningCommand(
            home, "run", "active", "--rate", "20", "--no-display", "--namespace", ship,
            "--json", home / "run.json",
        )  # fmt: skip
    yield commands
    for command in commands.values():
        command.clean_up()


def test_two_runs_share_a_domain_each_with_its_own_clock(
    running: dict[str, RunningCommand], named_run: NamedRun, tmp_path: Path
) -> None:
    for command in running.values():
        command.wait_for_text("data flow")
    # A third one in the root is not disturbed, and one in the same namespace is refused.
    alone = run_command(tmp_path, *RUN, "--json", tmp_path / "run.json")
    assert alone.returncode == 0, alone.stdout
    assert digests(report_of(tmp_path / "run.json")) == digests(named_run.root)
    doubled = run_command(tmp_path, *RUN, "--namespace", "shipB")
    assert doubled.returncode == 2
    assert "namespace /shipB: wait for its end" in doubled.stdout
    for ship, command in running.items():
        assert "data flow" in command.output
        command.interrupt()
        assert command.wait() == 130, command.output  # ended by Ctrl-C
        report = report_of(tmp_path / ship / "run.json")
        assert not report["failures"] and not report["warnings"]
        assert set(report["nodes"]) == {"world_simulator", "contact_simulator", "hpda_tracker"}
        assert report["topics"][f"/{ship}/active/tracks"]["messages"] > 0


@pytest.mark.parametrize(
    ("names", "sentence"),
    [
        (("--namespace", "ship A"), "is no name in ROS"),
        (("--remap", "active/trcks:=a"), "did you mean /active/tracks?"),
        (("--remap", "active/tracks:=active/contacts"), "would both be called"),
    ],
)
def test_names_that_cannot_be_are_refused_before_anything_is_started(
    tmp_path: Path, names: tuple[str, ...], sentence: str
) -> None:
    assert sentence in refused(tmp_path, *RUN, *names)
    assert not list(tmp_path.rglob("*.log"))
