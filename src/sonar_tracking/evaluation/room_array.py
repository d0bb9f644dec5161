"""Study ``room-array``: the passive chain on a real array, against surveyed bearings.

Recordings made from measured responses (see :mod:`sonar_tracking.evaluation.room_responses`) of
one and of two sources at three frequencies are imported as WAV files and tracked with automatic
start. One set of parameters serves all of them; only the number of sources is told to the chain,
since reflections, 10 to 15 dB below the sources, are signals too and would be counted.
"""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.bags.bag_records import bearing_tracks_of, snapshots_of
from sonar_tracking.bags.import_wav import SNAPSHOTS_TOPIC, TRUTH_TOPIC, import_wav
from sonar_tracking.bags.reader import Bag, read_bag
from sonar_tracking.errors import Notice
from sonar_tracking.evaluation.batch_runner import Task
from sonar_tracking.evaluation.offline_chain import OfflineRun, stage_configuration
from sonar_tracking.evaluation.room_array_figures import draw_room_array
from sonar_tracking.evaluation.room_responses import (
    evaluation_time,
    read_room_responses,
    received_signal,
    write_recording,
)
from sonar_tracking.evaluation.set_distances import assign
from sonar_tracking.evaluation.study import StudyRow
from sonar_tracking.evaluation.study_definition import Column, StudyDefinition, TableLayout
from sonar_tracking.passive.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.records import NANOSECONDS, BearingTracks, TrackStatus
from sonar_tracking.passive.subspace_stage import SubspaceConfiguration, SubspaceStage

FloatArray = NDArray[np.float64]

ROOM_ARRAY = "room-array"
"""Name of the study, as typed on the command line."""

SOURCES = (4, 5, 8, 9)
CASES = tuple((source,) for source in SOURCES) + tuple(itertools.combinations(SOURCES, 2))
FREQUENCIES = (4500.0, 5000.0, 5500.0)
BANDWIDTH = 80.0

ESTIMATOR_PARAMETERS: dict[str, Any] = {
    "method": "covariance",
    "forgetting_factor": 0.95,
    "period": 0.5,
    "n_subspaces": 7,
    "update_snapshots": 2,
    "covariance_snapshots": 40,
}
TRACKER_PARAMETERS: dict[str, Any] = {
    "method": "ml_fusion",
    "start": "automatic",
    "process_noise_deg2": 1.0,
    # Reflections move the bearing by about a degree, which the noise alone would not tell.
    "measurement_variance_deg2": 1.0,
}

FOUND_DEG = 10.0
"""A source is found where a confirmed track is nearer than this to it."""
APART_DEG = 20.0
"""Pairs at least so far apart are what the array must resolve."""


@dataclass(frozen=True)
class RoomTask:
    """Recordings of all cases at one frequency, for one worker.

    Attributes
    ----------
    data_file : str
        The measured responses.
    frequency : float
        Hz.
    seed : numpy.random.SeedSequence
        Of signals and noise.
    cases : tuple of tuple of int
        Sources that are heard together.
    """

    data_file: str
    frequency: float
    seed: np.random.SeedSequence
    cases: tuple[tuple[int, ...], ...] = CASES


@dataclass(frozen=True)
class RoomResult:
    """Bearings of one recording, one row a sub-array, one column a source.

    Attributes
    ----------
    sources : tuple of int
        Sources that were heard.
    frequency : float
        Hz.
    truth, tracked : ndarray, shape (n_sub_arrays, n_sources)
        Surveyed and tracked arrival angles, rad; NaN = not found.
    """

    sources: tuple[int, ...]
    frequency: float
    truth: FloatArray
    tracked: FloatArray

    @property
    def errors_deg(self) -> FloatArray:
        """Tracked minus surveyed, deg, shape (n_sub_arrays, n_sources)."""
        return np.degrees(self.tracked - self.truth)

    @property
    def apart(self) -> NDArray[np.bool_]:
        """Sub-arrays that see the sources at least APART_DEG apart, shape (n_sub_arrays,)."""
        spread = self.truth.max(axis=1) - self.truth.min(axis=1)
        return spread >= np.radians(APART_DEG)


def room_array(data_file: Path | str) -> StudyDefinition:
    """Return the study on a file of measured responses.

    Parameters
    ----------
    data_file : Path or str
        See :func:`sonar_tracking.evaluation.room_responses.read_room_responses`.

    Raises
    ------
    ConfigurationError
        If the file cannot be read.
    """
    read_room_responses(data_file)
    return StudyDefinition(
        name=ROOM_ARRAY,
        description="the passive chain on a recorded array, against surveyed bearings",
        default_runs=1,
        tasks=partial(room_tasks, str(data_file)),
        rows=room_rows,
        layouts=LAYOUTS,
        draw=draw_room_array,
    )


def room_tasks(data_file: str, runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: one task a run and frequency."""
    seeds = np.random.SeedSequence(seed).spawn(runs * len(FREQUENCIES))
    return tuple(
        Task(track_recordings, RoomTask(data_file, FREQUENCIES[index % len(FREQUENCIES)], child))
        for index, child in enumerate(seeds)
    )


def track_recordings(task: RoomTask) -> tuple[RoomResult, ...]:
    """Make, import and track the recordings of one task."""
    room = read_room_responses(task.data_file)
    source_seeds = task.seed.spawn(len(room.source_ids) + 1)
    heard = sorted({source for case in task.cases for source in case})
    signals = {
        source: received_signal(
            room, source, task.frequency, np.random.default_rng(source_seeds[index])
        )
        for index, source in enumerate(room.source_ids)
        if source in heard
    }
    noise_seeds = source_seeds[-1].spawn(len(task.cases))
    results = []
    for case, noise_seed in zip(task.cases, noise_seeds, strict=True):
        with tempfile.TemporaryDirectory() as folder:
            wav, geometry, truth = write_recording(
                room,
                case,
                [signals[source] for source in case],
                BANDWIDTH,
                np.random.default_rng(noise_seed),
                Path(folder),
            )
            bag_path = Path(folder) / "bag"
            parameters = node_parameters(len(case))
            import_wav(wav, geometry, task.frequency, BANDWIDTH, bag_path, truth, parameters)
            run = track_bag(read_bag(bag_path))
        results.append(_compared(run, case, task.frequency, room.n_sub_arrays))
    return tuple(results)


def node_parameters(n_sources: int) -> dict[str, dict[str, Any]]:
    """Return the parameters of the nodes for a recording of some sources."""
    return {
        "subspace_estimator": {**ESTIMATOR_PARAMETERS, "source_count": n_sources},
        "bearing_tracker": dict(TRACKER_PARAMETERS),
    }


def track_bag(bag: Bag) -> OfflineRun:
    """Track the snapshots of a bag in this process, with the parameters stored in it.

    Parameters
    ----------
    bag : Bag
        With the topics of an imported recording.
    """
    parameters = bag.recording.node_parameters if bag.recording else {}
    estimator = SubspaceStage(
        stage_configuration(
            SubspaceConfiguration, parameters.get("subspace_estimator", {}), str(bag.path)
        )
    )
    tracker = BearingTrackerStage(
        stage_configuration(
            BearingTrackerConfiguration, parameters.get("bearing_tracker", {}), str(bag.path)
        )
    )
    tracks: list[BearingTracks] = []
    notices: list[Notice] = []
    for block in snapshots_of(bag, SNAPSHOTS_TOPIC):
        update = estimator.update(block)
        notices.extend(update.notices)
        for estimates in update.estimates:
            tracked = tracker.update(estimates)
            tracks.append(tracked.tracks)
            notices.extend(tracked.notices)
    truth = tuple(bearing_tracks_of(bag, TRUTH_TOPIC)) if TRUTH_TOPIC in bag.topics else ()
    return OfflineRun(truth, tuple(tracks), tuple(notices))


def _compared(
    run: OfflineRun, sources: tuple[int, ...], frequency: float, n_sub_arrays: int
) -> RoomResult:
    """Compare the tracks with the survey once at each sub-array."""
    epoch = run.truth[0].stamp
    truth_stamps = np.array([sample.stamp for sample in run.truth])
    track_stamps = np.array([sample.stamp for sample in run.tracks])
    shape = (n_sub_arrays, len(sources))
    truth, tracked = np.full(shape, np.nan), np.full(shape, np.nan)
    for sub_array in range(n_sub_arrays):
        instant = epoch + round(evaluation_time(sub_array) * NANOSECONDS)
        truth[sub_array] = run.truth[_last_at(truth_stamps, instant)].arrival_angle
        index = _last_at(track_stamps, instant)
        if index >= 0:
            tracks = run.tracks[index]
            angles = tracks.arrival_angle[tracks.status != TrackStatus.TENTATIVE]
            distances = np.abs(angles[None, :] - truth[sub_array][:, None])
            pairs = assign(np.degrees(distances), FOUND_DEG, 1.0)
            tracked[sub_array, pairs.truths] = angles[pairs.estimates]
    return RoomResult(sources, frequency, truth, tracked)


def _last_at(stamps: NDArray[np.int64], instant: int) -> int:
    return int(np.searchsorted(stamps, instant, side="right")) - 1


def room_rows(results: Sequence[Sequence[RoomResult]]) -> tuple[StudyRow, ...]:
    """Return one row a recording and one for all pairs that are far enough apart."""
    recordings = [result for task in results for result in task]
    rows = [_recording_row(result) for result in recordings]
    pairs = [r.errors_deg[r.apart] for r in recordings if len(r.sources) == 2]
    metrics = _figures(np.concatenate(pairs)) if pairs else {}
    condition = f"pairs {APART_DEG:g} deg apart or more"
    return (*rows, StudyRow("all pairs", condition, {f"pairs_{k}": v for k, v in metrics.items()}))


def _recording_row(result: RoomResult) -> StudyRow:
    errors = result.errors_deg
    metrics = _figures(errors)
    if len(result.sources) > 1 and result.apart.any():
        apart = _figures(errors[result.apart])
        metrics |= {f"apart_{name}": value for name, value in apart.items()}
    for sub_array, row in enumerate(errors):
        for source, error in zip(result.sources, row, strict=True):
            metrics[f"sub_array_{sub_array}_source_{source}_error_deg"] = float(error)
    numbers = " and ".join(str(source) for source in result.sources)
    return StudyRow(
        system=f"source{'s' if len(result.sources) > 1 else ''} {numbers}",
        condition=f"{result.frequency:g} Hz",
        metrics=metrics,
    )


def _figures(errors_deg: FloatArray) -> dict[str, float]:
    """Return the figures of errors of shape (n_sub_arrays, n_sources), deg; NaN = not found."""
    known = np.abs(errors_deg[np.isfinite(errors_deg)])
    return {
        "sub_arrays": float(len(errors_deg)),
        "found_percent": 100.0 * float(np.isfinite(errors_deg).all(axis=1).mean()),
        "median_error_deg": float(np.median(known)) if known.size else np.nan,
        "worst_error_deg": float(known.max()) if known.size else np.nan,
    }


def _columns(prefix: str) -> tuple[Column, ...]:
    return (
        Column(f"{prefix}sub_arrays", "sub-arrays", ".0f"),
        Column(f"{prefix}found_percent", "all found %", ".0f"),
        Column(f"{prefix}median_error_deg", "median error deg", ".2f"),
        Column(f"{prefix}worst_error_deg", "worst deg", ".1f"),
    )


LAYOUTS = (
    TableLayout(
        "Bearings at every position of the sub-array",
        _columns(""),
        f"Found: a confirmed track within {FOUND_DEG:g} deg of every source.",
    ),
    TableLayout(f"Only where the pair is {APART_DEG:g} deg apart or more", _columns("apart_"), ""),
    TableLayout("Together", _columns("pairs_"), ""),
)
