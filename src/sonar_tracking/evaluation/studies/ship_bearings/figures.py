"""Pictures of the ship-bearings study: where the ship was and where it was located."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from sonar_tracking.evaluation.studies.ship_bearings.tracks import ShipTrack


def draw_tracks(tracks: Sequence[ShipTrack], directory: Path) -> tuple[Path, ...]:
    """Draw each track beside the truth, and its error over time.

    Parameters
    ----------
    tracks : sequence of ShipTrack
        What was located.
    directory : Path
        Where the pictures go.
    """
    import matplotlib.pyplot as plt

    directory.mkdir(parents=True, exist_ok=True)
    paths = []
    for track in tracks:
        figure, (plan, error) = plt.subplots(1, 2, figsize=(11, 4.5), layout="constrained")
        figure.suptitle(f"{track.system}, array {track.arrays}")
        plan.plot(*track.position.T, ".", markersize=1.5, color="#0072B2", label="located")
        plan.plot(*track.ship.T, linewidth=1, color="#D55E00", label="GPS")
        centre = np.nanmean(track.ship, axis=0)
        reach = 1.3 * float(np.nanmax(np.abs(track.ship - centre)))
        plan.set_xlim(centre[0] - reach, centre[0] + reach)
        plan.set_ylim(centre[1] - reach, centre[1] + reach)
        plan.set_xlabel("east, m")
        plan.set_ylabel("north, m")
        plan.legend(fontsize="small")
        distance = np.hypot(*(track.position - track.ship).T)
        error.semilogy(track.times, distance, ".", markersize=1.5, color="#0072B2")
        error.set_xlabel("time, s")
        error.set_ylabel("error, m")
        error.grid(alpha=0.3, which="both")
        name = f"{track.system} {track.arrays}".replace(" ", "_").replace(":", "")
        paths.append(directory / f"{name}.png")
        figure.savefig(paths[-1], dpi=150)
        plt.close(figure)
    return tuple(paths)
