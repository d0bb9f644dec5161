"""Audio files on one time axis: runs of samples without a gap.

Files of one recorder follow one another. Where their times say that there is less than a second
(0.1 s where these have fractions) between the end of one and the begin of the next, the samples go
on; how far times and samples come apart is reported. More is a gap, and stays one. What two files
hold both is taken from the earlier one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.bags.audio.audio_file import AudioFile
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import NANOSECONDS, seconds

_LARGEST_DRIFT = 5e-4
"""Of a clock; more of it are short gaps between files."""


@dataclass(frozen=True)
class AudioPart:
    """Files that were recorded at the same time, one beside the other.

    Attributes
    ----------
    files : tuple of AudioFile
        Their channels follow one another; one file where it has all channels.
    start : int or None
        Instant of the first sample, ns; None where nothing says it.
    resolution : float
        Of this instant, s.
    """

    files: tuple[AudioFile, ...]
    start: int | None
    resolution: float = 1.0

    @property
    def name(self) -> Path:
        """The file, or the first of them."""
        return self.files[0].path

    @property
    def n_samples(self) -> int:
        """Samples all files have."""
        return min(file.n_samples for file in self.files)

    @property
    def n_channels(self) -> int:
        """Of all files together."""
        return sum(file.n_channels for file in self.files)

    def samples(self, start: int, stop: int) -> FloatArray:
        """Return samples of all channels, shape (n, n_channels), linear, full scale 1."""
        pieces = [file.samples(start, stop) for file in self.files]
        return pieces[0] if len(pieces) == 1 else np.concatenate(pieces, axis=1)


@dataclass(frozen=True)
class Stretch:
    """Samples of one part that are used, and when they were recorded.

    Attributes
    ----------
    part : AudioPart
        Where they are.
    first : int
        Sample of the part it begins with; not 0 where the beginning was in the part before.
    run_start : int
        Instant of the first sample of the run it belongs to, ns.
    run_sample : int
        Sample of the run it begins with.
    """

    part: AudioPart
    first: int
    run_start: int
    run_sample: int

    @property
    def n_samples(self) -> int:
        """How many samples are used."""
        return self.part.n_samples - self.first

    def stamp(self, sample: int) -> int:
        """Return the instant of a sample, counted from the first that is used, ns."""
        rate = self.part.files[0].sample_rate
        return self.run_start + ((self.run_sample + sample) * NANOSECONDS + rate // 2) // rate

    def samples(self, start: int, stop: int) -> FloatArray:
        """Return used samples, shape (n, n_channels), linear, full scale 1."""
        return self.part.samples(self.first + start, self.first + stop)


@dataclass(frozen=True)
class Recording:
    """Everything that is imported, by rising time.

    Attributes
    ----------
    path : Path
        What was given: a file or a directory.
    sample_rate : int
        Hz.
    n_channels : int
        Of each part.
    stretches : tuple of Stretch
        Without overlap.
    notes : tuple of str
        Sentences on files, gaps, overlaps, drift.
    """

    path: Path
    sample_rate: int
    n_channels: int
    stretches: tuple[Stretch, ...]
    notes: tuple[str, ...]

    @property
    def start(self) -> int:
        """Instant of the first sample, ns."""
        return self.stretches[0].stamp(0)

    @property
    def n_samples(self) -> int:
        """Samples of each channel."""
        return sum(stretch.n_samples for stretch in self.stretches)

    @property
    def may_be_not_a_number(self) -> bool:
        """Whether any sample may be NaN."""
        return any(
            file.description.may_be_not_a_number
            for stretch in self.stretches
            for file in stretch.part.files
        )


def joined(path: Path, parts: Sequence[AudioPart], epoch: int, notes: Sequence[str]) -> Recording:
    """Put parts on one time axis.

    Parameters
    ----------
    path : Path
        What was given.
    parts : sequence of AudioPart
        In order where they have no times, else in any.
    epoch : int
        Instant of the first sample, ns; the times of the parts count by their differences.
    notes : sequence of str
        What is known already.

    Raises
    ------
    ConfigurationError
        If the parts have different rates or channels.
    """
    _check_alike(parts)
    ordered = sorted(parts, key=lambda part: part.start or 0)
    axis = _Axis(ordered[0], epoch)
    for part in ordered[1:]:
        axis.add(part)
    axis.end_run()
    first = parts[0]
    told = [note for part in ordered for file in part.files for note in file.description.notes]
    return Recording(
        path=path,
        sample_rate=first.files[0].sample_rate,
        n_channels=first.n_channels,
        stretches=tuple(axis.stretches),
        notes=(*told, *notes, *axis.notes()),
    )


def _check_alike(parts: Sequence[AudioPart]) -> None:
    first = parts[0]
    rate = first.files[0].sample_rate
    for part in parts:
        for file in part.files:
            if file.sample_rate != rate:
                raise ConfigurationError(
                    f"{file.path} has {file.sample_rate} Hz, {first.name} has {rate} Hz; import "
                    "files of one sample rate together."
                )
        if part.n_channels != first.n_channels:
            raise ConfigurationError(
                f"{part.name} has {part.n_channels} channels, {first.name} has "
                f"{first.n_channels}; import files of one array together."
            )


class _Axis:
    """Parts laid on the time axis one after the other."""

    def __init__(self, first: AudioPart, epoch: int) -> None:
        self._rate = first.files[0].sample_rate
        self._shift = epoch - (first.start or 0)
        self.stretches = [Stretch(first, 0, epoch, 0)]
        self._drift, self._largest = 0, (0.0, 0.0)
        self._gaps: list[str] = []
        self._overlaps: list[str] = []

    def add(self, part: AudioPart) -> None:
        """Add the next part: going on, after a gap, or without what was there already."""
        last = self.stretches[-1]
        run_sample = last.run_sample + last.n_samples
        if part.start is None or last.part.start is None:
            self.stretches.append(Stretch(part, 0, last.run_start, run_sample))
            return
        begin = last.part.start + (last.part.n_samples * NANOSECONDS) // self._rate
        apart = part.start - begin
        tolerance = 1.0 if max(part.resolution, last.part.resolution) >= 1.0 else 0.1
        tolerance = max(tolerance, part.resolution)
        together = self._drift + apart
        short_gaps = together > max(
            tolerance * NANOSECONDS, _LARGEST_DRIFT * run_sample * NANOSECONDS / self._rate
        )
        if abs(apart) <= tolerance * NANOSECONDS and not short_gaps:
            self._drift = together
            self.stretches.append(Stretch(part, 0, last.run_start, run_sample))
        elif apart > 0:
            self.end_run()
            self._gaps.append(f"{seconds(max(apart, together)):.1f} s before {part.name.name}")
            self.stretches.append(Stretch(part, 0, part.start + self._shift, 0))
        else:
            self._overlap(part, last, -apart, run_sample)

    def _overlap(self, part: AudioPart, last: Stretch, overlap: int, run_sample: int) -> None:
        self._overlaps.append(f"{seconds(overlap):.1f} s of {part.name.name}")
        first = -(-overlap * self._rate // NANOSECONDS)
        if first < part.n_samples:
            self.stretches.append(Stretch(part, first, last.run_start, run_sample))

    def end_run(self) -> None:
        """Keep the drift of the run that ends if it is the largest."""
        last = self.stretches[-1]
        length = (last.run_sample + last.n_samples) / self._rate
        if abs(self._drift) > abs(self._largest[0]):
            self._largest = float(seconds(self._drift)), length
        self._drift = 0

    def notes(self) -> list[str]:
        """Return what is to be said of gaps, overlaps and drift."""
        notes = []
        if self._gaps:
            notes.append(_counted("gap", "which stay gaps", self._gaps))
        if self._overlaps:
            notes.append(
                _counted("overlap", "where what the file before holds is left out", self._overlaps)
            )
        drift, length = self._largest
        if abs(drift) > 1.0:
            side = "ahead of" if drift > 0 else "behind"
            notes.append(
                f"Within {length:.0f} s without a gap the times of the files drift {abs(drift):.1f}"
                f" s {side} their samples ({drift / length * 1e6:+.0f} ppm); the samples are "
                "counted: the clock or the sample rate of the recorder is off."
            )
        return notes


def _counted(what: str, outcome: str, places: Sequence[str]) -> str:
    shown = ", ".join(places[:3])
    more = f" and {len(places) - 3} more" if len(places) > 3 else ""
    plural = "s" if len(places) > 1 else ""
    return f"{len(places)} {what}{plural} between files, {outcome}: {shown}{more}."
