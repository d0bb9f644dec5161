"""LOFAR gram: spectrum over time of each beam, with the lines that were followed on top.

Frequency to the right, time downwards, one panel a bearing track. The level is power over the
smoothed background, so that a steady tonal is a bright line on an even ground.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.lines import FrequencyLines, LofarRows
from sonar_tracking.records.time import seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh


MOST_PANELS = 6
"""Beams drawn, those with the most rows."""

MOST_COLUMNS = 1600
"""Of a panel; of more bins the strongest of neighbours is drawn."""

LOWEST_DB, HIGHEST_DB = -3.0, 15.0


@dataclass(frozen=True)
class BeamGram:
    """Spectrum of one beam over time.

    Attributes
    ----------
    track_id : int
        Bearing track the beam follows.
    times : ndarray, shape (n_rows,)
        Middle of each row, s.
    frequencies : ndarray, shape (n_bins,)
        Hz.
    levels_db : ndarray, shape (n_rows, n_bins)
        dB over the background.
    """

    track_id: int
    times: FloatArray
    frequencies: FloatArray
    levels_db: FloatArray


def beam_grams(rows: Iterable[LofarRows], start: int) -> tuple[BeamGram, ...]:
    """Return the grams of the beams with the most rows, by identifier.

    Parameters
    ----------
    rows : iterable of LofarRows
        In order of time; rows on other frequencies than the first of their beam are left out.
    start : int
        Stamp of time zero, ns.
    """
    taken: dict[int, list[tuple[float, FloatArray]]] = {}
    axes: dict[int, FloatArray] = {}
    for entry in rows:
        bins = np.arange(entry.level_db.shape[1])
        frequencies = np.asarray(entry.first_frequency + entry.bin_width * bins, np.float64)
        for identifier, level in zip(entry.track_id.tolist(), entry.level_db, strict=True):
            axis = axes.setdefault(identifier, frequencies)
            if np.array_equal(axis, frequencies):
                time = seconds(entry.stamp - start)
                taken.setdefault(identifier, []).append((time, level))
    counts = Counter({identifier: len(each) for identifier, each in taken.items()})
    chosen = sorted(identifier for identifier, _ in counts.most_common(MOST_PANELS))
    return tuple(
        BeamGram(
            identifier,
            np.array([time for time, _ in taken[identifier]]),
            *_reduced(axes[identifier], np.array([level for _, level in taken[identifier]])),
        )
        for identifier in chosen
    )


def draw_lofar_gram(
    grams: Sequence[BeamGram],
    lines: Iterable[FrequencyLines],
    start: int,
    path: Path,
    title: str = "",
) -> None:
    """Draw the grams beside each other into an image file.

    Parameters
    ----------
    grams : sequence of BeamGram
        At least one.
    lines : iterable of FrequencyLines
        Drawn on the gram of the track they belong to.
    start : int
        Stamp of time zero, ns.
    path : Path
        Image file.
    title : str
        Heading.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(2.5 + 4.5 * len(grams), 8.0), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title)
    panels = figure.subplots(1, len(grams), sharey=True, squeeze=False)[0]
    points = _points(lines, start)
    for axes, gram in zip(panels, grams, strict=True):
        mesh = _draw_gram(axes, gram)
        own = points[points[:, 1] == gram.track_id]
        axes.plot(own[:, 2], own[:, 0], ".", color="#FF5A36", markersize=0.9, alpha=0.7)
        axes.set(title=f"bearing track {gram.track_id}", xlabel="frequency, Hz")
        axes.set_xlim(gram.frequencies[0], gram.frequencies[-1])
    ends = [gram.times[-1] for gram in grams]
    begins = [gram.times[0] for gram in grams]
    panels[0].set(ylabel="time, s", ylim=(max(ends) + 1.0, min(begins) - 1.0))
    figure.colorbar(mesh, ax=list(panels), label="power over background, dB", shrink=0.6)
    figure.savefig(path, dpi=120)


def _reduced(
    frequencies: FloatArray, levels: NDArray[np.floating]
) -> tuple[FloatArray, FloatArray]:
    """Return the strongest of as many neighbouring bins as it takes to have few enough."""
    width = -(-len(frequencies) // MOST_COLUMNS)
    count = len(frequencies) // width
    blocks = levels[:, : count * width].reshape(len(levels), count, width)
    middle = frequencies[: count * width].reshape(count, width).mean(axis=1)
    return middle, np.asarray(blocks.max(axis=2), np.float64)


def _draw_gram(axes: Axes, gram: BeamGram) -> QuadMesh:
    """Draw one gram; a gap in time, where the beam was not formed, stays black."""
    axes.set_facecolor("black")
    step = float(np.median(np.diff(gram.times))) if len(gram.times) > 1 else 1.0
    gaps = np.flatnonzero(np.diff(gram.times) > 1.5 * step) + 1
    levels = np.insert(gram.levels_db, gaps, np.nan, axis=0)
    starts = np.insert(gram.times, gaps, gram.times[gaps - 1] + step) - 0.5 * step
    edges = np.append(starts, starts[-1] + step)
    half_bin = 0.5 * float(np.median(np.diff(gram.frequencies, prepend=gram.frequencies[0] - 1.0)))
    bins = np.append(gram.frequencies - half_bin, gram.frequencies[-1] + half_bin)
    return axes.pcolormesh(bins, edges, levels, cmap="bone", vmin=LOWEST_DB, vmax=HIGHEST_DB)


def _points(lines: Iterable[FrequencyLines], start: int) -> FloatArray:
    """Return time (s), bearing track and frequency (Hz) of every line, shape (n, 3)."""
    parts = [np.empty((0, 3))]
    for entry in lines:
        times = np.full(len(entry.frequency), seconds(entry.stamp - start))
        parts.append(np.stack([times, entry.track_id.astype(float), entry.frequency], axis=-1))
    return np.concatenate(parts)
