"""Protects: stated behaviour of the trackers of contacts on bad and missing input."""

import tracemalloc
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.records.bearings import TrackStatus
from tests.active.contact_scene import (
    METHODS,
    NOTHING,
    SECOND,
    WITH_EXISTENCE,
    confirmed,
    ping,
    start,
    target_positions,
)


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
    assert set(before.tracks.id[confirmed(before)]) <= set(after.tracks.id)


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


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("claimed", [5.0, 10_000.0])
def test_ten_thousand_contacts_leave_memory_bounded(method: str, claimed: float) -> None:
    """Whether the detector admits them or not; afterwards it goes on as before."""
    generator = np.random.default_rng(12)
    tracker = start(method, maximum_tracks=15_000, n_particles=100)
    crowds = [
        replace(ping(number, generator, clutter=10_000), clutter_density=claimed / (np.pi * 1e8))
        for number in range(3)
    ]
    for crowd in crowds[:2]:
        tracker.update(crowd)
    # The third one meets the tracks that the others have left, and needs most.
    tracemalloc.start()
    try:
        update = tracker.update(crowds[2])
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 380e6  # and less than 20 MB held before
    assert update.target_count <= 15_000.0
    for number in range(4, 16):
        update = tracker.update(ping(number, generator))
    assert np.all(np.isfinite(update.tracks.state))


@pytest.mark.slow
@pytest.mark.parametrize("method", ["roi_clustering", "smc_phd"])
def test_more_targets_than_particles_are_kept_for_are_said(method: str) -> None:
    generator = np.random.default_rng(28)
    tracker = start(method, maximum_tracks=10, n_particles=50)
    texts: list[str] = []
    for number in range(5):
        crowd = replace(ping(number, generator, clutter=5000), clutter_density=1e-9)
        texts += [notice.text for notice in tracker.update(crowd).notices]
    assert any("as many as clouds" in text or "told apart" in text for text in texts)


@pytest.mark.parametrize("maximum_range", [np.nan, 10_000.0])
@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_a_sensor_that_jumps_loses_no_track_list(method: str, maximum_range: float) -> None:
    """Not even if all targets are out of range from where it says it is."""
    generator = np.random.default_rng(13)
    tracker = start(method)
    for number in range(15):
        update = tracker.update(ping(number, generator))
    known = set(update.tracks.id[confirmed(update)].tolist())
    jumped = replace(ping(15, generator), sensor_position=(5e4, 0.0), maximum_range=maximum_range)
    update = tracker.update(jumped)
    assert known <= set(update.tracks.id.tolist())
    for number in range(16, 20):
        update = tracker.update(ping(number, generator))
    assert known <= set(update.tracks.id[confirmed(update)].tolist())


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


@pytest.mark.parametrize("method", METHODS)
def test_a_ping_that_could_not_be_used_gives_the_predicted_tracks(method: str) -> None:
    generator = np.random.default_rng(17)
    tracker = start(method)
    for number in range(20):
        before = tracker.update(ping(number, generator))
    stamp = (100 + 10 * 20) * SECOND
    coasted = tracker.coast(stamp, stamp + 10 * SECOND)
    assert (coasted.tracks.stamp, coasted.tracks.next_stamp) == (stamp, stamp + 10 * SECOND)
    assert (coasted.thresholds.stamp, len(coasted.thresholds.track_id)) == (stamp, 0)
    assert len(coasted.tracks) == len(before.tracks) == 1
    expected = before.tracks.state[0, :2] + 10.0 * before.tracks.state[0, 2:]
    assert coasted.tracks.state[0, :2] == pytest.approx(expected, abs=10.0)
    if method != "smc_phd":
        assert coasted.tracks.status[0] == TrackStatus.COASTED
        assert coasted.tracks.id[0] == before.tracks.id[0]
    with pytest.raises(InputError, match="not later"):
        tracker.coast(stamp, 0)
    after = tracker.update(ping(21, generator))
    assert after.tracks.status[0] == TrackStatus.CONFIRMED


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_a_sensor_that_jumps_is_said_and_loses_no_track(method: str) -> None:
    """One wrong position of own ship: the tracks coast and are found again under their names."""
    generator = np.random.default_rng(19)
    tracker = start(method)
    for number in range(20):
        before = tracker.update(ping(number, generator))
    jumped = tracker.update(replace(ping(20, generator), sensor_position=(5000.0, 0.0)))
    assert any(notice.culprit == "sensor_position" for notice in jumped.notices)
    (identity,) = before.tracks.id[confirmed(before)]
    assert jumped.tracks.status[jumped.tracks.id == identity] == TrackStatus.COASTED
    for number in range(21, 24):
        after = tracker.update(ping(number, generator))
    assert identity in after.tracks.id[after.tracks.status == TrackStatus.CONFIRMED]
    assert not any(notice.culprit == "sensor_position" for notice in after.notices)


def test_a_sensor_that_stays_where_it_jumped_to_finds_its_targets_anew() -> None:
    generator = np.random.default_rng(20)
    tracker = start("integrated")
    for number in range(45):
        contacts = ping(number, generator)
        moved = (5000.0, 0.0) if number >= 20 else (0.0, 0.0)
        update = tracker.update(replace(contacts, sensor_position=moved))
    rows = confirmed(update)
    assert len(rows) == 1
    truth = target_positions(44, 1)[0] + (5000.0, 0.0)
    assert update.tracks.state[rows[0], :2] == pytest.approx(truth, abs=60.0)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("detection_probability", 1.5),
        ("detection_probability", 0.0),
        ("false_alarm_probability", 0.0),
        ("detection_threshold", -1.0),
        ("signal_to_noise_ratio_linear", np.inf),
        ("signal_to_noise_ratio_linear", -2.0),
        ("clutter_density", -1e-7),
        ("range_resolution", 0.0),
        ("azimuth_resolution", np.inf),
        ("maximum_range", 0.0),
        ("minimum_range", 2e4),
        ("azimuth_width", -1.0),
    ],
)
def test_a_description_that_cannot_be_true_is_taken_for_none(
    method: str, name: str, value: float
) -> None:
    generator = np.random.default_rng(23)
    tracker = start(method)
    for number in range(6):
        contacts = ping(number, generator)
        change: dict[str, Any] = {name: value}
        update = tracker.update(replace(contacts, **change))
        assert [notice.culprit for notice in update.notices if notice.culprit == name] == [name]
    assert np.all(np.isfinite(update.tracks.state))
    assert np.isfinite(update.target_count)


@pytest.mark.parametrize("method", METHODS)
def test_extreme_contacts_leave_the_tracks_regular(method: str) -> None:
    """Equal, absurdly precise and absurdly strong contacts, after an instant and after a day."""
    generator = np.random.default_rng(24)
    tracker = start(method, acceleration_deviation=0.0)
    stamp = 100 * SECOND
    for number in range(30):
        stamp += (1, 10 * SECOND, 86_400 * SECOND)[0 if number % 5 else 1 + (number == 25)]
        contacts = replace(
            ping(number, generator, targets=3),
            stamp=stamp,
            range_standard_deviation=1e-9 if number % 2 else 1e9,
            azimuth_standard_deviation=1e-12 if number % 3 else 10.0,
        )
        if number % 4 == 0:
            contacts = replace(
                contacts,
                range=np.full(len(contacts.range), 3000.0),
                azimuth=np.zeros(len(contacts.range)),
                amplitude=np.full(len(contacts.range), 1e11),
            )
        update = tracker.update(contacts)
        assert np.all(np.isfinite(update.tracks.state))
        assert np.all(np.isfinite(update.tracks.covariance))


def test_a_sensor_faster_than_any_ship_is_refused() -> None:
    tracker = start("integrated")
    contacts = replace(ping(0, np.random.default_rng(25)), sensor_velocity=(2000.0, 0.0))
    with pytest.raises(InputError, match="2000 m/s"):
        tracker.update(contacts)


def test_sound_that_creeps_is_refused() -> None:
    with pytest.raises(ConfigurationError, match="sound_speed"):
        start("integrated", sound_speed=0.5)
