"""What feeds the live page: frames hold what messages say; nothing that comes stops it."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message

from sonar_tracking.display.page.frame_history import FrameHistory
from sonar_tracking.display.page.health_frames import GONE, STALE, Health
from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_commands import command_from_page
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_feed import PageFeed
from sonar_tracking.display.page.page_frames import Frame, binary_frame, plain, rounded, text_frame
from sonar_tracking.display.page.track_frames import tracks_frame
from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.simulated_writing import own_ship_to_bytes
from sonar_tracking.records.commands import CommandKind
from sonar_tracking.records.time import NANOSECONDS
from tests.display.page.page_scene import START, TOPIC, own_ship, tracks


def content(frame: Frame) -> dict[str, Any]:
    """Return what a text frame says."""
    found: dict[str, Any] = json.loads(frame.data)
    return found


def test_a_row_of_a_picture_follows_its_header_aligned() -> None:
    row = np.array([1.5, np.nan, -3.0], np.float32)
    frame = binary_frame("waterfall", 2.0, "array 1", {"sensor": "array", "scale": 1.0}, row)
    assert isinstance(frame.data, bytes)
    length = int.from_bytes(frame.data[:4], "little")
    assert (4 + length) % 4 == 0
    assert json.loads(frame.data[4 : 4 + length])["sensor"] == "array"
    np.testing.assert_array_equal(np.frombuffer(frame.data[4 + length :], "<f4"), row)


def test_what_is_unknown_is_null() -> None:
    given = {"a": np.array([1.0, np.nan]), "b": math.inf, "c": [np.float64("nan"), np.uint64(3)]}
    assert plain(given) == {"a": [1.0, None], "b": None, "c": [None, 3]}


def test_covariances_keep_five_digits() -> None:
    values = np.array([123456.0, -0.00123456, 0.0, np.nan])
    np.testing.assert_allclose(rounded(values), [123460.0, -0.0012346, 0.0, np.nan], rtol=1e-12)


def test_the_frame_of_tracks_holds_their_columns_to_the_last_bit() -> None:
    picture = tracks(7)
    said = content(tracks_frame(TOPIC, picture))
    assert said["id"] == [1, 2, 3]
    for column, name in enumerate(("x", "y", "vx", "vy")):
        assert said[name] == picture.state[:, column].tolist()
    assert said["position_covariance"][:3] == [400.0, 0.0, 900.0]
    assert said["contributors"] == [[0, 1, "array", 7]]
    assert said["t"] == START + 7


@pytest.mark.parametrize("is_expected", [True, False])
def test_another_ship_is_shown_beside_own_ship_whoever_tells_first(is_expected: bool) -> None:
    sent: list[Frame] = []
    feed = PageFeed(PageConfiguration(), sent.append)
    if is_expected:
        for topic in ("/consort/own_ship/odometry", "/own_ship/odometry"):
            feed.expect(topic, "nav_msgs/msg/Odometry")
    for topic, x in (("/consort/own_ship/odometry", 900.0), ("/own_ship/odometry", 5.0)) * 2:
        state = replace(own_ship(2), position=(x, 0.0))
        feed.take(topic, deserialize_message(own_ship_to_bytes(state), Odometry))
        feed.take(topic, deserialize_message(own_ship_to_bytes(state), Odometry))
    said = [(one.kind, content(one)["x"]) for one in sent if one.kind in ("own_ship", "ship")]
    # Of a ship nobody has spoken of, the only one there is is taken for her until she is heard.
    assert said[:2] == [("ship" if is_expected else "own_ship", 900.0)] * 2
    assert said[2:] == [("own_ship", 5.0)] * 2 + [("ship", 900.0)] * 2 + [("own_ship", 5.0)] * 2


def test_own_ship_is_known_between_and_shortly_after_its_states() -> None:
    log = OwnShipLog()
    assert log.state_at(own_ship(0).stamp) is None
    log.add(own_ship(0))
    log.add(own_ship(2))
    for second in (1.0, 2.0, 4.0):
        known = log.state_at(own_ship(second).stamp)
        assert known is not None
        assert known.position == pytest.approx((0.0, 4.0 * second))
    assert log.state_at(own_ship(60).stamp) is None


def test_the_past_is_bounded_in_time_and_the_newest_is_always_there() -> None:
    history = FrameHistory(60.0)
    for second in range(12 * 3600):
        history.add(Frame("own_ship", "own_ship ", float(second), "x"))
    assert len(history) == 61
    assert history.latest["own_ship "].time == 12 * 3600 - 1


def test_the_past_is_bounded_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sonar_tracking.display.page.frame_history.LARGEST", 1000)
    history = FrameHistory(1e6)
    for second in range(100):
        history.add(Frame("tracks", "tracks a", float(second), "x" * 100))
    assert len(history) == 10


def test_where_the_data_begin_anew_nothing_of_a_later_time_is_left() -> None:
    """A row that had begun, or a spectrum, would say again that the clock has gone back."""
    history = FrameHistory(600.0)
    kinds = ("tracks", "waterfall_open", "lofar", "dots")
    for kind in kinds:
        history.add(Frame(kind, f"{kind} a", 700.0, "x"))
    assert all(history.begins_anew(Frame(kind, f"{kind} a", 100.0, "x")) for kind in kinds)
    history.clear()
    assert not any(history.begins_anew(Frame(kind, f"{kind} a", 100.0, "x")) for kind in kinds)


def test_commands_last_longer_than_the_past_and_may_be_late() -> None:
    history = FrameHistory(60.0)
    told = [Frame("command", "command ", time, "x") for time in (10.0, 10.0, 0.0)]
    for frame in told:
        assert not history.begins_anew(frame)
        history.add(frame)
    for second in range(3600):
        history.add(Frame("own_ship", "own_ship ", float(second), "x"))
    assert list(history)[:3] == told
    assert len(history) == 64
    history.clear()
    assert len(history) == 0


class _Columns:
    """A message with two tracks and one status."""

    id = (1, 2)
    status = (1,)

    def __getattr__(self, name: str) -> tuple[int, ...]:
        return ()


def test_a_message_that_cannot_be_read_is_counted_and_named() -> None:
    sent: list[Frame] = []
    feed = PageFeed(PageConfiguration(), sent.append)
    # A class of a message is called so by whoever made it of the definition.
    broken = type("sonar_tracking_msgs__msg__Tracks", (_Columns,), {})()
    feed.take("/tracks", broken)
    feed.take("/unknown", SimpleNamespace())
    topic = content(feed.health.frame())["topics"][0]
    assert topic["name"] == "/tracks"
    assert topic["rejected"] == 1
    assert topic["reason"]


def diagnostics(node: str, level: int, message: str, **values: int) -> SimpleNamespace:
    """Return a message in which a node tells of one input."""
    items = [SimpleNamespace(key=key, value=str(value)) for key, value in values.items()]
    status = SimpleNamespace(
        name=f"{node}: input /array", level=bytes([level]), message=message, values=items
    )
    return SimpleNamespace(status=[status])


def test_health_tells_backlog_remedies_and_who_is_gone() -> None:
    now = 100.0
    health = Health(lambda: now)
    health.heard("/tracks", START + 10.0)
    last = (START + 8) * NANOSECONDS
    known = {"received": 12, "finished": 9, "rejected": 1, "last_stamp_ns": last}
    health.diagnosed(diagnostics("tma_tracker", 1, "slow; give it a core.", **known))
    node = content(health.frame())["nodes"][0]
    assert node["alive"]
    assert (node["backlog"], node["rejected"], node["lag"]) == (3, 1, 2.0)
    assert (node["level"], node["message"]) == ("warning", "slow; give it a core.")
    assert not content(health.frame())["stale"]
    now += max(GONE, STALE) + 1.0
    said = content(health.frame())
    assert said["stale"]
    assert not said["nodes"][0]["alive"]


def test_a_command_of_a_page_is_that_of_the_message() -> None:
    asked = {"command": "choose_side", "topic": "passive/tracks", "id": 4, "side": 2, "kind": "x"}
    command = command_from_page(asked)
    assert command.kind is CommandKind.CHOOSE_SIDE
    assert (command.topic, command.id, int(command.side)) == ("passive/tracks", 4, 2)


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({}, "no command 'None'"),
        ({"command": "sink"}, "no command 'sink'"),
        ({"command": "end_track", "topic": "tracks", "id": -1}, "id of a command"),
        ({"command": "end_track", "topic": "tracks", "id": "1"}, "id of a command"),
        ({"command": "end_track", "topic": "tracks", "id": 1e300}, "id of a command"),
        ({"command": "end_track", "topic": ["tracks"], "id": 1}, "topic of a command"),
        ({"command": "start_track", "topic": "passive/bearing_tracks"}, "does not say where"),
        ({"command": "end_track", "topic": "tracks", "id": math.nan}, "id of a command"),
    ],
)
def test_a_command_that_makes_no_sense_is_refused(asked: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        command_from_page(asked)


def test_text_frames_are_strict_json() -> None:
    frame = text_frame("health", math.nan, x=math.inf, y=np.array([np.nan]))
    assert content(frame) == {"kind": "health", "t": None, "x": None, "y": [None]}
