"""Protects: tracks from contacts in clutter, their lives, and stated behaviour on bad input."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contact_tracker import ContactTracker, make_contact_tracker
from sonar_tracking.active.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.records import Contacts, ContactTrackerUpdate
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.passive.records import TrackStatus

METHODS = ("integrated", "hpda_kalman", "hpda_particle", "roi_clustering", "smc_phd")
WITH_EXISTENCE = METHODS[:3]
SECOND = 1_000_000_000
VELOCITY = np.array([2.0, -1.0])
NOTHING = np.zeros(0)


def start(method: str, **values: float | str) -> ContactTracker:
    given = {"sound_speed": 0.0, "acceleration_deviation": 0.005, "n_particles": 300, **values}
    return make_contact_tracker(
        ContactTrackerConfiguration(method=method, **given)  # type: ignore[arg-type]
    )


def ping(
    number: int,
    generator: np.random.Generator,
    targets: int = 1,
    clutter: int = 5,
    heard: bool = True,
) -> Contacts:
    """Return a ping with targets 3 km apart that all move alike."""
    truth = target_positions(number, targets)
    distance = np.hypot(truth[:, 0], truth[:, 1]) + 20.0 * generator.standard_normal(targets)
    azimuth = np.arctan2(truth[:, 1], truth[:, 0]) + 0.002 * generator.standard_normal(targets)
    if not heard:
        distance, azimuth = NOTHING, NOTHING
    far = 10_000.0 * np.sqrt(generator.random(clutter))
    around = np.pi * (2.0 * generator.random(clutter) - 1.0)
    strong = 1.0 + 11.0 * generator.exponential(size=len(distance))
    return Contacts(
        stamp=(100 + 10 * number) * SECOND,
        range=np.concatenate([distance, far]),
        azimuth=np.concatenate([azimuth, around]),
        amplitude=np.concatenate([strong, 1.0 + generator.exponential(size=clutter)]),
        range_standard_deviation=20.0,
        azimuth_standard_deviation=0.002,
        detection_threshold=1.0,
        clutter_density=max(clutter, 1) / (np.pi * 1e8),
        maximum_range=10_000.0,
    )


def target_positions(number: int, targets: int) -> np.ndarray:
    starts = np.array([[3000.0 * index - 3000.0, 4000.0] for index in range(targets)])
    return starts + 10.0 * number * VELOCITY


def confirmed(update: ContactTrackerUpdate) -> np.ndarray:
    return np.flatnonzero(
        np.isin(update.tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
    )


@pytest.mark.parametrize("method", METHODS)
def test_targets_are_found_and_followed(method: str) -> None:
    generator = np.random.default_rng(1)
    tracker = start(method)
    counts, errors, names = [], [], set()
    for number in range(40):
        update = tracker.update(ping(number, generator, targets=3))
        rows = confirmed(update)
        if number >= 20:
            counts.append(len(rows))
            truth = target_positions(number, 3)
            distance = np.linalg.norm(update.tracks.state[rows, None, :2] - truth[None], axis=2)
            errors.append(np.min(distance, axis=0))
            names.update(update.tracks.id[rows].tolist())
    assert np.mean(counts) == pytest.approx(3.0, abs=0.4)
    assert np.median(errors) < 30.0
    if method in WITH_EXISTENCE:
        assert len(names) == 3


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_a_lost_target_coasts_and_is_told_to_have_ended_once(method: str) -> None:
    generator = np.random.default_rng(2)
    tracker = start(method)
    for number in range(20):
        update = tracker.update(ping(number, generator))
    (identity,) = update.tracks.id[confirmed(update)]
    states = []
    for number in range(20, 40):
        update = tracker.update(ping(number, generator, heard=False))
        row = np.flatnonzero(update.tracks.id == identity)
        states += update.tracks.status[row].tolist()
    assert states[0] == TrackStatus.COASTED
    assert states.count(TrackStatus.TERMINATED) == 1
    assert states[-1] == TrackStatus.TERMINATED


@pytest.mark.parametrize("method", METHODS)
def test_clutter_alone_makes_no_lasting_tracks(method: str) -> None:
    generator = np.random.default_rng(3)
    tracker = start(method)
    counts = []
    for number in range(40):
        update = tracker.update(ping(number, generator, heard=False, clutter=10))
        counts.append(len(confirmed(update)))
    assert np.mean(counts) < 0.5


@pytest.mark.parametrize("method", METHODS)
def test_results_are_reproducible(method: str) -> None:
    states = []
    for _ in range(2):
        generator, tracker = np.random.default_rng(4), start(method)
        for number in range(12):
            update = tracker.update(ping(number, generator, targets=2))
        states.append(update.tracks.state)
    assert np.array_equal(states[0], states[1])


@pytest.mark.parametrize("method", METHODS)
def test_no_contacts_for_many_pings(method: str) -> None:
    tracker = start(method)
    generator = np.random.default_rng(5)
    for number in range(15):
        update = tracker.update(ping(number, generator, clutter=0, heard=number == 0))
    assert len(confirmed(update)) == 0
    assert np.isfinite(update.target_count)


@pytest.mark.parametrize("method", METHODS)
def test_duplicates_and_pings_out_of_order_are_refused(method: str) -> None:
    generator = np.random.default_rng(6)
    tracker = start(method)
    for number in range(10):
        before = tracker.update(ping(number, generator))
    for number in (9, 4):
        with pytest.raises(InputError, match="not later"):
            tracker.update(ping(number, generator))
    after = tracker.update(ping(10, generator))
    assert set(before.tracks.id[confirmed(before)]) <= set(after.tracks.id) or method == "smc_phd"


@pytest.mark.parametrize("method", METHODS)
def test_single_bad_contacts_are_left_out(method: str) -> None:
    generator = np.random.default_rng(7)
    tracker = start(method)
    for number in range(15):
        contacts = ping(number, generator)
        bad = replace(
            contacts,
            range=np.concatenate([contacts.range, [np.nan, -5.0, 900.0]]),
            azimuth=np.concatenate([contacts.azimuth, [0.0, 1.0, 2.0]]),
            amplitude=np.concatenate([contacts.amplitude, [2.0, 2.0, -1.0]]),
        )
        update = tracker.update(bad)
    assert any("3 of 9 contacts" in notice.text for notice in update.notices)
    assert np.all(np.isfinite(update.tracks.state))
    assert len(confirmed(update)) >= 1


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"range_standard_deviation": 0.0}, "range_standard_deviation"),
        ({"azimuth_standard_deviation": np.nan}, "azimuth_standard_deviation"),
        ({"sensor_position": (np.nan, 0.0)}, "sensor"),
        ({"range_standard_deviation": np.ones(3)}, "3 entries for 6 contacts"),
        ({"azimuth": np.zeros(2)}, "equally many"),
    ],
)
def test_a_ping_that_cannot_be_used_is_refused(
    method: str, change: dict[str, object], text: str
) -> None:
    tracker = start(method)
    contacts = ping(0, np.random.default_rng(8))
    with pytest.raises(InputError, match=text):
        tracker.update(replace(contacts, **change))  # type: ignore[arg-type]
    tracker.update(contacts)


@pytest.mark.parametrize("method", METHODS)
def test_a_clutter_density_of_zero_is_said_and_survived(method: str) -> None:
    generator = np.random.default_rng(9)
    tracker = start(method)
    for number in range(8):
        update = tracker.update(replace(ping(number, generator), clutter_density=0.0))
    assert any(notice.culprit == "clutter_density" for notice in update.notices)
    assert np.all(np.isfinite(update.tracks.state))


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_without_amplitudes_distance_serves_alone(method: str) -> None:
    generator = np.random.default_rng(10)
    tracker = start(method)
    for number in range(25):
        update = tracker.update(replace(ping(number, generator), amplitude=NOTHING))
    assert any(notice.culprit == "amplitude" for notice in update.notices)
    assert len(confirmed(update)) == 1


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_unknown_clutter_is_counted(method: str) -> None:
    generator = np.random.default_rng(11)
    tracker = start(method)
    for number in range(25):
        unknown = replace(
            ping(number, generator),
            clutter_density=np.nan,
            maximum_range=np.nan,
            detection_threshold=np.nan,
        )
        update = tracker.update(unknown)
    assert len(confirmed(update)) == 1


def test_ten_thousand_contacts_leave_memory_bounded() -> None:
    generator = np.random.default_rng(12)
    tracker = start("integrated", maximum_tracks=5000)
    for number in range(3):
        update = tracker.update(ping(number, generator, clutter=10_000))
    assert len(update.tracks.id) <= 5000


def test_a_sensor_that_jumps_loses_no_track_list() -> None:
    generator = np.random.default_rng(13)
    tracker = start("integrated")
    for number in range(15):
        update = tracker.update(ping(number, generator))
    known = set(update.tracks.id[confirmed(update)].tolist())
    jumped = replace(ping(15, generator), sensor_position=(50_000.0, 0.0), maximum_range=np.nan)
    update = tracker.update(jumped)
    assert known <= set(update.tracks.id.tolist())
    for number in range(16, 20):
        update = tracker.update(ping(number, generator))
    assert known <= set(update.tracks.id[confirmed(update)].tolist())


@pytest.mark.parametrize("method", METHODS)
def test_each_contact_may_have_its_own_errors(method: str) -> None:
    states = []
    for own in (False, True):
        generator = np.random.default_rng(17)
        tracker = start(method)
        for number in range(15):
            contacts = ping(number, generator)
            if own:
                count = len(contacts.range)
                contacts = replace(
                    contacts,
                    range_standard_deviation=np.full(count, 20.0),
                    azimuth_standard_deviation=np.full(count, 0.002),
                )
            update = tracker.update(contacts)
        states.append(update.tracks.state)
        none = replace(
            contacts,
            stamp=contacts.stamp + 10 * SECOND,
            range=NOTHING,
            azimuth=NOTHING,
            amplitude=NOTHING,
            range_standard_deviation=NOTHING if own else 20.0,
            azimuth_standard_deviation=NOTHING if own else 0.002,
        )
        assert np.all(np.isfinite(tracker.update(none).tracks.state))
    assert np.array_equal(states[0], states[1])


def test_two_tracks_of_one_target_become_one() -> None:
    """Contacts that come in pairs start two candidates; only one may live."""
    generator = np.random.default_rng(14)
    tracker = start("integrated")
    for number in range(25):
        contacts = ping(number, generator, clutter=0)
        twice = replace(
            contacts,
            range=np.repeat(contacts.range, 2) + np.array([0.0, 3.0]),
            azimuth=np.repeat(contacts.azimuth, 2),
            amplitude=np.repeat(contacts.amplitude, 2),
        )
        update = tracker.update(twice)
    assert len(confirmed(update)) == 1


def test_thresholds_in_gates_follow_their_size() -> None:
    generator = np.random.default_rng(15)
    tracker = start("integrated", gate_threshold="closed_form", search_false_alarm_probability=0.01)
    for number in range(20):
        contacts = replace(
            ping(number, generator),
            clutter_density=np.nan,
            false_alarm_probability=0.05,
            detection_threshold=-np.log(0.05),
            signal_to_noise_ratio_linear=10.0,
            range_resolution=2.0,
            azimuth_resolution=2e-4,
        )
        contacts = replace(contacts, amplitude=contacts.amplitude + 6.0)
        update = tracker.update(contacts)
    thresholds = update.thresholds
    assert thresholds is not None
    assert thresholds.track_id.tolist() == update.tracks.id[confirmed(update)].tolist()
    assert np.all(thresholds.resolution_cells > 100.0)
    assert np.all(thresholds.false_alarm_probability < 0.01)
    assert thresholds.threshold == pytest.approx(-np.log(thresholds.false_alarm_probability))
    assert thresholds.search_threshold == pytest.approx(-np.log(0.01))


def test_thresholds_without_resolution_are_refused() -> None:
    tracker = start("integrated", gate_threshold="closed_form")
    with pytest.raises(InputError, match="range_resolution"):
        tracker.update(ping(0, np.random.default_rng(16)))


@pytest.mark.parametrize(
    "values",
    [
        {"termination_probability": 0.95},
        {"initial_existence": 0.4, "confirmation_probability": 0.5},
        {"method": "smc_phd", "gate_threshold": "fixed"},
    ],
)
def test_parameters_that_do_not_fit_are_refused(values: dict[str, float | str]) -> None:
    with pytest.raises(ConfigurationError):
        start(**{"method": "integrated", **values})  # type: ignore[arg-type]
