"""Protects ``sonar-tracking smooth``: a bag with everything that was, and smoothed tracks."""

from __future__ import annotations

import io
import shutil
import subprocess
import sys
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.importers.contact_messages import truth_tracks_cdr
from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.position_score import PositionScore
from sonar_tracking.evaluation.metrics.score_bag import score_bag
from sonar_tracking.evaluation.offline.offline_tma_chain import OfflineTmaRun
from sonar_tracking.evaluation.offline.smoothed_bag import smooth_bag
from sonar_tracking.records.bearings import BearingTracks, Sensor
from sonar_tracking.records.positions import TrackSource
from tests.bags.position_fixtures import (
    BEARINGS,
    ODOMETRY,
    POSITIONS,
    bearings_cdr,
    odometry_cdr,
    position_tracks_cdr,
)
from tests.tma.offline_runs import offline_tma_run

OFFSET = 10**12
"""Log times of a recorder that runs on another clock, ns."""


def simulated() -> OfflineTmaRun:
    return offline_tma_run("cross_fix")


def recorded(
    path: Path,
    *,
    odometry: bool = True,
    positions: bool = True,
    change: Callable[[BearingTracks], BearingTracks] = lambda one: one,
) -> Path:
    """Write the bag of a simulated run of two stations."""
    writer = BagWriter(path)
    writer.add_topic("/truth/tracks", POSITIONS, role="truth")
    writer.add_topic("/own_ship/odometry", ODOMETRY)
    updates = iter(simulated().updates)
    declared: set[str] = set()
    for frame in simulated().frames:
        now = frame.start_stamp + OFFSET
        writer.write("/truth/tracks", now, truth_tracks_cdr(frame.truth_tracks))
        if odometry:
            writer.write("/own_ship/odometry", now, odometry_cdr(frame.own_ship))
        reports = [one.bearings for one in frame.reports if one.bearings is not None]
        for bearings in reports:
            topic = f"/{bearings.sensor.sensor_id}/bearing_tracks"
            if topic not in declared:
                writer.add_topic(topic, BEARINGS)
                declared.add(topic)
            writer.write(topic, now, bearings_cdr(change(bearings)))
        if reports and positions and (tracks := next(updates).tracks) is not None:
            if "/passive/tracks" not in declared:
                writer.add_topic("/passive/tracks", POSITIONS)
                declared.add("/passive/tracks")
            writer.write("/passive/tracks", now, position_tracks_cdr(tracks))
    writer.close()
    return path


def without_pose(bearings: BearingTracks) -> BearingTracks:
    """Return bearings that do not tell where their sensor is."""
    sensor = Sensor(bearings.sensor.sensor_id, bearings.sensor.frame_id)
    return replace(bearings, sensor=sensor)


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a bag of everything, which no test changes."""
    return recorded(tmp_path_factory.mktemp("recorded") / "bag")


@pytest.fixture(scope="module")
def smoothed(bag: Path) -> tuple[Path, str]:
    """Return the bag made of it by default, and what was printed."""
    said = io.StringIO()
    with redirect_stdout(said):
        made = smooth_bag(bag)
    return made, said.getvalue()


def test_the_new_bag_holds_what_was_and_better_tracks(
    bag: Path, smoothed: tuple[Path, str]
) -> None:
    made, said = smoothed
    assert made == bag.with_name("bag_smoothed")
    assert "tracks in /passive/tracks_smoothed." in said
    old, new = read_bag(bag), read_bag(made)
    assert set(new.topics) == {*old.topics, "/passive/tracks_smoothed"}
    kept = [one for one in new.messages() if one.topic != "/passive/tracks_smoothed"]
    assert kept == list(old.messages())
    times = {
        name: [one.log_time for one in new.messages([name])]
        for name in ("/passive/tracks", "/passive/tracks_smoothed")
    }
    assert times["/passive/tracks_smoothed"] == times["/passive/tracks"]
    rows = [one.source for one in position_tracks_of(new, "/passive/tracks_smoothed")]
    assert set(np.concatenate(rows).tolist()) == {TrackSource.SMOOTHED}
    scores = score_bag(made)
    before, after = scores["/passive/tracks"], scores["/passive/tracks_smoothed"]
    assert isinstance(before, PositionScore) and isinstance(after, PositionScore)
    assert after.identities.held_share > before.identities.held_share + 0.2
    assert after.far_share < 0.05 and after.nees_per_dimension < 1.6


def test_a_bag_of_bearings_alone_is_tracked_first(tmp_path: Path) -> None:
    made = smooth_bag(recorded(tmp_path / "bag", positions=False), tmp_path / "new")
    score = score_bag(made)["/passive/tracks_smoothed"]
    assert isinstance(score, PositionScore)
    assert score.identities.held_share > 0.95 and score.median_error_m < 40.0


def test_larger_systematic_errors_give_larger_covariances(
    bag: Path, smoothed: tuple[Path, str], tmp_path: Path
) -> None:
    """Than those that are taken for granted."""
    larger = smooth_bag(bag, tmp_path / "larger", None, 2.0)
    spread = []
    for made in (smoothed[0], larger):
        pictures = list(position_tracks_of(read_bag(made), "/passive/tracks_smoothed"))
        spread.append(float(np.mean(pictures[-1].covariance[:, 0, 0])))
    assert spread[1] > 2.0 * spread[0]


def test_what_cannot_be_smoothed_is_refused_in_words(
    bag: Path, smoothed: tuple[Path, str], tmp_path: Path
) -> None:
    made, _ = smoothed
    with pytest.raises(ConfigurationError, match="smooth the bag it was made from"):
        smooth_bag(made, tmp_path / "twice")
    with pytest.raises(ConfigurationError, match="exists already"):
        smooth_bag(bag)
    with pytest.raises(ConfigurationError, match=r"acceleration.*0\.0"):
        smooth_bag(bag, tmp_path / "still", 0.0)
    lost = recorded(tmp_path / "lost", odometry=False, positions=False, change=without_pose)
    with pytest.raises(ConfigurationError, match="no odometry of own ship"):
        smooth_bag(lost)
    lost = recorded(tmp_path / "lost_too", odometry=False, change=without_pose)
    with pytest.raises(ConfigurationError, match="no odometry of own ship"):
        smooth_bag(lost)
    writer = BagWriter(tmp_path / "mute")
    writer.add_topic("/passive/tracks", POSITIONS)
    tracks = simulated().tracks[-1]
    writer.write("/passive/tracks", 1, position_tracks_cdr(tracks))
    writer.close()
    with pytest.raises(ConfigurationError, match="holds no bearing tracks"):
        smooth_bag(tmp_path / "mute")
    assert not [path for path in tmp_path.iterdir() if path.name in ("mute_smoothed", "twice")]


def test_the_command_smooths_a_damaged_bag_and_says_so(bag: Path, tmp_path: Path) -> None:
    """A third of the file is gone: what is whole is smoothed."""
    damaged = shutil.copytree(bag, tmp_path / "bag")
    (file,) = damaged.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: 2 * file.stat().st_size // 3])
    command = [sys.executable, "-m", "sonar_tracking", "smooth", str(damaged)]
    done = subprocess.run(
        [*command, "--output", str(tmp_path / "new"), "--acceleration", "0.02"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "/passive/tracks_smoothed" in done.stdout and str(damaged) in done.stdout
    assert "/passive/tracks_smoothed" in read_bag(tmp_path / "new").topics
    nothing = subprocess.run(
        [*command[:-1], str(tmp_path / "none")], capture_output=True, text=True, check=False
    )
    assert nothing.returncode == 2 and nothing.stderr.startswith("sonar-tracking: ")
