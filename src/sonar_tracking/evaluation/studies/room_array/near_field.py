"""Near sources of the recorded array: plane against spherical waves, given how many there are.

Sources 1 to 3 are a quarter of a metre from an array of 0.93 m: even for eight elements plane waves
hold only beyond 1.3 m. All 32 elements hear at once, so that bearing and range are found at every
position of the sub-array, and with the whole array, whose limit is 25 m, also of sources 4 to 9.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.evaluation.studies.room_array.near_field_rows import (
    PLANE,
    SPHERICAL,
    SPHERICAL_MUSIC,
    NearFieldResult,
)
from sonar_tracking.evaluation.studies.room_array.positions import onset_positions
from sonar_tracking.evaluation.studies.room_array.responses import (
    SIGNAL_TO_NOISE_DB,
    SOUND_SPEED,
    SUB_ARRAY_ELEMENTS,
    RoomResponses,
    child_seed,
    read_room_responses,
    source_noise,
)
from sonar_tracking.filtering.assignment import least_cost_pairs
from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.lines.demodulation import Demodulator, design_band
from sonar_tracking.passive.near_field.near_field_search import (
    NearFieldFix,
    near_field_grid,
    near_field_maximum_likelihood,
    near_field_music,
)
from sonar_tracking.passive.near_field.spherical_steering import rayleigh_distance
from sonar_tracking.records.arrays import ComplexArray, FloatArray

NEAR_SOURCES = (1, 2, 3)
NEAR_CASES = ((1,), (2,), (3,), (1, 2), (1, 3), (2, 3))
"""Heard by the sub-arrays and by the whole array."""
FAR_CASES = ((4,), (5,), (8,), (9,))
"""Heard by the whole array only."""

NEAREST = 0.15
"""Least range that is looked at, m."""
DURATION = 2.2
"""Of a recording, s."""


@dataclass(frozen=True)
class NearFieldTask:
    """Recordings of the near sources at one frequency, for one worker.

    Attributes
    ----------
    data_file : str
        The measured responses.
    frequency : float
        Hz.
    bandwidth : float
        Of the snapshots, Hz.
    seed : numpy.random.SeedSequence
        Of signals and noise.
    run : int
        Number of the run.
    cases : tuple of tuple of int
        Sources that are heard together.
    """

    data_file: str
    frequency: float
    bandwidth: float
    seed: np.random.SeedSequence
    run: int
    cases: tuple[tuple[int, ...], ...] = NEAR_CASES + FAR_CASES


def locate_near_sources(task: NearFieldTask) -> tuple[NearFieldResult, ...]:
    """Make and evaluate the recordings of one task."""
    room = read_room_responses(task.data_file)
    heard = {source for case in task.cases for source in case}
    by_onsets = replace(room, source_positions=onset_positions(room, heard))
    seed = task.seed
    signals = {
        source: whole_array_snapshots(
            room,
            source,
            (task.frequency, task.bandwidth),
            np.random.default_rng(child_seed(seed, 0, source)),
        )
        for source in heard
    }
    results = []
    for case in task.cases:
        data = np.sum([signals[source] for source in case], axis=0)
        generator = np.random.default_rng(child_seed(seed, 1, *case))
        parts = generator.normal(size=(2, *data.shape))
        amplitude = np.sqrt(0.5 * 10 ** (-SIGNAL_TO_NOISE_DB / 10))
        data = data + amplitude * (parts[0] + 1j * parts[1])
        sizes = [len(room.element_places)]
        if set(case) <= set(NEAR_SOURCES):
            sizes.insert(0, SUB_ARRAY_ELEMENTS)
        for n_elements in sizes:
            results.extend(_results(task, (room, by_onsets), case, data, n_elements))
    return tuple(results)


def whole_array_snapshots(
    room: RoomResponses, source: int, band: tuple[float, float], generator: np.random.Generator
) -> ComplexArray:
    """Return what all elements receive of one source, mean power 1.

    Parameters
    ----------
    room : RoomResponses
        Measured responses.
    source : int
        Number of the source.
    band : tuple of float
        Centre and width, Hz.
    generator : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    ndarray, shape (n_snapshots, n_elements), complex
        Linear amplitude.
    """
    from scipy.signal import oaconvolve  # takes longer to load than any study

    responses = room.responses[room.source_ids.index(source)]
    n_samples = round(DURATION * room.sample_rate) + responses.shape[1] - 1
    noise = source_noise(n_samples, band[0], room.sample_rate, generator)
    received = oaconvolve(noise[None, :], responses, "valid", axes=1).T
    demodulator = Demodulator(design_band(room.sample_rate, *band), room.sample_rate)
    snapshots = demodulator.update(received)
    return np.asarray(snapshots / np.sqrt(np.mean(np.abs(snapshots) ** 2)), dtype=np.complex128)


def _results(
    task: NearFieldTask,
    rooms: tuple[RoomResponses, RoomResponses],
    case: tuple[int, ...],
    data: ComplexArray,
    n_elements: int,
) -> list[NearFieldResult]:
    """Return what each method finds with all sub-arrays of one size."""
    number = wavenumber(task.frequency, SOUND_SPEED)
    places = rooms[0].element_places
    windows = [slice(k, k + n_elements) for k in range(len(places) - n_elements + 1)]
    surveyed, located = (
        np.array([[_from(room, source, places[w].mean()) for source in case] for w in windows])
        for room in rooms
    )
    found: dict[str, list[FloatArray]] = {PLANE: [], SPHERICAL: [], SPHERICAL_MUSIC: []}
    for window, reference in zip(windows, located, strict=True):
        positions = np.zeros((n_elements, 3))
        positions[:, 0] = places[window]
        part = data[:, window]
        covariance = part.T @ part.conj() / len(part)
        plane = near_field_grid(positions, number, None)
        spherical = near_field_grid(positions, number, NEAREST)
        fixes = {
            PLANE: near_field_maximum_likelihood(covariance, len(case), plane),
            SPHERICAL: near_field_maximum_likelihood(covariance, len(case), spherical),
            SPHERICAL_MUSIC: near_field_music(covariance, len(case), spherical),
        }
        for method, fix in fixes.items():
            found[method].append(_matched(reference, fix))
    rayleigh = rayleigh_distance(positions, number)
    return [
        NearFieldResult(
            method=method,
            run=task.run,
            sources=case,
            frequency=task.frequency,
            n_elements=n_elements,
            rayleigh=rayleigh,
            surveyed=surveyed,
            located=located,
            found=np.array(each),
        )
        for method, each in found.items()
    ]


def _from(room: RoomResponses, source: int, centre: float) -> tuple[float, float]:
    """Return angle and range of a source from a place along the array, rad and m."""
    distance, place = room.source_positions[room.source_ids.index(source)]
    ahead = place - centre
    return float(np.arctan2(ahead, distance)), float(np.hypot(ahead, distance))


def _matched(reference: FloatArray, fix: NearFieldFix) -> FloatArray:
    """Return the angles and ranges of a fix in the order of the sources, NaN = missing."""
    matched = np.full(reference.shape, np.nan)
    distances = np.abs(reference[:, :1] - fix.angles)
    rows, columns = least_cost_pairs(distances)
    matched[rows] = np.stack([fix.angles, fix.ranges], axis=-1)[columns]
    return matched
