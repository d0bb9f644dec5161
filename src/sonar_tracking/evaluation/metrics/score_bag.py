"""``sonar-tracking score``: the tracks in a bag against the truth in the bag.

Every topic of bearing tracks is scored against the true bearings, every topic of position tracks
against the true positions. The JSON is ``{"bag": str, "topics": {name: score}}``; a score is one
flat mapping of the fields of :class:`~sonar_tracking.evaluation.metrics.bearing_score.BearingScore`
(bearings, in degrees) or :class:`~sonar_tracking.evaluation.metrics.position_score.PositionScore`
(positions, in metres) and, of both, of
:class:`~sonar_tracking.evaluation.metrics.identity_score.IdentityScore`; unknown is null.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from sonar_tracking.bags.contents.topic_names import RECORDED_NAMES, TopicNames
from sonar_tracking.bags.storage.bag_records import (
    BEARING_TRACKS_TYPE,
    POSITION_TRACKS_TYPE,
    bearing_tracks_of,
    position_tracks_of,
    topics_of_type,
)
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.bearing_score import BearingScore, score_bearing_tracks
from sonar_tracking.evaluation.metrics.cutoff import (
    CUTOFF_M,
    FAR_LIMIT_M,
    check_cutoff,
    check_far_limit,
)
from sonar_tracking.evaluation.metrics.position_score import PositionScore, score_position_tracks

BEARING_TRACKS_BELOW, TRUE_BEARINGS_BELOW = "/passive/bearing_tracks", "/truth/bearing_tracks"
"""Names of bearing tracks and true bearings, after the namespace of their station."""

Score = BearingScore | PositionScore
Scores = dict[str, Score]

LABELS = {
    "held_share": "share of time tracked",
    "targets_never_held": "targets never tracked",
    "far_share": "share of rows beyond the far limit",
}
"""What the table calls a field whose name does not say it."""


def score_bag(
    path: Path,
    output: Path | None = None,
    cutoff_m: float = CUTOFF_M,
    names: TopicNames = RECORDED_NAMES,
    far_limit_m: float = FAR_LIMIT_M,
) -> Scores:
    """Score every topic of tracks in a bag, print the scores and write them as JSON.

    Parameters
    ----------
    path : Path
        The bag.
    output : Path, optional
        File for the JSON.
    cutoff_m : float
        Distance from which on a position track is none of a target, m.
    names : TopicNames
        How to call the recorded topics.
    far_limit_m : float
        Distance from the nearest target beyond which a row of position tracks is far off, m.

    Returns
    -------
    dict
        Topic to its score.

    Raises
    ------
    ConfigurationError
        If a distance is not positive, the bag cannot be read, or it lacks tracks or truth.
    """
    check_cutoff(cutoff_m)
    check_far_limit(far_limit_m)
    bag = read_bag(path).named(names)
    console = Console(highlight=False)
    if bag.recovery:
        console.print(bag.recovery, markup=False, soft_wrap=True)
    remarks: list[str] = []
    scores = _scores(bag, cutoff_m, far_limit_m, remarks)
    for topic, score in scores.items():
        console.print(_table(topic, score))
    for sentence in remarks:
        console.print(sentence, markup=False, soft_wrap=True)
    if output is not None:
        _write(output, path, scores)
    return scores


def _scores(bag: Bag, cutoff_m: float, far_limit_m: float, remarks: list[str]) -> Scores:
    """Return the score of every topic of tracks whose truth is in the bag."""
    scores: Scores = _scores_of_kind(
        bag, BEARING_TRACKS_TYPE, "true bearings", bearing_tracks_of, score_bearing_tracks, remarks
    )
    scores |= _scores_of_kind(
        bag,
        POSITION_TRACKS_TYPE,
        "true positions",
        position_tracks_of,
        lambda truth, tracks: score_position_tracks(truth, tracks, cutoff_m, far_limit_m),
        remarks,
    )
    if not scores:
        reason = " ".join(remarks) or (
            f"{bag.path} holds no tracks to score; its topics are {', '.join(bag.topics)}."
        )
        raise ConfigurationError(reason)
    return scores


def _scores_of_kind(
    bag: Bag,
    type_name: str,
    truth_name: str,
    read: Callable[..., Any],
    score: Callable[[list[Any], list[Any]], Score],
    remarks: list[str],
) -> Scores:
    truths = topics_of_type(bag, type_name, "truth")
    # Bearings that a simulator or a station delivers are measurements, not tracks to be scored.
    topics = [
        name
        for name in topics_of_type(bag, type_name)
        if bag.topics[name].role not in ("truth", "input")
    ]
    if not topics:
        return {}
    if not truths:
        remarks.append(
            f"{bag.path} holds no {truth_name} to score {', '.join(topics)} against; its topics "
            f"are {', '.join(bag.topics)}."
        )
        return {}
    true = {name: list(read(bag, name, remarks)) for name in {_truth_of(t, truths) for t in topics}}
    return {
        topic: score(true[_truth_of(topic, truths)], list(read(bag, topic, remarks)))
        for topic in topics
    }


def _truth_of(topic: str, truths: list[str]) -> str:
    """Return what is true of a topic: the truth of its station, else the first one there is."""
    station = topic.removesuffix(BEARING_TRACKS_BELOW)
    named = [name for name in truths if name == station + TRUE_BEARINGS_BELOW]
    return named[0] if named else truths[0]


def _table(topic: str, score: Score) -> Table:
    table = Table("metric", "value", title=topic, title_justify="left", show_edge=False)
    for name, value in score.to_mapping().items():
        table.add_row(LABELS.get(name, name.replace("_", " ")), _text(value))
    return table


def _text(value: object) -> str:
    if isinstance(value, list):
        return " to ".join(_text(entry) for entry in value)
    if value is None:
        return "unknown"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _write(output: Path, bag: Path, scores: Scores) -> None:
    topics = {topic: score.to_mapping() for topic, score in scores.items()}
    try:
        output.write_text(json.dumps({"bag": str(bag), "topics": topics}, indent=2) + "\n")
    except OSError as error:
        raise ConfigurationError(
            f"{output} cannot be written ({error.strerror}); give another path."
        ) from error
