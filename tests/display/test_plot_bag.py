"""``plot``: a picture of each kind of data the bag holds, whatever is odd about them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.display.plot_bag import plot_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from tests.bags.bag_fixtures import EPOCH, SECOND, TRACKS, tracks_cdr
from tests.bags.position_fixtures import (
    COMMANDS,
    CONTACTS,
    IMAGE,
    LINES,
    ODOMETRY,
    POSITIONS,
    command_cdr,
    contacts_cdr,
    frequency_lines_cdr,
    lofar_cdr,
    odometry_cdr,
    position_tracks_cdr,
)
from tests.display.position_pictures import position_tracks

N_SECONDS = 12


def message(kind: str, second: int, truth: bool) -> bytes:
    stamp = (EPOCH + second) * SECOND
    if kind == ODOMETRY:
        return odometry_cdr(OwnShipState(stamp, (5.0 * second, 0.0), 0.0, (5.0, 0.0), 0.0))
    if kind == CONTACTS:
        generator = np.random.default_rng(second)
        return contacts_cdr(
            Contacts(
                stamp=stamp,
                range=np.append(generator.uniform(100.0, 3000.0, 5), np.nan),
                azimuth=generator.uniform(-3.0, 3.0, 6),
                amplitude=generator.exponential(5.0, 6),
                range_standard_deviation=5.0,
                azimuth_standard_deviation=0.01,
                sensor_position=(5.0 * second, 0.0),
            )
        )
    if kind == LINES:
        return frequency_lines_cdr(stamp, [300.0 + 0.01 * second, 210.0])
    if kind == IMAGE:
        return lofar_cdr(stamp, np.random.default_rng(second).normal(size=400).astype(np.float32))
    if kind == TRACKS:
        return tracks_cdr(second)
    if kind == COMMANDS:
        return command_cdr(stamp)
    spread = np.full((1, 4, 4), np.nan) if truth else np.diag([900.0, 100.0, 1.0, 1.0])[None]
    state = [1000.0 - 3.0 * second, 800.0, -3.0, 0.0]
    return position_tracks_cdr(position_tracks(second, [state], covariance=spread))


def bag(path: Path, topics: dict[str, str], n_seconds: int = N_SECONDS) -> Path:
    """Write a bag with topics of the given types."""
    writer = BagWriter(path)
    for topic, kind in topics.items():
        truth = topic.startswith("/truth/")
        writer.add_topic(topic, kind, role="truth" if truth else "output")
        for second in range(n_seconds):
            writer.write(topic, (EPOCH + second) * SECOND, message(kind, second, truth))
    writer.close()
    return path


ACTIVE = {
    "/active/contacts": CONTACTS,
    "/active/tracks": POSITIONS,
    "/truth/tracks": POSITIONS,
    "/own_ship/odometry": ODOMETRY,
}
PLACES = ("tactical_plot.png",)
TABLES = ("tracks.txt", "track_table.png")


@pytest.fixture(scope="module")
def of_active(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, ...]:
    """Return what is drawn of a bag of active sonar."""
    folder = tmp_path_factory.mktemp("active")
    return tuple(plot_bag(bag(folder / "run", ACTIVE), folder / "pictures"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("topics", "names"),
    [
        (ACTIVE, (*PLACES, "contact_record.png", *TABLES)),
        ({"/passive/tracks": POSITIONS}, (*PLACES, *TABLES)),
        ({"/truth/tracks": POSITIONS}, PLACES),
        ({"/active/contacts": CONTACTS}, (*PLACES, "contact_record.png")),
        (
            {"/array/lofar": IMAGE, "/passive/frequency_lines": LINES},
            ("line_record.png", "lofar_gram.png"),
        ),
        (
            {"/bow/array/lofar": IMAGE, "/camera/image": IMAGE, "/a/tracks": TRACKS},
            ("lofar_gram.png",),
        ),
        ({"/a/tracks": TRACKS}, ()),
    ],
)
def test_whatever_the_bag_holds_is_drawn(
    tmp_path: Path,
    of_active: tuple[Path, ...],
    topics: dict[str, str],
    names: tuple[str, ...],
) -> None:
    if not names:
        with pytest.raises(ConfigurationError, match="nor confirmed tracks; its topics are /a/"):
            plot_bag(bag(tmp_path / "run", topics), tmp_path / "pictures")
        assert not (tmp_path / "pictures").exists()
        return
    written = of_active
    if topics is not ACTIVE:
        written = tuple(plot_bag(bag(tmp_path / "run", topics), tmp_path / "pictures"))
    assert tuple(path.name for path in written if path.suffix != ".svg") == names
    for path in written:
        if path.suffix == ".png":
            assert path.read_bytes().startswith(b"\x89PNG") and path.stat().st_size > 5000
            drawing = path.with_suffix(".svg").read_text()
            assert drawing.startswith("<?xml") and "</text>" in drawing


@pytest.mark.slow
def test_a_bag_of_one_instant_is_drawn(tmp_path: Path) -> None:
    written = plot_bag(bag(tmp_path / "run", ACTIVE, 1), tmp_path / "pictures")
    assert len([path for path in written if path.suffix != ".svg"]) == 4


@pytest.mark.slow
def test_the_table_tells_where_a_track_ended(of_active: tuple[Path, ...]) -> None:
    lines = of_active[0].with_name("tracks.txt").read_text().splitlines()
    row = next(line for line in lines if line.split()[:1] == ["1"])
    assert row.split() == [
        *("1", "0.0", "11.0", "+967", "+800", "270", "3.0", "73x24,", "090"),
        *("-", "-", "-"),
    ]
