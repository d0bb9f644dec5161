"""Files of one recording lie on one time axis: gaps stay, overlaps and drift are reported."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

from sonar_tracking.bags.audio.recorded_files import open_recording
from sonar_tracking.bags.audio.recording import Recording
from sonar_tracking.errors import ConfigurationError

RATE, SECOND = 1000, 10**9
NOON = int(datetime(2022, 1, 1, 12, tzinfo=timezone.utc).timestamp()) * SECOND
ASSUMED = 1_767_225_600 * SECOND


def write(folder: Path, name: str, seconds: float, channels: int = 2, first: int = 0) -> None:
    """Write samples that count up from ``first``, the channels a thousand apart."""
    count = first + np.arange(round(seconds * RATE))
    samples = count[:, None] % 900 + 1000 * np.arange(channels)
    wavfile.write(folder / name, RATE, samples.astype(np.int16))


def opened(folder: Path, channels: int = 2, epoch: int | None = None) -> Recording:
    return open_recording(folder, channels, epoch, ASSUMED)


def stamps(recording: Recording) -> list[float]:
    return [(stretch.stamp(0) - recording.start) / SECOND for stretch in recording.stretches]


def test_consecutive_files_go_on_and_gaps_stay_gaps(tmp_path: Path) -> None:
    for clock in ("120000", "120010", "120030"):
        write(tmp_path, f"5146.220101{clock}.wav", 10.0)
    recording = opened(tmp_path)
    assert recording.start == NOON and recording.n_samples == 30 * RATE
    assert stamps(recording) == [0.0, 10.0, 30.0]
    assert [stretch.run_sample for stretch in recording.stretches] == [0, 10 * RATE, 0]
    assert any("1 gap between files" in note and "10.0 s" in note for note in recording.notes)


def test_less_than_a_second_is_the_rounding_of_the_names(tmp_path: Path) -> None:
    for clock, seconds in (("120000", 9.6), ("120010", 10.3), ("120020", 1.0)):
        write(tmp_path, f"a_20220101_{clock}.wav", seconds)
    assert stamps(opened(tmp_path)) == [0.0, 9.6, 19.9]


def test_what_two_files_hold_both_is_taken_once(tmp_path: Path) -> None:
    write(tmp_path, "a_20220101_120000.wav", 10.0)
    write(tmp_path, "a_20220101_120006.wav", 10.0, first=6000)
    write(tmp_path, "a_20220101_120008.wav", 2.0, first=8000)
    recording = opened(tmp_path)
    assert recording.n_samples == 16 * RATE
    got = np.concatenate([part.samples(0, part.n_samples) for part in recording.stretches])
    np.testing.assert_array_equal(got[:, 0] * 32768, np.arange(16_000) % 900)
    assert any("2 overlaps" in note and "4.0 s" in note for note in recording.notes)


@pytest.mark.slow
def test_a_clock_that_drifts_is_reported(tmp_path: Path) -> None:
    """Names that fall behind by 0.02 % gain 2 s in three hours."""
    for hour in range(4):
        at = datetime.fromtimestamp(NOON // SECOND + round(3600.72 * hour), tz=timezone.utc)
        write(tmp_path, f"a_{at:%Y%m%d_%H%M%S}.wav", 3600.0, channels=1)
    recording = opened(tmp_path, channels=1)
    assert len({stretch.run_start for stretch in recording.stretches}) == 1
    assert any("drift 2.0 s ahead of" in note for note in recording.notes)


def test_many_short_gaps_are_gaps_and_no_drift(tmp_path: Path) -> None:
    for minute in range(4):
        write(tmp_path, f"a_20220101_12{minute:02d}00.wav", 59.2)
    recording = opened(tmp_path)
    assert any("between files, which stay gaps" in note for note in recording.notes)
    assert abs(stamps(recording)[-1] - 180.0) <= 1.0


def test_one_file_a_hydrophone(tmp_path: Path) -> None:
    for number in (1, 2, 10):
        write(tmp_path, f"H{number}_20220101_120000.wav", 10.0, 1, first=number)
        write(tmp_path, f"H{number}_20220101_120010.wav", 9.0 + (number == 2), 1, first=number)
    recording = opened(tmp_path, channels=3)
    assert recording.n_channels == 3 and stamps(recording) == [0.0, 10.0]
    first = recording.stretches[0].samples(0, 1)
    np.testing.assert_array_equal(first * 32768, [[1, 2, 10]])
    notes = " ".join(recording.notes)
    assert "H1_20220101_120000.wav, H2_" in notes and "synchronised" in notes
    assert "differ in length" in notes and "+1000.0 ms" in notes


def test_files_without_times(tmp_path: Path) -> None:
    write(tmp_path, "part10.wav", 1.0)
    write(tmp_path, "part9.wav", 2.0)
    recording = opened(tmp_path)
    assert [part.part.name.name for part in recording.stretches] == ["part9.wav", "part10.wav"]
    assert recording.start == ASSUMED and stamps(recording) == [0.0, 2.0]
    notes = " ".join(recording.notes)
    assert "Nothing says when" in notes and "without a gap" in notes
    assert opened(tmp_path, epoch=NOON).start == NOON


def test_the_given_epoch_goes_before_the_names(tmp_path: Path) -> None:
    write(tmp_path, "a_20220101_120000.wav", 1.0)
    write(tmp_path, "a_20220101_120100.wav", 1.0)
    recording = opened(tmp_path, epoch=ASSUMED)
    assert recording.start == ASSUMED and stamps(recording) == [0.0, 60.0]
    assert any("the files say 2022-01-01T12:00:00Z" in note for note in recording.notes)


def test_what_does_not_belong_together_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="no audio file"):
        opened(tmp_path)
    write(tmp_path, "a_20220101_120000.wav", 1.0)
    write(tmp_path, "b.wav", 1.0)
    with pytest.raises(ConfigurationError, match=r"b\.wav has no time"):
        opened(tmp_path)
    (tmp_path / "b.wav").unlink()
    write(tmp_path, "a_20220101_130000.wav", 1.0, channels=3)
    with pytest.raises(ConfigurationError, match="has 3 channels"):
        opened(tmp_path)
    (tmp_path / "a_20220101_130000.wav").write_bytes(b"RIFF")
    recording = opened(tmp_path)
    assert any("left out" in note for note in recording.notes)
