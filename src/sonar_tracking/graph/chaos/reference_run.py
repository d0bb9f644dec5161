"""An undisturbed run of a scenario, which others are compared with."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from rclpy.serialization import deserialize_message

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES
from sonar_tracking.graph.chaos.track_identities import TrackList
from sonar_tracking.graph.chaos.track_watch import track_list
from sonar_tracking.graph.chaos.watched_graph import WatchedGraph
from sonar_tracking.graph.message_writing.field_writing import message_class


def reference_lists(graph: WatchedGraph, folder: Path) -> Sequence[TrackList]:
    """Run a scenario at full speed and return its lists of tracks; none if it fails.

    Parameters
    ----------
    graph : WatchedGraph
        What is run, and watched of it.
    folder : Path
        Where its bag goes; it must not exist.
    """
    command = ["run", graph.scenario, "--rate", "max", "--no-display", "--no-display-topics"]
    done = subprocess.run(
        [sys.executable, "-m", "sonar_tracking", *command, "--record", str(folder)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        check=False,
    )
    if done.returncode != 0:
        return ()
    kind = message_class(graph.tracks.message_type)
    messages = read_bag(folder).messages([ROOT_NAMES.of(graph.tracks)])
    return [track_list(deserialize_message(message.data, kind)) for message in messages]
