"""A WAV file is believed as far as it agrees with itself; its samples are right all the same."""

from __future__ import annotations

import struct
import wave
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

from sonar_tracking.bags.audio.open_audio import open_audio
from sonar_tracking.errors import ConfigurationError

SAMPLES = np.array([[0.5, -0.5], [0.25, -1.0], [0.0, 0.75]])
PLAIN = struct.pack("<HHIIHH", 1, 2, 8000, 32_000, 4, 16)
COUNT = np.arange(1, 4001, dtype="<i2")


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
    wav = open_audio(tmp_path / "a.wav")
    assert (wav.sample_rate, wav.n_channels, wav.n_samples) == (48_000, 2, 3)
    assert not wav.description.notes
    np.testing.assert_array_equal(wav.samples(0, 3), SAMPLES)
    np.testing.assert_array_equal(wav.samples(1, 2), SAMPLES[1:2])


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_float_samples(tmp_path: Path, kind: type) -> None:
    wavfile.write(tmp_path / "a.wav", 16_000, SAMPLES.astype(kind))
    wav = open_audio(tmp_path / "a.wav")
    assert wav.description.may_be_not_a_number
    np.testing.assert_array_equal(wav.samples(0, 3), SAMPLES)


def riff(
    form: bytes = PLAIN, name: bytes = b"RIFF", data: bytes = bytes(12), size: int = -1
) -> bytes:
    """Return a WAV file with an unknown chunk of odd length before the data."""
    chunks = b"fmt " + struct.pack("<I", len(form)) + form + b"note\x03\x00\x00\x00abc\x00"
    if name == b"RF64":
        chunks = b"ds64" + struct.pack("<IQQQI", 28, 0, len(data), 0, 0) + chunks
    size = len(data) if size < 0 else size
    chunks += b"data" + struct.pack("<I", size) + data
    return name + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


EXTENSIBLE = struct.pack("<HHIIHHHHIH", 0xFFFE, 2, 8000, 32_000, 4, 16, 22, 16, 3, 1) + bytes(14)
LIST = b"LIST\x04\x00\x00\x00INFO"
DATA = COUNT.tobytes()
WHOLE = riff(data=DATA)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        pytest.param(WHOLE, "", id="as it should be"),
        pytest.param(WHOLE + LIST, "", id="a chunk behind the samples"),
        pytest.param(riff(EXTENSIBLE, data=DATA), "", id="extensible"),
        pytest.param(riff(PLAIN, b"RF64", DATA, 0xFFFFFFFF), "", id="RF64"),
        pytest.param(riff(data=DATA, size=0xFFFFFFFF), "does not say how long", id="unknown size"),
        pytest.param(riff(data=DATA, size=0), "does not say how long", id="zero size"),
        pytest.param(riff(data=DATA, size=400), "holds more than announced", id="stale size"),
        pytest.param(riff(data=DATA, size=16_000), "announces 0.5 s and holds 0.2 s", id="cut"),
        pytest.param(riff(data=DATA[:4000]) + b"data" + struct.pack("<I", 4000) + DATA[4000:],
                     "has 2 chunks of samples", id="second data chunk"),
        pytest.param(WHOLE.replace(b"abc\0", b"abc"), "lacks the byte that pads", id="no pad"),
        pytest.param(riff(data=DATA[:5120]).replace(b"abc\0", b"abc"), "lacks the byte that pads",
                     id="no pad, and a size that looks like one"),
        pytest.param(WHOLE.replace(b"note\x03\0\0", b"note\x03\x55\x55"), "damaged chunk",
                     id="chunk of a wrong size"),
        pytest.param(WHOLE + bytes(100_000), "ends in 100000 bytes of zeros", id="zeros behind"),
        pytest.param(riff(data=DATA + b"\x01\x02", size=0), "ends within a sample",
                     id="half a sample"),
    ],
)  # fmt: skip
def test_all_samples_come_out_and_what_is_wrong_is_said(
    tmp_path: Path, content: bytes, said: str
) -> None:
    (tmp_path / "a.wav").write_bytes(content)
    wav = open_audio(tmp_path / "a.wav")
    whole = COUNT.reshape(-1, 2)[: wav.n_samples]
    np.testing.assert_array_equal(wav.samples(0, wav.n_samples) * 32768, whole)
    assert wav.n_samples in (len(DATA) // 4, 1280)
    notes = " ".join(wav.description.notes)
    assert said in notes and bool(said) == bool(notes)


def test_a_size_that_wrapped_at_four_gigabytes(tmp_path: Path) -> None:
    """The file is sparse: it takes no room on the disk."""
    size = (1 << 32) + 4000
    with (tmp_path / "a.wav").open("wb") as file:
        file.write(riff(data=b"", size=4000))
        begin = file.tell()
        file.seek(begin + 4000)
        file.write(b"\x01\x00")
        file.seek(begin + size)
        file.write(LIST)
    wav = open_audio(tmp_path / "a.wav")
    assert wav.n_samples == size // 4
    assert any("holds more than announced" in note for note in wav.description.notes)


def test_a_sample_rate_that_no_recorder_has_is_refused(tmp_path: Path) -> None:
    form = struct.pack("<HHIIHH", 1, 2, 4_000_000_000, 4_000_000_000, 4, 16)
    (tmp_path / "a.wav").write_bytes(riff(form, data=DATA))
    with pytest.raises(ConfigurationError, match="4000000000 Hz; its format description"):
        open_audio(tmp_path / "a.wav")


@pytest.mark.parametrize("shift", [8, 0], ids=["upper bytes", "lower bytes"])
def test_samples_of_24_bits_in_4_bytes(tmp_path: Path, shift: int) -> None:
    values = np.array([1, -2, 3, -8_000_000, 5, 8_000_001], "<i4")
    form = struct.pack("<HHIIHH", 1, 2, 8000, 64_000, 8, 24)
    (tmp_path / "a.wav").write_bytes(riff(form, data=(values << shift).tobytes()))
    wav = open_audio(tmp_path / "a.wav")
    assert wav.n_samples == 3
    np.testing.assert_allclose(wav.samples(0, 3).ravel(), values / 2.0**23)
    assert "cells of 4 bytes" in wav.description.notes[0]


def test_rates_that_contradict_each_other_are_reported(tmp_path: Path) -> None:
    form = struct.pack("<HHIIHH", 1, 2, 9000, 32_000, 4, 16)
    (tmp_path / "a.wav").write_bytes(riff(form, data=DATA))
    (note,) = open_audio(tmp_path / "a.wav").description.notes
    assert "9000 Hz" in note and "8000 Hz" in note


def test_zeros_at_the_end_of_the_samples_are_reported(tmp_path: Path) -> None:
    (tmp_path / "a.wav").write_bytes(riff(data=DATA + bytes(4 * 16_000)))
    (note,) = open_audio(tmp_path / "a.wav").description.notes
    assert "its last 2.0 s are zeros" in note


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    unknown = struct.pack("<HHIIHH", 0x1234, 2, 8000, 16_000, 2, 8)
    none = struct.pack("<HHIIHH", 1, 0, 8000, 16_000, 2, 16)
    no_bits = struct.pack("<HHIIHH", 1, 2, 8000, 16_000, 2, 0)
    for content, reason in (
        (riff(no_bits), "channels of 0 bits"),
        (b"ID3 some music", "is not an audio file"),
        (b"", "holds 0 bytes"),
        (riff(unknown), "is not an audio file"),
        (riff(none), "0 channels"),
        (riff(data=b""), "holds no samples"),
        (riff()[:14], "has no format"),
        (riff()[:40], "has no data"),
    ):
        (tmp_path / "a.wav").write_bytes(content)
        with pytest.raises(ConfigurationError, match=reason) as caught:
            open_audio(tmp_path / "a.wav")
        assert "a.wav" in str(caught.value)
    with pytest.raises(ConfigurationError, match="cannot be read"):
        open_audio(tmp_path / "absent.wav")
