"""Protects: joint and integrated association, interacting modes, particles, contact positions."""

import numpy as np
import pytest

from sonar_tracking.active.association.jpda import associate_jointly
from sonar_tracking.active.association.lm_ipda import PairEvidence, associate_integrated
from sonar_tracking.active.contacts.contact_positions import PlacedContacts, place_contacts
from sonar_tracking.active.detection.gate_association import (
    PROBABILITY_IN_GATE,
    GateModel,
    associate_by_distance,
)
from sonar_tracking.active.tracks import contact_gating
from sonar_tracking.active.tracks.contact_gating import (
    GatePairs,
    SensorGeometry,
    find_pairs,
    predict_gates,
)
from sonar_tracking.active.tracks.motion_modes import MotionModes, turn_matrices
from sonar_tracking.active.tracks.pair_updates import mix_updates, update_pairs
from sonar_tracking.active.tracks.particle_cloud import (
    ParticleCloud,
    ParticleMotion,
    gaussian_cloud,
    particle_densities,
    predict_cloud,
    resample_cloud,
)
from sonar_tracking.active.tracks.track_bank import TrackBank, predict_bank
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.filtering.kalman import update as kalman_update
from sonar_tracking.records.contacts import Contacts

COVARIANCE = np.diag([400.0, 900.0, 1.0, 2.0])


def bank_of(positions: list[list[float]], n_modes: int = 1) -> TrackBank:
    count = len(positions)
    mean = np.column_stack([positions, np.full(count, 1.0), np.full(count, 0.5)])
    return TrackBank(
        id=np.arange(1, count + 1),
        existence=np.full(count, 0.8),
        confirmed=np.ones(count, dtype=bool),
        initiated=np.zeros(count, dtype=np.int64),
        updated=np.zeros(count, dtype=np.int64),
        mean=np.repeat(mean[:, None], n_modes, axis=1),
        covariance=np.tile(COVARIANCE, (count, n_modes, 1, 1)),
        mode_probability=np.full((count, n_modes), 1.0 / n_modes),
    )


def contacts_at(positions: list[list[float]], delay: float = 0.0) -> PlacedContacts:
    position = np.array(positions, dtype=float).reshape(-1, 2)
    count = len(position)
    return PlacedContacts(
        position=position,
        covariance=np.tile(np.diag([100.0, 50.0]), (count, 1, 1)),
        distance=np.hypot(position[:, 0], position[:, 1]),
        delay=np.full(count, delay),
    )


def associate(bank: TrackBank, contacts: PlacedContacts, density: float = 1e-7) -> tuple:
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.001, 0.0)
    pairs = find_pairs(bank, predict_gates(bank, sensor), contacts)
    updates = update_pairs(bank, contacts, pairs)
    count = len(pairs.track)
    evidence = PairEvidence(updates.density, np.ones(count), np.full(count, density))
    outcome = associate_integrated(
        bank, pairs, evidence, np.full(len(bank), 0.9), len(contacts.distance)
    )
    return pairs, updates, outcome


def test_a_lone_track_is_associated_as_by_pda() -> None:
    bank = bank_of([[1000.0, 2000.0]])
    pairs, updates, outcome = associate(bank, contacts_at([[1010.0, 2005.0], [990.0, 1950.0]]))
    assert len(pairs.track) == 2
    model = GateModel(1.0, 1e-7, 0.9)
    single = associate_by_distance(updates.density[:, 0], model)
    assert outcome.weights[:, 0] == pytest.approx(single.probabilities, rel=1e-9)


def test_a_certain_contact_gives_the_kalman_update() -> None:
    bank = bank_of([[1000.0, 2000.0]])
    contacts = contacts_at([[1020.0, 1990.0]], delay=1.5)
    pairs = GatePairs(np.zeros(1, dtype=np.intp), np.zeros(1, dtype=np.intp))
    mixed = mix_updates(bank, pairs, update_pairs(bank, contacts, pairs), np.ones((1, 1)))
    matrix = np.hstack([np.eye(2), 1.5 * np.eye(2)])
    single = kalman_update(
        KalmanState(bank.mean[0, 0], bank.covariance[0, 0]),
        contacts.position[0],
        matrix,
        contacts.covariance[0],
    )
    assert mixed.mean[0, 0] == pytest.approx(single.state.mean)
    assert mixed.covariance[0, 0] == pytest.approx(single.state.covariance)


def test_a_contact_of_a_neighbour_is_worth_less() -> None:
    contacts = contacts_at([[1000.0, 2000.0]])
    _, _, alone = associate(bank_of([[1010.0, 2000.0]]), contacts)
    _, _, both = associate(bank_of([[1010.0, 2000.0], [1000.0, 2000.0]]), contacts)
    assert both.weights[0, 0] < alone.weights[0, 0]
    assert both.bank.existence[0] < alone.bank.existence[0]


def test_a_missed_track_loses_existence() -> None:
    bank = bank_of([[1000.0, 2000.0]])
    _, _, outcome = associate(bank, contacts_at([[-9000.0, 0.0]]))
    ratio = 1.0 - 0.9 * PROBABILITY_IN_GATE
    assert outcome.bank.existence[0] == pytest.approx(0.8 * ratio / (0.2 + 0.8 * ratio))
    assert np.all(outcome.claimed == 0.0)


@pytest.mark.parametrize("compared_at_once", [0, 3000, 100_000])
def test_gating_finds_what_exhaustive_search_finds(
    compared_at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether all are compared or boxes are searched."""
    monkeypatch.setattr(contact_gating, "COMPARED_AT_ONCE", compared_at_once)
    generator = np.random.default_rng(1)
    bank = bank_of(generator.uniform(-3000.0, 3000.0, (60, 2)).tolist())
    contacts = contacts_at(generator.uniform(-3000.0, 3000.0, (200, 2)).tolist())
    sensor = SensorGeometry(np.zeros(2), 10.0, 0.001, 0.0)
    pairs = find_pairs(bank, predict_gates(bank, sensor), contacts)
    found = set(zip(pairs.track.tolist(), pairs.contact.tolist(), strict=True))
    spread = COVARIANCE[:2, :2] + contacts.covariance[0]
    difference = contacts.position[None] - bank.mean[:, 0, None, :2]
    square = np.einsum("tci,ij,tcj->tc", difference, np.linalg.inv(spread), difference)
    assert found == set(zip(*(index.tolist() for index in np.nonzero(square < 16.0)), strict=True))
    assert np.all(np.diff(pairs.track) >= 0)


def test_joint_association_agrees_with_listing_all_events() -> None:
    ratios, missed = np.array([[2.0, 0.5], [1.5, 0.0]]), 0.1
    events = {
        (-1, -1): missed * missed,
        (0, -1): 2.0 * missed,
        (1, -1): 0.5 * missed,
        (-1, 0): missed * 1.5,
        (1, 0): 0.5 * 1.5,
    }
    total = sum(events.values())
    expected = np.zeros((2, 2))
    for chosen, weight in events.items():
        for track, contact in enumerate(chosen):
            if contact >= 0:
                expected[track, contact] += weight / total
    assert associate_jointly(ratios, missed) == pytest.approx(expected)


def test_joint_association_of_crowds_falls_back() -> None:
    ratios = np.full((8, 30), 0.1)
    probabilities = associate_jointly(ratios, 0.5)
    assert np.sum(probabilities, axis=1) == pytest.approx(np.full(8, 3.0 / 3.5))
    assert associate_jointly(np.zeros((0, 3)), 0.1).shape == (0, 3)


def test_modes_mix_without_changing_the_mean() -> None:
    modes = MotionModes(3, 0.0, 0.01, 0.05, 0.8)
    bank = bank_of([[100.0, 200.0]], 3)
    still = predict_bank(bank, modes, 0.0, 1.0)
    assert still.moments()[0] == pytest.approx(bank.moments()[0])
    assert still.moments()[1] == pytest.approx(bank.moments()[1])
    assert np.sum(still.mode_probability) == pytest.approx(1.0)
    assert modes.mode_prior @ modes.mode_transition == pytest.approx(modes.mode_prior)


def test_turns_keep_the_speed_and_follow_the_circle() -> None:
    rate, interval = 0.005, 10.0
    state = np.array([0.0, 0.0, 2.0, 0.0])
    turned = turn_matrices(np.array(rate), interval) @ state
    radius = 2.0 / rate
    angle = rate * interval
    assert np.hypot(*turned[2:]) == pytest.approx(2.0)
    assert turned[:2] == pytest.approx([radius * np.sin(angle), radius * (1.0 - np.cos(angle))])
    straight = turn_matrices(np.array(0.0), interval) @ state
    assert straight == pytest.approx([20.0, 0.0, 2.0, 0.0])


def test_resampling_keeps_mean_and_covariance() -> None:
    generator = np.random.default_rng(2)
    cloud = gaussian_cloud(np.array([10.0, 20.0, 1.0, 2.0]), COVARIANCE, 20_000, generator)
    weight = np.exp(-0.5 * ((cloud.state[:, 0] - 30.0) / 4.0) ** 2)
    cloud = ParticleCloud(cloud.state, cloud.mode, weight)
    mean, covariance = cloud.moments()
    resampled = resample_cloud(cloud, generator)
    assert resampled.weight == pytest.approx(np.full(20_000, 1.0 / 20_000))
    again, spread = resampled.moments()
    assert again == pytest.approx(mean, abs=1.0)
    assert np.diag(spread) == pytest.approx(np.diag(covariance), rel=0.1)


def test_particles_move_as_the_modes_do() -> None:
    generator = np.random.default_rng(3)
    state = np.tile([0.0, 0.0, 2.0, 1.0], (3, 1))
    cloud = ParticleCloud(state, np.arange(3), np.ones(3))
    moved = predict_cloud(cloud, ParticleMotion(0.0, 0.01, 1.0), 10.0, generator)
    rates = MotionModes(3, 0.0, 0.01).turn_rates(state[None, :, 2:])[0]
    expected = turn_matrices(rates, 10.0) @ state[0]
    assert moved.state == pytest.approx(expected)


def test_particle_density_is_one_over_the_plane() -> None:
    sensor = SensorGeometry(np.array([100.0, -50.0]), 30.0, 0.02, 0.0)
    axis = np.arange(-400.0, 400.0, 10.0)
    grid = np.stack(np.meshgrid(1100.0 + axis, 450.0 + axis), axis=-1).reshape(-1, 2)
    density = particle_densities(
        np.array([[1100.0, 450.0, 0.0, 0.0]]), contacts_at(grid.tolist()), sensor
    )
    assert np.sum(density) * 100.0 == pytest.approx(1.0, abs=0.01)


def test_contacts_are_placed_where_they_were_reflected() -> None:
    """A moving own ship hears the echo elsewhere than where it pinged."""
    target, speed = np.array([3000.0, 4000.0]), 1500.0
    velocity = np.array([8.0, -3.0])
    there = np.hypot(*target) / speed
    travel = there
    for _ in range(30):
        travel = there + np.hypot(*(target - travel * velocity)) / speed
    receiver = travel * velocity
    azimuth = np.arctan2(*(target - receiver)[::-1])
    placed = place_contacts(
        Contacts(
            stamp=1,
            range=np.array([0.5 * speed * travel]),
            azimuth=np.array([azimuth]),
            amplitude=np.zeros(0),
            range_standard_deviation=10.0,
            azimuth_standard_deviation=0.01,
            sensor_velocity=(8.0, -3.0),
        ),
        speed,
    )
    assert placed.position[0] == pytest.approx(target, abs=1e-6)
    assert placed.delay[0] == pytest.approx(there, abs=1e-9)
    distance = np.hypot(*(target - receiver))
    assert np.linalg.det(placed.covariance[0]) == pytest.approx((10.0 * 0.01 * distance) ** 2)
