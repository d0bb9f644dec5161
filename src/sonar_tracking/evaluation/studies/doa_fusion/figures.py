"""Pictures of the doa-fusion study: the paper's Figs. 2 and 3 and its table against the level."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonar_tracking.evaluation.monte_carlo.bearing_histories import (
    SUCCESS_STEPS,
    mean_square_error_deg2,
    successful,
)
from sonar_tracking.evaluation.monte_carlo.plot_styles import Style, styles_of
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.records.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TARGET_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00")
"""Okabe and Ito's palette: told apart by colour-blind readers, too."""

SYSTEM_STYLES = {
    "RYU": Style("#D55E00", "o"),
    "average only": Style("#E69F00", "v"),
    "R/7 only": Style("#CC79A7", "^"),
    "PROPOSED": Style("#0072B2", "s"),
    "automatic start": Style("#56B4E9", "D"),
    "joint MAP, causal": Style("#009E73", "P"),
    "joint MAP, centred": Style("#000000", "X"),
    "joint MAP, default q": Style("#882255", "D"),
    "tracking bound": Style("#555555"),
}
"""Of the systems of the study; others get the next free ones."""

NOT_DRAWN = ("correlated variance",)
"""PROPOSED with another belief about its variance, which the table tells."""


def typical_run(angles: Sequence[FloatArray], truth: FloatArray) -> int:
    """Return the number of the run whose errors are nearest to the median of every tracker.

    Parameters
    ----------
    angles : sequence of ndarray, shape (n_runs, n_steps, n_targets)
        Filtered bearings of each tracker, rad.
    truth : ndarray, shape (n_steps, n_targets)
        True bearings, rad.

    Returns
    -------
    int
        Among the runs in which all trackers succeed, where there are such runs.
    """
    errors = [np.log(mean_square_error_deg2(angle, truth)) for angle in angles]
    distance = sum(np.abs(error - np.median(error)) for error in errors)
    all_succeed = np.all([successful(angle, truth) for angle in angles], axis=0)
    if np.any(all_succeed):
        distance = np.where(all_succeed, distance, np.inf)
    return int(np.argmin(distance))


def failed_run(angle: FloatArray, other: FloatArray, truth: FloatArray) -> int | None:
    """Return the failed run with the largest error, of those in which the other tracker succeeds.

    Parameters
    ----------
    angle, other : ndarray, shape (n_runs, n_steps, n_targets)
        Filtered bearings of the tracker in question and of the other one, rad.
    truth : ndarray, shape (n_steps, n_targets)
        True bearings, rad.

    Returns
    -------
    int or None
        None if every run succeeds; of all failed runs where the other tracker never succeeds.
    """
    failed = ~successful(angle, truth)
    if not np.any(failed):
        return None
    rescued = failed & successful(other, truth)
    errors = mean_square_error_deg2(angle, truth)
    return int(np.argmax(np.where(rescued if np.any(rescued) else failed, errors, -np.inf)))


def draw_run(
    path: Path, title: str, times: FloatArray, truth: FloatArray, angles: Mapping[str, FloatArray]
) -> Path:
    """Draw one run: true and estimated bearings over time, one panel a tracker.

    Parameters
    ----------
    path : Path
        File to write.
    title : str
        Over the picture.
    times : ndarray, shape (n_steps,)
        s.
    truth : ndarray, shape (n_steps, n_targets)
        True bearings, rad.
    angles : mapping of str to ndarray, shape (n_steps, n_targets)
        Filtered bearings of each tracker, rad.
    """
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(
        1,
        len(angles),
        figsize=(5.5 * len(angles), 5),
        sharey=True,
        layout="constrained",
        squeeze=False,
    )
    for axis, (name, angle) in zip(axes[0], angles.items(), strict=True):
        _draw_bearings(axis, times, truth, angle)
        outcome = "successful" if successful(angle, truth) else "failed"
        error = float(mean_square_error_deg2(angle, truth))
        last = float(np.degrees(np.abs(angle - truth)[-SUCCESS_STEPS:].max()))
        axis.set_title(
            f"{name}: {outcome}\nmean square error {error:.2f} deg², "
            f"at most {last:.1f} deg in the last {SUCCESS_STEPS} steps",
            fontsize="medium",
        )
        axis.set_xlabel("time (s)")
    axes[0, 0].set_ylabel("bearing from broadside (deg)")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    figure.suptitle(title)
    return _save(figure, path)


def draw_levels(path: Path, rows: Sequence[StudyRow], levels_db: Sequence[int]) -> Path:
    """Draw mean square error and success against the level, published points beside.

    Parameters
    ----------
    path : Path
        File to write.
    rows : sequence of StudyRow
        Of the study; conditions are ``"SNR <level> dB"``.
    levels_db : sequence of int
        Levels, ascending.
    """
    import matplotlib.pyplot as plt

    figure, (errors, successes) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    conditions = {f"SNR {level} dB" for level in levels_db}
    drawn = [r.system for r in rows if r.condition in conditions and r.system not in NOT_DRAWN]
    for system, style in styles_of(drawn, SYSTEM_STYLES).items():
        for axis, metric in ((errors, "mse_deg2"), (successes, "success_percent")):
            _draw_against_level(axis, rows, levels_db, system, metric, style)
    errors.set_yscale("log")
    ticks = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
    errors.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    errors.minorticks_off()
    errors.set_ylabel("mean square error of successful runs (deg²)")
    successes.set_ylabel("successful runs (%)")
    successes.set_ylim(top=102)
    for axis in (errors, successes):
        axis.set_xlabel("signal-to-noise ratio per element (dB)")
        axis.set_xticks(list(levels_db))
        axis.grid(alpha=0.3)
    handles, labels = errors.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", fontsize="small")
    figure.suptitle("Five crossing targets: measured (filled) and published (open)")
    return _save(figure, path)


def draw_fused_variance(path: Path, rows: Sequence[StudyRow]) -> Path:
    """Draw the variance of the 7-average, relative to one subspace, against the forgetting factor.

    Parameters
    ----------
    path : Path
        File to write.
    rows : sequence of StudyRow
        Rows of the fused-variance check.
    """
    import matplotlib.pyplot as plt

    figure, axis = plt.subplots(figsize=(6.4, 4.6), layout="constrained")
    checked = [row for row in rows if "variance_ratio" in row.metrics]
    conditions = list(dict.fromkeys(row.condition for row in checked))
    for condition, marker, colour in zip(conditions, cycle("so^"), cycle(TARGET_COLOURS)):
        own = [row.metrics for row in checked if row.condition == condition]
        factors = [metrics["forgetting_factor"] for metrics in own]
        ratios = [metrics["variance_ratio"] for metrics in own]
        axis.plot(factors, ratios, marker, color=colour, label=f"measured, {condition}")
    for metric, name, style in (
        ("correlated_ratio", "claimed with the correlation of subspaces", "-"),
        ("independent_ratio", "claimed by the paper's equation (14)", "--"),
    ):
        axis.plot(factors, [metrics[metric] for metrics in own], style, color="#555555", label=name)
    axis.set_ylim(0, 1.02)
    axis.set_xlabel("forgetting factor")
    axis.set_ylabel("variance of the mean of 7 / variance of one")
    axis.grid(alpha=0.3)
    axis.legend(fontsize="small", loc="center right")
    axis.set_title("Adjacent subspaces are not independent measurements")
    return _save(figure, path)


def _draw_bearings(axis: Axes, times: FloatArray, truth: FloatArray, angle: FloatArray) -> None:
    for target in range(truth.shape[1]):
        colour = TARGET_COLOURS[target % len(TARGET_COLOURS)]
        truth_label = "true" if target == 0 else None
        track_label = "tracked" if target == 0 else None
        axis.plot(
            times,
            np.degrees(truth[:, target]),
            color=colour,
            linewidth=5,
            alpha=0.3,
            label=truth_label,
        )
        axis.plot(
            times,
            np.degrees(angle[:, target]),
            "o-",
            color=colour,
            markersize=3,
            linewidth=1,
            label=track_label,
        )
    margin = 6.0
    axis.set_ylim(np.degrees(truth.min()) - margin, np.degrees(truth.max()) + margin)
    axis.set_xlim(times[0] - 1, times[-1] + 1)
    axis.grid(alpha=0.3)


def _draw_against_level(
    axis: Axes,
    rows: Sequence[StudyRow],
    levels_db: Sequence[int],
    system: str,
    metric: str,
    style: Style,
) -> None:
    own = {row.condition: row for row in rows if row.system == system}
    at_level = [own.get(f"SNR {level} dB") for level in levels_db]
    measured = [row.metrics.get(metric, np.nan) if row else np.nan for row in at_level]
    published = [row.published.get(metric, np.nan) if row else np.nan for row in at_level]
    if np.any(np.isfinite(measured)):
        line = style.marker + style.line
        axis.plot(levels_db, measured, line, color=style.colour, label=system, linewidth=1.2)
    if np.any(np.isfinite(published)):
        axis.plot(
            levels_db,
            published,
            style.marker + ":",
            color=style.colour,
            markerfacecolor="white",
            markersize=9,
            markeredgewidth=1.5,
            linewidth=1,
            zorder=1,
            label=f"{system}, published",
        )


def _save(figure: Figure, path: Path) -> Path:
    import matplotlib.pyplot as plt

    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    plt.close(figure)
    return path
