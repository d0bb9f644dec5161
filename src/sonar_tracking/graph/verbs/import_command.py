"""``sonar-tracking import``: recorded data into a bag to replay."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from sonar_tracking.bags.importers.audio_recording import NOT_GIVEN, GivenTime
from sonar_tracking.bags.importers.import_bearings import (
    BearingSensor,
    BearingSources,
    import_bearings,
)
from sonar_tracking.bags.importers.import_contacts import ContactSensor, import_contacts
from sonar_tracking.bags.importers.import_nmea import import_nmea
from sonar_tracking.bags.importers.import_samples import import_samples, suggested_estimator
from sonar_tracking.bags.importers.import_wav import import_wav
from sonar_tracking.configuration import from_mapping
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.active_nodes import HPDA_TRACKER
from sonar_tracking.graph.catalogue.fusion_nodes import TRACK_FUSION
from sonar_tracking.graph.catalogue.node_settings import read_settings, resolved_settings
from sonar_tracking.graph.catalogue.passive_nodes import (
    BAND_DEMODULATOR,
    BEARING_TRACKER,
    LINE_TRACKER,
    SUBSPACE_ESTIMATOR,
)
from sonar_tracking.graph.catalogue.tma_nodes import TMA_TRACKER
from sonar_tracking.graph.catalogue.topics import BEARING_TRACKS, FREQUENCY_LINES
from sonar_tracking.records.datum import Datum, datum_if_told
from sonar_tracking.simulation.scenarios.scenario_mapping import checked_epoch


def import_wav_file(
    file: Path,
    geometry: Path,
    frequency: float | None,
    bandwidth: float | None,
    output: Path,
    truth: Sequence[Path] | None = None,
    parameters: Path | None = None,
    time: GivenTime = NOT_GIVEN,
    datum: Datum | None = None,
) -> str:
    """Import an audio file as snapshots and return what was done, in words.

    Parameters
    ----------
    file, geometry, frequency, bandwidth, output, truth, time, datum
        See :func:`sonar_tracking.bags.importers.import_wav.import_wav`.
    parameters : Path, optional
        YAML file of node, parameter, value: stored in the bag for its replay.

    Raises
    ------
    ConfigurationError
        If anything given cannot be used; no bag is left then.
    """
    if frequency is None:
        raise ConfigurationError("Give --frequency, the centre of the band snapshots are made of.")
    given = _given(parameters)
    settings = resolved_settings(given, (SUBSPACE_ESTIMATOR, BEARING_TRACKER), str(parameters))
    summary = import_wav(file, geometry, frequency, bandwidth, output, truth, settings, time, datum)
    return _with_next_command(summary.text(), output)


def import_audio_samples(
    file: Path,
    geometry: Path,
    frequency: float | None,
    bandwidth: float | None,
    output: Path,
    own_ship: Sequence[Path] | None = None,
    truth: Sequence[Path] | None = None,
    parameters: Path | None = None,
    time: GivenTime = NOT_GIVEN,
    datum: Datum | None = None,
) -> str:
    """Import audio files as element time series and return what was done, in words.

    Positions are looked for if own ship's are given, or the parameters name ``tma_tracker``.

    Parameters
    ----------
    file, geometry, output, own_ship, truth, time, datum
        See :func:`sonar_tracking.bags.importers.import_samples.import_samples`.
    frequency, bandwidth : float, optional
        Of the band bearings are made of, Hz, if the parameters do not say so.
    parameters : Path, optional
        YAML file of node, parameter, value: stored in the bag for its replay.

    Raises
    ------
    ConfigurationError
        If anything given cannot be used; no bag is left then.
    """
    given = _given(parameters)
    band = {"center_frequency": frequency, "bandwidth": bandwidth}
    demodulator = given.setdefault(BAND_DEMODULATOR.name, {})
    demodulator |= {name: value for name, value in band.items() if value is not None}
    if "center_frequency" not in demodulator:
        raise ConfigurationError(
            "Say which frequency bearings are to be made of: give --frequency, or "
            "'band_demodulator: {center_frequency: ...}' in --parameters."
        )
    where = "import samples" if parameters is None else str(parameters)
    suggested = suggested_estimator(geometry, demodulator, f"{where}: {BAND_DEMODULATOR.name}")
    given[SUBSPACE_ESTIMATOR.name] = suggested | given.get(SUBSPACE_ESTIMATOR.name, {})
    nodes = [BAND_DEMODULATOR, SUBSPACE_ESTIMATOR, BEARING_TRACKER, LINE_TRACKER]
    if own_ship is not None or TMA_TRACKER.name in given:
        nodes.append(TMA_TRACKER)
        topics = {"bearing_topics": (BEARING_TRACKS.name,), "line_topics": (FREQUENCY_LINES.name,)}
        given[TMA_TRACKER.name] = topics | given.get(TMA_TRACKER.name, {})
    settings = resolved_settings(given, tuple(nodes), where)
    with progress_bar("importing") as progress:
        done = import_samples(
            file, geometry, output, settings, own_ship, truth, time, progress, datum
        )
    return _with_next_command(done, output)


def import_contacts_file(
    file: Path,
    output: Path,
    sensor: Mapping[str, Any],
    own_ship: Sequence[Path] | None = None,
    truth: Sequence[Path] | None = None,
    parameters: Path | None = None,
    datum: Datum | None = None,
) -> str:
    """Import recorded contacts and return what was done, in words.

    Parameters
    ----------
    file, output, own_ship, truth, datum
        See :func:`sonar_tracking.bags.importers.import_contacts.import_contacts`.
    sensor : mapping
        Fields of ContactSensor by name; ``epoch`` as a person writes it.
    parameters : Path, optional
        YAML file of node, parameter, value: stored in the bag for its replay.

    Raises
    ------
    ConfigurationError
        If anything given cannot be used; no bag is left then.
    """
    given = _given(parameters)
    settings = resolved_settings(given, (HPDA_TRACKER,), str(parameters))
    values = {**sensor, "epoch": checked_epoch(sensor["epoch"], "")}
    described = from_mapping(ContactSensor, values, "import contacts")
    done = import_contacts(file, output, described, own_ship, truth, settings, datum)
    return _with_next_command(done, output)


def import_bearings_file(
    file: Path,
    output: Path,
    sensor: Mapping[str, Any],
    sources: BearingSources,
    parameters: Path | None = None,
) -> str:
    """Import recorded bearings and return what was done, in words.

    The replay starts ``tma_tracker``, and ``track_fusion`` if the parameters name it.

    Parameters
    ----------
    file, output, sources
        See :func:`sonar_tracking.bags.importers.import_bearings.import_bearings`.
    sensor : mapping
        Fields of BearingSensor by name; ``epoch`` as a person writes it.
    parameters : Path, optional
        YAML file of node, parameter, value: stored in the bag for its replay.

    Raises
    ------
    ConfigurationError
        If anything given cannot be used; no bag is left then.
    """
    given = _given(parameters)
    where = "import bearings" if parameters is None else str(parameters)

    def settings(topics: list[tuple[str, str]]) -> Mapping[str, Mapping[str, Any]]:
        named = {
            "bearing_topics": tuple(bearings[1:] for bearings, _ in topics),
            "line_topics": tuple(lines[1:] for _, lines in topics if lines),
        }
        given[TMA_TRACKER.name] = named | given.get(TMA_TRACKER.name, {})
        fused = (TRACK_FUSION,) if TRACK_FUSION.name in given else ()
        return resolved_settings(given, (TMA_TRACKER, *fused), where)

    values = {**sensor, "epoch": checked_epoch(sensor["epoch"], "")}
    described = from_mapping(BearingSensor, values, "import bearings")
    done = import_bearings(file, output, described, sources, settings)
    return _with_next_command(done, output)


def import_nmea_logs(files: Sequence[Path], output: Path, datum: Datum | None, epoch: str) -> str:
    """Import logs of NMEA 0183 and return what was done, in words.

    Parameters
    ----------
    files, output, datum
        See :func:`sonar_tracking.bags.importers.import_nmea.import_nmea`.
    epoch : str
        As a person writes it.

    Raises
    ------
    ConfigurationError
        If anything given cannot be used; no bag is left then.
    """
    done = import_nmea(files, output, datum, checked_epoch(epoch, ""))
    return (
        f"{done}\nshow it with: sonar-tracking show {output}; beside the data of a sensor give "
        "the logs to its import, as --own-ship and --truth."
    )


def given_datum(text: str) -> Datum | None:
    """Return the datum as typed; None = not typed.

    Raises
    ------
    ConfigurationError
        If it is none.
    """
    return datum_if_told(text)


def given_time(epoch: str | None, time_pattern: str | None) -> GivenTime:
    """Return what a person says of the time of a recording.

    Raises
    ------
    ConfigurationError
        If the epoch is none.
    """
    text = int(epoch) if epoch is not None and epoch.isdecimal() else epoch
    return GivenTime(None if text is None else checked_epoch(text, "--"), time_pattern)


@contextmanager
def progress_bar(what: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on a terminal; yields what is called with the share that is done, 0 to 1."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    hidden = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as progress:
        task = progress.add_task(what, total=1.0)
        yield lambda share: progress.update(task, completed=share)


def _given(parameters: Path | None) -> dict[str, dict[str, Any]]:
    """Return the settings in the file, none without one."""
    return read_settings(parameters) if parameters is not None else {}


def _with_next_command(done: str, output: Path) -> str:
    replay = f"sonar-tracking replay {output}"
    return f"{done}\nreplay it with: {replay}\nor, for pictures of the tracks: {replay} --plots DIR"
