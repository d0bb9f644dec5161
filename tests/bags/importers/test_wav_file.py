"""Samples must be read right whatever their width, and other files refused with a sentence."""

from __future__ import annotations

import struct
import wave
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

from sonar_tracking.bags.importers.wav_file import open_wav
from sonar_tracking.errors import ConfigurationError

SAMPLES = np.array([[0.5, -0.5], [0.25, -1.0], [0.0, 0.75]])


@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_integer_samples_of_every_width(tmp_path: Path, width: int) -> None:
    values = np.round(SAMPLES * 2 ** (8 * width - 1)).astype(int).ravel()
    if width == 1:
        data = bytes(int(value) + 128 for value in values)
    else:
        data = b"".join(int(value).to_bytes(width, "little", signed=True) for value in values)
    with wave.open(str(tmp_path / "a.wav"), "wb") as file:
        file.setparams((2, width, 48_000, 0, "NONE", ""))
        file.writeframes(data)
    wav = open_wav(tmp_path / "a.wav")
    assert (wav.sample_rate, wav.n_channels, wav.n_samples) == (48_000, 2, 3)
    np.testing.assert_array_equal(wav.samples(0, 3), SAMPLES)
    np.testing.assert_array_equal(wav.samples(1, 2), SAMPLES[1:2])


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_float_samples(tmp_path: Path, kind: type) -> None:
    wavfile.write(tmp_path / "a.wav", 16_000, SAMPLES.astype(kind))
    wav = open_wav(tmp_path / "a.wav")
    assert wav.is_float
    np.testing.assert_array_equal(wav.samples(0, 3), SAMPLES)


def riff(form: bytes, name: bytes = b"RIFF", data: bytes = bytes(12), size: int = -1) -> bytes:
    """Return a WAV file with an unknown chunk of odd length before the data."""
    chunks = b"fmt " + struct.pack("<I", len(form)) + form + b"note\x03\x00\x00\x00abc\x00"
    if name == b"RF64":
        chunks = b"ds64" + struct.pack("<IQQQI", 28, 0, len(data), 0, 0) + chunks
    size = len(data) if size < 0 else size
    chunks += b"data" + struct.pack("<I", size) + data
    return name + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


def test_extensible_and_long_files(tmp_path: Path) -> None:
    plain = struct.pack("<HHIIHH", 1, 2, 8000, 32_000, 4, 16)
    extensible = struct.pack("<HHIIHHHHIH", 0xFFFE, 2, 8000, 32_000, 4, 16, 22, 16, 3, 1)
    data = np.arange(6, dtype="<i2").tobytes()
    for content, missing in (
        (riff(plain, data=data), 0),
        (riff(extensible + bytes(14), data=data), 0),
        (riff(plain, b"RF64", data, 0xFFFFFFFF), 0),
        (riff(plain, data=data, size=0xFFFFFFFF), 0),
        (riff(plain, data=data, size=4000), 997),
    ):
        (tmp_path / "a.wav").write_bytes(content)
        wav = open_wav(tmp_path / "a.wav")
        assert (wav.n_samples, wav.missing_samples) == (3, missing)
        np.testing.assert_array_equal(wav.samples(0, 3) * 32768, np.arange(6).reshape(3, 2))


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    law = struct.pack("<HHIIHH", 7, 2, 8000, 16_000, 2, 8)
    none = struct.pack("<HHIIHH", 1, 0, 8000, 16_000, 2, 16)
    plain = struct.pack("<HHIIHH", 1, 2, 8000, 32_000, 4, 16)
    for content, reason in (
        (b"ID3 some music", "is not a WAV file"),
        (b"", "is not a WAV file"),
        (riff(law), "format 7"),
        (riff(none), "0 channels"),
        (riff(plain, data=b""), "holds no samples"),
        (riff(plain)[:14], "has no format"),
        (riff(plain)[:40], "has no data"),
    ):
        (tmp_path / "a.wav").write_bytes(content)
        with pytest.raises(ConfigurationError, match=reason) as caught:
            open_wav(tmp_path / "a.wav")
        assert "a.wav" in str(caught.value)
    with pytest.raises(ConfigurationError, match="cannot be read"):
        open_wav(tmp_path / "absent.wav")
