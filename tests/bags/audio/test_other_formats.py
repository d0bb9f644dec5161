"""FLAC, W64, RF64, AIFF and CAF: all samples that are there, and a word on those that are not."""

from __future__ import annotations

import random
import struct
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.audio.open_audio import open_audio
from sonar_tracking.bags.audio.recorded_files import open_recording
from sonar_tracking.errors import ConfigurationError

soundfile = pytest.importorskip("soundfile")

N, RATE = 20_000, 8000
SAMPLES = np.round(np.random.default_rng(3).normal(size=(N, 3)) * 3000) / 32768
FORMATS = {"wav": "WAV", "flac": "FLAC", "w64": "W64", "rf64": "RF64", "aiff": "AIFF", "caf": "CAF"}
MUTATED = 25
"""Files of each format."""


@pytest.fixture(scope="module")
def originals(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("audio")
    for ending, name in FORMATS.items():
        soundfile.write(folder / f"a.{ending}", SAMPLES, RATE, "PCM_16", format=name)
    return {ending: (folder / f"a.{ending}").read_bytes() for ending in FORMATS}


def read(path: Path) -> tuple[np.ndarray, str]:
    audio = open_audio(path)
    step = 4000
    parts = [
        audio.samples(a, min(a + step, audio.n_samples)) for a in range(0, audio.n_samples, step)
    ]
    return np.concatenate(parts), " ".join(audio.description.notes)


@pytest.mark.parametrize("ending", FORMATS)
def test_samples_are_those_that_were_written(
    tmp_path: Path, originals: dict[str, bytes], ending: str
) -> None:
    (tmp_path / "a").write_bytes(originals[ending])
    audio = open_audio(tmp_path / "a")
    assert (audio.sample_rate, audio.n_channels, audio.n_samples) == (RATE, 3, N)
    np.testing.assert_array_equal(audio.samples(0, N), SAMPLES)
    np.testing.assert_array_equal(audio.samples(777, 900), SAMPLES[777:900])
    assert not audio.description.notes


@pytest.mark.parametrize("ending", FORMATS)
def test_a_file_that_is_cut_off_gives_what_it_holds(
    tmp_path: Path, originals: dict[str, bytes], ending: str
) -> None:
    (tmp_path / "a").write_bytes(originals[ending][: len(originals[ending]) * 2 // 3])
    samples, notes = read(tmp_path / "a")
    assert "is cut off: it announces 2.5 s and holds" in notes
    good = np.isfinite(samples).all(axis=1)
    np.testing.assert_array_equal(samples[good], SAMPLES[: len(samples)][good])
    assert good.sum() > 0.5 * N


@pytest.mark.parametrize(
    ("ending", "marker", "offset", "form"),
    [("w64", b"data\xf3\xac", 16, "<q"), ("aiff", b"SSND", 4, ">I"), ("caf", b"data", 4, ">q")],
)
@pytest.mark.parametrize("size", [0, 6000])
def test_a_size_that_is_too_small_is_not_believed(
    tmp_path: Path, originals: dict[str, bytes], ending: str, marker: bytes, offset: int,
    form: str, size: int,
) -> None:  # fmt: skip
    content = bytearray(originals[ending])
    struct.pack_into(form, content, content.index(marker) + offset, size)
    (tmp_path / "a").write_bytes(content)
    samples, notes = read(tmp_path / "a")
    np.testing.assert_array_equal(samples, SAMPLES)
    assert "holds more than announced" in notes or "does not say how long" in notes


@pytest.mark.parametrize("total", [0, 1000])
def test_flac_counts_its_frames(tmp_path: Path, originals: dict[str, bytes], total: int) -> None:
    content = bytearray(originals["flac"])
    content[22:26] = total.to_bytes(4, "big")
    (tmp_path / "a").write_bytes(content)
    samples, notes = read(tmp_path / "a")
    np.testing.assert_array_equal(samples, SAMPLES)
    assert "does not say" in notes or "more than announced" in notes


def test_what_cannot_be_decoded_is_no_number_and_moves_nothing(
    tmp_path: Path, originals: dict[str, bytes]
) -> None:
    content = bytearray(originals["flac"])
    middle = len(content) // 2
    content[middle : middle + 40] = bytes(40)
    (tmp_path / "a").write_bytes(content)
    samples, _ = read(tmp_path / "a")
    bad = ~np.isfinite(samples).all(axis=1)
    assert 0 < bad.sum() < N // 2
    np.testing.assert_array_equal(samples[~bad], SAMPLES[~bad])


def mutated(content: bytes, source: random.Random) -> bytes:
    """Return a file with bytes changed, cut, added, zeroed or moved, most of them in its head."""
    data, kind = bytearray(content), source.choice("hhhcgzid")
    at = source.randrange(len(data))
    if kind == "h":
        for _ in range(source.choice([1, 2, 4])):
            data[source.randrange(120)] = source.randrange(256)
    elif kind == "c":
        data = data[:at]
    elif kind == "g":
        data += source.randbytes(3000)
    elif kind == "z":
        data[at : at + 50] = bytes(len(data[at : at + 50]))
    elif kind == "i":
        data[at:at] = source.randbytes(30)
    else:
        del data[at : at + 30]
    return bytes(data)


@pytest.mark.parametrize("ending", FORMATS)
def test_damaged_files_are_refused_or_read_with_a_word_on_what_lacks(
    tmp_path: Path, originals: dict[str, bytes], ending: str
) -> None:
    """Nothing but a sentence may come out; samples that lack are never passed over."""
    source = random.Random(ending)
    for number in range(MUTATED):
        (tmp_path / "a").write_bytes(mutated(originals[ending], source))
        try:
            samples, notes = read(tmp_path / "a")
        except ConfigurationError:
            continue
        if samples.shape[1] == 3 and np.isfinite(samples).all():
            assert len(samples) >= N or notes, number


@pytest.mark.parametrize("ending", FORMATS)
def test_another_sample_rate_in_one_directory_is_refused(tmp_path: Path, ending: str) -> None:
    for number, rate in enumerate((8000, 16_000), start=1):
        path = tmp_path / f"a_2022010{number}_000000.{ending}"
        soundfile.write(path, SAMPLES, rate, "PCM_16", format=FORMATS[ending])
    with pytest.raises(ConfigurationError, match=r"16000 Hz, .* has 8000 Hz; import files of one"):
        open_recording(tmp_path, 3, None, 1)


@pytest.mark.parametrize("rate", [RATE, 2 * RATE])
def test_a_second_stream_in_a_flac_file_is_told(
    tmp_path: Path, originals: dict[str, bytes], rate: int
) -> None:
    soundfile.write(tmp_path / "b.flac", SAMPLES, rate, "PCM_16")
    both = originals["flac"] + (tmp_path / "b.flac").read_bytes()
    (tmp_path / "both.flac").write_bytes(both)
    _, notes = read(tmp_path / "both.flac")
    place = f"from byte {len(originals['flac'])} on, of {rate} Hz where the first has {RATE} Hz"
    assert place in notes and "it is not used" in notes
