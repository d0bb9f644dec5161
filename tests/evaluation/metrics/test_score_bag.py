"""``score``: what the bag holds is scored, and what it lacks is said."""

import json
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.contents.topic_names import topic_names
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.position_score import PositionScore
from sonar_tracking.evaluation.metrics.score_bag import score_bag
from sonar_tracking.records.positions import PositionTracks
from tests.bags.bag_fixtures import EPOCH, SECOND, TRACKS, tracks_cdr
from tests.bags.position_fixtures import POSITIONS, position_tracks_cdr


def tracks(second: int, error: float) -> PositionTracks:
    return PositionTracks(
        stamp=(EPOCH + second) * SECOND,
        id=np.array([5], np.uint64),
        status=np.ones(1, np.uint8),
        source=np.zeros(1, np.uint8),
        state=np.array([[10.0 * second + error, 0.0, 10.0, 0.0]]),
    )


def bag(path: Path, *topics: str) -> Path:
    """Write a bag of ten seconds with the given topics."""
    writer = BagWriter(path)
    for topic in topics:
        kind = TRACKS if topic.endswith("bearing_tracks") else POSITIONS
        writer.add_topic(topic, kind, role="truth" if "/truth/" in topic else "output")
        for second in range(10):
            error = 0.0 if "/truth/" in topic else 3.0
            data = (
                tracks_cdr(second) if kind == TRACKS else position_tracks_cdr(tracks(second, error))
            )
            writer.write(topic, (EPOCH + second) * SECOND, data)
    writer.close()
    return path


def test_both_kinds_of_tracks_are_scored(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = bag(
        tmp_path / "run",
        *("/truth/bearing_tracks", "/truth/tracks"),
        *("/passive/bearing_tracks", "/passive/tracks", "/active/tracks"),
    )
    scores = score_bag(path, tmp_path / "score.json")
    assert set(scores) == {"/passive/bearing_tracks", "/passive/tracks", "/active/tracks"}
    written = json.loads((tmp_path / "score.json").read_text())["topics"]
    assert written["/active/tracks"]["rmse_m"] == pytest.approx(3.0)
    assert written["/active/tracks"]["continuity"] == 1.0
    assert "rmse_deg" in written["/passive/bearing_tracks"]
    assert "/active/tracks" in capsys.readouterr().out


def test_the_cutoff_is_the_users(tmp_path: Path) -> None:
    path = bag(tmp_path / "run", "/truth/tracks", "/active/tracks")
    score = score_bag(path, cutoff_m=2.0)["/active/tracks"]
    assert isinstance(score, PositionScore) and score.ospa_m == pytest.approx(2.0)
    with pytest.raises(ConfigurationError, match=r"cut-off is 0\.0 m; give a positive"):
        score_bag(path, cutoff_m=0.0)


def test_a_bag_with_a_namespace_scores_like_the_same_without(tmp_path: Path) -> None:
    topics = ("/active/tracks", "/truth/tracks")
    plain = score_bag(bag(tmp_path / "plain", *topics))
    own = bag(tmp_path / "own", *(f"/ship{topic}" for topic in topics))
    scores = score_bag(own, names=topic_names([], "ship"))
    assert {name: score.to_mapping() for name, score in scores.items()} == {
        name: score.to_mapping() for name, score in plain.items()
    }


def test_tracks_without_truth_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = bag(tmp_path / "run", "/truth/tracks", "/active/tracks", "/passive/bearing_tracks")
    assert set(score_bag(path)) == {"/active/tracks"}
    assert "no true bearings to score /passive/bearing_tracks" in capsys.readouterr().out
    alone = bag(tmp_path / "alone", "/active/tracks")
    with pytest.raises(ConfigurationError, match="no true positions to score /active/tracks"):
        score_bag(alone)
    truth = bag(tmp_path / "truth", "/truth/tracks")
    with pytest.raises(ConfigurationError, match="holds no tracks to score; its topics are"):
        score_bag(truth)


def test_bearings_of_a_station_are_scored_against_what_is_true_there(tmp_path: Path) -> None:
    topics = ("/bow/passive/bearing_tracks", "/passive/bearing_tracks")
    path = bag(tmp_path / "run", "/truth/bearing_tracks", *topics)
    writer = BagWriter(tmp_path / "turned")
    for topic in read_bag(path).topics.values():
        writer.add_topic(topic.name, TRACKS, role=topic.role)
    writer.add_topic("/bow/truth/bearing_tracks", TRACKS, role="truth")
    for message in read_bag(path).messages():
        writer.write(message.topic, message.log_time, message.data)
        if message.topic == "/truth/bearing_tracks":
            # What is true at the station is a second late.
            late = tracks_cdr(message.log_time // SECOND - EPOCH + 1)
            writer.write("/bow/truth/bearing_tracks", message.log_time + SECOND, late)
    writer.close()
    scores = score_bag(tmp_path / "turned")
    assert set(scores) == set(topics)
    periods = [scores[topic].to_mapping()["unscored_periods"] for topic in topics]
    assert periods == [1, 0]
