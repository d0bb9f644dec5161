"""Protects: gates, mixing, thresholds, births, ends and claims, each against its own definition."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.association.hpda import associate_ranked
from sonar_tracking.active.association.lm_ipda import PairEvidence, associate_integrated
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.clutter_monitor import ClutterMonitor
from sonar_tracking.active.detection.detection_levels import mean_probability, prior_weights
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.active.tracks.contact_gating import GatePairs, SensorGeometry, predict_gates
from sonar_tracking.active.tracks.gate_thresholds import apply_thresholds
from sonar_tracking.active.tracks.motion_modes import MotionModes
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.track_bank import TrackBank, predict_bank
from sonar_tracking.active.tracks.track_management import duplicates, start_candidates, survivors
from sonar_tracking.records.bearings import TrackStatus
from tests.active.contact_scene import WITH_EXISTENCE, ping, start
from tests.active.track_scene import bank_of, contacts_at

MODEL = DetectionModel(
    detection_probability=0.9,
    signal_to_noise_ratio_linear=10.0,
    averaged=False,
    outlier_share=0.0,
    threshold=-float(np.log(0.03)),
    false_alarm_probability=0.03,
    cell_size=1.0,
    uniform_density=np.nan,
    maximum_range=10_000.0,
)
CONFIGURATION = ContactTrackerConfiguration()
AT_3_M_PER_S = MotionModes(1, 0.0, initial_speed_deviation=3.0)
NEVER_SEEN = prior_weights(np.nan)
SENSOR = SensorGeometry(np.array([100.0, -50.0]), 20.0, 0.01, 1500.0)


def uneven_bank() -> TrackBank:
    """Return two tracks whose three modes disagree."""
    generator = np.random.default_rng(1)
    bank = bank_of([[3000.0, 1000.0], [-2000.0, 500.0]], n_modes=3)
    probability = np.array([[0.6, 0.3, 0.1], [0.2, 0.2, 0.6]])
    mean = bank.mean + generator.normal(0.0, [50.0, 50.0, 2.0, 2.0], bank.mean.shape)
    root = generator.normal(size=(2, 3, 4, 4)) * np.array([20.0, 20.0, 1.0, 1.0])[:, None]
    return replace(
        bank,
        mean=mean,
        covariance=bank.covariance + root @ np.swapaxes(root, -1, -2),
        mode_probability=probability,
    )


def test_a_gate_is_that_of_the_position_at_the_reflection() -> None:
    bank = bank_of([[3000.0, 1000.0]])
    gates = predict_gates(bank, SENSOR)
    separation = bank.mean[0, 0, :2] - SENSOR.position
    distance = float(np.hypot(*separation))
    delayed = np.hstack([np.eye(2), distance / 1500.0 * np.eye(2)])
    along = separation / distance
    across = np.array([-along[1], along[0]])
    noise = 400.0 * np.outer(along, along) + (0.01 * distance) ** 2 * np.outer(across, across)
    covariance = delayed @ bank.covariance[0, 0] @ delayed.T + noise
    assert gates.centre[0] == pytest.approx(delayed @ bank.mean[0, 0])
    assert gates.covariance[0] == pytest.approx(covariance)
    assert gates.volume[0] == pytest.approx(16.0 * np.pi * np.sqrt(np.linalg.det(covariance)))


def test_mixing_keeps_mean_and_covariance_of_a_track() -> None:
    """What the modes disagree about stays in their covariances."""
    bank = uneven_bank()
    mixed = predict_bank(bank, MotionModes(3, 0.01, initial_speed_deviation=8.0), 0.0, 1.0)
    for before, after in zip(bank.moments(), mixed.moments(), strict=True):
        assert after == pytest.approx(before, rel=1e-9)
    assert not np.allclose(mixed.mean, bank.mean)


def test_a_candidate_is_as_uncertain_at_the_reflection_as_its_contact() -> None:
    contacts = contacts_at([[1500.0, 200.0]], delay=2.0)
    bank = start_candidates(contacts, np.array([0.003]), 0, 1, AT_3_M_PER_S, np.ones(1), NEVER_SEEN)
    delayed = np.hstack([np.eye(2), 2.0 * np.eye(2)])
    spread = delayed @ bank.covariance[0, 0] @ delayed.T
    assert spread == pytest.approx(contacts.covariance[0])
    assert bank.covariance[0, 0, 2:, 2:] == pytest.approx(9.0 * np.eye(2))


def test_claims_are_those_of_a_plain_coding() -> None:
    """The formulas of the module, track by track and contact by contact."""
    bank = replace(bank_of([[0.0, 0.0], [60.0, 0.0]]), existence=np.array([0.95, 0.4]))
    pairs = GatePairs(np.array([0, 0, 1, 1]), np.array([0, 1, 1, 2]))
    density, ratio = np.array([2e-4, 9e-5, 3e-4, 5e-5]), np.array([3.0, 0.5, 1.5, 0.2])
    evidence = PairEvidence(density[:, None], ratio, np.full(4, 1e-5))
    outcome = associate_integrated(bank, pairs, evidence, np.array([0.9, 0.9]), 3)
    in_gate = 0.9 * PROBABILITY_IN_GATE
    strength = {
        (t, c): d * e / PROBABILITY_IN_GATE
        for t, c, d, e in zip(pairs.track, pairs.contact, density, ratio, strict=True)
    }
    total = [sum(a for (t, _), a in strength.items() if t == row) for row in (0, 1)]
    prior = {(t, c): in_gate * bank.existence[t] * a / total[t] for (t, c), a in strength.items()}
    odds = {key: strength[key] * prior[key] / (1.0 - prior[key]) for key in strength}
    others = {(t, c): sum(o for (s, d), o in odds.items() if s != t and d == c) for t, c in odds}
    explained = {key: in_gate * strength[key] / (1e-5 + others[key]) for key in strength}
    claimed = np.zeros(3)
    for row in (0, 1):
        own = {c: e for (t, c), e in explained.items() if t == row}
        likelihood = 1.0 - in_gate + sum(own.values())
        weighted = likelihood * bank.existence[row]
        existence = weighted / (1.0 - bank.existence[row] + weighted)
        assert outcome.bank.existence[row] == pytest.approx(existence)
        for contact, each in own.items():
            claimed[contact] += existence * each / likelihood
    assert outcome.claimed == pytest.approx(claimed)


@pytest.mark.parametrize("gate_probability", [1e-3, 1e-2])
def test_a_threshold_changes_detection_and_clutter_together(gate_probability: float) -> None:
    bank = replace(bank_of([[3000.0, 0.0], [0.0, 2000.0]]), confirmed=np.array([True, False]))
    configuration = replace(
        CONFIGURATION,
        gate_threshold="fixed",
        gate_false_alarm_probability=gate_probability,
        search_false_alarm_probability=2e-3,
    )
    gates, both = predict_gates(bank, SENSOR), SceneRows((2,))
    (applied,) = apply_thresholds(bank, both, gates, [MODEL], configuration, (7, 8))
    probability = np.array([gate_probability, 2e-3])
    assert applied.threshold == pytest.approx(-np.log(probability))
    # What is found at the detector's threshold, here .95, falls by P_D's law of the threshold.
    left = (probability / 0.03) ** (1.0 / 11.0)
    assert applied.detection_probability == pytest.approx(0.95 * left)
    assert applied.clutter_share == pytest.approx(probability / 0.03)
    assert applied.search_threshold == pytest.approx(-np.log(2e-3))
    assert (applied.published.stamp, applied.published.next_stamp) == (7, 8)


def test_a_candidate_outlives_two_misses_and_a_half() -> None:
    """Each of them divides its existence by ten; the limits of confirmed tracks are others."""
    bank = bank_of([[0.0, 0.0]] * 4)
    bank = replace(
        bank,
        existence=np.array([3e-5, 3e-6, 0.61, 0.59]),
        confirmed=np.array([False, False, True, True]),
    )
    alive = survivors(bank, np.zeros(4), 1e4, 0.9, CONFIGURATION)
    assert alive.tolist() == [True, False, True, False]
    far = survivors(bank, np.array([11_999.0, 0.0, 12_001.0, 0.0]), 1e4, 0.9, CONFIGURATION)
    assert far.tolist() == [True, False, False, False]


@pytest.mark.parametrize(("confirmed", "ends"), [((True, True), 1), ((False, True), 0)])
def test_of_two_alike_the_younger_ends_but_no_confirmed_one_for_a_candidate(
    confirmed: tuple[bool, bool], ends: int
) -> None:
    bank = replace(bank_of([[0.0, 0.0], [5.0, 0.0]]), confirmed=np.array(confirmed))
    pairs = GatePairs(np.array([0, 1]), np.array([0, 0]))
    repeated = duplicates(bank, pairs, np.full((2, 1), 0.9))
    assert np.flatnonzero(repeated).tolist() == [ends]


def test_a_confirmed_track_chooses_first_and_keeps_what_it_takes() -> None:
    """Even if a candidate is more sure to exist, and the contact itself is doubtful."""
    bank = bank_of([[0.0, 0.0], [0.0, 0.0]])
    bank = replace(bank, existence=np.array([0.99, 0.7]), confirmed=np.array([False, True]))
    pairs = GatePairs(np.array([0, 1]), np.array([0, 0]))
    evidence = PairEvidence(np.full((2, 1), 1e-5), np.ones(2), np.full(2, 1e-4))
    volume = np.full(2, 1e4)
    outcome = associate_ranked(
        bank, pairs, evidence, np.array([5.0]), volume, np.full(2, 0.9), 10.0
    )
    assert outcome.weights[0, 0] == 0.0
    assert 0.0 < outcome.weights[1, 0] < 0.5
    assert outcome.claimed.tolist() == [1.0]


def test_contacts_of_confirmed_tracks_are_not_counted_as_clutter() -> None:
    model = replace(MODEL, uniform_density=1e-8)
    monitor = ClutterMonitor().after(50, 10, model)
    assert monitor.counted == pytest.approx(50.0 - 10 * 0.9)
    assert ClutterMonitor().after(3, 10, model).counted == 0.0


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_existence_confirms(method: str) -> None:
    generator = np.random.default_rng(31)
    tracker = start(method, tentative_probability=1e-6, confirmation_probability=0.99)
    known: set[int] = set()
    n_tentative = 0
    for number in range(25):
        tracks = tracker.update(ping(number, generator, targets=3, clutter=60)).tracks
        confirmed = tracks.status == TrackStatus.CONFIRMED
        for name, existence in zip(tracks.id, tracks.existence_probability, strict=True):
            if name in tracks.id[confirmed] and int(name) not in known:
                assert existence >= 0.99
        tentative = tracks.status == TrackStatus.TENTATIVE
        assert np.all(tracks.existence_probability[tentative] < 0.99)
        n_tentative += int(np.sum(tracks.existence_probability[tentative] > 0.5))
        known |= set(tracks.id[confirmed].tolist())
    assert len(known) >= 3
    assert n_tentative >= 1


def test_strong_contacts_start_likelier_candidates_and_weak_ones_none() -> None:
    tracker = start(
        "integrated",
        tentative_probability=1e-6,
        search_false_alarm_probability=0.01,
        detection_probability=0.95,
    )
    scene = replace(
        ping(0, np.random.default_rng(32), clutter=0, heard=False),
        range=np.array([2000.0, 4000.0, 6000.0]),
        azimuth=np.array([0.0, 1.0, 2.0]),
        amplitude=np.array([4.0, 5.0, 15.0]),
        clutter_density=np.nan,
        false_alarm_probability=0.05,
        detection_threshold=3.0,
        signal_to_noise_ratio_linear=10.0,
        range_resolution=20.0,
        azimuth_resolution=0.02,
    )
    tracker.update(scene)
    assert tracker.next_id == 3  # 4.0 lies below the threshold of the search, 4.6
    nothing = np.zeros(0)
    silence = replace(scene, range=nothing, azimuth=nothing, amplitude=nothing)
    tracks = tracker.update(replace(silence, stamp=scene.stamp + 10**10)).tracks
    existence = tracks.existence_probability
    assert len(existence) == 2
    # Odds of 0.003 to 0.997 times e(a) / (0.99 + 0.01 e(a)); then a miss and survival.
    excess = np.array([5.0, 15.0]) + np.log(0.01)
    ratio = np.exp(excess * 10.0 / 11.0) / 11.0
    odds = 0.003 / 0.997 * ratio / (0.99 + 0.01 * ratio)
    begun = np.exp(-0.001) * odds / (1.0 + odds)
    detection = float(mean_probability(prior_weights(0.95))) * (0.01 / 0.05) ** (1.0 / 11.0)
    missed = 1.0 - detection * PROBABILITY_IN_GATE
    assert existence == pytest.approx(missed * begun / (1.0 - begun + missed * begun), rel=1e-6)
