"""``sonar-tracking import wav``: a recorded array into a bag that can be replayed."""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.bags.import_wav import import_wav
from sonar_tracking.graph.node_catalogue import BEARING_TRACKER, SUBSPACE_ESTIMATOR
from sonar_tracking.graph.node_settings import read_settings, resolved_settings


def import_wav_file(
    file: Path,
    geometry: Path,
    frequency: float,
    bandwidth: float | None,
    output: Path,
    truth: Path | None = None,
    parameters: Path | None = None,
) -> str:
    """Import a WAV file and return what was done, in words.

    Parameters
    ----------
    file, geometry, frequency, bandwidth, output, truth
        See :func:`sonar_tracking.bags.import_wav.import_wav`.
    parameters : Path, optional
        YAML file of node, parameter, value: stored in the bag for its replay.

    Raises
    ------
    ConfigurationError
        If anything given cannot be used; no bag is left then.
    """
    given = read_settings(parameters) if parameters is not None else {}
    settings = resolved_settings(given, (SUBSPACE_ESTIMATOR, BEARING_TRACKER), str(parameters))
    summary = import_wav(file, geometry, frequency, bandwidth, output, truth, settings)
    return f"{summary.text()}\nreplay it with: sonar-tracking replay {output}"
