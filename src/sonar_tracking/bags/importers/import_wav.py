"""A multichannel audio file becomes a bag of narrowband snapshots that can be replayed.

The snapshots are made by demodulation, low-pass filtering and decimation; see
:mod:`sonar_tracking.passive.lines.demodulation` for why. Their stamps are those of the samples the
filter is centred on: ``epoch + sample / sample_rate``.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.audio.recording import Recording, Stretch
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.importers.array_geometry_file import RecordedArray, read_array_geometry
from sonar_tracking.bags.importers.array_plausibility import check_bearings
from sonar_tracking.bags.importers.audio_recording import (
    NOT_GIVEN,
    TRUTH_TOPIC,
    GivenTime,
    Message,
    opened_recording,
    truth_messages,
    write_messages,
)
from sonar_tracking.bags.importers.bearing_truth_file import (
    SurveyedBearings,
    holds_true_bearings,
    read_surveyed_bearings,
)
from sonar_tracking.bags.importers.recorded_messages import snapshots_cdr
from sonar_tracking.bags.positions.given_files import Files, files_text
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.storage.bag_records import BEARING_TRACKS_TYPE, SNAPSHOTS_TYPE
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.passive.lines.demodulation import Band, Demodulator, design_band
from sonar_tracking.passive.subspaces.block_checks import MAXIMUM_RELATIVE_BANDWIDTH
from sonar_tracking.records.arrays import ComplexArray
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.time import END_OF_DATA, seconds

SNAPSHOTS_TOPIC = "/array/snapshots"

BLOCK_SNAPSHOTS = 20
"""Snapshots in one message."""

DEFAULT_RELATIVE_BANDWIDTH = 0.05
"""Bandwidth * aperture / sound_speed where no bandwidth is given: half of what is allowed."""

DEFAULT_NODE_PARAMETERS: Mapping[str, Mapping[str, Any]] = {
    "subspace_estimator": {},
    "bearing_tracker": {},
}
"""Nodes a replay starts where nothing else is asked for, with their default parameters."""

_SAMPLES_AT_ONCE = 1 << 16


@dataclass(frozen=True)
class ImportSummary:
    """What was imported.

    Attributes
    ----------
    output : Path
        The bag.
    n_channels, n_elements : int
        Channels of the file and elements of the array.
    sample_rate, snapshot_rate : float
        Hz.
    bandwidth : float
        Hz.
    n_snapshots, n_blocks : int
        Written to the bag.
    dropped : tuple of str
        A sentence for each thing that is assumed, contradictory or unusual, and for each block
        that was left out because of samples that are not numbers.
    seconds : float
        Length of the file, s.
    plane_wave_range : float
        Range beyond which the plane waves hold that bearings are made of, m.
    """

    output: Path
    n_channels: int
    n_elements: int
    sample_rate: float
    snapshot_rate: float
    bandwidth: float
    n_snapshots: int
    n_blocks: int
    dropped: tuple[str, ...]
    seconds: float
    plane_wave_range: float

    def text(self) -> str:
        """Return the summary in words."""
        lines = [
            f"{self.output}: {self.n_snapshots} snapshots of {self.n_elements} elements in "
            f"{self.n_blocks} blocks, {self.snapshot_rate:.1f} a second, bandwidth "
            f"{self.bandwidth:g} Hz, from {self.seconds:.1f} s of {self.n_channels} channels at "
            f"{self.sample_rate:g} Hz.",
            f"Bearings are made of plane waves: of sources beyond {self.plane_wave_range:.3g} m "
            "(2 aperture^2 / wavelength).",
            *self.dropped,
        ]
        return "\n".join(lines)


@dataclass(frozen=True)
class _Block:
    stamp: int
    data: ComplexArray


def import_wav(
    file: Path | str,
    geometry: Path | str,
    frequency: float,
    bandwidth: float | None,
    output: Path | str,
    truth: Files | None = None,
    node_parameters: Mapping[str, Mapping[str, Any]] = DEFAULT_NODE_PARAMETERS,
    time: GivenTime = NOT_GIVEN,
    datum: Datum | None = None,
) -> ImportSummary:
    """Bring a multichannel audio file into a bag of narrowband snapshots.

    Parameters
    ----------
    file, geometry : Path or str
        Audio file, one channel an element, or a directory; and the array: see
        :func:`sonar_tracking.bags.importers.import_samples.import_samples`.
    frequency : float
        Centre of the band, Hz.
    bandwidth : float, optional
        Two-sided, Hz; default: half of what the narrowband model allows.
    output : Path or str
        The new bag.
    truth : Path, str, or sequence of one, optional
        Table of true bearings; see :mod:`sonar_tracking.bags.importers.bearing_truth_file`.
    node_parameters : mapping of mapping
        Node, parameter, value: what a replay of the bag starts.
    time : GivenTime
        What is said of its time; default: what the geometry file, the names or the files say.
    datum : Datum, optional
        Of ``map``.

    Raises
    ------
    ConfigurationError
        If file, geometry, band or truth cannot be used; no bag is left then.
    """
    array = read_array_geometry(geometry)
    wav, array = opened_recording(file, array, time)
    columns = array.columns(wav.n_channels, str(wav.path))
    dropped = [*wav.notes, *check_bearings(array, frequency, str(geometry))]
    band = _checked_band(array, wav, frequency, bandwidth)
    surveyed = _surveyed_bearings(truth, array, dropped)
    known = len(dropped)
    blocks = _finite_blocks(wav, columns, band, dropped)
    first = next(blocks, None)
    if first is None:
        raise ConfigurationError(dropped[-1] if len(dropped) > known else _too_short(wav, band))
    true = {TRUTH_TOPIC: BEARING_TRACKS_TYPE} if surveyed else {}
    information = _information(wav, array, band, node_parameters, true, datum)
    messages = heapq.merge(
        _snapshot_messages(first, blocks, wav.sample_rate, array, band),
        truth_messages(surveyed, array),
    )
    path, counts, n_snapshots = write_messages(
        Path(output), information, {SNAPSHOTS_TOPIC: SNAPSHOTS_TYPE}, true, messages
    )
    written = path, counts[SNAPSHOTS_TOPIC], n_snapshots
    return _summary(wav, array, len(columns), band, written, dropped)


def _surveyed_bearings(
    truth: Files | None, array: RecordedArray, notes: list[str]
) -> list[SurveyedBearings]:
    if truth is None:
        return []
    if not holds_true_bearings(truth):
        raise ConfigurationError(
            f"{files_text(truth)} is no table with time_s, target and arrival_angle_deg; "
            "positions and AIS go with the time series of the elements: use import samples."
        )
    surveyed, told = read_surveyed_bearings(truth, array.epoch)
    notes.extend(told)
    return surveyed


def _summary(
    wav: Recording,
    array: RecordedArray,
    n_elements: int,
    band: Band,
    written: tuple[Path, int, int],
    dropped: list[str],
) -> ImportSummary:
    output, n_blocks, n_snapshots = written
    return ImportSummary(
        output=output,
        n_channels=wav.n_channels,
        n_elements=n_elements,
        sample_rate=wav.sample_rate,
        snapshot_rate=wav.sample_rate / band.decimation,
        bandwidth=band.bandwidth,
        n_snapshots=n_snapshots,
        n_blocks=n_blocks,
        dropped=tuple(dropped),
        seconds=wav.n_samples / wav.sample_rate,
        plane_wave_range=2.0 * array.aperture**2 * band.frequency / array.sound_speed,
    )


def _too_short(wav: Recording, band: Band) -> str:
    return (
        f"{wav.path} lasts {wav.n_samples / wav.sample_rate:g} s, less than the "
        f"{len(band.taps) / wav.sample_rate:g} s one snapshot of {band.bandwidth:g} Hz needs; "
        "give a longer file or a larger bandwidth."
    )


def _checked_band(
    array: RecordedArray, wav: Recording, frequency: float, bandwidth: float | None
) -> Band:
    """Return the band, or raise a sentence if it is not narrow for the array."""
    limit = MAXIMUM_RELATIVE_BANDWIDTH * array.sound_speed / array.aperture
    if bandwidth is None:
        bandwidth = DEFAULT_RELATIVE_BANDWIDTH * array.sound_speed / array.aperture
    if bandwidth >= limit:
        raise ConfigurationError(
            f"A bandwidth of {bandwidth:g} Hz is not narrow for an array of {array.aperture:g} m: "
            f"bandwidth * aperture / sound_speed must be below {MAXIMUM_RELATIVE_BANDWIDTH:g}; "
            f"give less than {limit:.4g} Hz."
        )
    return design_band(wav.sample_rate, frequency, bandwidth)


def _finite_blocks(
    wav: Recording, columns: list[int], band: Band, dropped: list[str]
) -> Iterator[_Block]:
    """Yield blocks of snapshots; a block that is not finite is left out and reported."""
    for run in _runs(wav):
        for block in _blocks(run, wav.sample_rate, columns, band):
            bad = ~np.isfinite(block.data).all(axis=0)
            if not bad.any():
                yield block
                continue
            channels = ", ".join(str(columns[element] + 1) for element in np.flatnonzero(bad))
            dropped.append(
                f"{wav.path} has samples that are not numbers on channel {channels} near "
                f"{seconds(block.stamp - wav.start):.3f} s; these snapshots were left out."
            )


def _runs(wav: Recording) -> list[list[Stretch]]:
    """Return the stretches that follow one another without a gap."""
    runs: list[list[Stretch]] = []
    for stretch in wav.stretches:
        if stretch.run_sample == 0:
            runs.append([])
        runs[-1].append(stretch)
    return runs


def _blocks(
    run: Sequence[Stretch], sample_rate: int, columns: list[int], band: Band
) -> Iterator[_Block]:
    demodulator = Demodulator(band, sample_rate)
    first_sample = demodulator.next_centre
    held = np.empty((0, len(columns)), np.complex128)
    for stretch in run:
        for start in range(0, stretch.n_samples, _SAMPLES_AT_ONCE):
            stop = min(start + _SAMPLES_AT_ONCE, stretch.n_samples)
            samples = stretch.samples(start, stop)[:, columns]
            held = np.concatenate([held, demodulator.update(samples)])
            while len(held) >= BLOCK_SNAPSHOTS:
                yield _Block(run[0].stamp(first_sample), held[:BLOCK_SNAPSHOTS])
                first_sample += BLOCK_SNAPSHOTS * band.decimation
                held = held[BLOCK_SNAPSHOTS:]
    if len(held):
        yield _Block(run[0].stamp(first_sample), held)


def _snapshot_messages(
    first: _Block,
    blocks: Iterator[_Block],
    sample_rate: int,
    array: RecordedArray,
    band: Band,
) -> Iterator[Message]:
    """Yield the messages, each with the stamp of the next as its watermark."""
    block: _Block | None = first
    while block is not None:
        following = next(blocks, None)
        next_stamp = following.stamp if following else END_OF_DATA
        data = snapshots_cdr(
            array=array,
            stamp=block.stamp,
            next_stamp=next_stamp,
            data=block.data,
            sample_period=band.decimation / sample_rate,
            frequency=band.frequency,
            bandwidth=band.bandwidth,
        )
        yield block.stamp, SNAPSHOTS_TOPIC, data, len(block.data)
        block = following


def _information(
    wav: Recording,
    array: RecordedArray,
    band: Band,
    node_parameters: Mapping[str, Mapping[str, Any]],
    true: Iterable[str],
    datum: Datum | None,
) -> RecordingInformation:
    scenario = {
        "name": wav.path.stem,
        "description": (
            f"imported from {wav.path.name}: {len(array.element_positions)} elements, "
            f"{band.frequency:g} Hz, bandwidth {band.bandwidth:g} Hz"
        ),
        **MapOrigin(datum).scenario(),
    }
    roles: dict[str, Any] = {SNAPSHOTS_TOPIC: "input", **dict.fromkeys(true, "truth")}
    return RecordingInformation(scenario, node_parameters, roles)
