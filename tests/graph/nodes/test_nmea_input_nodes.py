"""Live own_ship_nmea and ais_truth: sentences over UDP become odometry and truth of the graph."""

from __future__ import annotations

import math
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.scenario_graph import started_nodes
from sonar_tracking.graph.catalogue.topics import FUSED_TRACKS, ODOMETRY, TRUE_TRACKS
from sonar_tracking.graph.message_writing.position_writing import position_tracks_to_message
from sonar_tracking.message_reading.array_reading import own_ship_from_message
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.scenarios.scenario_mapping import scenario_from_mapping
from tests.bags.nmea.nmea_scene import BEGIN, FERRY, OWN_VELOCITY, gga, log_lines
from tests.graph.live_graph import Probe, node_process

OWN_SHIP, AIS = "own_ship_nmea", "ais_truth"
START = round(BEGIN.timestamp()) * NANOSECONDS
GROUND_SPEED = math.hypot(*OWN_VELOCITY)


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as trial:
        trial.bind(("127.0.0.1", 0))
        return int(trial.getsockname()[1])


@pytest.fixture
def probe() -> Iterator[Probe]:
    probe = Probe()
    yield probe
    probe.close()


@contextmanager
def sender(port: int) -> Iterator[Callable[[str], None]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as speaker:

        def send(text: str) -> None:
            speaker.sendto(text.encode("latin-1"), ("127.0.0.1", port))

        yield send


def test_own_ship_is_where_its_receiver_says_when_it_says(probe: Probe, tmp_path: Path) -> None:
    port = free_port()
    heard = probe.listen(ODOMETRY)
    module = f"sonar_tracking.graph.nodes.{OWN_SHIP}"
    parameters = {"address": "127.0.0.1", "port": port}
    with node_process(module, tmp_path / "log.txt", **parameters), sender(port) as send:
        probe.wait_matched(OWN_SHIP, "/own_ship/odometry")
        send("\x00noise\r\n" + gga(0, (0.0, 0.0)) + "\r\n")  # of no date yet
        for line in log_lines(20, ships=()):
            whole = f"{line}\r\n"
            send(whole[:17])  # as converters of serial lines cut it
            send(whole[17:])
        send("$GPHDT,1.0,T*00\r\n")
        probe.wait_for_count(lambda: len(heard), 20, "own ship's states")
        probe.wait_sentence(f"{OWN_SHIP}: sentences", "1 times no sentence of NMEA 0183")
        probe.wait_sentence(f"{OWN_SHIP}: sentences", "1 times the checksum is wrong")
        assert probe.values(f"{OWN_SHIP}: sentences")["RMC"] == "20"
    states = [own_ship_from_message(message) for message in heard]
    assert [s.stamp for s in states] == [START + n * NANOSECONDS for n in range(20)]
    for second, state in enumerate(states):
        expected = (OWN_VELOCITY[0] * second, OWN_VELOCITY[1] * second)
        assert state.position == pytest.approx(expected, abs=0.02)
        assert state.velocity == pytest.approx((GROUND_SPEED, 0.0), abs=0.01)


def test_ships_are_the_truth_by_the_datum_and_the_time_of_own_ship(
    probe: Probe, tmp_path: Path
) -> None:
    port, own_port, plotter = free_port(), free_port(), free_port()
    screen = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    screen.bind(("127.0.0.1", plotter))
    screen.settimeout(20.0)
    truth, odometry = probe.listen(TRUE_TRACKS), probe.listen(ODOMETRY)
    tracks = probe.publisher(FUSED_TRACKS)
    common = {"address": "127.0.0.1"}
    start = "sonar_tracking.graph.nodes."
    with (
        node_process(start + OWN_SHIP, tmp_path / "own.txt", port=own_port, **common),
        node_process(start + AIS, tmp_path / "ais.txt", port=port, **common),
        node_process(start + "nmea_output", tmp_path / "out.txt", port=plotter, **common),
        screen,
        sender(port) as send,
        sender(own_port) as send_own,
    ):
        probe.wait_matched(AIS, "/truth/tracks", "/own_ship/odometry")
        probe.wait_matched(OWN_SHIP, "/own_ship/odometry")
        probe.wait_matched("nmea_output", "/tracks")
        for second in range(40):
            burst = log_lines(second + 1, ships=(FERRY,))[-4 if second % 10 == 0 else -3 :]
            for line in burst:
                (send if line.startswith("!") else send_own)(f"{line}\r\n")
            probe.wait_for_count(lambda: len(odometry), second, "own ship's states")
        probe.wait_for_count(lambda: len(truth), 20, "pictures of the ships")
        pictures = [position_tracks_from_message(message) for message in truth]
        tracks.publish(position_tracks_to_message(fused(START + 30 * NANOSECONDS)))
        assert "$RATLL,01,5410.8" in screen.recv(200).decode("ascii")
    known = [picture for picture in pictures if picture.id.tolist() == [FERRY.mmsi]]
    assert len(known) > 10
    for picture in known:
        time = (picture.stamp - START) / NANOSECONDS
        assert picture.source.tolist() == [TrackSource.TRUTH]
        assert picture.state[0, :2] == pytest.approx(FERRY.at(time), abs=0.6)
        assert picture.state[0, 2:] == pytest.approx(FERRY.velocity, abs=0.06)
    assert any(picture.status[0] == TrackStatus.CONFIRMED for picture in known)


def fused(stamp: int) -> PositionTracks:
    return PositionTracks(
        stamp=stamp,
        id=np.array([5], np.uint64),
        status=np.array([TrackStatus.CONFIRMED], np.uint8),
        source=np.array([TrackSource.FUSED], np.uint8),
        state=np.array([[0.0, 0.0, np.nan, np.nan]]),
    )


def test_a_node_that_cannot_listen_or_is_told_nonsense_says_so(tmp_path: Path) -> None:
    for name in (OWN_SHIP, AIS):
        module = f"sonar_tracking.graph.nodes.{name}"
        for number, (parameters, words) in enumerate(
            [({"address": "192.0.2.7"}, "nobody can listen there"), ({"datum": "north"}, "datum")]
        ):
            log = tmp_path / f"{name}{number}.txt"
            with node_process(module, log, **parameters) as process:
                assert process.wait() == 1
                assert words in process.output


def test_a_run_does_not_start_what_its_clock_cannot_wait_for() -> None:
    scenario = scenario_from_mapping(
        {"active_sonar": {"maximum_range": 6000.0}, "nodes": {OWN_SHIP: {}}}, "live"
    )
    with pytest.raises(ConfigurationError, match="ros2 run sonar_tracking own_ship_nmea"):
        started_nodes(scenario, "live")
    assert AIS not in [
        node.name
        for node in started_nodes(
            scenario_from_mapping({"active_sonar": {"maximum_range": 6000.0}}, "plain"), "plain"
        )
    ]
