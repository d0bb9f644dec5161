"""A live operator_display: the page of its own graph, whatever else is heard in the domain."""

from __future__ import annotations

import asyncio
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

from tornado.websocket import websocket_connect

from sonar_tracking.graph.catalogue.topics import FUSED_TRACKS
from sonar_tracking.graph.message_writing.position_writing import position_tracks_to_message
from tests.display.page.page_scene import tracks
from tests.display.page.socket_frames import close, frames_from
from tests.graph.live_graph import NodeProcess, Probe, node_process

MODULE = "sonar_tracking.graph.nodes.operator_display"


def port_of(process: NodeProcess, probe: Probe) -> int:
    """Return the port of a page, once it is told."""
    told = re.compile(r"the page is at http://localhost:(\d+)/")
    probe.wait(lambda: told.search(process.output), "address of the page")
    found = told.search(process.output)
    assert found
    return int(found[1])


async def lists_of_tracks(port: int, count: int) -> list[dict[str, Any]]:
    """Return the first lists of tracks a page shows."""
    link = await websocket_connect(f"ws://localhost:{port}/socket")
    found: list[dict[str, Any]] = []
    async for frame in frames_from(link):
        if frame["kind"] == "tracks" and frame["t"] not in [one["t"] for one in found]:
            found.append(frame)
        if len(found) == count:
            break
    await close(link)
    return found


def test_pages_of_two_graphs_show_each_its_own(tmp_path: Path) -> None:
    """Both ask for one port: the second takes the next, and says so."""
    probe = Probe()
    ships = ("/ship_a", "/ship_b")
    publishers = [probe.publisher(replace(FUSED_TRACKS, name=f"{ship}/tracks")) for ship in ships]
    with (
        node_process(MODULE, tmp_path / "a.log", ships[0], port=0) as first,
        node_process(MODULE, tmp_path / "b.log", ships[1], port=port_of(first, probe)) as second,
    ):
        ports = [port_of(one, probe) for one in (first, second)]
        assert ports[0] != ports[1]
        probe.wait(
            lambda: all(one.get_subscription_count() for one in publishers), "both pages listen"
        )
        for number in range(3):
            publishers[0].publish(position_tracks_to_message(tracks(number, 1)))
            publishers[1].publish(position_tracks_to_message(tracks(number, 2)))
        shown = [asyncio.run(lists_of_tracks(port, 3)) for port in ports]
        for ship, frames, count in zip(ships, shown, (1, 2), strict=True):
            assert {frame["topic"] for frame in frames} == {f"{ship}/tracks"}
            assert {len(frame["id"]) for frame in frames} == {count}
        assert first.stop() == second.stop() == 0
    probe.close()
