"""Opening of an audio file, by what its first bytes say it is."""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.bags.audio.audio_file import AudioFile
from sonar_tracking.bags.audio.sound_file import open_sound
from sonar_tracking.bags.audio.wav_file import open_wav
from sonar_tracking.errors import ConfigurationError

AUDIO_ENDINGS = (".wav", ".flac", ".w64", ".rf64", ".bw64", ".aif", ".aiff", ".aifc", ".caf")
"""Of names, in lower case; what a file is, its content says."""

HIGHEST_RATE = 20_000_000
"""Sample rate that a recorder may have, Hz."""


def open_audio(path: Path | str) -> AudioFile:
    """Open an audio file: WAV, RF64, FLAC, W64, AIFF, CAF, or what else libsndfile reads.

    Raises
    ------
    ConfigurationError
        If it cannot be read, or holds no samples.
    ModuleNotFoundError
        If it is not plain WAV, and the package soundfile is not installed.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            head = file.read(12)
        if len(head) < 12:
            raise ConfigurationError(f"{path} is no audio file: it holds {len(head)} bytes.")
        is_wav = head[:4] in (b"RIFF", b"RF64", b"BW64") and head[8:12] == b"WAVE"
        audio = (open_wav(path) if is_wav else None) or open_sound(path)
    except OSError as error:
        raise ConfigurationError(f"{path} cannot be read ({error.strerror}).") from error
    if audio.sample_rate > HIGHEST_RATE:
        raise ConfigurationError(
            f"{path} says it was sampled at {audio.sample_rate} Hz; its format description is "
            "damaged: copy it again."
        )
    return audio
