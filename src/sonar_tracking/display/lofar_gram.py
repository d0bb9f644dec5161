"""LOFAR gram: spectrum over time of each beam, with the lines that were followed on top.

Frequency to the right, time downwards, one panel a bearing track. The level is power over the
smoothed background, so that a steady tonal is a bright line on an even ground.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.display.picture_files import loudness_colours, new_figure, save_picture
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.lines import FrequencyLines, LofarRows
from sonar_tracking.records.time import LAST_STAMP, seconds

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh


MOST_PANELS = 6
"""Beams drawn, those with the most rows."""

MOST_BEAMS = 4 * MOST_PANELS
"""Kept in memory, besides those heard at the moment."""

MOST_ROWS = 1000
"""Of a beam; of more, neighbours are integrated to one."""

MOST_COLUMNS = 1600
"""Of a panel; of more bins the strongest of neighbours is drawn."""

LINES, BESIDE = "#D55E00", 2.2
"""Colour of the lines that were followed, and how far beside them their dots stand, points."""

LOWEST_DB, HIGHEST_DB = 1.0, 15.0


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


class GramRows:
    """Takes the rows of all beams; of too many, pairs are integrated to one."""

    def __init__(self) -> None:
        self._rows: dict[int, _BeamRows] = {}

    def add(self, entry: LofarRows) -> None:
        """Take the rows of one frame; those on other frequencies than the first are left out."""
        bins = np.arange(entry.level_db.shape[1])
        frequencies = np.asarray(entry.first_frequency + entry.bin_width * bins, np.float64)
        for identifier, level in zip(entry.track_id.tolist(), entry.level_db, strict=True):
            beam = self._rows.setdefault(identifier, _BeamRows(frequencies))
            if np.array_equal(beam.frequencies, frequencies):
                beam.add(entry.stamp, _power(level))
        self._forget(set(entry.track_id.tolist()))

    @property
    def begin(self) -> int:
        """Stamp of the first row, ns."""
        return min(beam.begin for beam in self._rows.values())

    def grams(self, start: int) -> tuple[BeamGram, ...]:
        """Return the grams of the beams with the most rows, by identifier.

        Parameters
        ----------
        start : int
            Stamp of time zero, ns.
        """
        longest = sorted(self._rows, key=lambda identifier: -self._rows[identifier].count)
        return tuple(
            self._rows[identifier].gram(identifier, start)
            for identifier in sorted(longest[:MOST_PANELS])
        )

    def _forget(self, heard: set[int]) -> None:
        """Forget the shortest of more beams than memory is meant for, but none heard now."""
        while len(self._rows) > MOST_BEAMS and (ended := self._rows.keys() - heard):
            del self._rows[min(ended, key=lambda identifier: self._rows[identifier].count)]


class _BeamRows:
    """The rows of one beam: linear power over the background."""

    def __init__(self, frequencies: FloatArray) -> None:
        self.frequencies = frequencies
        self.begin, self.count = LAST_STAMP, 0
        self._stamps: list[int] = []
        self._powers: list[NDArray[np.float32]] = []
        self._each = 1

    def add(self, stamp: int, power: NDArray[np.float32]) -> None:
        """Take the next row; so many in a row are integrated as it takes to have few enough."""
        self.begin = min(self.begin, stamp)
        if self.count % self._each == 0:
            self._stamps.append(stamp)
            self._powers.append(power)
        else:
            integrated = self.count % self._each + 1
            share = np.float32(1.0 / integrated)
            self._powers[-1] = self._powers[-1] + share * (power - self._powers[-1])
            self._stamps[-1] += (stamp - self._stamps[-1]) // integrated
        self.count += 1
        if len(self._powers) > MOST_ROWS and self.count % self._each == 0:
            self._halve()

    def gram(self, identifier: int, start: int) -> BeamGram:
        """Return the gram."""
        times = seconds(np.array(self._stamps, np.int64) - start)
        levels = 10.0 * np.log10(np.maximum(self._powers, 1e-9))
        return BeamGram(identifier, times, *_reduced(self.frequencies, levels))

    def _halve(self) -> None:
        even = len(self._powers) // 2 * 2
        pairs = zip(self._powers[:even:2], self._powers[1:even:2], strict=True)
        rest = self._powers[even:]
        self._powers = [np.float32(0.5) * (one + two) for one, two in pairs] + rest
        stamps = zip(self._stamps[:even:2], self._stamps[1:even:2], strict=True)
        self._stamps = [(one + two) // 2 for one, two in stamps] + self._stamps[even:]
        self._each *= 2
        self.count = self._each * len(self._powers) - (self._each // 2 if rest else 0)


def draw_lofar_gram(
    grams: Sequence[BeamGram],
    lines: Iterable[FrequencyLines],
    start: int,
    path: Path,
    title: str = "",
) -> tuple[Path, Path]:
    """Draw the grams beside each other, and return the files written.

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
    figure = new_figure(1.8 + 3.6 * len(grams), 7.5)
    figure.suptitle(title, fontsize=10)
    panels = figure.subplots(1, len(grams), sharey=True, squeeze=False)[0]
    points = _points(lines, start)
    for axes, gram in zip(panels, grams, strict=True):
        mesh = _draw_gram(axes, gram)
        own = points[points[:, 1] == gram.track_id]
        _draw_lines(axes, own)
        axes.set(title=f"bearing track {gram.track_id}", xlabel="frequency, Hz")
        axes.set_xlim(gram.frequencies[0], gram.frequencies[-1])
    ends = [gram.times[-1] for gram in grams]
    begins = [gram.times[0] for gram in grams]
    panels[0].set(ylabel="time, s", ylim=(max(ends) + 1.0, min(begins) - 1.0))
    label = "power over background, dB"
    figure.colorbar(mesh, ax=list(panels), label=label, shrink=0.5, aspect=30, pad=0.01)
    return save_picture(figure, path)


def _power(level: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return levels in dB as linear ratios; single precision holds 380 dB."""
    return np.float32(10.0) ** (np.clip(level, -300.0, 300.0).astype(np.float32) / np.float32(10.0))


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
    """Draw one gram; a gap in time, where the beam was not formed, stays empty."""
    step = float(np.median(np.diff(gram.times))) if len(gram.times) > 1 else 1.0
    gaps = np.flatnonzero(np.diff(gram.times) > 1.5 * step) + 1
    levels = np.insert(gram.levels_db, gaps, np.nan, axis=0)
    starts = np.insert(gram.times, gaps, gram.times[gaps - 1] + step) - 0.5 * step
    edges = np.append(starts, starts[-1] + step)
    half_bin = 0.5 * float(np.median(np.diff(gram.frequencies, prepend=gram.frequencies[0] - 1.0)))
    bins = np.append(gram.frequencies - half_bin, gram.frequencies[-1] + half_bin)
    return axes.pcolormesh(
        bins,
        edges,
        levels,
        cmap=loudness_colours(),
        vmin=LOWEST_DB,
        vmax=HIGHEST_DB,
        rasterized=True,
    )


def _draw_lines(axes: Axes, points: FloatArray) -> None:
    """Draw dots on either side of each line, which itself is to be seen."""
    from matplotlib.transforms import ScaledTranslation

    for side in (-BESIDE, BESIDE):
        moved = ScaledTranslation(side / 72.0, 0.0, axes.figure.dpi_scale_trans)
        place = axes.transData + moved
        axes.plot(points[:, 2], points[:, 0], ".", color=LINES, markersize=0.8, transform=place)


def _points(lines: Iterable[FrequencyLines], start: int) -> FloatArray:
    """Return time (s), bearing track and frequency (Hz) of every line, shape (n, 3)."""
    parts = [np.empty((0, 3))]
    for entry in lines:
        times = np.full(len(entry.frequency), seconds(entry.stamp - start))
        parts.append(np.stack([times, entry.track_id.astype(float), entry.frequency], axis=-1))
    return np.concatenate(parts)
