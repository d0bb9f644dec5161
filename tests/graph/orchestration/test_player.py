"""The player publishes recorded inputs in order, in time, and never past the flow window."""

import math
from typing import Any

import pytest

from sonar_tracking.bags.contents.storage_file import BagMessage
from sonar_tracking.graph.catalogue.run_identity import CONTROL_NODE
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.player import CLOCK_PERIOD, FULL_SPEED_CLOCK_PERIOD, Player
from tests.graph.orchestration.quiet_desk import quiet_desk

BLOCKS, TRACKS = "/array/snapshots", "/passive/bearing_tracks"
TRUTH = "/truth/bearing_tracks"
START = 1_767_225_600_000_000_000
WINDOW = 4


class Graph:
    """Takes what the player publishes, in place of the ROS side."""

    def __init__(self) -> None:
        self.published: list[tuple[str, bytes]] = []
        self.clocks: list[int] = []
        self.ledger = FlowLedger({BLOCKS: ("chain",)}, {BLOCKS: CONTROL_NODE})
        self.aside: list[BagMessage] = []

    def publish(self, topic: str, data: bytes) -> None:
        self.published.append((topic, data))

    def publish_clock(self, stamp: int) -> None:
        self.clocks.append(stamp)

    def player(self, messages: list[BagMessage], rate: float) -> Player:
        control: Any = self
        return Player(
            control,
            self.ledger,
            messages,
            {BLOCKS},
            {TRUTH},
            self.aside.append,
            lambda topic, data, wall: None,
            WINDOW,
            rate,
            quiet_desk(),
        )


def recording(blocks: int) -> list[BagMessage]:
    messages = []
    for number in range(blocks):
        stamp = START + number * CLOCK_PERIOD
        messages.append(BagMessage(BLOCKS, stamp, b"block %d" % number))
        messages.append(BagMessage(TRACKS, stamp, b"tracks %d" % number))
    return messages


def test_full_speed_stops_at_the_window_and_goes_on_with_the_consumer() -> None:
    graph = Graph()
    player = graph.player(recording(10), math.inf)
    for _ in range(20):
        player.advance(0.0)
    assert len(graph.published) == WINDOW
    for finished in range(1, 11):
        graph.ledger.finished("chain", BLOCKS, finished)
        player.advance(0.0)
    assert player.finished
    assert [data for _, data in graph.published] == [b"block %d" % n for n in range(10)]
    # What is not an input is not published, but handed on; none is forgotten at the end.
    assert [message.data for message in graph.aside] == [b"tracks %d" % n for n in range(10)]
    assert graph.clocks == [START, START + FULL_SPEED_CLOCK_PERIOD]
    assert player.data_seconds == pytest.approx(0.9)


def test_recorded_time_is_kept_at_any_rate() -> None:
    graph = Graph()
    player = graph.player(recording(3), 2.0)
    assert player.advance(10.0) == 0.0
    assert player.advance(10.0) == pytest.approx(0.05)
    assert player.advance(10.049) == pytest.approx(0.001)
    player.advance(10.0501)
    assert len(graph.published) == 2


def test_a_pause_is_not_caught_up() -> None:
    graph = Graph()
    player = graph.player(recording(3), 1.0)
    player.advance(0.0)
    player.resume(0.04, 50.0)
    assert player.advance(50.0) == pytest.approx(0.06), "what passed before the pause counts"


def test_a_recording_without_inputs_is_finished_at_once() -> None:
    graph = Graph()
    player = graph.player([BagMessage(TRACKS, START, b"tracks")], 1.0)
    assert player.finished
    assert player.data_seconds == 0.0
    assert len(graph.aside) == 1


def test_truth_is_published_beside_the_inputs_and_moves_no_clock() -> None:
    graph = Graph()
    early, late = START - 3600 * 10 * CLOCK_PERIOD, START + 3600 * 10 * CLOCK_PERIOD
    between = START + CLOCK_PERIOD // 2
    blocks = [message for message in recording(2) if message.topic == BLOCKS]
    truth = [BagMessage(TRUTH, time, b"truth") for time in (early, between, late)]
    messages = sorted([*blocks, *truth], key=lambda message: message.log_time)
    player = graph.player(messages, 1.0)
    player.advance(0.0)
    player.advance(0.0)
    player.advance(0.0)
    assert [topic for topic, _ in graph.published] == [TRUTH, BLOCKS, TRUTH]
    assert player.advance(0.04) == pytest.approx(0.06), "the second block waits for its time"
    player.advance(0.11)
    player.advance(0.11)
    assert [topic for topic, _ in graph.published[3:]] == [BLOCKS, TRUTH] and player.finished
    assert graph.clocks == [message.log_time for message in blocks]
    assert player.data_seconds == pytest.approx(0.1)


def test_truth_waits_for_a_slow_consumer_like_anything_else() -> None:
    graph = Graph()
    graph.ledger = FlowLedger({TRUTH: ("recorder",)}, {TRUTH: CONTROL_NODE})
    player = graph.player([BagMessage(TRUTH, START, b"%d" % n) for n in range(9)], math.inf)
    for _ in range(20):
        player.advance(0.0)
    assert len(graph.published) == WINDOW
    for finished in range(1, 9):
        graph.ledger.finished("recorder", TRUTH, finished)
        player.advance(0.0)
    assert [data for _, data in graph.published] == [b"%d" % n for n in range(9)]


def test_a_recording_that_begins_again_waits_for_its_first_end_and_keeps_its_pace() -> None:
    graph = Graph()
    blocks = [message for message in recording(3) if message.topic == BLOCKS]
    player = graph.player([*blocks, *blocks], 1.0)
    for wall in (0.0, 0.11, 0.21, 0.31):
        player.advance(wall)
    assert len(graph.published) == 3, "the graph is still at work on the first pass"
    graph.ledger.finished("chain", BLOCKS, 3)
    player.advance(5.0)
    assert len(graph.published) == 4
    assert player.advance(5.0) == pytest.approx(0.1)
    player.advance(5.11)
    player.advance(5.21)
    assert player.finished
    assert graph.clocks == [message.log_time for message in (*blocks, *blocks)]
    assert player.data_seconds == pytest.approx(0.4)


def test_a_player_that_waits_for_a_consumer_is_behind() -> None:
    graph = Graph()
    player = graph.player(recording(10), 1.0)
    assert player.behind(5.0) == 0.0
    for tenths in range(20):
        player.advance(10.0 + tenths / 10)
    assert len(graph.published) == WINDOW
    assert player.behind(10.4) == pytest.approx(0.0, abs=1e-6)
    assert player.behind(12.4) == pytest.approx(2.0)
    for finished in range(1, 11):
        graph.ledger.finished("chain", BLOCKS, finished)
        player.advance(12.4)
    assert player.finished
    assert player.behind(12.4) == pytest.approx(1.5), "the last block was due after 0.9 s"
