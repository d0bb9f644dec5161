"""AIS: reports as others decode them, their instants, and ships between two reports."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sonar_tracking.bags.nmea.ais_reports import (
    NO_POSITION,
    NO_TIME,
    OTHER_MESSAGE,
    PARTS,
    AisReport,
    AisReports,
)
from sonar_tracking.bags.nmea.sentence_time import SentenceTime
from sonar_tracking.bags.nmea.sentences import read_sentence
from sonar_tracking.bags.nmea.ship_histories import LEAPS, ShipHistory, report_state
from sonar_tracking.errors import InputError
from sonar_tracking.geodesy import surface_places
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.scene.nmea_format import KNOT
from tests.bags.nmea.nmea_scene import (
    ANCHORED,
    BEGIN,
    DATUM,
    FERRY,
    encapsulated,
    payload,
    position_bits,
    vdm,
)

PUBLISHED = "!AIVDM,1,1,,B,15M67FC000G?ufbE`FepT@3n00Sa,0*5C"
"""Of the documentation of AIS decoders: MMSI 366053209 off San Francisco, second 59."""


def reports(now: float | None = BEGIN.timestamp()) -> AisReports:
    time = SentenceTime()
    if now is not None:
        time.take_instant(now)
    return AisReports(time)


def taken(reader: AisReports, line: str) -> AisReport | None:
    return reader.take(read_sentence(line.encode("ascii")))


def test_a_published_report_is_read() -> None:
    report = taken(reports(), PUBLISHED)
    assert report is not None and report.mmsi == 366_053_209
    assert (report.latitude_deg, report.longitude_deg) == pytest.approx((37.802118, -122.341618))
    assert report.speed == 0.0 and report.course_deg == pytest.approx(219.3)


@pytest.mark.parametrize("kind", [1, 2, 3, 18, 19])
def test_others_read_the_same(kind: int) -> None:
    pyais = pytest.importorskip("pyais")
    for time in range(0, 600, 37):
        bits = position_bits(FERRY, time, kind).ljust(312 if kind == 19 else 168, "0")
        line = encapsulated(f"AIVDM,1,1,,A,{payload(bits)},0")
        ours, theirs = taken(reports(), line), pyais.decode(line.encode())
        assert ours is not None and ours.mmsi == theirs.mmsi
        assert ours.latitude_deg == pytest.approx(theirs.lat, abs=1e-6)
        assert ours.longitude_deg == pytest.approx(theirs.lon, abs=1e-6)
        assert ours.speed == pytest.approx(theirs.speed * KNOT)
        assert ours.course_deg == pytest.approx(theirs.course)
        assert ours.instant % 60.0 == theirs.second


@pytest.mark.parametrize(("late", "second", "offset"), [(0, 30, 0), (4, 30, 0), (-3, 30, 0)])
def test_the_second_of_a_report_is_that_of_the_latest_minute(
    late: int, second: int, offset: int
) -> None:
    reader = reports(BEGIN.timestamp() + late)
    report = taken(reader, vdm(FERRY, 0.0, second=second))
    assert report is not None
    assert reader.time.stamp(report.instant) == round(BEGIN.timestamp() + offset) * NANOSECONDS


def test_without_a_time_in_the_stream_reports_cannot_be_used() -> None:
    with pytest.raises(InputError) as caught:
        taken(reports(None), vdm(FERRY, 0.0))
    assert str(caught.value) == NO_TIME


def test_a_shore_station_tells_the_time() -> None:
    reader = reports(None)
    fields = [
        (4, 6),
        (0, 2),
        (2_111_111, 30),
        (2026, 14),
        (5, 4),
        (1, 5),
        (23, 5),
        (59, 6),
        (28, 6),
    ]
    bits = "".join(f"{value:0{count}b}" for value, count in fields).ljust(168, "0")
    with pytest.raises(InputError, match=OTHER_MESSAGE[:20]):
        taken(reader, encapsulated(f"AIVDM,1,1,,A,{payload(bits)},0"))
    report = taken(reader, vdm(FERRY, 0.0))
    assert report is not None
    assert reader.time.stamp(report.instant) == round(BEGIN.timestamp()) * NANOSECONDS


def test_a_message_in_two_parts_needs_both_in_order() -> None:
    whole = payload(position_bits(FERRY, 0.0, 19).ljust(312, "0"))
    first = encapsulated(f"AIVDM,2,1,7,A,{whole[:30]},0")
    second = encapsulated(f"AIVDM,2,2,7,A,{whole[30:]},0")
    reader = reports()
    assert taken(reader, first) is None
    report = taken(reader, second)
    assert report is not None and report.mmsi == FERRY.mmsi
    with pytest.raises(InputError) as caught:
        taken(reader, second)
    assert str(caught.value) == PARTS


def test_own_ship_is_none_of_the_others_and_unknown_values_are_none() -> None:
    reader = reports()
    own = encapsulated(f"AIVDO,1,1,,,{payload(position_bits(FERRY, 0.0))},0")
    assert taken(reader, own) is None and taken(reader, vdm(FERRY, 0.0)) is None
    bits = position_bits(ANCHORED, 0.0)
    nowhere = bits[:61] + f"{181 * 600_000:028b}" + f"{91 * 600_000:027b}" + bits[116:]
    with pytest.raises(InputError) as caught:
        taken(reader, encapsulated(f"AIVDM,1,1,,A,{payload(nowhere)},0"))
    assert str(caught.value) == NO_POSITION


def test_a_state_in_map_is_where_the_ship_is() -> None:
    latitude, longitude = surface_places(np.array([40_000.0, 30_000.0]), DATUM)
    # Due north along its meridian: the map sees it turned by the convergence of the meridians.
    report = AisReport(FERRY.mmsi, 0.0, latitude, longitude, 10.0, 0.0)
    state = report_state(report, DATUM)
    assert state[:2] == pytest.approx([40_000.0, 30_000.0], abs=0.01)
    assert math.hypot(*state[2:]) == pytest.approx(10.0)
    convergence = math.radians(longitude - DATUM.longitude_deg) * math.sin(math.radians(latitude))
    assert math.atan2(state[2], state[3]) == pytest.approx(-convergence, rel=0.02)


def at_rest(x: float) -> np.ndarray:
    return np.array([x, 0.0, 0.0, 0.0])


def second(time: float) -> int:
    return round(time * NANOSECONDS)


def test_a_turning_ship_is_followed_between_two_reports() -> None:
    rate, radius = 0.01, 500.0
    ship = ShipHistory()
    for time in (0.0, 30.0):
        phase = rate * time
        position = radius * np.array([math.sin(phase), 1.0 - math.cos(phase)])
        velocity = radius * rate * np.array([math.cos(phase), math.sin(phase)])
        ship.add(second(time), np.concatenate([position, velocity]))
    state = ship.at(second(15.0))
    assert state is not None and not state.is_predicted
    expected = radius * np.array([math.sin(0.15), 1.0 - math.cos(0.15)])
    assert np.hypot(*(state.state[:2] - expected)) < 0.02  # m; the chord is 5.6 m away
    assert ship.at(second(-1.0)) is None and ship.at(second(31.0)) is None


def test_nothing_is_known_in_a_long_gap_unless_the_ship_lies_still() -> None:
    still, moving = ShipHistory(), ShipHistory()
    for time in (0.0, 200.0):
        still.add(second(time), at_rest(5.0))
        moving.add(second(time), np.array([5.0 * time, 0.0, 5.0, 0.0]))
    middle = second(100.0)
    assert still.at(middle) is not None and moving.at(middle) is None
    assert [len(ship.known_from_to()) for ship in (still, moving)] == [1, 2]


def test_a_ship_is_predicted_for_a_while_and_said_to_be() -> None:
    ship = ShipHistory()
    ship.add(0, np.array([0.0, 0.0, 5.0, 0.0]))
    state = ship.at(second(10.0), longest_prediction=30.0)
    assert state is not None and state.is_predicted
    assert state.state[0] == pytest.approx(50.0)
    assert ship.at(second(31.0), longest_prediction=30.0) is None


def test_a_leap_is_refused_once_and_believed_if_it_goes_on() -> None:
    ship = ShipHistory()
    ship.add(0, at_rest(0.0))
    with pytest.raises(InputError) as caught:
        ship.add(second(10.0), at_rest(9000.0))
    assert str(caught.value) == LEAPS
    ship.add(second(20.0), at_rest(0.0))
    with pytest.raises(InputError):
        ship.add(second(30.0), at_rest(9000.0))
    ship.add(second(40.0), at_rest(9000.0))
    assert len(ship.stamps) == 2
