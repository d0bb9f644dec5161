"""``sonar-tracking import``: a recorded array, or recorded contacts, into a bag to replay."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sonar_tracking.bags.import_contacts import ContactSensor, import_contacts
from sonar_tracking.bags.import_wav import import_wav
from sonar_tracking.configuration import from_mapping
from sonar_tracking.graph.node_catalogue import (
    BEARING_TRACKER,
    HPDA_TRACKER,
    SUBSPACE_ESTIMATOR,
)
from sonar_tracking.graph.node_settings import read_settings, resolved_settings
from sonar_tracking.simulation.scenario import checked_epoch


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


def import_contacts_file(
    file: Path,
    output: Path,
    sensor: Mapping[str, Any],
    own_ship: Path | None = None,
    truth: Path | None = None,
    parameters: Path | None = None,
) -> str:
    """Import recorded contacts and return what was done, in words.

    Parameters
    ----------
    file, output, own_ship, truth
        See :func:`sonar_tracking.bags.import_contacts.import_contacts`.
    sensor : mapping
        Fields of ContactSensor by name; ``epoch`` as a person writes it.
    parameters : Path, optional
        YAML file of node, parameter, value: stored in the bag for its replay.

    Raises
    ------
    ConfigurationError
        If anything given cannot be used; no bag is left then.
    """
    given = read_settings(parameters) if parameters is not None else {}
    settings = resolved_settings(given, (HPDA_TRACKER,), str(parameters))
    values = {**sensor, "epoch": checked_epoch(sensor["epoch"], "")}
    described = from_mapping(ContactSensor, values, "import contacts")
    done = import_contacts(file, output, described, own_ship, truth, settings)
    return f"{done}\nreplay it with: sonar-tracking replay {output}"
