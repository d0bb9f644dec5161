"""Multichannel WAV files, read block by block: RIFF and RF64, integer and float samples.

Samples are returned as float64 with full scale 1. The file is mapped, not loaded, so that its
length does not matter.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.arrays import CodeArray, FloatArray

_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
_SIZE_ELSEWHERE = 0xFFFFFFFF
_WIDTHS = {_PCM: (8, 16, 24, 32), _FLOAT: (32, 64)}


@dataclass(frozen=True)
class WavFile:
    """A WAV file that was opened.

    Attributes
    ----------
    path : Path
        The file.
    sample_rate : int
        Samples per second and channel.
    n_channels, n_samples : int
        Channels, and samples per channel.
    is_float : bool
        Floating-point samples, which may be NaN.
    sample_bits : int
        Bits per sample.
    data : ndarray of uint8, shape (n_bytes,)
        The sample bytes, mapped.
    missing_samples : int
        Samples per channel that the file announces and does not hold.
    """

    path: Path
    sample_rate: int
    n_channels: int
    n_samples: int
    is_float: bool
    sample_bits: int
    data: CodeArray
    missing_samples: int = 0

    def samples(self, start: int, stop: int) -> FloatArray:
        """Return samples ``start`` to ``stop``, shape (n, n_channels), linear, full scale 1."""
        frame = self.n_channels * self.sample_bits // 8
        values = _decoded(self.data[start * frame : stop * frame], self.sample_bits, self.is_float)
        return values.reshape(-1, self.n_channels)


def open_wav(path: Path | str) -> WavFile:
    """Open a WAV file.

    Raises
    ------
    ConfigurationError
        If it cannot be read, is no WAV file, or has samples of an unknown kind.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            head = file.read(12)
            if head[:4] not in (b"RIFF", b"RF64", b"BW64") or head[8:12] != b"WAVE":
                raise ConfigurationError(f"{path} is not a WAV file; convert it to WAV first.")
            chunks = _chunks(path)
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read ({error.strerror}).") from error
    if "fmt " not in chunks or "data" not in chunks:
        raise ConfigurationError(
            f"{path} is not a whole WAV file: it has no {'data' if 'fmt ' in chunks else 'format'}."
        )
    return _described(path, chunks)


def _described(path: Path, chunks: dict[str, tuple[int, int]]) -> WavFile:
    position, size = chunks["fmt "]
    with path.open("rb") as file:
        file.seek(position)
        form = file.read(min(size, 40))
    if len(form) < 16:
        raise ConfigurationError(f"{path} has a damaged format description.")
    kind, n_channels, sample_rate, _, _, sample_bits = struct.unpack_from("<HHIIHH", form)
    if kind == _EXTENSIBLE and len(form) >= 26:
        (kind,) = struct.unpack_from("<H", form, 24)
    if sample_bits not in _WIDTHS.get(kind, ()) or not n_channels or not sample_rate:
        raise ConfigurationError(
            f"{path} has {n_channels} channels of {sample_bits} bits at {sample_rate} Hz in format "
            f"{kind}; convert it to plain PCM (8, 16, 24, 32 bits) or float (32, 64 bits)."
        )
    position, size = chunks["data"]
    frame = n_channels * sample_bits // 8
    n_samples = min(size, path.stat().st_size - position) // frame
    if n_samples <= 0:
        raise ConfigurationError(f"{path} holds no samples.")
    return WavFile(
        path=path,
        sample_rate=sample_rate,
        n_channels=n_channels,
        n_samples=n_samples,
        is_float=kind == _FLOAT,
        sample_bits=sample_bits,
        data=np.memmap(path, np.uint8, "r", position, (n_samples * frame,)),
        missing_samples=size // frame - n_samples,
    )


def _chunks(path: Path) -> dict[str, tuple[int, int]]:
    """Return position and size of the first chunk of each name."""
    found: dict[str, tuple[int, int]] = {}
    long_data_size = 0
    end, position = path.stat().st_size, 12
    with path.open("rb") as file:
        while position + 8 <= end:
            file.seek(position)
            name, size = struct.unpack("<4sI", file.read(8))
            if name == b"ds64":
                _, long_data_size = struct.unpack("<QQ", file.read(16).ljust(16, b"\0"))
            if name == b"data" and size == _SIZE_ELSEWHERE:
                size = long_data_size or end - position - 8
            found.setdefault(name.decode("latin-1"), (position + 8, size))
            position += 8 + size + size % 2
    return found


def _decoded(data: CodeArray, bits: int, is_float: bool) -> FloatArray:
    if is_float:
        return np.frombuffer(data, f"<f{bits // 8}").astype(np.float64)
    if bits == 8:
        return (data.astype(np.float64) - 128.0) / 128.0
    if bits == 24:
        # Three bytes become the upper ones of four, which keeps the sign.
        wide = np.zeros((data.size // 3, 4), np.uint8)
        wide[:, 1:] = data.reshape(-1, 3)
        return wide.view("<i4").reshape(-1) / 2.0**31
    return np.frombuffer(data, f"<i{bits // 8}") / 2.0 ** (bits - 1)
