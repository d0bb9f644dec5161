"""Kernels of lines, contacts and positions."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from sonar_tracking.active.baselines.regions_of_interest import PolarContacts, find_regions
from sonar_tracking.active.contacts.contact_positions import PlacedContacts, position_covariance
from sonar_tracking.active.detection.amplitude_order_statistics import load_rank_probabilities
from sonar_tracking.active.detection.detection_levels import prior_weights
from sonar_tracking.active.detection.gate_association import GateModel, associate_by_rank
from sonar_tracking.active.tracks.contact_gating import SensorGeometry, predict_gates
from sonar_tracking.active.tracks.motion_modes import MotionModes
from sonar_tracking.active.tracks.pair_search import find_pairs
from sonar_tracking.active.tracks.track_management import start_candidates
from sonar_tracking.evaluation.bench.bench_data import SEED, SIZES, SOUND_SPEED, bench_positions
from sonar_tracking.evaluation.bench.kernel import Kernel, Prepared, Timed, Work
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.passive.lines.background_normalisation import (
    REPETITIONS,
    BackgroundNormaliser,
)
from sonar_tracking.passive.lines.beam_spectra import beam_powers
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import simulate_runs
from sonar_tracking.tma.estimators.range_bank import RangeBank

N_BINS = 2000
CONTACTS = (50, 500, 5000)
IN_GATE = (2, 8, 32)
TARGETS = (1, 6, 12, 24)
RANGE_DEVIATION, AZIMUTH_DEVIATION = 30.0, 0.01
MAXIMUM_RANGE = 10_000.0
SETTLED_FRAMES = 100

_COMPLEX, _REAL = 16.0, 8.0
"""Bytes of a number."""


def tracking_kernels() -> tuple[Kernel, ...]:
    """Return the kernels behind the bearings."""
    return (
        Kernel(f"one beam of {N_BINS} bins", "elements", SIZES, _beam),
        Kernel(f"background of {N_BINS} bins", "spectra", (1, 5, 25), _background),
        Kernel("contacts in the gates of as many tracks", "contacts", CONTACTS, _gating),
        Kernel("HPDA in one gate", "contacts in it", IN_GATE, _ranked),
        Kernel("regions of interest, three pings", "contacts", CONTACTS, _regions),
        Kernel("range bank, six lines, a frame", "targets", TARGETS, _range_bank),
    )


def _beam(n_elements: int) -> Prepared:
    generator = np.random.default_rng(SEED)
    parts = generator.standard_normal((2, N_BINS, n_elements))
    spectra = parts[0] + 1j * parts[1]
    frequencies = np.linspace(10.0, 1000.0, N_BINS)
    positions = bench_positions(n_elements)
    angles = np.array([0.3])
    entries = float(N_BINS * n_elements)
    # A phasor is the one before times a constant, then a multiplication with addition.
    work = Work(14.0 * entries, _COMPLEX * entries)
    call = partial(beam_powers, spectra, frequencies, positions, SOUND_SPEED, angles)
    return Prepared(Timed(call), work)


def _background(n_spectra: int) -> Prepared:
    power = np.random.default_rng(SEED).exponential(size=(n_spectra, N_BINS))
    normaliser = BackgroundNormaliser(np.linspace(10.0, 1000.0, N_BINS), 30, 1e-4)
    passes = REPETITIONS + 2
    work = Work(6.0 * passes * power.size, 2.0 * _REAL * passes * power.size)
    return Prepared(Timed(partial(normaliser.normalise, power)), work)


def _contacts(n_contacts: int, generator: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Return ranges and azimuths of uniform density in the plane, m and rad."""
    distance = MAXIMUM_RANGE * np.sqrt(generator.uniform(0.01, 1.0, n_contacts))
    return distance, generator.uniform(-np.pi, np.pi, n_contacts)


def _placed(distance: FloatArray, azimuth: FloatArray) -> PlacedContacts:
    direction = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    covariance = position_covariance(direction, distance, RANGE_DEVIATION, AZIMUTH_DEVIATION)
    delay = np.zeros(len(distance))
    return PlacedContacts(distance[:, None] * direction, covariance, distance, delay)


def _gating(n_contacts: int) -> Prepared:
    generator = np.random.default_rng(SEED)
    contacts = _placed(*_contacts(n_contacts, generator))
    before = _placed(*_contacts(n_contacts, generator))
    bank = start_candidates(
        before,
        existence=np.full(n_contacts, 0.01),
        stamp=0,
        first_id=0,
        modes=MotionModes(1, 0.0, initial_speed_deviation=1.0),
        mode_prior=np.ones(1),
        detection_weight=prior_weights(np.nan),
    )
    sensor = SensorGeometry(np.zeros(2), RANGE_DEVIATION, AZIMUTH_DEVIATION, 0.0)
    gates = predict_gates(bank, sensor)
    n_pairs = len(find_pairs(bank, gates, contacts).track)
    found = n_contacts * np.log2(n_contacts)
    # A sort, then the distance of each pair from two by two matrices.
    work = Work(2.0 * found + 40.0 * n_pairs, _REAL * (10.0 * n_contacts + 10.0 * n_pairs))
    return Prepared(Timed(lambda: find_pairs(bank, predict_gates(bank, sensor), contacts)), work)


def _ranked(n_contacts: int) -> Prepared:
    load_rank_probabilities()
    generator = np.random.default_rng(SEED)
    density = generator.uniform(1e-5, 1e-4, n_contacts)
    amplitudes = 1.0 + generator.exponential(size=n_contacts)
    model = GateModel(volume=1e5, clutter_density=1e-5 * n_contacts, detection_probability=0.9)
    work = Work(10.0 * n_contacts, 3.0 * _REAL * n_contacts)
    return Prepared(Timed(partial(associate_by_rank, density, amplitudes, model, 10.0)), work)


def _regions(n_contacts: int) -> Prepared:
    generator = np.random.default_rng(SEED)
    window = []
    for _ in range(3):
        distance, azimuth = _contacts(n_contacts, generator)
        window.append(PolarContacts(_placed(distance, azimuth).position, distance, azimuth))
    call: Callable[[], object] = partial(
        find_regions, window, RANGE_DEVIATION, AZIMUTH_DEVIATION, 4.0, 0.9
    )
    compared = 3.0 * n_contacts * np.log2(n_contacts)
    return Prepared(Timed(call), Work(8.0 * compared, 3.0 * 4.0 * _REAL * n_contacts))


def _range_bank(n_targets: int) -> Prepared:
    seeds = np.random.SeedSequence(SEED).spawn(n_targets)
    frames = list(simulate_runs(scenario("S1"), seeds).frames())[: SETTLED_FRAMES + 1]
    bank = RangeBank()
    for frame in frames[:-1]:
        bank.update(frame)
    state = bank.state
    if state is None:
        raise AssertionError("A bank that has taken a frame has a state.")
    *batch, n_hypotheses, n_states = state.bank.mean.shape
    filters = float(np.prod([*batch, n_hypotheses]))
    n_rows = 2 + frames[-1].n_lines

    def step() -> object:
        bank.state = state
        return bank.update(frames[-1])

    # One row after the other into the covariance, and a prediction.
    work = Work(
        filters * (4.0 * n_rows * n_states**2 + 8.0 * n_states**2),
        2.0 * _REAL * filters * (n_states**2 + n_states),
    )
    return Prepared(Timed(step), work)
