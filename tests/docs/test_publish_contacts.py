"""Protects ten lines that publish contacts: they are as good as an import of the same contacts."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.graph.catalogue.topics import ACTIVE_TRACKS
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.bearings import TrackStatus
from tests.docs.code_blocks import DOCS, CodeBlock, blocks_of
from tests.docs.test_tutorials import reader_environment, run_block
from tests.graph.live_graph import PATIENCE, Probe

PAGE = DOCS / "tutorials" / "publish_contacts.md"
NODE = "hpda_tracker"
N_PINGS = 60
TEN_LINES = 10
"""Without the imports."""


def publisher() -> CodeBlock:
    """Return the program that publishes."""
    (block,) = (each for each in blocks_of(PAGE) if each.caption == "publisher.py")
    return block


def test_it_has_ten_lines_and_fills_five_fields() -> None:
    lines = [line for line in publisher().text.splitlines() if line and "import" not in line]
    assert len(lines) == TEN_LINES
    filled = ("range=", "azimuth=", "range_standard_deviation", "azimuth_standard_deviation")
    assert all(name in publisher().text for name in (*filled, "header.stamp.sec = "))
    assert publisher().text.count("ping.") == 3


@contextmanager
def tracker(folder: Path) -> Iterator[None]:
    """Run the tracker as the page says, with a queue that holds everything on a busy machine."""
    lines = [line for block in blocks_of(PAGE) for line in block.commands if NODE in line]
    with (folder / "tracker.log").open("w") as output:
        process = subprocess.Popen(
            [sys.executable, *lines[0].split()[1:], "-p", f"flow_depth:={N_PINGS}"],
            cwd=folder,
            env=reader_environment(folder),
            stdout=output,
            stderr=subprocess.STDOUT,
        )
    try:
        yield
    finally:
        process.terminate()
        process.wait(PATIENCE)


@pytest.mark.system
def test_its_tracks_are_those_of_the_import(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Live against imported and replayed: states, names and confirmations of every ping."""
    for block in blocks_of(PAGE):
        run_block(block, tmp_path, tmp_path_factory)
    replayed = list(position_tracks_of(read_bag(tmp_path / "ping_tracks"), "/active/tracks"))
    assert len(replayed) == N_PINGS
    assert np.count_nonzero(replayed[-1].status == TrackStatus.CONFIRMED) == 2
    probe = Probe()
    heard = probe.listen(ACTIVE_TRACKS)
    with tracker(tmp_path):
        probe.wait(lambda: probe.matched(NODE), "the tracker")
        subprocess.run(
            [sys.executable, "publisher.py"],
            cwd=tmp_path,
            env=reader_environment(tmp_path),
            timeout=PATIENCE,
            check=True,
        )
        probe.wait_for_count(heard.__len__, N_PINGS, "pictures")
    probe.close()
    assert (tmp_path / "tracker.log").read_text().count("sensor_pose is that of a new message") == 1
    for message, expected in zip(heard, replayed, strict=True):
        live = position_tracks_from_message(message)
        assert live.stamp == expected.stamp
        assert live.id.tolist() == expected.id.tolist()
        assert live.status.tolist() == expected.status.tolist()
        np.testing.assert_allclose(live.state, expected.state, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(live.covariance, expected.covariance, rtol=1e-9, atol=1e-9)
