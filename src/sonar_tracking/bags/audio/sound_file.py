"""Audio files that libsndfile reads: FLAC, W64, AIFF, CAF, and WAV that is coded.

What cannot be decoded is not a number, so that what follows keeps its time.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.audio.audio_file import AudioDescription, AudioFile, length_note
from sonar_tracking.bags.audio.flac_length import (
    announced_samples,
    further_stream,
    held_samples,
    total_patch,
)
from sonar_tracking.bags.audio.header_repair import RepairedFile, SampleChunk, sample_chunk
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.arrays import FloatArray

_PIECE = 4096
"""Samples that are tried on their own where more of them could not be decoded."""

_MOST_FAILURES = 64
"""Pieces in a row after which the rest of a file counts as damaged."""

_WIDTHS = {"PCM_S8": 1, "PCM_U8": 1, "PCM_16": 2, "PCM_24": 3, "PCM_32": 4, "FLOAT": 4, "DOUBLE": 8}
_MOST_CHANNELS, _HIGHEST_RATE = 1024, 100_000_000
_DATA_FORMATS = ("FLOAT", "DOUBLE")


class SoundFile(AudioFile):
    """A file that libsndfile decodes.

    Parameters
    ----------
    description : AudioDescription
        What it is.
    patches : dict of int to bytes
        Position and bytes of what its head should say instead.
    """

    def __init__(self, description: AudioDescription, patches: dict[int, bytes]) -> None:
        super().__init__(description)
        self._patches = patches
        self._open: Any = None
        self._failures = 0

    def samples(self, start: int, stop: int) -> FloatArray:
        """Return samples ``start`` to ``stop``, shape (n, n_channels), linear, full scale 1."""
        data = self._decoded(start, stop)
        if data is not None:
            return data
        parts = []
        for first in range(start, stop, _PIECE):
            last = min(first + _PIECE, stop)
            part = self._decoded(first, last)
            self._failures = 0 if part is not None else self._failures + 1
            parts.append(np.full((last - first, self.n_channels), np.nan) if part is None else part)
        return np.concatenate(parts)

    def _decoded(self, start: int, stop: int) -> FloatArray | None:
        """Return the samples, shape (n, n_channels), or None if not all can be decoded."""
        if self._failures >= _MOST_FAILURES:
            return None
        soundfile = _library()
        try:
            if self._open is None:
                self._open = soundfile.SoundFile(RepairedFile(self.path, self._patches))
            if self._open.tell() != start:
                self._open.seek(start)
            data = self._open.read(stop - start, dtype="float64", always_2d=True)
        except (RuntimeError, OSError):
            self._open = None
            return None
        if stop == self.n_samples or len(data) != stop - start:
            self._open = None
        if len(data) != stop - start:
            return None
        return np.asarray(data)


def open_sound(path: Path) -> SoundFile:
    """Open a file with libsndfile.

    Raises
    ------
    ConfigurationError
        If it cannot be read, or holds no samples.
    ModuleNotFoundError
        If the package soundfile is not installed.
    """
    notes: list[str] = []
    patches = _flac_patches(path) if _is_flac(path) else {}
    found = sample_chunk(path)
    if found is not None and found.announced != found.held:
        patches = found.patches(1)
    info = _information(path, patches)
    frame = _WIDTHS.get(info.subtype, 0) * info.channels
    if found is not None and frame and patches:
        patches = found.patches(frame)
        info = _information(path, patches)
    n_samples = info.frames
    if frame and found is not None:
        n_samples = min(n_samples, found.held // frame)
        notes += _size_notes(path, found, n_samples, frame, info.samplerate)
    if not 0 < n_samples < 1 << 40:
        raise ConfigurationError(f"{path} holds no samples.")
    if _is_flac(path) and (announced := announced_samples(path)) != n_samples:
        told = announced / info.samplerate if announced else None
        notes.append(length_note(path, told, n_samples / info.samplerate))
    if _is_flac(path) and (further := further_stream(path)) is not None:
        notes.append(
            f"{path} holds another FLAC stream from byte {further[0]} on, of {further[1]} Hz where "
            f"the first has {info.samplerate} Hz; it is not used: put it into a file of its own."
        )
    description = AudioDescription(
        path=path,
        kind=f"{info.format}, {info.subtype.replace('_', ' ')}",
        sample_rate=int(info.samplerate),
        n_channels=info.channels,
        n_samples=n_samples,
        may_be_not_a_number=info.subtype in _DATA_FORMATS or _is_flac(path) or not frame,
        notes=tuple(notes),
    )
    return SoundFile(description, patches)


def _information(path: Path, patches: dict[int, bytes]) -> Any:
    soundfile = _library()
    try:
        with RepairedFile(path, patches) as file, soundfile.SoundFile(file) as opened:
            return _Facts(opened)
    except (RuntimeError, struct.error, ValueError, TypeError) as error:
        reason = str(getattr(error, "error_string", error)).rstrip(". ") or "its head is damaged"
        raise ConfigurationError(
            f"{path} is not an audio file that can be read ({reason}); give WAV, FLAC, W64, RF64, "
            "AIFF or CAF, or copy it again."
        ) from error


def _size_notes(
    path: Path, found: SampleChunk, n_samples: int, frame: int, sample_rate: int
) -> list[str]:
    """Return sentences on samples that are not as many as the file says, or as it has room for."""
    notes, byte_rate = [], frame * sample_rate
    if abs(found.announced - found.held) >= frame:
        told = found.announced / byte_rate if found.announced else None
        notes.append(length_note(path, told, found.held / byte_rate))
    unread = found.held - n_samples * frame
    if unread:
        notes.append(f"{path} has {unread} bytes of samples that are no whole sample; left out.")
    return notes


class _Facts:
    """What libsndfile says of a file."""

    def __init__(self, opened: Any) -> None:
        self.frames, self.channels = int(opened.frames), int(opened.channels)
        self.samplerate = int(opened.samplerate)
        self.format, self.subtype = str(opened.format), str(opened.subtype)
        if not 0 < self.samplerate <= _HIGHEST_RATE or not 0 < self.channels <= _MOST_CHANNELS:
            raise ValueError(f"it says {self.channels} channels at {self.samplerate} Hz")


def _is_flac(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(4) == b"fLaC"


def _flac_patches(path: Path) -> dict[int, bytes]:
    """Return what makes the head of a FLAC file announce what the file holds."""
    held = held_samples(path)
    if held is None:
        raise ConfigurationError(f"{path} ends without a FLAC frame; copy it again.")
    return {} if held == announced_samples(path) else total_patch(path, held)


def _library() -> Any:
    """Return the package that binds libsndfile; only those who need it wait for it."""
    import soundfile

    return soundfile
