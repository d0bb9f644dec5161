"""A live tracker of contacts: one picture a ping, usable or not, and no track lost on the way."""

from __future__ import annotations

import array
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from sonar_tracking_msgs.msg import Contacts as ContactsMessage

from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_THRESHOLD,
    ACTIVE_TRACKS,
    CONTACTS,
    ODOMETRY,
)
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.graph.message_writing.contact_writing import contacts_to_message
from sonar_tracking.message_reading.contact_reading import thresholds_from_message
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TrackSource
from sonar_tracking.records.time import END_OF_DATA
from tests.graph.live_graph import NodeProcess, Probe, node_process, stamps

NODE = "hpda_tracker"
INPUT = f"{NODE}: input /active/contacts"
SECOND = 1_000_000_000
INTERVAL = 10 * SECOND
NEWEST_RUN = 1_767_225_600 * SECOND
SHIP_SPEED = 4.0
TARGET = np.array([3000.0, 2000.0])
VELOCITY = np.array([-2.0, 3.0])
FIRST_ID = 1 + (1 << 32)
SETTLED = 10
"""Pings after which the target is surely tracked."""


def ping(start: int, number: int, clutter: int = 5, told: bool = True) -> Contacts:
    """One target among clutter, seen from a ship that goes east; its pose told or not."""
    generator = np.random.default_rng(number)
    stamp = start + number * INTERVAL
    ship = np.array([SHIP_SPEED * 10.0 * number, 0.0])
    separation = TARGET + 10.0 * number * VELOCITY - ship
    unknown = (np.nan, np.nan)
    return Contacts(
        stamp=stamp,
        range=np.append(5000.0 * np.sqrt(generator.random(clutter)), np.hypot(*separation)),
        azimuth=np.append(
            np.pi * (2.0 * generator.random(clutter) - 1.0),
            np.arctan2(separation[1], separation[0]),
        ),
        amplitude=np.append(5.0 + generator.exponential(size=clutter), 15.0),
        range_standard_deviation=20.0,
        azimuth_standard_deviation=0.01,
        sensor_position=(float(ship[0]), 0.0) if told else unknown,
        sensor_velocity=(SHIP_SPEED, 0.0) if told else unknown,
        detection_threshold=5.0,
        clutter_density=5.0 / (np.pi * 5000.0**2),
        maximum_range=5000.0,
        next_stamp=stamp + INTERVAL,
    )


def odometry(stamp: int, start: int) -> Any:
    """Own ship, whose turning point lies 50 m behind the sensor."""
    x = SHIP_SPEED * (stamp - start) * 1e-9 - 50.0
    return array_writing.own_ship_to_message(
        OwnShipState(stamp, (x, 0.0), 0.0, (SHIP_SPEED, 0.0), 0.0)
    )


class Tracker:
    """A live tracker and the means to feed it."""

    def __init__(self, process: NodeProcess, probe: Probe) -> None:
        self.process = process
        self.probe = probe
        self.outputs = probe.listen(ACTIVE_TRACKS)
        self.thresholds = probe.listen(ACTIVE_THRESHOLD)
        self.publisher = probe.publisher(CONTACTS)
        self.odometry = probe.publisher(ODOMETRY)
        self.sent = 0
        self._run = NEWEST_RUN

    def new_run(self) -> int:
        """Return the start of a run that lies so far back that the node begins again."""
        self._run -= 10_000 * SECOND
        for heard in (self.outputs, self.thresholds, self.probe.diagnostics):
            heard.clear()
        return self._run

    def send(self, *sent: Any) -> None:
        """Publish pings (or messages) and wait until the node has taken them."""
        for each in sent:
            message = contacts_to_message(each) if isinstance(each, Contacts) else each
            self.publisher.publish(message)
            self.sent += 1
            self.probe.wait(
                lambda: self.probe.finished(NODE, "/active/contacts") >= self.sent,
                f"message {self.sent} finished; output of the node:\n{self.process.output}",
            )

    def assert_pictures(self, start: int, numbers: Any) -> None:
        """Check one picture and one list of thresholds a ping, of the same stamp."""
        expected = [start + number * INTERVAL for number in numbers]
        for heard in (self.outputs, self.thresholds):
            self.probe.wait_for_count(heard.__len__, len(expected), "pictures")
            assert stamps(heard) == expected
        assert self.process.is_alive

    def target(self, picture: int) -> tuple[int, int]:
        """Return identifier and status of the one track of a picture that is confirmed."""
        tracks = position_tracks_from_message(self.outputs[picture])
        shown = np.isin(tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
        (row,) = np.flatnonzero(shown)
        run_time = 10.0 * round((tracks.stamp - stamps(self.outputs)[0]) / INTERVAL)
        assert tracks.state[row, :2] == pytest.approx(TARGET + run_time * VELOCITY, abs=80.0)
        return int(tracks.id[row]), int(tracks.status[row])


@pytest.fixture(scope="module")
def tracker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tracker]:
    log = tmp_path_factory.mktemp("tracker") / "log.txt"
    parameters = {
        "use_sim_time": True,
        "first_id": FIRST_ID,
        "initial_speed_deviation": 4.0,
        "mounting_x": 50.0,
        "method": "integrated",
    }
    probe = Probe()
    with node_process(f"sonar_tracking.graph.nodes.{NODE}", log, **parameters) as process:
        tracker = Tracker(process, probe)
        topics = ("/active/contacts", "/active/tracks", "/active/threshold", "/own_ship/odometry")
        probe.wait_matched(NODE, *topics, "/clock", "/flow/done")
        probe.wait(lambda: tracker.publisher.get_subscription_count(), "probe matched")
        yield tracker
    probe.close()


def test_every_ping_gives_one_picture(tracker: Tracker) -> None:
    start = tracker.new_run()
    tracker.send(*(ping(start, number) for number in range(SETTLED + 1)))
    tracker.assert_pictures(start, range(SETTLED + 1))
    identifier, status = tracker.target(-1)
    assert identifier >= FIRST_ID
    assert status == TrackStatus.CONFIRMED
    picture = position_tracks_from_message(tracker.outputs[-1])
    assert np.all(picture.source == TrackSource.ACTIVE)
    assert np.all(np.linalg.eigvalsh(picture.covariance) > 0.0)
    assert np.max(picture.existence_probability) > 0.9
    assert picture.next_stamp == picture.stamp + INTERVAL
    thresholds = thresholds_from_message(tracker.thresholds[-1])
    assert thresholds.track_id.tolist() == [identifier]
    assert thresholds.threshold == 5.0


def test_bad_pings_are_named_and_the_track_is_predicted_over_them(tracker: Tracker) -> None:
    """Each gives its picture; the track keeps its name and is found again."""
    start = tracker.new_run()
    tracker.send(*(ping(start, number) for number in range(SETTLED)))
    unequal = contacts_to_message(ping(start, SETTLED))
    unequal.azimuth = array.array("d", [0.0])
    bad = [
        unequal,
        replace(ping(start, SETTLED + 1), range_standard_deviation=0.0),
        replace(ping(start, SETTLED + 2), azimuth_standard_deviation=np.nan),
        replace(ping(start, SETTLED + 3), sensor_velocity=(np.inf, 0.0)),
    ]
    tracker.send(*bad, *(ping(start, SETTLED + number) for number in (4, 5)))
    tracker.assert_pictures(start, range(SETTLED + 6))
    identifier, _ = tracker.target(SETTLED - 1)
    for number in range(len(bad)):
        assert tracker.target(SETTLED + number) == (identifier, TrackStatus.COASTED)
    assert tracker.target(-1) == (identifier, TrackStatus.CONFIRMED)
    for parts in (
        ("Contacts.azimuth has 1 values",),
        ("range_standard_deviation", "not positive"),
        ("azimuth_standard_deviation", "not positive"),
        ("Position or velocity of the sensor",),
    ):
        tracker.probe.wait_sentence(INPUT, "rejected", *parts)


def test_single_bad_contacts_are_left_out_and_said(tracker: Tracker) -> None:
    start = tracker.new_run()
    for number in range(SETTLED + 1):
        good = ping(start, number)
        tracker.send(
            replace(
                good,
                range=np.append(good.range, [np.nan, 900.0]),
                azimuth=np.append(good.azimuth, [0.0, 1.0]),
                amplitude=np.append(good.amplitude, [20.0, -1.0]),
            )
        )
    tracker.assert_pictures(start, range(SETTLED + 1))
    assert tracker.target(-1)[1] == TrackStatus.CONFIRMED
    tracker.probe.wait_sentence(f"{NODE}: contacts", "2 of 8 contacts", "negative amplitude")


def test_tracks_that_contacts_do_not_tell_apart_are_named(tracker: Tracker) -> None:
    """Two targets 70 m apart, 36 m of a contact's deviation across the line of sight."""
    start, probe = tracker.new_run(), tracker.probe
    for number in range(2 * SETTLED):
        good = ping(start, number)
        tracker.send(
            replace(
                good,
                range=np.append(good.range, good.range[-1]),
                azimuth=np.append(good.azimuth, good.azimuth[-1] + 0.02),
                amplitude=np.append(good.amplitude, 15.0),
            )
        )
    shown = position_tracks_from_message(tracker.outputs[-1])
    first, second = sorted(shown.id[shown.established].tolist())
    probe.diagnostics.clear()
    probe.tick(start + 2 * SETTLED * INTERVAL)
    probe.wait(lambda: probe.values(f"{NODE}: unresolved tracks"), "status")
    assert probe.values(f"{NODE}: unresolved tracks") == {
        f"track {first}": f"beside {second}",
        f"track {second}": f"beside {first}",
    }


def test_duplicates_and_late_pings_change_nothing(tracker: Tracker) -> None:
    start = tracker.new_run()
    numbers = [number for number in range(SETTLED + 2) if number != SETTLED - 2]
    for number in numbers:
        tracker.send(ping(start, number))
        if number == SETTLED:
            late = replace(ping(start, SETTLED - 2), next_stamp=start + (SETTLED - 1) * INTERVAL)
            tracker.send(ping(start, number), ping(start, number - 4), late)
    tracker.assert_pictures(start, numbers)
    names = {tracker.target(picture)[0] for picture in range(SETTLED - 3, SETTLED)}
    assert len(names) == 1
    tracker.probe.wait_sentence(INPUT, "already received")
    tracker.probe.wait_sentence(INPUT, "earlier than the one before")


def test_without_amplitudes_it_says_so_and_goes_by_distance(tracker: Tracker) -> None:
    start = tracker.new_run()
    nothing = np.zeros(0)
    tracker.send(
        *(replace(ping(start, number), amplitude=nothing) for number in range(SETTLED + 5))
    )
    tracker.assert_pictures(start, range(SETTLED + 5))
    assert tracker.target(-1)[1] == TrackStatus.CONFIRMED
    tracker.probe.wait_sentence(f"{NODE}: amplitude", "by distance alone")


def test_ten_thousand_contacts_are_survived(tracker: Tracker) -> None:
    start = tracker.new_run()
    tracker.send(*(ping(start, number) for number in range(SETTLED)))
    tracker.send(ping(start, SETTLED, clutter=10_000), ping(start, SETTLED + 1))
    tracker.assert_pictures(start, range(SETTLED + 2))
    assert tracker.target(-1)[0] == tracker.target(SETTLED - 1)[0]


def states(pictures: list[Any]) -> list[np.ndarray]:
    """Return the states of every picture, whatever its tracks are called."""
    return [position_tracks_from_message(picture).state for picture in pictures]


def test_a_description_of_zeros_is_unknown(tracker: Tracker) -> None:
    """As in a message in which nobody has filled it in: the same tracks as without any."""
    names = ("clutter_density", "detection_threshold", "maximum_range")
    found = []
    for unknown in (np.nan, 0.0):
        start = tracker.new_run()
        description: dict[str, Any] = dict.fromkeys(names, unknown)
        tracker.send(*(replace(ping(start, n), **description) for n in range(SETTLED + 1)))
        tracker.assert_pictures(start, range(SETTLED + 1))
        assert tracker.target(-1)[1] == TrackStatus.CONFIRMED
        found.append(states(tracker.outputs))
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_sensor_that_jumps_is_said_and_loses_no_track(tracker: Tracker) -> None:
    start = tracker.new_run()
    tracker.send(*(ping(start, number) for number in range(SETTLED)))
    tracker.send(replace(ping(start, SETTLED), sensor_position=(50_000.0, 9_000.0)))
    tracker.send(*(ping(start, SETTLED + number) for number in (1, 2)))
    tracker.assert_pictures(start, range(SETTLED + 3))
    identifier, _ = tracker.target(SETTLED - 1)
    assert identifier in tracker.outputs[SETTLED].id
    assert tracker.target(-1) == (identifier, TrackStatus.CONFIRMED)
    tracker.probe.wait_sentence(f"{NODE}: sensor_position", "from where its motion takes it")


def test_silence_ends_the_track_once(tracker: Tracker) -> None:
    start = tracker.new_run()
    tracker.send(*(ping(start, number) for number in range(SETTLED)))
    nothing = np.zeros(0)
    silent = [
        replace(ping(start, SETTLED + n), range=nothing, azimuth=nothing, amplitude=nothing)
        for n in range(15)
    ]
    tracker.send(*silent)
    tracker.assert_pictures(start, range(SETTLED + 15))
    identifier, _ = tracker.target(SETTLED - 1)
    told = [
        status
        for message in tracker.outputs[SETTLED:]
        for name, status in zip(message.id, message.status, strict=True)
        if name == identifier
    ]
    assert told[0] == TrackStatus.COASTED
    assert told.count(TrackStatus.TERMINATED) == 1 and told[-1] == TrackStatus.TERMINATED
    assert not len(tracker.outputs[-1].id)


def test_odometry_tells_where_the_sensor_is_when_the_ping_does_not(tracker: Tracker) -> None:
    """Pings wait for it, and are placed as if they had carried their pose themselves."""
    start = tracker.new_run()
    for number in range(SETTLED + 1):
        tracker.send(ping(start, number, told=False))
        # The third ping shows that the data have begun again.
        assert number < 3 or len(tracker.outputs) == number
        for seconds in (-3, 4):
            tracker.odometry.publish(odometry(start + number * INTERVAL + seconds * SECOND, start))
        if number >= 2:
            tracker.probe.wait_for_count(tracker.outputs.__len__, number + 1, "pictures")
    tracker.assert_pictures(start, range(SETTLED + 1))
    assert tracker.target(-1)[1] == TrackStatus.CONFIRMED


def unset(contacts: Contacts) -> Any:
    """Return a ping of azimuths in map whose sender has not filled in a pose."""
    message, new = contacts_to_message(contacts), ContactsMessage()
    message.sensor_pose, message.sensor_velocity = new.sensor_pose, new.sensor_velocity
    return message


def test_a_pose_that_nobody_has_set_is_taken_from_odometry_and_said_once(tracker: Tracker) -> None:
    """Pings are placed as those that tell that they do not know it."""
    found = []
    for told in (True, False):
        start = tracker.new_run()
        for number in range(SETTLED + 1):
            for seconds in (-3, 4):
                stamp = start + number * INTERVAL + seconds * SECOND
                tracker.odometry.publish(odometry(stamp, start))
            one = ping(start, number, told=False)
            tracker.send(one if told else unset(one))
        tracker.assert_pictures(start, range(SETTLED + 1))
        found.append(states(tracker.outputs))
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one, other)
    tracker.probe.wait_sentence(INPUT, "sensor_pose is that of a new message", "m away")
    assert tracker.process.output.count("sensor_pose is that of a new message") == 1


def test_a_pose_that_contradicts_odometry_is_used_and_said(tracker: Tracker) -> None:
    start = tracker.new_run()
    taken = tracker.probe.finished(NODE, "/own_ship/odometry")
    for number in range(SETTLED):
        for seconds in (-3, 4):
            tracker.odometry.publish(odometry(start + number * INTERVAL + seconds * SECOND, start))
        due = taken + 2 * (number + 1)
        tracker.probe.wait_for_count(
            lambda: tracker.probe.finished(NODE, "/own_ship/odometry"), due, "odometry"
        )
        far = ping(start, number)
        east, north = far.sensor_position
        tracker.send(replace(far, sensor_position=(east, north + 800.0)))
    tracker.assert_pictures(start, range(SETTLED))
    tracker.probe.wait_sentence(INPUT, "sensor_pose is 800 m from where", "of the message is used")
    picture = position_tracks_from_message(tracker.outputs[-1])
    row = np.flatnonzero(picture.status == TrackStatus.CONFIRMED)[0]
    expected = TARGET + 10.0 * (SETTLED - 1) * VELOCITY + (0.0, 800.0)
    assert picture.state[row, :2] == pytest.approx(expected, abs=80.0)


def test_the_end_of_the_data_is_passed_on(tracker: Tracker) -> None:
    start = tracker.new_run()
    last = replace(ping(start, 2), next_stamp=END_OF_DATA)
    tracker.send(ping(start, 0), ping(start, 1), last)
    tracker.assert_pictures(start, range(3))
    for heard in (tracker.outputs, tracker.thresholds):
        assert stamp_from_time(heard[-1].next_stamp) == END_OF_DATA


def test_a_new_run_has_new_names(tracker: Tracker) -> None:
    names = []
    for _ in range(2):
        start = tracker.new_run()
        tracker.send(*(ping(start, number) for number in range(SETTLED)))
        tracker.assert_pictures(start, range(SETTLED))
        names.append(tracker.target(-1)[0])
    assert names[1] > names[0] >= FIRST_ID
