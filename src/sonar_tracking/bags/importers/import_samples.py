"""Recorded audio becomes a bag of element time series: lines and bearings in one replay.

Nothing is taken out of the samples: the demodulator and the line tracker of the replay do that. A
block that holds values that are not numbers is left out and named. Samples tell where the array
was, from own ship's recorded positions and the mounting in the geometry file; without positions own
ship rests at the origin, its bow to the north.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Mapping
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.audio.recording import Recording
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.importers.array_geometry_file import RecordedArray, read_array_geometry
from sonar_tracking.bags.importers.array_plausibility import check_bearings
from sonar_tracking.bags.importers.audio_recording import (
    NOT_GIVEN,
    GivenTime,
    opened_recording,
    write_messages,
)
from sonar_tracking.bags.importers.recording_truth import RecordingTruth, read_recording_truth
from sonar_tracking.bags.importers.sample_blocks import (
    ODOMETRY_TOPIC,
    SAMPLES_TOPIC,
    SampleBlocks,
)
from sonar_tracking.bags.positions.given_files import Files
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLogs
from sonar_tracking.bags.positions.position_files import read_own_ship
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.bags.storage.bag_records import SAMPLES_TYPE
from sonar_tracking.configuration import from_mapping
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.passive.lines.band_demodulator_configuration import (
    BandDemodulatorConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_stage import chosen_bandwidth
from sonar_tracking.records.datum import Datum

LONGEST_COVARIANCE = 4.0
"""s, if that is not fewer snapshots than can be told apart from noise."""

FEWEST_SNAPSHOTS = 24
MOST_SNAPSHOTS = 100
"""Of a covariance that is suggested; at least two for each element."""


def suggested_estimator(
    geometry: Path | str, demodulator: Mapping[str, Any], where: str
) -> dict[str, Any]:
    """Return parameters of the subspace estimator that suit the snapshots of a narrow band.

    A covariance of about a hundred snapshots, but of no more than four seconds if that leaves
    enough of them, around the sample time: sources and own ship move meanwhile.

    Parameters
    ----------
    geometry : Path or str
        YAML file of the array.
    demodulator : mapping
        Parameters of the band demodulator that are given.
    where : str
        Where they come from, named in errors.

    Raises
    ------
    ConfigurationError
        If one of them cannot be used.
    """
    array = read_array_geometry(geometry)
    configuration = from_mapping(BandDemodulatorConfiguration, _band(demodulator), where)
    bandwidth = chosen_bandwidth(configuration, array.element_positions, array.sound_speed)
    fewest = max(FEWEST_SNAPSHOTS, 2 * len(array.element_positions))
    count = max(fewest, min(round(LONGEST_COVARIANCE * bandwidth), MOST_SNAPSHOTS))
    return {
        "covariance_snapshots": count,
        "covariance_alignment": "centred",
        "period": max(round(0.5 * count / bandwidth, 2), 0.05),
    }


def import_samples(
    file: Path | str,
    geometry: Path | str,
    output: Path | str,
    node_parameters: Mapping[str, Mapping[str, Any]],
    own_ship: Files | None = None,
    truth: Files | None = None,
    time: GivenTime = NOT_GIVEN,
    progress: Callable[[float], None] | None = None,
    datum: Datum | None = None,
) -> str:
    """Bring recorded audio into a bag of element time series; say what was done.

    Parameters
    ----------
    file : Path or str
        Audio file, one channel an element; or a directory of them, consecutive, or one a
        hydrophone. See :mod:`sonar_tracking.bags.audio.recorded_files`.
    geometry : Path or str
        YAML file; see
        :func:`sonar_tracking.bags.importers.array_geometry_file.read_array_geometry`.
    output : Path or str
        The new bag.
    node_parameters : mapping of mapping
        Node, parameter, value: what a replay of the bag starts.
    own_ship, truth : Path, str, or sequence of them, optional
        See :mod:`sonar_tracking.bags.positions.position_files`, and
        :mod:`sonar_tracking.bags.importers.recording_truth`.
    time : GivenTime
        What is said of its time; default: what the geometry file, the names or the files say.
    progress : callable, optional
        Called with the share that is done, 0 to 1.
    datum : Datum, optional
        Of ``map``; default: own ship's first place, if its file tells places.

    Raises
    ------
    ConfigurationError
        If file, geometry, band, own ship or truth cannot be used; no bag is left then.
    """
    recording, array = opened_recording(file, read_array_geometry(geometry), time)
    columns = array.columns(recording.n_channels, str(recording.path))
    notes = list(recording.notes)
    origin, logs = MapOrigin(datum), NmeaLogs()
    surveyed = _surveyed_own_ship(own_ship, array, origin, logs, notes)
    demodulator = _band(node_parameters.get("band_demodulator", {}))
    configuration = from_mapping(BandDemodulatorConfiguration, demodulator, str(recording.path))
    notes += check_bearings(array, configuration.center_frequency, str(geometry))
    blocks = SampleBlocks(recording, array, columns, surveyed, progress)
    notes += blocks.own_ship_notes
    band = blocks.band(configuration)
    true = read_recording_truth(truth, array, blocks.end, surveyed, notes, origin, logs)
    information = _information(recording, array, node_parameters, true.topics, origin)
    counted = _write(Path(output), recording, array, blocks, information, true)
    summary = (
        f"{output}: {counted} at {recording.sample_rate} Hz. Bearings are made of the "
        f"{band.bandwidth:.3g} Hz around {band.frequency:g} Hz, lines looked for on each."
    )
    return "\n".join([summary, *dict.fromkeys([*notes, *origin.notes]), *blocks.left_out()])


def _write(
    output: Path,
    recording: Recording,
    array: RecordedArray,
    blocks: SampleBlocks,
    information: RecordingInformation,
    true: RecordingTruth,
) -> str:
    """Write the bag and return how much is in it, in words."""
    n_elements = len(array.element_positions)
    samples = blocks.samples()
    first = next(samples)  # where none is of use, no bag is begun
    _, counts, n_samples = write_messages(
        output,
        information,
        {SAMPLES_TOPIC: SAMPLES_TYPE, ODOMETRY_TOPIC: ODOMETRY_TYPE},
        true.topics,
        heapq.merge(
            blocks.odometry(),
            true.messages(),
            chain([first], samples),
            key=lambda message: message[0],
        ),
    )
    return (
        f"{n_samples} samples of {n_elements} elements in {counts[SAMPLES_TOPIC]} blocks, "
        f"{n_samples / recording.sample_rate:.1f} s"
    )


def _information(
    recording: Recording,
    array: RecordedArray,
    node_parameters: Mapping[str, Mapping[str, Any]],
    true: Iterable[str],
    origin: MapOrigin,
) -> RecordingInformation:
    roles: dict[str, Any] = {SAMPLES_TOPIC: "input", ODOMETRY_TOPIC: "input"}
    roles |= dict.fromkeys(true, "truth")
    name, rate = recording.path.name, recording.sample_rate
    n_elements = len(array.element_positions)
    description = f"imported from {name}: {n_elements} elements, {rate} Hz"
    scenario = {"name": recording.path.stem, "description": description, **origin.scenario()}
    return RecordingInformation(scenario, node_parameters, roles)


def _band(given: Mapping[str, Any]) -> dict[str, Any]:
    return {name: given[name] for name in ("center_frequency", "bandwidth") if name in given}


def _surveyed_own_ship(
    given: Files | None,
    array: RecordedArray,
    origin: MapOrigin,
    logs: NmeaLogs,
    notes: list[str],
) -> SurveyedPositions:
    if given is not None:
        surveyed, bad = read_own_ship(given, array.epoch, origin, logs)
        notes.extend(bad)
        return surveyed
    notes.append("No --own-ship: it rests at the origin, its bow to the north.")
    return SurveyedPositions(np.array([array.epoch]), np.zeros((1, 2)), np.array([0.5 * np.pi]))
