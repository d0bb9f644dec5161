"""Protects which contacts are used and which pings are refused: every bound from both sides."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_checks import (
    PingOrigin,
    check_order,
    check_ping,
    origin_of,
    sensor_jump,
)
from sonar_tracking.errors import InputError, Notice
from sonar_tracking.records.contacts import Contacts

SECOND = 1_000_000_000


def ping(**changes: Any) -> Contacts:
    """Return three good contacts."""
    values: dict[str, Any] = {
        "stamp": 10 * SECOND,
        "range": np.array([1000.0, 2000.0, 3000.0]),
        "azimuth": np.array([0.1, 0.2, 0.3]),
        "amplitude": np.array([2.0, 3.0, 4.0]),
        "range_standard_deviation": np.array([10.0, 20.0, 30.0]),
        "azimuth_standard_deviation": 0.01,
    }
    return Contacts(**{**values, **changes})


def culprits(notices: tuple[Notice, ...]) -> list[str]:
    return [notice.culprit for notice in notices]


def test_good_contacts_pass_as_they_are() -> None:
    usable, notices = check_ping(ping(), None)
    assert notices == ()
    assert usable.range.tolist() == [1000.0, 2000.0, 3000.0]
    assert usable.range_standard_deviation == pytest.approx([10.0, 20.0, 30.0])


@pytest.mark.parametrize(
    ("name", "value", "used"),
    [
        ("range", 0.0, False),
        ("range", 1e-3, True),
        ("range", 1e7, True),
        ("range", 1.1e7, False),
        ("range", np.nan, False),
        ("azimuth", np.nan, False),
        ("azimuth", -np.inf, False),
        ("azimuth", -4.0, True),
        ("amplitude", 0.0, True),
        ("amplitude", -1e-9, False),
        ("amplitude", 1e12, True),
        ("amplitude", 1.1e12, False),
        ("amplitude", np.nan, False),
    ],
)
def test_one_contact_is_left_out_by_its_own_value(name: str, value: float, used: bool) -> None:
    """Its neighbours and their columns stay."""
    contacts = ping()
    getattr(contacts, name)[1] = value
    usable, notices = check_ping(contacts, None)
    rows = [0, 1, 2] if used else [0, 2]
    for column in ("range", "azimuth", "amplitude", "range_standard_deviation"):
        assert getattr(usable, column).tolist() == getattr(contacts, column)[rows].tolist()
    assert usable.azimuth_standard_deviation == 0.01
    assert culprits(notices) == ([] if used else ["contacts"])
    assert used or "1 of 3 contacts" in notices[0].text


def test_contacts_without_amplitudes_are_used_and_said_once_there_are_any() -> None:
    usable, notices = check_ping(ping(amplitude=np.zeros(0)), None)
    assert len(usable.range) == 3
    assert culprits(notices) == ["amplitude"]
    nothing = np.zeros(0)
    silent = ping(
        range=nothing, azimuth=nothing, amplitude=nothing, range_standard_deviation=nothing
    )
    assert check_ping(silent, None)[1] == ()


@pytest.mark.parametrize(
    ("name", "given", "taken"),
    [
        ("range_standard_deviation", 1e-9, 1e-3),
        ("range_standard_deviation", 1e-3, 1e-3),
        ("range_standard_deviation", 1e6, 1e6),
        ("range_standard_deviation", 1e9, 1e6),
        ("azimuth_standard_deviation", 1e-12, 1e-7),
        ("azimuth_standard_deviation", 100.0, np.pi),
    ],
)
def test_extreme_deviations_are_brought_to_where_gates_stay_regular(
    name: str, given: float, taken: float
) -> None:
    usable, notices = check_ping(ping(**{name: given}), None)
    assert getattr(usable, name) == pytest.approx(taken)
    assert notices == ()
    # One a contact: only the extreme one is changed.
    regular = {"range_standard_deviation": 10.0, "azimuth_standard_deviation": 0.1}[name]
    usable, _ = check_ping(ping(**{name: np.array([regular, given, regular])}), None)
    assert getattr(usable, name) == pytest.approx([regular, taken, regular])


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
@pytest.mark.parametrize("name", ["range_standard_deviation", "azimuth_standard_deviation"])
def test_deviations_that_are_none_refuse_the_ping(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name):
        check_ping(ping(**{name: value}), None)
    with pytest.raises(InputError, match=name):
        check_ping(ping(**{name: np.array([1.0, value, 1.0])}), None)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"azimuth": np.zeros(2)}, "3 ranges, 2 azimuths and 3 amplitudes"),
        ({"amplitude": np.zeros(2)}, "3 ranges, 3 azimuths and 2 amplitudes"),
        ({"range_standard_deviation": np.ones(2)}, "2 entries for 3 contacts"),
        ({"sensor_position": (np.nan, 0.0)}, "unknown"),
        ({"sensor_velocity": (0.0, np.inf)}, "unknown"),
        ({"sensor_velocity": (160.0, -121.0)}, "moves at 201 m/s"),
    ],
)
def test_a_ping_that_contradicts_itself_is_refused(changes: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        check_ping(ping(**changes), None)


def test_a_fast_sensor_is_possible_up_to_200_metres_a_second() -> None:
    check_ping(ping(sensor_velocity=(160.0, -120.0)), None)


def test_stamps_must_rise() -> None:
    last = origin_of(ping())
    assert last == PingOrigin(10 * SECOND, (0.0, 0.0), (0.0, 0.0))
    check_order(10 * SECOND + 1, last)
    check_order(0, None)
    with pytest.raises(InputError, match="not later"):
        check_order(10 * SECOND, last)


def test_a_sensor_is_expected_where_its_mean_velocity_takes_it() -> None:
    last = PingOrigin(0, (100.0, 200.0), (4.0, -2.0))
    assert last.interval(10 * SECOND) == 10.0
    assert last.moved_to(10 * SECOND) == PingOrigin(10 * SECOND, (140.0, 180.0), (4.0, -2.0))
    # In 10 s with (4, -2) turning into (6, 2): (50, 0) on average.
    moved = ping(sensor_position=(150.0, 200.0), sensor_velocity=(6.0, 2.0))
    assert sensor_jump(moved, last) == 0.0
    # 100 m and half of 1 m/s^2 for 10 s are allowed: 150 m.
    for away, said in [(149.0, False), (151.0, True), (-151.0, True)]:
        jumped = replace(moved, sensor_position=(150.0, 200.0 + away))
        assert sensor_jump(jumped, last) == pytest.approx(abs(away) if said else 0.0)
        assert culprits(check_ping(jumped, last)[1]) == (["sensor_position"] if said else [])
    assert sensor_jump(replace(moved, sensor_position=(9e9, 0.0)), None) == 0.0
