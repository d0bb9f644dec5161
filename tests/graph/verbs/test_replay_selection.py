"""Protects what is decided of somebody else's bag, of parts and of loops before a replay."""

from __future__ import annotations

import io
import math
from itertools import islice
from pathlib import Path

import pytest
from rich.console import Console

from sonar_tracking.bags.contents.recording_information import role_of_type
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.display.run_display import LineDisplay
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_settings import NodeSettings
from sonar_tracking.graph.verbs.inferred_nodes import inferred_nodes
from sonar_tracking.graph.verbs.replay_selection import Selection
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.graph.verbs.run_replay import settings_of
from tests.bags.bag_fixtures import EPOCH, SECOND

SNAPSHOTS, BEARINGS, LINES, CONTACTS, POSITIONS = (
    f"sonar_tracking_msgs/msg/{name}"
    for name in ("ArraySnapshots", "BearingTracks", "FrequencyLines", "Contacts", "Tracks")
)


def foreign_bag(folder: Path, topics: dict[str, str]) -> Bag:
    writer = BagWriter(folder / "foreign")
    for name, type_name in topics.items():
        writer.add_topic(name, type_name, role=role_of_type(name, type_name))
    for second in range(3):
        for name in topics:
            writer.write(name, (EPOCH + second) * SECOND, b"\0\1\0\0 %d" % second)
    writer.add_topic("/silent/contacts", CONTACTS)
    writer.close()
    return read_bag(writer.path)


@pytest.mark.parametrize(
    ("topics", "nodes"),
    [
        ({"/x": CONTACTS}, {"hpda_tracker": {}}),
        ({"/x": SNAPSHOTS}, {"subspace_estimator": {}, "bearing_tracker": {}}),
        (
            {"/x": SNAPSHOTS, "/y": BEARINGS, "/z": CONTACTS},
            {"subspace_estimator": {}, "bearing_tracker": {}, "hpda_tracker": {}},
        ),
        (
            {"/b/tracks": BEARINGS, "/a/tracks": BEARINGS, "/truth/bearing_tracks": BEARINGS},
            {"tma_tracker": {"bearing_topics": ["a/tracks", "b/tracks"]}},
        ),
        (
            {"/x": BEARINGS, "/y": LINES},
            {"tma_tracker": {"bearing_topics": ["x"], "line_topics": ["y"]}},
        ),
    ],
)
def test_nodes_follow_from_types(
    topics: dict[str, str], nodes: dict[str, object], tmp_path: Path
) -> None:
    assert inferred_nodes(foreign_bag(tmp_path, topics)) == nodes


def test_a_bag_of_nothing_to_track_needs_parameters(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="--parameters FILE"):
        inferred_nodes(foreign_bag(tmp_path, {"/truth/tracks": POSITIONS}))


def test_inferred_nodes_are_said_in_one_line_and_given_ones_are_not(tmp_path: Path) -> None:
    bag = foreign_bag(tmp_path, {"/x": CONTACTS, "/y": BEARINGS})
    said = io.StringIO()
    display = LineDisplay(Console(file=said, width=1000))
    settings = settings_of(bag, None, display, None)
    assert set(settings) == {"hpda_tracker", "tma_tracker", "scene_publisher"}
    assert settings["tma_tracker"]["bearing_topics"] == ("y",)
    assert settings["scene_publisher"]["bearing_topics"] == ("y",)
    assert said.getvalue().count("\n") == 1 and "tma_tracker, hpda_tracker" in said.getvalue()
    (tmp_path / "own.yaml").write_text("hpda_tracker: {}\n")
    given = settings_of(bag, tmp_path / "own.yaml", display, None)
    assert set(given) == {"hpda_tracker", "scene_publisher"}
    assert said.getvalue().count("\n") == 1


def test_a_loop_gives_the_part_again_and_again(tmp_path: Path) -> None:
    selection = Selection(start_offset=1.0, loop=True)
    bag = selection.of(foreign_bag(tmp_path, {"/x": CONTACTS}))
    messages = islice(selection.messages(bag, ["/x"]), 5)
    assert [m.log_time // SECOND - EPOCH for m in messages] == [1, 2, 1, 2, 1]
    once = Selection(start_offset=1.0)
    assert len(list(once.messages(bag, ["/x"]))) == 2
    assert Selection().whole and not once.whole and not selection.whole


@pytest.mark.parametrize(
    ("selection", "sentence"),
    [
        (Selection(start_offset=-1.0), "--start-offset is -1"),
        (Selection(start_offset=math.nan), "--start-offset is nan"),
        (Selection(duration=0.0), "--duration is 0"),
        (Selection(duration=math.nan), "--duration is nan"),
        (Selection(loop=True), "leave out --record or --loop"),
    ],
)
def test_what_cannot_be_replayed_is_refused(selection: Selection, sentence: str) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        selection.check(RunOptions(record=Path("bag")))


def test_a_loop_that_nodes_would_take_for_disorder_is_refused(tmp_path: Path) -> None:
    bag = foreign_bag(tmp_path, {"/x": CONTACTS})  # 2 s long
    for reset_after in (1.9, 2.0):
        settings: NodeSettings = {"hpda_tracker": {"reset_after": reset_after}}
        Selection().check_loop(bag, settings)
        if reset_after < 2.0:
            Selection(loop=True).check_loop(bag, settings)
        else:
            with pytest.raises(ConfigurationError, match=r"2\.0 s are replayed"):
                Selection(loop=True).check_loop(bag, settings)
