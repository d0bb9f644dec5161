"""Own ship's instants: what belongs together, at which time."""

from __future__ import annotations

import math
from datetime import date
from itertools import pairwise

import pytest

from sonar_tracking.bags.nmea.own_ship_fixes import OwnShipFix, OwnShipFixes
from sonar_tracking.bags.nmea.own_ship_sentences import own_ship_report
from sonar_tracking.bags.nmea.sentence_time import SentenceTime
from sonar_tracking.bags.nmea.sentences import read_sentence
from sonar_tracking.errors import InputError
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.scene.nmea_format import KNOT, with_checksum
from tests.bags.nmea.nmea_scene import BEGIN, OWN_VELOCITY, compass, gga, hdt, log_lines, rmc


def fixes_of(lines: list[str]) -> tuple[list[OwnShipFix], OwnShipFixes]:
    fixes = OwnShipFixes(SentenceTime())
    found = []
    for line in lines:
        report = own_ship_report(read_sentence(line.encode("ascii")))
        if report is not None:
            found.append(fixes.take(report))
    found.append(fixes.close())
    return [fix for fix in found if fix is not None], fixes


def test_a_burst_is_one_instant_and_midnight_is_passed() -> None:
    fixes, state = fixes_of(log_lines(60))
    stamps = [state.time.stamp(fix.instant) for fix in fixes]
    begin = round(BEGIN.timestamp()) * NANOSECONDS
    assert stamps == [begin + second * NANOSECONDS for second in range(60)]
    assert {round(fix.heading_deg, 2) for fix in fixes} == {round(compass(OWN_VELOCITY), 2)}
    assert fixes[30].speed == pytest.approx(math.hypot(*OWN_VELOCITY), rel=1e-3)


def test_a_midnight_is_passed_without_a_date() -> None:
    lines = [gga(time, (0.0, 0.0)) for time in (0, 20, 40, 60)]
    fixes, state = fixes_of(lines)
    assert not state.time.is_dated
    assert [fix.instant - fixes[0].instant for fix in fixes] == [0.0, 20.0, 40.0, 60.0]
    assert state.course_for_heading == 4
    day = (date(2026, 5, 1) - date(1970, 1, 1)).days
    assert state.time.stamp(fixes[-1].instant, day) == (
        round(BEGIN.timestamp()) * NANOSECONDS + 60 * NANOSECONDS
    )


def test_a_date_that_comes_later_holds_for_what_came_before() -> None:
    lines = [gga(0, (0.0, 0.0)), gga(40, (0.0, 0.0)), rmc(50, (0.0, 0.0), (1.0, 0.0))]
    fixes, state = fixes_of(lines)
    assert state.time.stamp(fixes[0].instant) == round(BEGIN.timestamp()) * NANOSECONDS


def test_a_heading_is_of_the_instant_before_it_and_holds_for_a_while() -> None:
    lines = [gga(0, (0.0, 0.0)), hdt(10.0), hdt(12.0), gga(1, (5.0, 0.0)), gga(9, (9.0, 0.0))]
    fixes, state = fixes_of(lines)
    assert [fix.heading_deg for fix in fixes[:2]] == [10.0, 12.0]
    assert math.isnan(fixes[2].heading_deg) and state.course_for_heading == 1


def test_water_speed_is_none_over_ground_but_its_heading_is_taken() -> None:
    vhw = with_checksum("VWVHW,45.0,T,44.0,M,6.0,N,11.1,K")
    vtg = with_checksum("GPVTG,50.0,T,,M,5.0,N,9.3,K,A")
    (first, second), _ = fixes_of([gga(0, (0.0, 0.0)), vhw, gga(1, (0.0, 0.0)), vtg, vhw])
    assert first.heading_deg == 45.0 and math.isnan(first.speed)
    assert (second.speed, second.course_deg) == (pytest.approx(5.0 * KNOT), 50.0)


def test_a_late_position_is_told_and_a_source_that_begins_again_is_followed() -> None:
    with pytest.raises(InputError, match="before that of a position"):
        fixes_of([gga(5, (0.0, 0.0)), gga(4, (0.0, 0.0))])
    fixes, _ = fixes_of([rmc(t, (0.0, 0.0), (1.0, 0.0)) for t in (50, 51, 0, 1)])
    assert [b.instant - a.instant for a, b in pairwise(fixes)] == [1.0, -51.0, 1.0]


def test_a_time_that_leaps_alone_is_told_and_one_that_goes_on_is_believed() -> None:
    def at(*times: int) -> list[str]:
        return [rmc(t, (0.0, 0.0), (1.0, 0.0)) for t in times]

    with pytest.raises(InputError, match="leaps"):
        fixes_of(at(0, 1, 400_000_000))
    time = SentenceTime()
    time.take(0.0, 20_000)
    for wrong in (20_500, 10_000):
        with pytest.raises(InputError, match="leaps"):
            time.take(0.0, wrong)
        assert time.take(1.0, 20_000) == 1.0
    with pytest.raises(InputError, match="leaps"):
        time.take(0.0, 20_500)
    assert time.take(1.0, 20_500) == 500 * 86_400.0 + 1.0
