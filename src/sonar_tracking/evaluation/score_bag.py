"""``sonar-tracking score``: the bearing tracks in a bag against the truth in the bag."""

from __future__ import annotations

import json
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sonar_tracking.bags.bag_records import (
    BEARING_TRACKS_TYPE,
    bearing_tracks_of,
    topics_of_type,
)
from sonar_tracking.bags.reader import Bag, read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.bearing_score import BearingScore, score_bearing_tracks


def score_bag(path: Path, output: Path | None = None) -> dict[str, BearingScore]:
    """Score every topic of bearing tracks in a bag, print the scores and write them as JSON.

    Parameters
    ----------
    path : Path
        The bag.
    output : Path, optional
        File for the JSON: ``{"bag": str, "topics": {name: score}}``.

    Returns
    -------
    dict
        Topic to its score.

    Raises
    ------
    ConfigurationError
        If the bag cannot be read or lacks tracks or truth.
    """
    bag = read_bag(path)
    console = Console()
    if bag.recovery:
        console.print(bag.recovery, highlight=False, markup=False, soft_wrap=True)
    truth_topic = _truth_topic(bag)
    rejected: list[str] = []
    truth = list(bearing_tracks_of(bag, truth_topic, rejected))
    scores = {}
    for topic in topics_of_type(bag, BEARING_TRACKS_TYPE):
        if topic == truth_topic:
            continue
        scores[topic] = score_bearing_tracks(truth, list(bearing_tracks_of(bag, topic, rejected)))
        console.print(_table(topic, scores[topic]))
    for sentence in rejected:
        console.print(sentence, highlight=False, markup=False, soft_wrap=True)
    if not scores:
        raise ConfigurationError(
            f"{path} holds no bearing tracks to score; its topics are {', '.join(bag.topics)}."
        )
    if output is not None:
        _write(output, path, scores)
    return scores


def _truth_topic(bag: Bag) -> str:
    topics = topics_of_type(bag, BEARING_TRACKS_TYPE, "truth")
    if not topics:
        raise ConfigurationError(
            f"{bag.path} holds no true bearings to score against; its topics are "
            f"{', '.join(bag.topics)}."
        )
    return topics[0]


def _table(topic: str, score: BearingScore) -> Table:
    table = Table("metric", "value", title=topic, title_justify="left", show_edge=False)
    for name, value in score.to_mapping().items():
        text = f"{value:.4g}" if isinstance(value, float) else str(value)
        table.add_row(name.replace("_", " "), "unknown" if value is None else text)
    return table


def _write(output: Path, bag: Path, scores: dict[str, BearingScore]) -> None:
    topics = {topic: score.to_mapping() for topic, score in scores.items()}
    try:
        output.write_text(json.dumps({"bag": str(bag), "topics": topics}, indent=2) + "\n")
    except OSError as error:
        raise ConfigurationError(
            f"{output} cannot be written ({error.strerror}); give another path."
        ) from error
