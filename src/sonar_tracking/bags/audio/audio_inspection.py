"""What an audio file, or a directory of them, is: what is wrong with it, and how to import it."""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.bags.audio.recorded_files import audio_paths, open_recording
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH


def inspect_audio(path: Path) -> tuple[str, list[str], str]:
    """Return what audio is, sentences on what is wrong or assumed, and the command to import it.

    Parameters
    ----------
    path : Path
        File or directory.

    Raises
    ------
    ConfigurationError
        If it cannot be read, or is no recording of one array.
    """
    n_files = len(audio_paths(path))
    recording = open_recording(path, default_epoch=DEFAULT_EPOCH)
    first = recording.stretches[0].part.files[0]
    what = (
        f"{'a directory of ' + str(n_files) + ' audio files' if path.is_dir() else 'audio'}: "
        f"{first.description.kind}, {recording.n_channels} channels at {recording.sample_rate} "
        f"Hz, {recording.n_samples / recording.sample_rate:.1f} s"
    )
    command = (
        f"sonar-tracking import samples {path} --geometry array.yaml --frequency HZ --output bag"
    )
    return what, list(recording.notes), command
