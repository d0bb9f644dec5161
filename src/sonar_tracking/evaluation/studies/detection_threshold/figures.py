"""Pictures of the detection-threshold study: Figs. 1 and 2 of Jung and Shin (2002)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path

import numpy as np

from sonar_tracking.active.detection.detection_threshold import (
    FalseAlarmLimits,
    closed_form_false_alarm_probability,
    linear_from_decibel,
)
from sonar_tracking.active.detection.information_reduction import optimal_false_alarm_probability
from sonar_tracking.evaluation.monte_carlo.plot_styles import PALETTE, styles_of
from sonar_tracking.records.arrays import FloatArray

LIMITS = FalseAlarmLimits(1e-12, 1.0)


def draw_optima(path: Path, levels_db: Sequence[float]) -> Path:
    """Draw the closed form and the exact optimum over the number of cells in the gate.

    Parameters
    ----------
    path : Path
        Picture to write; missing directories are made.
    levels_db : sequence of float
        Signal-to-noise ratios, dB.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.add_subplot()
    cells = np.geomspace(2.0, 1000.0, 40)
    for colour, level in zip(cycle(PALETTE), levels_db):
        ratio = float(linear_from_decibel(level))
        closed = closed_form_false_alarm_probability(cells, ratio, LIMITS)
        exact = [optimal_false_alarm_probability(float(n), ratio, LIMITS) for n in cells]
        axes.loglog(cells, closed, color=colour, label=f"{level:g} dB, closed form")
        axes.loglog(cells, exact, color=colour, linestyle="--", label=f"{level:g} dB, exact")
    axes.set_xlabel("resolution cells in the gate")
    axes.set_ylabel("false-alarm probability")
    axes.set_title("False-alarm probability of least expected error")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    return path


def draw_errors(path: Path, errors: Mapping[str, FloatArray], condition: str) -> Path:
    """Draw the median position error over time, one line a system.

    Parameters
    ----------
    path : Path
        Picture to write; missing directories are made.
    errors : mapping of str to ndarray, shape (n_runs, n_scans)
        Position errors by system, m.
    condition : str
        Named in the title.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    axes = figure.add_subplot()
    for name, style in styles_of(errors).items():
        scans = np.arange(1, errors[name].shape[1] + 1)
        median = np.median(errors[name], axis=0)
        axes.semilogy(scans, median, style.line, color=style.colour, label=name)
    axes.set_xlabel("scan")
    axes.set_ylabel("median position error (m)")
    axes.set_title(f"One target in clutter, {condition}")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120)
    return path
