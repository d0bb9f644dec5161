"""The live page of a run: it comes back when it is killed, and nothing of the run depends on it."""

from __future__ import annotations

import asyncio
import re
import socket
import time
from pathlib import Path

from tornado.websocket import websocket_connect

from tests.display.page.socket_frames import close, greeting
from tests.system.command_line import (
    PATIENCE,
    RunningCommand,
    report_of,
    run_command,
)

PAGE = ("--display", "page", "--no-browser")


async def tracks_seen(port: int) -> int:
    """Return how many lists of tracks the page at a port has shown so far; wait for the first."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        try:
            link = await websocket_connect(f"ws://localhost:{port}/socket")
        except OSError:
            await asyncio.sleep(0.1)
            continue
        kinds = [frame["kind"] for frame in await greeting(link)]
        await close(link)
        if "tracks" in kinds:
            return kinds.count("tracks")
        await asyncio.sleep(0.1)
    raise AssertionError("the page has shown no tracks")


def test_a_killed_page_comes_back(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        asked = taken.getsockname()[1]
        command = RunningCommand(tmp_path, "run", "active", *PAGE, "--page-port", asked)
        try:
            command.wait_for_text("data flow")
            address = re.match(r"page: http://localhost:(\d+)/#token=[\w-]+\n", command.output)
            assert address, "the address is printed first"
            assert f"port {asked} is taken" in command.output
            port = int(address[1])
            assert asyncio.run(tracks_seen(port))
            command.kill_node("operator_display")
            command.wait_for_text("it was started again")
            assert asyncio.run(tracks_seen(port))
            command.interrupt()
            assert command.wait() == 130, command.output
        finally:
            command.clean_up()
    assert "failed" not in command.own_output


def test_what_is_computed_does_not_depend_on_the_page(tmp_path: Path) -> None:
    bag, reports = tmp_path / "bag", [tmp_path / f"{n}.json" for n in range(2)]
    run = ("run", "active", "--duration", "60", "--rate", "max")
    run_command(tmp_path, *run, *PAGE, "--record", bag, "--json", reports[0])
    run_command(tmp_path, "replay", bag, "--rate", "max", "--json", reports[1])
    with_page, without = map(report_of, reports)
    assert with_page["failures"] == without["failures"] == []
    assert with_page["warnings"] == []
    compared = without["comparison"]
    assert compared
    assert all(words.startswith("identical") for words in compared.values())
