"""Pictures of the tma-frequency-fusion study: the paper's Figs. 2 to 7, for every scenario."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.evaluation.monte_carlo.plot_styles import Style, styles_of
from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import TmaHistories
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import (
    BEARINGS_ONLY,
    CHAN,
    JAUFFRET,
    PROPOSED,
    RANGE_BANK,
    STACKED,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import true_states

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SYSTEM_STYLES = {
    PROPOSED: Style("#0072B2"),
    CHAN: Style("#D55E00"),
    JAUFFRET: Style("#E69F00"),
    STACKED: Style("#56B4E9"),
    RANGE_BANK: Style("#009E73"),
    # The twin lies on the default where turns do it all: dotted, so that both are seen.
    BEARINGS_ONLY: Style("#CC79A7", line=":"),
}
"""Of the estimators of the study; others get the next free ones."""

QUANTITIES = ("range error, m", "bearing error, deg", "course error, deg", "speed error, m/s")


def draw_scene(path: Path, name: str, title: str) -> Path:
    """Draw the geometry and the schedule of the lines.

    Parameters
    ----------
    path : Path
        File to write.
    name : str
        Of the scenario.
    title : str
        Over the picture.
    """
    import matplotlib.pyplot as plt

    scene = scenario(name)
    target = true_states(scene, np.zeros((len(scene.times), 2)))
    figure, (plan, lines) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    figure.suptitle(title)
    for track, colour, label in (
        (target, "#D55E00", "target"),
        (scene.sensor_position, "#0072B2", "own ship"),
    ):
        plan.plot(track[:, 0], track[:, 1], color=colour, label=label)
        plan.plot(*track[0, :2], "o", color=colour)
    plan.set_xlabel("east, m")
    plan.set_ylabel("north, m")
    plan.set_aspect("equal", adjustable="datalim")
    plan.grid(alpha=0.3)
    plan.legend(fontsize="small")
    for frequency, heard in zip(scene.line_frequency, scene.heard.T, strict=True):
        lines.plot(scene.times, np.where(heard, frequency, np.nan), linewidth=3, color="#555555")
    lines.set_xlabel("time, s")
    lines.set_ylabel("line, Hz")
    lines.grid(alpha=0.3)
    return _save(figure, path)


def draw_errors(
    path: Path, title: str, histories: Mapping[str, TmaHistories], bound: FloatArray
) -> Path:
    """Draw the RMSE of all estimators over time, with the bound.

    Parameters
    ----------
    path : Path
        File to write.
    title : str
        Over the picture.
    histories : mapping of str to TmaHistories
        By name of the estimator.
    bound : ndarray, shape (n_frames, 4)
        Root of the bounds on range, azimuth, course and speed, m, deg, deg, m/s.
    """
    import matplotlib.pyplot as plt

    styles = styles_of(histories, SYSTEM_STYLES)
    figure, axes = plt.subplots(2, 2, figsize=(11, 7.5), sharex=True, layout="constrained")
    figure.suptitle(title)
    for index, (axis, quantity) in enumerate(zip(axes.flat, QUANTITIES, strict=True)):
        for system, style in styles.items():
            rms = np.sqrt(np.mean(histories[system].error[..., index] ** 2, axis=0))
            axis.semilogy(rms, style.line, color=style.colour, linewidth=1.2, label=system)
        axis.semilogy(bound[:, index], color="black", linestyle="--", label="bound")
        axis.set_ylabel(f"RMS {quantity}")
        axis.grid(alpha=0.3, which="both")
    axes[1, 0].set_xlabel("frame")
    axes[1, 1].set_xlabel("frame")
    axes[0, 0].legend(fontsize="x-small")
    return _save(figure, path)


def _save(figure: Figure, path: Path) -> Path:
    import matplotlib.pyplot as plt

    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    plt.close(figure)
    return path
