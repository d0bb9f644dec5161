"""Sentences are found among anything; damage is refused in one of a few sentences."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sonar_tracking.bags.nmea.own_ship_sentences import READERS, own_ship_report
from sonar_tracking.bags.nmea.sentences import (
    NO_CHECKSUM,
    NO_SENTENCE,
    WRONG_CHECKSUM,
    lines_of,
    read_sentence,
)
from sonar_tracking.errors import InputError
from sonar_tracking.scene.nmea_format import checksum, with_checksum
from tests.bags.nmea.nmea_scene import log_lines

PUBLISHED = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47"


def told(line: bytes) -> str:
    with pytest.raises(InputError) as caught:
        read_sentence(line)
    return str(caught.value)


def test_a_published_sentence_is_read() -> None:
    sentence = read_sentence(PUBLISHED + b"\r\n")
    assert (sentence.talker, sentence.format, sentence.field(0)) == ("GP", "GGA", "123519")
    report = own_ship_report(sentence)
    assert report is not None and report.time_of_day == 45_319.0
    assert report.latitude_deg == pytest.approx(48.0 + 7.038 / 60.0)
    assert report.longitude_deg == pytest.approx(11.0 + 31.0 / 60.0)


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        (b"hello", NO_SENTENCE),
        (bytes(range(128, 256)), NO_SENTENCE),
        (PUBLISHED[:30], NO_CHECKSUM),
        (PUBLISHED[:-1], NO_CHECKSUM),
        (PUBLISHED.replace(b"4807", b"4907"), WRONG_CHECKSUM),
        (PUBLISHED[10:], NO_SENTENCE),
    ],
)
def test_what_is_damaged_is_told_by_kind(line: bytes, kind: str) -> None:
    assert told(line) == kind


def test_half_a_sentence_ahead_costs_nothing_but_itself() -> None:
    assert read_sentence(PUBLISHED[:25] + PUBLISHED).format == "GGA"
    assert read_sentence(b"2026-05-01 12:35:19.2 " + PUBLISHED).format == "GGA"


def test_a_sentence_that_another_one_cut_off_is_told_beside_it() -> None:
    line = b"12:00:01; $GPRMC,120001.00,A,5410.80\0\0$HEHDT,88.6,T*19"
    assert lines_of(line) == [b"12:00:01; $GPRMC,120001.00,A,5410.80\0\0", b"$HEHDT,88.6,T*19"]
    tagged = b"\\c:1777636800*54\\!AIVDM,1,1,,A,139>Jh@P1QPT<0jO0jO<Wwv00000,0*13"
    assert lines_of(tagged) == [tagged]


def test_two_sentences_of_one_line_are_two() -> None:
    assert [read_sentence(each).format for each in lines_of(PUBLISHED * 3)] == ["GGA"] * 3


def test_a_tag_block_tells_when_a_sentence_was_heard() -> None:
    for text, time in (
        ("c:1767225600", 1_767_225_600.0),
        ("s:st,c:1767225600123", 1_767_225_600.123),
    ):
        block = f"\\{text}*{checksum(text.encode())}\\".encode()
        (line,) = lines_of(block + PUBLISHED)
        assert read_sentence(line).heard == pytest.approx(time)
    assert math.isnan(read_sentence(b"\\c:1767225600*00\\" + PUBLISHED).heard)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("GPGGA,123519,4807.038,N,01131.000,E,0,08,0.9,545.4,M,46.9,M,,", "no fix"),
        ("GPRMC,123519,V,4807.038,N,01131.000,E,1,1,010126,,,N", "not valid"),
        ("GPGGA,126019,4807.038,N,01131.000,E,1", "no clock shows"),
        ("GPGGA,,4807.038,N,01131.000,E,1", "no time"),
        ("GPGGA,123519,4860.038,N,01131.000,E,1", "off the Earth"),
        ("GPGGA,123519,9107.038,N,01131.000,E,1", "off the Earth"),
        ("GPGGA,123519,807.038,N,01131.000,E,1", "no position"),
        ("GPGGA,123519,4807.038,X,01131.000,E,1", "no position"),
        ("GPRMC,123519,A,4807.038,N,01131.000,E,1,1,310226", "no calendar"),
        ("GPRMC,123519,A,4807.038,N,01131.000,E,1,1,2026", "not ddmmyy"),
        ("GPRMC,123519,A,4807.038,N,01131.000,E,-1,1,010126", "negative speed"),
        ("HEHDT,north,T", "not a number"),
        ("HEHDT,nan,T", "not a number"),
        ("HEHDT,1e3,T", "beyond 360"),
        ("GPVTG,10,T,,M,5,N,9,K,N", "not valid"),
        ("GPZDA,120000,,,", "no date"),
    ],
)
def test_contents_that_cannot_be_are_refused(body: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        own_ship_report(read_sentence(with_checksum(body).encode("ascii")))


def test_proprietary_sentences_say_nothing_of_own_ship() -> None:
    assert own_ship_report(read_sentence(with_checksum("PGRME,15.0,M").encode())) is None


def test_others_read_the_same() -> None:
    reader = pytest.importorskip("pynmeagps").NMEAReader
    generator = np.random.default_rng(5)
    for _ in range(200):
        la, lo = generator.uniform(0, 89), generator.uniform(0, 179)
        ns, ew = "NS"[generator.integers(2)], "EW"[generator.integers(2)]
        place = f"{int(la):02d}{60 * (la % 1):08.5f},{ns},{int(lo):03d}{60 * (lo % 1):08.5f},{ew}"
        speed, course = generator.uniform(0, 40), generator.uniform(0, 360)
        line = with_checksum(f"GPRMC,101112.50,A,{place},{speed:.2f},{course:.1f},110526,,,A")
        theirs = reader.parse(f"{line}\r\n")
        ours = own_ship_report(read_sentence(line.encode()))
        assert ours is not None
        assert ours.latitude_deg == pytest.approx(theirs.lat, abs=1e-8)
        assert ours.longitude_deg == pytest.approx(theirs.lon, abs=1e-8)
        assert ours.speed == pytest.approx(theirs.spd * 1852.0 / 3600.0)
        assert ours.course_deg == theirs.cog
        assert (theirs.date - type(theirs.date)(1970, 1, 1)).days == ours.day


@pytest.mark.slow
def test_damaged_lines_are_counted_and_none_crashes() -> None:
    """The same with 100,000 lines has been run."""
    generator = np.random.default_rng(3)
    lines = [line.encode("ascii") for line in log_lines(60)]
    kinds: dict[str, int] = {}
    read = 0
    for _ in range(3000):
        line = bytearray(lines[generator.integers(len(lines))])
        for _ in range(generator.integers(1, 4)):
            match generator.integers(4):
                case 0:
                    line[generator.integers(len(line))] = generator.integers(256)
                case 1:
                    line = line[: max(1, int(generator.integers(len(line))))]
                case 2:
                    line = line[generator.integers(len(line)) :] or line
                case _:
                    place = generator.integers(len(line))
                    line[place:place] = generator.bytes(5)
        for part in lines_of(bytes(line)):
            try:
                sentence = read_sentence(part)
                read += sentence.format in READERS
            except InputError as error:
                kinds[str(error)] = kinds.get(str(error), 0) + 1
    assert {NO_SENTENCE, NO_CHECKSUM, WRONG_CHECKSUM} <= kinds.keys()
    assert len(kinds) < 20 and sum(kinds.values()) > 1000
