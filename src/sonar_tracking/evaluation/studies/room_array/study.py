"""Study ``room-array``: the passive chain on a real array, against surveyed bearings.

Recordings made from measured responses (see
:mod:`sonar_tracking.evaluation.studies.room_array.responses`) of one and of two sources at three
frequencies are imported as WAV files and tracked with automatic start, one set of parameters for
all of them: by one filter a target, given how many sources there are, and by the default tracker
from nothing. Reflections are signals too and would be counted: to the latter the array is told to
have steering vectors as wrong as the reflections make them. Sources too near for plane waves are
located apart, with spherical ones.
"""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.importers.import_wav import SNAPSHOTS_TOPIC, TRUTH_TOPIC, import_wav
from sonar_tracking.bags.storage.bag_records import bearing_tracks_of, snapshots_of
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.errors import Notice
from sonar_tracking.evaluation.metrics.ospa_gospa import assign
from sonar_tracking.evaluation.monte_carlo.batch_runner import Task
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import StudyDefinition
from sonar_tracking.evaluation.offline.offline_bearing_chain import OfflineRun, stage_configuration
from sonar_tracking.evaluation.studies.room_array.figures import draw_room_array
from sonar_tracking.evaluation.studies.room_array.near_field import (
    NearFieldTask,
    locate_near_sources,
)
from sonar_tracking.evaluation.studies.room_array.near_field_rows import (
    NEAR_FIELD_LAYOUTS,
    NearFieldResult,
    near_field_rows,
)
from sonar_tracking.evaluation.studies.room_array.positions import onset_positions
from sonar_tracking.evaluation.studies.room_array.responses import (
    RoomResponses,
    check_sources,
    child_seed,
    end_of_dwell,
    read_room_responses,
    received_signal,
    write_recording,
)
from sonar_tracking.evaluation.studies.room_array.rows import (
    FOUND_DEG,
    FROM_NOTHING,
    RECORDING_LAYOUTS,
    TOLD,
    RoomResult,
    recording_rows,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.time import NANOSECONDS

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

NOTHING_ESTIMATOR_PARAMETERS: dict[str, Any] = {
    "method": "covariance",
    "period": 0.4,
    "n_subspaces": 1,
    "covariance_snapshots": 32,
    # Reflections later than a snapshot lasts bring 0.4 of the direct sound's amplitude on average,
    # 0.7 at some elements, as the measured responses tell.
    "steering_error": 0.6,
}
NOTHING_TRACKER_PARAMETERS: dict[str, Any] = {
    "method": "joint_map",
    "start": "automatic",
    # A sub-array moves on by 2 to 4 deg at once, every two seconds.
    "process_noise_deg2": 1.0,
    # In longer means weak reflections stand out of the noise: sources of their own.
    "covariances_counted": 1,
}

_CASE_GROUPS = tuple(
    tuple(case for case in CASES if (SOURCES[0] in case) == shared) for shared in (True, False)
)
"""Cases of one worker: those that hear the first source share its signal."""


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
    systems : tuple of str
        What the chain knows beforehand: TOLD and FROM_NOTHING.
    run : int
        Number of the run.
    """

    data_file: str
    frequency: float
    seed: np.random.SeedSequence
    cases: tuple[tuple[int, ...], ...] = CASES
    systems: tuple[str, ...] = (TOLD, FROM_NOTHING)
    run: int = 0


def room_array(data_file: Path | str) -> StudyDefinition:
    """Return the study on a file of measured responses.

    Parameters
    ----------
    data_file : Path or str
        See :func:`sonar_tracking.evaluation.studies.room_array.responses.read_room_responses`.

    Raises
    ------
    ConfigurationError
        If the file cannot be read, or lacks a source of the study.
    """
    check_sources(read_room_responses(data_file), data_file)
    return StudyDefinition(
        name=ROOM_ARRAY,
        description="the passive chain on a recorded array, against surveyed bearings",
        default_runs=1,
        tasks=partial(room_tasks, str(data_file)),
        rows=room_rows,
        layouts=(*RECORDING_LAYOUTS, *NEAR_FIELD_LAYOUTS),
        draw=draw_room_array,
    )


def room_tasks(data_file: str, runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: some cases of a run and frequency; the near sources."""
    seeds = np.random.SeedSequence(seed).spawn(runs * len(FREQUENCIES))
    tasks = []
    for index, child in enumerate(seeds):
        run, frequency = index // len(FREQUENCIES), FREQUENCIES[index % len(FREQUENCIES)]
        tasks += [
            Task(track_recordings, RoomTask(data_file, frequency, child, cases, run=run))
            for cases in _CASE_GROUPS
        ]
        near = NearFieldTask(data_file, frequency, BANDWIDTH, child_seed(child, 2), run)
        tasks.append(Task(locate_near_sources, near))
    return tuple(tasks)


def track_recordings(task: RoomTask) -> tuple[RoomResult, ...]:
    """Make, import and track the recordings of one task, with what each system knows."""
    room = read_room_responses(task.data_file)
    heard = sorted({source for case in task.cases for source in case})
    by_onsets = replace(room, source_positions=onset_positions(room, heard))
    signals = {
        source: received_signal(
            room, source, task.frequency, np.random.default_rng(child_seed(task.seed, 0, source))
        )
        for source in heard
    }
    results = []
    for case in task.cases:
        with tempfile.TemporaryDirectory() as folder:
            wav, geometry, truth = write_recording(
                room,
                case,
                [signals[source] for source in case],
                BANDWIDTH,
                np.random.default_rng(child_seed(task.seed, 1, *case)),
                Path(folder),
            )
            for system in task.systems:
                bag_path = Path(folder) / system.replace(" ", "_")
                parameters = node_parameters(len(case) if system == TOLD else 0)
                import_wav(wav, geometry, task.frequency, BANDWIDTH, bag_path, truth, parameters)
                run = track_bag(read_bag(bag_path))
                results.append(_compared(run, system, case, task, by_onsets))
    return tuple(results)


def node_parameters(n_sources: int) -> dict[str, dict[str, Any]]:
    """Return the parameters of the nodes for a recording of some sources, 0 = not given."""
    if n_sources == 0:
        return {
            "subspace_estimator": dict(NOTHING_ESTIMATOR_PARAMETERS),
            "bearing_tracker": dict(NOTHING_TRACKER_PARAMETERS),
        }
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
    run: OfflineRun,
    system: str,
    sources: tuple[int, ...],
    task: RoomTask,
    by_onsets: RoomResponses,
) -> RoomResult:
    """Compare the tracks with the survey once at each sub-array, at the end of its dwell."""
    epoch = run.truth[0].stamp
    truth_stamps = np.array([sample.stamp for sample in run.truth])
    track_stamps = np.array([sample.stamp for sample in run.tracks])
    n_sub_arrays = by_onsets.n_sub_arrays
    shape = (n_sub_arrays, len(sources))
    truth, tracked = np.full(shape, np.nan), np.full(shape, np.nan)
    extra: list[FloatArray] = []
    for sub_array in range(n_sub_arrays):
        # The last tracks before the sub-array moves on.
        instant = epoch + round(end_of_dwell(sub_array) * NANOSECONDS) - 1
        truth[sub_array] = run.truth[_last_at(truth_stamps, instant)].arrival_angle
        index, angles = _last_at(track_stamps, instant), np.empty(0)
        if index >= 0:
            tracks = run.tracks[index]
            angles = tracks.arrival_angle[tracks.status == TrackStatus.CONFIRMED]
        distances = np.abs(angles[None, :] - truth[sub_array][:, None])
        pairs = assign(np.degrees(distances), FOUND_DEG, 1.0)
        tracked[sub_array, pairs.truths] = angles[pairs.estimates]
        extra.append(np.delete(angles, pairs.estimates))
    located = [
        [by_onsets.arrival_angle(source, k) for source in sources] for k in range(n_sub_arrays)
    ]
    most = max(len(angles) for angles in extra)
    padded = [np.pad(angles, (0, most - len(angles)), constant_values=np.nan) for angles in extra]
    return RoomResult(
        system=system,
        run=task.run,
        sources=sources,
        frequency=task.frequency,
        truth=truth,
        located=np.array(located),
        tracked=tracked,
        extra=np.array(padded),
    )


def _last_at(stamps: IntArray, instant: int) -> int:
    return int(np.searchsorted(stamps, instant, side="right")) - 1


def room_rows(results: Sequence[Sequence[RoomResult | NearFieldResult]]) -> tuple[StudyRow, ...]:
    """Return the rows of the tracked recordings and those of the near sources."""
    flat = [result for task in results for result in task]
    return (
        *recording_rows([r for r in flat if isinstance(r, RoomResult)]),
        *near_field_rows([r for r in flat if isinstance(r, NearFieldResult)]),
    )
