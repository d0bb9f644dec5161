"""Multichannel WAV files, read piece by piece: RIFF, RF64 and BW64, integer and float samples.

What a file says of itself is compared with what is there: :mod:`riff_chunks` for sizes, this module
for the format of the samples.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

from sonar_tracking.bags.audio.audio_file import AudioDescription, AudioFile, length_note
from sonar_tracking.bags.audio.broadcast_extension import broadcast_origin
from sonar_tracking.bags.audio.riff_chunks import RiffChunks, riff_chunks
from sonar_tracking.bags.audio.sample_cells import SampleCells, bits_in_cells
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.arrays import FloatArray

_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
_CONTAINERS = {b"RIFF": "WAV", b"RF64": "RF64", b"BW64": "BW64"}
_LOOKED_AT = 1 << 20
"""Bytes of samples from which their place in their cells is told."""
_MOST_LOOKED_AT = 1 << 26
"""The same at the end of a file."""

_SILENCE = 1.0
"""Zeros at the end that are worth a sentence, s."""


class WavFile(AudioFile):
    """A WAV file of integer or floating-point samples.

    Parameters
    ----------
    description : AudioDescription
        What it is.
    cells : SampleCells
        How a sample lies in its bytes.
    extents : list of tuple of int
        Position and size, bytes, of the samples in the file, in order.
    """

    def __init__(
        self, description: AudioDescription, cells: SampleCells, extents: list[tuple[int, int]]
    ) -> None:
        super().__init__(description)
        self._cells, self._extents = cells, extents
        self._frame = cells.size * description.n_channels

    def samples(self, start: int, stop: int) -> FloatArray:
        """Return samples ``start`` to ``stop``, shape (n, n_channels), linear, full scale 1."""
        data = bytes_of(self.path, self._extents, start * self._frame, stop * self._frame)
        return self._cells.decoded(data).reshape(-1, self.n_channels)


@dataclass(frozen=True)
class _Format:
    code: int
    n_channels: int
    sample_rate: int
    byte_rate: int
    frame: int
    bits: int
    valid_bits: int

    @property
    def bytes_of_bits(self) -> int:
        return -(-self.bits // 8)


def open_wav(path: Path) -> WavFile | None:
    """Open a RIFF, RF64 or BW64 file; None if its samples are coded in some other way.

    Raises
    ------
    ConfigurationError
        If it is no whole WAV file, or holds no samples.
    """
    chunks = riff_chunks(path)
    if "fmt " not in chunks.bodies or not chunks.data:
        lacking = "data" if "fmt " in chunks.bodies else "format"
        raise ConfigurationError(
            f"{path} is not a whole WAV file: it has no {lacking}; copy it again."
        )
    form = _format(path, chunks)
    if form.code not in (_PCM, _FLOAT):
        return None
    cells, remarks = _cells(path, form, chunks)
    notes = [f"{path} {remark}." for remark in (*chunks.remarks, *remarks)]
    n_bytes, frame = sum(size for _, size in chunks.data), cells.size * form.n_channels
    n_samples = n_bytes // frame
    if n_samples <= 0:
        raise ConfigurationError(f"{path} holds no samples.")
    notes += _length_notes(path, chunks, n_bytes, frame * form.sample_rate, frame)
    notes += _silence_notes(path, chunks.data, n_bytes, frame * form.sample_rate)
    with path.open("rb") as file:
        head = file.read(4)
        position, size = chunks.bodies.get("bext", (0, 0))
        file.seek(position)
        origin = broadcast_origin(path, file.read(min(size, _LOOKED_AT)), form.sample_rate)
    kind = "floating-point numbers" if cells.is_float else "integers"
    description = AudioDescription(
        path=path,
        kind=f"{_CONTAINERS.get(head, 'WAV')}, {form.bits} bits, {kind}",
        sample_rate=form.sample_rate,
        n_channels=form.n_channels,
        n_samples=n_samples,
        may_be_not_a_number=cells.is_float,
        notes=tuple(notes),
        origin=origin,
    )
    return WavFile(description, cells, chunks.data)


def bytes_of(path: Path, extents: list[tuple[int, int]], start: int, stop: int) -> bytes:
    """Return bytes ``start`` to ``stop`` of the samples of a file.

    Raises
    ------
    ConfigurationError
        If the file cannot be read any more.
    """
    parts, begin = [], 0
    try:
        with path.open("rb") as file:
            for position, size in extents:
                first, last = max(start - begin, 0), min(stop - begin, size)
                if first < last:
                    file.seek(position + first)
                    parts.append(file.read(last - first))
                begin += size
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read ({error.strerror}).") from error
    data = b"".join(parts) if len(parts) != 1 else parts[0]
    if len(data) != min(stop, begin) - start:
        raise ConfigurationError(f"{path} became shorter while it was read; import it again.")
    return data


def _format(path: Path, chunks: RiffChunks) -> _Format:
    position, size = chunks.bodies["fmt "]
    with path.open("rb") as file:
        file.seek(position)
        body = file.read(min(size, 40))
    if len(body) < 16:
        raise ConfigurationError(f"{path} has a damaged format description; copy it again.")
    code, n_channels, sample_rate, byte_rate, frame, bits = struct.unpack_from("<HHIIHH", body)
    valid_bits = bits
    if code == _EXTENSIBLE and len(body) >= 26:
        valid_bits, _, code = struct.unpack_from("<HIH", body, 18)
    if not n_channels or not sample_rate or (not bits and code in (_PCM, _FLOAT)):
        raise ConfigurationError(
            f"{path} says it has {n_channels} channels of {bits} bits at {sample_rate} Hz; its "
            "format description is damaged: copy it again."
        )
    return _Format(code, n_channels, sample_rate, byte_rate, frame, bits, valid_bits or bits)


def _cells(path: Path, form: _Format, chunks: RiffChunks) -> tuple[SampleCells, list[str]]:
    """Return how a sample lies in its bytes, and what the file says of that which is not so."""
    size, remarks = form.bytes_of_bits, []
    expected = size * form.n_channels
    if form.frame != expected:
        wider = form.frame // form.n_channels
        confirmed = form.frame * form.sample_rate == form.byte_rate
        if form.frame % form.n_channels == 0 and size < wider <= 4 and (confirmed or wider == 4):
            remarks.append(
                f"has samples of {form.bits} bits in cells of {wider} bytes; they are read as such"
            )
            size = wider
        else:
            remarks.append(
                f"says that {form.n_channels} samples of {form.bits} bits take {form.frame} bytes, "
                f"which is {expected}; that is taken"
            )
    if size * form.n_channels * form.sample_rate != form.byte_rate and form.byte_rate:
        told = form.byte_rate / (size * form.n_channels)
        remarks.append(
            f"contradicts itself: its sample rate is {form.sample_rate} Hz, and its bytes per "
            f"second belong to {told:g} Hz; the sample rate is taken, check it"
        )
    is_float = form.code == _FLOAT
    if size not in ((4, 8) if is_float else (1, 2, 3, 4)):
        raise ConfigurationError(
            f"{path} has {form.n_channels} channels of {form.bits} bits at {form.sample_rate} Hz "
            f"in format {form.code}; convert it to PCM (8 to 32 bits) or float (32, 64 bits)."
        )
    bits = 8 * size
    used = min(form.bits, form.valid_bits)
    if not is_float and size == 4 and used < 32:
        whole = _LOOKED_AT // (4 * form.n_channels) * 4 * form.n_channels
        bits = bits_in_cells(bytes_of(path, chunks.data, 0, max(whole, 4)), used)
        if bits < 32:
            remarks.append(f"has its {used} bits in the lower bytes of their cells")
    return SampleCells(size, is_float, bits), remarks


def _length_notes(
    path: Path, chunks: RiffChunks, n_bytes: int, byte_rate: int, frame: int
) -> list[str]:
    notes = []
    announced = chunks.announced
    if announced is None or abs(n_bytes - announced) >= frame:
        told = None if announced is None else announced / byte_rate
        notes.append(length_note(path, told, n_bytes / byte_rate))
    if len(chunks.data) > 1:
        notes.append(f"{path} has {len(chunks.data)} chunks of samples; they are joined.")
    if chunks.zeros:
        notes.append(f"{path} ends in {chunks.zeros} bytes of zeros behind its samples, not used.")
    if n_bytes % frame:
        notes.append(
            f"{path} ends within a sample of all channels; {n_bytes % frame} bytes are left out."
        )
    return notes


def _silence_notes(
    path: Path, extents: list[tuple[int, int]], n_bytes: int, byte_rate: int
) -> list[str]:
    """Return a sentence if the samples end in zeros, as in a file that was prepared in advance."""
    last, first_looked_at = n_bytes, max(n_bytes - _MOST_LOOKED_AT, 0)
    while last > first_looked_at:
        first = max(last - _LOOKED_AT, first_looked_at)
        piece = bytes_of(path, extents, first, last)
        kept = len(piece.rstrip(b"\0"))
        last = first + kept
        if kept:
            break
    zeros = (n_bytes - last) / byte_rate
    if not last:
        return [f"{path} holds nothing but zeros; check the recorder, or copy it again."]
    if zeros < _SILENCE:
        return []
    more = " or more" if last == first_looked_at else ""
    return [f"{path}: its last {zeros:.1f} s{more} are zeros on all channels, imported as such."]
