"""Pictures of the maritime-contacts study: one chart a scenario."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sonar_tracking.evaluation.studies.maritime_contacts.scenarios import MaritimeScenario
from sonar_tracking.records.positions import PositionTracks

TRUTH_COLOURS = ("#0072B2", "#D55E00")
"""Two of Okabe and Ito's palette: told apart by colour-blind readers, too."""


def draw_scenario(
    path: Path, scenario: MaritimeScenario, tracks: Sequence[PositionTracks], latency: float
) -> Path:
    """Draw contacts, true paths and confirmed tracks.

    Parameters
    ----------
    path : Path
        Picture to write; missing directories are made.
    scenario : MaritimeScenario
        Contacts, own ship and truth.
    tracks : sequence of PositionTracks
        Of one tracker.
    latency : float
        By which its scans were stamped earlier, s.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 6.5), layout="constrained")
    axes = figure.add_subplot()
    axes.set_aspect("equal")
    contacts = np.concatenate([scenario.positions(scan) for scan in range(len(scenario.times))])
    axes.plot(contacts[:, 0], contacts[:, 1], ".", color="#bbbbbb", markersize=3, label="contacts")
    axes.plot(scenario.own_ship[:, 0], scenario.own_ship[:, 1], "k^", markersize=3, label="ferry")
    states = scenario.true_states(latency)
    for number, colour in enumerate(TRUTH_COLOURS[: states.shape[1]]):
        label = f"boat {number + 1}, GNSS"
        axes.plot(
            states[:, number, 0], states[:, number, 1], color=colour, linewidth=3, label=label
        )
    label = "tracks"
    for history in _histories(tracks):
        axes.plot(history[:, 0], history[:, 1], "k-", linewidth=1.0, label=label)
        axes.plot(*history[-1], "k.", markersize=4)
        label = ""
    axes.set_xlabel("east (m)")
    axes.set_ylabel("north (m)")
    axes.set_title(f"{scenario.name}: {len(scenario.times)} scans")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    return path


def _histories(tracks: Sequence[PositionTracks]) -> list[np.ndarray]:
    """Return the positions of each track while it was confirmed, shape (n, 2)."""
    histories: dict[int, list[np.ndarray]] = {}
    for entry in tracks:
        shown = entry.established
        for identity, state in zip(entry.id[shown], entry.state[shown], strict=True):
            histories.setdefault(int(identity), []).append(state[:2])
    return [np.array(history) for history in histories.values()]
