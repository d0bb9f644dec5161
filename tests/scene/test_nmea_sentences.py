"""Protects the sentences for chart plotters: as computed by hand, as others read them, and few."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.scene.nmea_format import KNOT, NAUTICAL_MILE, with_checksum
from sonar_tracking.scene.nmea_sentences import TrackSentences, tll_sentence, ttm_sentence

BEGIN = 1_767_225_600 * NANOSECONDS + 45_296 * NANOSECONDS
"""2026-01-01T12:34:56Z, ns."""

OWN_SHIP = OwnShipState(BEGIN, (0.0, 0.0), math.pi / 2, (10.0 * KNOT, 0.0), 0.0)
"""Goes north with 10 kn."""


def picture(time: float, ids: list[int], status: int = TrackStatus.CONFIRMED) -> PositionTracks:
    """Return ships one nautical mile east of the origin that go west with 10 kn."""
    state = np.tile([NAUTICAL_MILE, 0.0, -10.0 * KNOT, 0.0], (len(ids), 1))
    return PositionTracks(
        stamp=BEGIN + round(time * NANOSECONDS),
        id=np.array(ids, np.uint64),
        status=np.full(len(ids), status, np.uint8),
        source=np.full(len(ids), TrackSource.FUSED, np.uint8),
        state=state,
    )


def body(sentence: str) -> str:
    """Return what stands between ``$`` and ``*``, where the checksum fits."""
    inside = sentence[1:].partition("*")[0]
    assert with_checksum(inside) == sentence
    return inside


def test_the_checksum_is_that_of_a_published_sentence() -> None:
    published = "GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,"
    assert with_checksum(published) == f"${published}*47"


def test_a_place_is_in_degrees_and_minutes() -> None:
    sentence = tll_sentence(7, -33.5, 151.2583, "T12", BEGIN + 340_000_000, False)
    assert body(sentence) == "RATLL,07,3330.0000,S,15115.4980,E,T12,123456.34,T,"


def test_minutes_are_never_sixty() -> None:
    sentence = tll_sentence(1, 53.999999999, -0.999999999, "T1", BEGIN, True)
    assert body(sentence) == "RATLL,01,5400.0000,N,00100.0000,W,T1,123456.00,Q,"


def test_a_ship_that_closes_at_right_angles_passes_where_geometry_says() -> None:
    (sentence,) = TrackSentences().of_picture(picture(0.0, [12]), OWN_SHIP)
    # Relative to own ship it goes 10 kn west and 10 kn south: closest after 3 minutes, and then
    # half a mile east and half a mile south, 0.71 miles away.
    expected = "RATTM,01,1.00,90.0,T,10.0,270.0,T,0.71,3.00,N,T12,T,,123456.00,A"
    assert body(sentence) == expected


def test_without_relative_motion_there_is_no_closest_approach() -> None:
    sentence = ttm_sentence(1, (0.0, 1852.0, 0.0, 0.0), (0.0, 0.0), "T1", BEGIN, False)
    assert body(sentence).split(",")[8:10] == ["", ""]


def test_a_track_is_told_once_in_two_seconds_at_most() -> None:
    sentences = TrackSentences()
    told = [len(sentences.of_picture(picture(0.5 * n, [3]), OWN_SHIP)) for n in range(9)]
    assert told == [1, 0, 0, 0, 1, 0, 0, 0, 1]


def test_a_track_keeps_its_number_and_a_free_one_is_given_again() -> None:
    sentences = TrackSentences()
    pictures = [picture(0.0, [30, 40]), picture(2.0, [40]), picture(4.0, [40, 50])]
    numbers = [
        [body(text).split(",")[1] for text in sentences.of_picture(one, OWN_SHIP)]
        for one in pictures
    ]
    assert numbers == [["01", "02"], ["02"], ["02", "01"]]


def test_more_tracks_than_numbers_are_counted() -> None:
    sentences = TrackSentences()
    assert len(sentences.of_picture(picture(0.0, list(range(1, 121))), OWN_SHIP)) == 99
    assert sentences.unnumbered == 21


def test_tentative_tracks_are_not_told_and_coasted_ones_are_lost() -> None:
    tentative = picture(0.0, [1], TrackStatus.TENTATIVE)
    assert not TrackSentences().of_picture(tentative, OWN_SHIP)
    coasted = picture(0.0, [1], TrackStatus.COASTED)
    (sentence,) = TrackSentences().of_picture(coasted, OWN_SHIP)
    assert body(sentence).split(",")[12] == "Q"


def test_without_own_ship_a_datum_gives_places() -> None:
    (sentence,) = TrackSentences(Datum(0.0, 10.0)).of_picture(picture(0.0, [5]), None)
    # On the equator 1852 m are 1852 / (2 pi 6378137 / 21600) = 0.9982 minutes.
    assert body(sentence).split(",")[:6] == ["RATLL", "01", "0000.0000", "N", "01000.9982", "E"]
    assert not TrackSentences().of_picture(picture(0.0, [5]), None)


def test_others_read_the_sentences_as_they_are_meant() -> None:
    reader = pytest.importorskip("pynmeagps").NMEAReader
    ttm, tll = TrackSentences(Datum(54.18, 7.89)).of_picture(picture(0.0, [12]), OWN_SHIP)
    read = reader.parse(f"{ttm}\r\n")
    assert (read.targetnum, read.targetdist, read.targetbearing) == (1, 1.0, 90.0)
    assert (read.targetspeed, read.targetcourse, read.timetoCPA) == (10.0, 270.0, 3.0)
    place = reader.parse(f"{tll}\r\n")
    # A minute of longitude is 1855.3 m at the equator, and its cosine at 54.18 degrees.
    minutes = 1852.0 / (1855.3 * math.cos(math.radians(54.18)))
    assert place.targetlat == pytest.approx(54.18, abs=1e-5)
    assert place.targetlon == pytest.approx(7.89 + minutes / 60.0, abs=1e-4)
