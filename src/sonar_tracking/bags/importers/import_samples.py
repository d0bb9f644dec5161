"""A multichannel WAV file becomes a bag of element time series: lines and bearings in one replay.

Nothing is taken out of the samples: the demodulator and the line tracker of the replay do that. A
block that holds values that are not numbers is left out and named. Samples tell where the array
was, from own ship's recorded positions and the mounting in the geometry file; without positions own
ship rests at the origin, its bow to the north.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.importers.array_geometry_file import RecordedArray, read_array_geometry
from sonar_tracking.bags.importers.bearing_truth_file import read_surveyed_bearings
from sonar_tracking.bags.importers.contact_file import SurveyedPositions, read_own_ship
from sonar_tracking.bags.importers.contact_messages import odometry_cdr
from sonar_tracking.bags.importers.own_ship_track import checked_coverage, own_ship_at
from sonar_tracking.bags.importers.recorded_messages import samples_cdr
from sonar_tracking.bags.importers.wav_file import WavFile, open_wav
from sonar_tracking.bags.importers.wav_recording import (
    TRUTH_TOPIC,
    Message,
    missing_end,
    sample_stamp,
    truth_messages,
    write_messages,
)
from sonar_tracking.bags.storage.bag_records import ODOMETRY_TYPE, SAMPLES_TYPE
from sonar_tracking.bags.storage.recording_information import RecordingInformation
from sonar_tracking.configuration import from_mapping
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.motion import lever_arm, swing_velocity
from sonar_tracking.passive.lines.band_demodulator_configuration import (
    BandDemodulatorConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_stage import (
    chosen_bandwidth,
    demodulated_band,
)
from sonar_tracking.passive.lines.demodulation import Band
from sonar_tracking.passive.lines.sample_frames import check_samples_block
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA

SAMPLES_TOPIC = "/array/samples"
ODOMETRY_TOPIC = "/own_ship/odometry"

BLOCK_SECONDS = 0.5
LARGEST_BLOCK = 1 << 18
"""Values in one message at most."""

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
    own_ship: Path | str | None = None,
    truth: Path | str | None = None,
) -> str:
    """Bring a multichannel WAV file into a bag of element time series; say what was done.

    Parameters
    ----------
    file : Path or str
        WAV file, one channel an element.
    geometry : Path or str
        YAML file; see
        :func:`sonar_tracking.bags.importers.array_geometry_file.read_array_geometry`.
    output : Path or str
        The new bag.
    node_parameters : mapping of mapping
        Node, parameter, value: what a replay of the bag starts.
    own_ship : Path or str, optional
        CSV or npz of own ship's positions; see :mod:`sonar_tracking.bags.importers.contact_file`.
    truth : Path or str, optional
        CSV file of true bearings; see :mod:`sonar_tracking.bags.importers.bearing_truth_file`.

    Raises
    ------
    ConfigurationError
        If file, geometry, band, own ship or truth cannot be used; no bag is left then.
    """
    array = read_array_geometry(geometry)
    wav = open_wav(file)
    columns = array.columns(wav.n_channels, str(wav.path))
    notes = missing_end(wav)
    surveyed = _surveyed_own_ship(own_ship, array, notes)
    blocks = _Blocks(wav, array, columns, surveyed)
    demodulator = _band(node_parameters.get("band_demodulator", {}))
    band = blocks.band(from_mapping(BandDemodulatorConfiguration, demodulator, str(wav.path)))
    notes.extend(blocks.own_ship_notes)
    blocks.leave_out(notes)
    bearings = read_surveyed_bearings(truth) if truth is not None else []
    path, counts, n_samples = write_messages(
        Path(output),
        _information(wav, len(columns), node_parameters, bool(bearings)),
        {SAMPLES_TOPIC: SAMPLES_TYPE, ODOMETRY_TOPIC: ODOMETRY_TYPE},
        heapq.merge(
            blocks.odometry(),
            truth_messages(bearings, array),
            blocks.samples(),
            key=lambda message: message[0],
        ),
    )
    summary = (
        f"{path}: {n_samples} samples of {len(columns)} elements in {counts[SAMPLES_TOPIC]} "
        f"blocks, {n_samples / wav.sample_rate:.1f} s at {wav.sample_rate} Hz. Bearings are made "
        f"of the {band.bandwidth:.3g} Hz around {band.frequency:g} Hz, lines looked for on each."
    )
    return "\n".join([summary, *notes])


def _information(
    wav: WavFile,
    n_elements: int,
    node_parameters: Mapping[str, Mapping[str, Any]],
    with_truth: bool,
) -> RecordingInformation:
    roles: dict[str, Any] = {SAMPLES_TOPIC: "input", ODOMETRY_TOPIC: "input"}
    if with_truth:
        roles[TRUTH_TOPIC] = "truth"
    description = f"imported from {wav.path.name}: {n_elements} elements, {wav.sample_rate} Hz"
    scenario = {"name": wav.path.stem, "description": description}
    return RecordingInformation(scenario, node_parameters, roles)


def _band(given: Mapping[str, Any]) -> dict[str, Any]:
    return {name: given[name] for name in ("center_frequency", "bandwidth") if name in given}


def _surveyed_own_ship(
    path: Path | str | None, array: RecordedArray, notes: list[str]
) -> SurveyedPositions:
    if path is not None:
        surveyed, bad = read_own_ship(path, array.epoch)
        notes.extend(bad)
        return surveyed
    notes.append("No --own-ship: it rests at the origin, its bow to the north.")
    return SurveyedPositions(np.array([array.epoch]), np.zeros((1, 2)), np.array([0.5 * np.pi]))


class _Blocks:
    """The file cut into blocks, with own ship at the begin of each and at the end of the last."""

    def __init__(
        self,
        wav: WavFile,
        array: RecordedArray,
        columns: list[int],
        surveyed: SurveyedPositions,
    ) -> None:
        self._wav, self._array, self._columns = wav, array, columns
        size = min(round(BLOCK_SECONDS * wav.sample_rate), LARGEST_BLOCK // wav.n_channels)
        self._edges = [*range(0, wav.n_samples, max(size, 1)), wav.n_samples]
        stamps = np.array([sample_stamp(array, wav, edge) for edge in self._edges])
        self.own_ship_notes = checked_coverage(surveyed, stamps)
        self._motion = own_ship_at(surveyed, stamps)
        self._states = [self._motion.state(index) for index in range(len(stamps))]
        self._kept = list(range(len(self._edges) - 1))

    def band(self, configuration: BandDemodulatorConfiguration) -> Band:
        """Return the band bearings are made of, or say why samples or band are of no use."""
        n_samples, rate = self._wav.n_samples, self._wav.sample_rate
        silence = self._record(0, np.zeros((1, len(self._columns))), END_OF_DATA)
        try:
            check_samples_block(silence)
            band = demodulated_band(configuration, silence)
        except InputError as error:
            raise ConfigurationError(
                f"{self._wav.path} is of no use as samples: {error}"
            ) from error
        if n_samples < len(band.taps):
            raise ConfigurationError(
                f"{self._wav.path} lasts {n_samples / rate:g} s, less than the "
                f"{len(band.taps) / rate:g} s one snapshot of {band.bandwidth:.3g} Hz needs; give "
                "a longer file or a larger bandwidth."
            )
        return band

    def leave_out(self, notes: list[str]) -> None:
        """Leave out the blocks that hold values that are not numbers, and tell."""
        if not self._wav.is_float:
            return
        self._kept = []
        spans: list[tuple[str, float, float]] = []
        for index in range(len(self._edges) - 1):
            bad = ~np.isfinite(self._data(index)).all(axis=0)
            if not bad.any():
                self._kept.append(index)
                continue
            channels = ", ".join(str(self._columns[each] + 1) for each in np.flatnonzero(bad))
            first, last = (edge / self._wav.sample_rate for edge in self._edges[index : index + 2])
            if spans and spans[-1][0] == channels and spans[-1][2] == first:
                first = spans.pop()[1]
            spans.append((channels, first, last))
        notes.extend(
            f"{self._wav.path} has samples that are not numbers on channel {channels}; "
            f"{first:.3f} s to {last:.3f} s were left out."
            for channels, first, last in spans
        )
        if not self._kept:
            raise ConfigurationError(notes[-1])

    def samples(self) -> Iterator[Message]:
        """Yield the blocks, each with the stamp of the next as its watermark."""
        for place, index in enumerate(self._kept):
            last = place + 1 == len(self._kept)
            following = END_OF_DATA if last else self._states[self._kept[place + 1]].stamp
            block = self._record(index, self._data(index), following)
            yield block.stamp, SAMPLES_TOPIC, samples_cdr(block), len(block.data)

    def odometry(self) -> Iterator[Message]:
        """Yield own ship at both ends of each block."""
        for state in self._states:
            yield state.stamp, ODOMETRY_TOPIC, odometry_cdr(state), 0

    def _data(self, index: int) -> FloatArray:
        samples = self._wav.samples(self._edges[index], self._edges[index + 1])
        with np.errstate(over="ignore"):
            return samples[:, self._columns].astype(np.float32).astype(np.float64)

    def _record(self, index: int, data: FloatArray, next_stamp: int) -> ArraySamples:
        return ArraySamples(
            stamp=self._states[index].stamp,
            data=data,
            element_positions=self._array.element_positions,
            sample_rate=float(self._wav.sample_rate),
            sound_speed=self._array.sound_speed,
            next_stamp=next_stamp,
            sensor=self._sensor(index),
        )

    def _sensor(self, index: int) -> Sensor:
        """Return the array aboard own ship; its height is zero."""
        azimuth = float(self._motion.azimuth[index])
        arm = lever_arm(azimuth, *self._array.mounting)
        x, y = self._motion.position[index] + arm
        turn_rate = float(self._motion.turn_rate[index])
        vx, vy = self._motion.velocity[index] + swing_velocity(turn_rate, arm)
        half = 0.5 * (azimuth + self._array.mounting_yaw)
        return Sensor(
            sensor_id=self._array.sensor_id,
            position=(float(x), float(y), 0.0),
            orientation=(0.0, 0.0, float(np.sin(half)), float(np.cos(half))),
            velocity=(float(vx), float(vy), 0.0),
        )
