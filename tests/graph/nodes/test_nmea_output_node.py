"""A live nmea_output: what a chart plotter hears of the tracks of the graph."""

from __future__ import annotations

import math
import socket
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.scenario_graph import started_nodes
from sonar_tracking.graph.catalogue.topics import FUSED_TRACKS, ODOMETRY
from sonar_tracking.graph.message_writing.array_writing import own_ship_to_message
from sonar_tracking.graph.message_writing.position_writing import position_tracks_to_message
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.scenarios.scenario_mapping import scenario_from_mapping
from tests.graph.live_graph import Probe, node_process

NODE = "nmea_output"
BEGIN = 1_767_225_600


def picture(second: int) -> PositionTracks:
    return PositionTracks(
        stamp=(BEGIN + second) * NANOSECONDS,
        next_stamp=(BEGIN + second + 1) * NANOSECONDS,
        id=np.array([5], np.uint64),
        status=np.array([TrackStatus.CONFIRMED], np.uint8),
        source=np.array([TrackSource.FUSED], np.uint8),
        state=np.array([[1852.0, 0.0, 0.0, 0.0]]),
    )


def test_a_plotter_hears_ranges_and_places_every_two_seconds(tmp_path: Path) -> None:
    plotter = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    plotter.bind(("127.0.0.1", 0))
    plotter.settimeout(20.0)
    parameters = {"use_sim_time": True, "port": plotter.getsockname()[1], "datum": "'0.0,10.0'"}
    probe = Probe()
    odometry, tracks = probe.publisher(ODOMETRY), probe.publisher(FUSED_TRACKS)
    module = f"sonar_tracking.graph.nodes.{NODE}"
    with node_process(module, tmp_path / "log.txt", **parameters), plotter:
        probe.wait_matched(NODE, "/tracks", "/own_ship/odometry")
        for second in range(4):
            stamp = (BEGIN + second) * NANOSECONDS
            state = OwnShipState(stamp, (0.0, 0.0), math.pi / 2, (0.0, 0.0), 0.0)
            odometry.publish(own_ship_to_message(state))
            tracks.publish(position_tracks_to_message(picture(second)))
        heard = [plotter.recv(200).decode("ascii") for _ in range(4)]
    probe.close()
    assert all(text.endswith("\r\n") for text in heard)
    assert [text.split(",")[0] for text in heard] == ["$RATTM", "$RATLL"] * 2
    assert heard[0].split(",")[1:4] == ["01", "1.00", "90.0"]
    assert heard[1].split(",")[2:6] == ["0000.0000", "N", "01000.9982", "E"]
    assert [text.split(",")[14] for text in heard[::2]] == ["000000.00", "000002.00"]


def test_a_scenario_that_asks_for_it_needs_fused_tracks() -> None:
    sonar = {"active_sonar": {"maximum_range": 6000.0}}
    both = scenario_from_mapping({**sonar, "nodes": {"track_fusion": {}, NODE: {}}}, "both")
    assert NODE in [node.name for node in started_nodes(both, "both")]
    alone = scenario_from_mapping({**sonar, "nodes": {NODE: {}}}, "alone")
    with pytest.raises(ConfigurationError, match=r"nmea_output has nothing to do .* tracks"):
        started_nodes(alone, "alone")
