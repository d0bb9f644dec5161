"""Who asks what a recording is gets its kind, what is wrong with it, and the command."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.io import wavfile

from sonar_tracking.bags.audio.audio_inspection import inspect_audio


def test_a_file_and_a_directory_are_described(tmp_path: Path) -> None:
    samples = np.ones((2000, 4), np.int16)
    for name in ("a_20220101_120000.wav", "a_20220101_120100.wav"):
        wavfile.write(tmp_path / name, 1000, samples)
    what, wrong, command = inspect_audio(tmp_path / "a_20220101_120000.wav")
    assert what == "audio: WAV, 16 bits, integers, 4 channels at 1000 Hz, 2.0 s"
    assert wrong == ["The first sample is at 2022-01-01T12:00:00Z, as the files say, taken as UTC."]
    assert command.startswith(f"sonar-tracking import samples {tmp_path}")
    what, wrong, _ = inspect_audio(tmp_path)
    assert "2 audio files" in what and "4.0 s" in what
    assert any("1 gap between files" in note for note in wrong)
