"""``show``: the page of a recording, whatever it holds."""

from __future__ import annotations

import asyncio
import json
import signal
import subprocess
import sys
import threading
from collections import Counter
from pathlib import Path

import pytest
from tornado.websocket import websocket_connect

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.display.page import recorded_page
from sonar_tracking.display.page.recorded_page import RecordedPage
from sonar_tracking.errors import ConfigurationError
from tests.bags.bag_fixtures import TRACKS
from tests.bags.position_fixtures import COMMANDS, CONTACTS, IMAGE, LINES, ODOMETRY, POSITIONS
from tests.display.page.socket_frames import close, frames_from, greeting, heard
from tests.display.test_plot_bag import EPOCH, N_SECONDS, bag

TOPICS = {
    "/own_ship/odometry": ODOMETRY,
    "/active/contacts": CONTACTS,
    "/active/tracks": POSITIONS,
    "/truth/tracks": POSITIONS,
    "/passive/bearing_tracks": TRACKS,
    "/passive/frequency_lines": LINES,
}
KINDS = {
    "/own_ship/odometry": "own_ship",
    "/active/contacts": "contacts",
    "/active/tracks": "tracks",
    "/truth/tracks": "tracks",
    "/passive/bearing_tracks": "bearings",
    "/passive/frequency_lines": "lines",
}


def shown(path: Path) -> Counter[str]:
    """Return how many frames of each kind the page of a bag shows of the past."""
    page = RecordedPage(read_bag(path), 0, "127.0.0.1")
    page.server.start()

    async def frames() -> Counter[str]:
        link = await websocket_connect(f"ws://localhost:{page.server.port}/socket")
        kinds = [frame["kind"] for frame in await greeting(link)]
        await close(link)
        return Counter(kinds[kinds.index("history") :])

    try:
        page.feed()
        return asyncio.run(asyncio.wait_for(frames(), 60.0))
    finally:
        page.server.stop()


@pytest.mark.slow
@pytest.mark.parametrize(
    "left",
    [
        tuple(TOPICS),
        ("/own_ship/odometry", "/active/contacts", "/passive/frequency_lines"),
        ("/active/tracks", "/truth/tracks", "/passive/bearing_tracks"),
        ("/active/contacts",),
    ],
    ids=["all", "half", "other_half", "one"],
)
def test_what_a_bag_holds_is_shown(tmp_path: Path, left: tuple[str, ...]) -> None:
    found = shown(bag(tmp_path / "bag", {name: TOPICS[name] for name in left}))
    expected: Counter[str] = Counter()
    for name in left:
        # Of the truth, which moves steadily, every other second is shown.
        expected[KINDS[name]] += N_SECONDS // 2 if name.startswith("/truth/") else N_SECONDS
    assert {kind: found[kind] for kind in KINDS.values()} == {
        kind: expected[kind] for kind in KINDS.values()
    }


def test_a_bag_with_nothing_to_show_is_refused(tmp_path: Path) -> None:
    path = bag(tmp_path / "bag", {"/array/lofar": IMAGE, "/array/tracks": TRACKS})
    only_pictures = read_bag(path)
    only_pictures.topics.pop("/array/tracks")
    with pytest.raises(ConfigurationError, match="holds nothing to show"):
        RecordedPage(only_pictures, 0, "127.0.0.1")


@pytest.mark.slow
def test_the_command_shows_a_bag_until_it_is_interrupted(tmp_path: Path) -> None:
    path = bag(tmp_path / "bag", TOPICS)
    command = [sys.executable, "-m", "sonar_tracking", "show", str(path), "--no-browser"]
    with subprocess.Popen(
        [*command, "--page-port", "0"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as running:
        assert running.stdout is not None
        assert "is shown at http://localhost:" in running.stdout.readline()
        running.send_signal(signal.SIGINT)
        assert running.wait(60.0) == 130
        assert running.stdout.read() == ""


@pytest.mark.slow
def test_every_part_of_a_long_bag_can_be_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Memory takes some of ten minutes: the beginning, then what is looked for, with what leads.

    What was commanded before has its effect there.
    """
    topics = {"/operator/commands": COMMANDS, "/active/tracks": POSITIONS}
    path = bag(tmp_path / "bag", topics, 600)
    monkeypatch.setattr(recorded_page, "LEAD", 20.0)
    monkeypatch.setattr(recorded_page, "LARGEST_PART", 50_000)
    page = RecordedPage(read_bag(path), 0, "127.0.0.1")
    page.server.start()
    found: dict[float, tuple[float, float, str]] = {}
    commanded: dict[float, list[float]] = {}

    async def look(*wanted: float) -> None:
        link = await websocket_connect(f"ws://localhost:{page.server.port}/socket")
        begin, end = (await heard(link, "hello"))["span"]
        assert (begin, end) == (EPOCH, EPOCH + 599)
        for offset in wanted:
            await link.write_message(json.dumps({"kind": "seek", "t": begin + offset}))
            times: list[float] = []
            commanded[offset] = []
            part = False
            async for frame in frames_from(link):
                part |= frame["kind"] == "part"
                if part and frame["kind"] == "tracks":
                    times.append(frame["t"] - begin)
                if part and frame["kind"] == "command":
                    commanded[offset].append(frame["t"] - begin)
                if part and frame["kind"] == "recording" and "reading" not in frame["state"]:
                    found[offset] = (times[0], times[-1], frame["state"])
                    break
        await link.write_message(json.dumps({"kind": "seek", "t": begin - 1.0}))
        assert "has no time" in (await heard(link, "command_result"))["sentence"]
        await close(link)

    try:
        page.feed()
        threading.Thread(target=page.follow, daemon=True).start()
        asyncio.run(asyncio.wait_for(look(599.0, 300.0, 5.0), 60.0))
    finally:
        page.server.stop()
    assert found[599.0] == (579.0, 599.0, "last part")
    assert found[5.0][0] == 0.0
    first, last, state = found[300.0]
    assert (first, state) == (280.0, "part")
    assert 300.0 < last < 500.0
    assert commanded[300.0][:301] == list(range(301))
    assert commanded[5.0][:10] == list(range(10))
