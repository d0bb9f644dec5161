"""The time a recorder writes into the name of a file is the begin of the file."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path

import pytest

from sonar_tracking.bags.audio.broadcast_extension import broadcast_origin
from sonar_tracking.bags.audio.start_times import start_in_name
from sonar_tracking.errors import ConfigurationError

NOON = int(datetime(2022, 1, 1, 12, 30, tzinfo=timezone.utc).timestamp()) * 10**9
RATE = 48_000


@pytest.mark.parametrize(
    ("name", "rest"),
    [
        ("5146.220101123000", "5146.*"),
        ("20220101_123000", "*"),
        ("SM4_20220101_123000", "SM4_*"),
        ("SBW1234_20220101_123000", "SBW1234_*"),
        ("SITE_220101_123000.x", "SITE_*.x"),
        ("AMAR173.4.20220101T123000Z", "AMAR173.4.*"),
        ("20220101T123000_5146_2.0dB", "*_5146_2.0dB"),
        ("OO-HYVM2--YDH-2022-01-01T12:30:00.000000", "OO-HYVM2--YDH-*"),
        ("2022-01-01_12-30-00", "*"),
        ("61D04948", ""),
    ],
)
def test_names_of_usual_recorders(name: str, rest: str) -> None:
    found = start_in_name(name)
    assert found is not None
    assert (found.instant, found.rest) == (NOON, rest)


def test_fractions_count() -> None:
    found = start_in_name("PAM_20220101_123000_250")
    assert found is not None
    assert (found.instant, found.resolution) == (NOON + 250_000_000, 1e-3)


@pytest.mark.parametrize("name", ["recording", "take_12", "20220101", "20221301_123000", "1234567"])
def test_names_without_a_time(name: str) -> None:
    assert start_in_name(name) is None


def test_a_pattern_finds_the_time_anywhere() -> None:
    found = start_in_name("buoy7 01Jan22 12h30 x", "%d%b%y %Hh%M")
    assert found is not None
    assert (found.instant, found.rest) == (NOON, "buoy7 * x")
    offset = start_in_name("2022-01-01T14:30:00+0200", "%Y-%m-%dT%H:%M:%S%z")
    assert offset is not None and offset.instant == NOON
    assert start_in_name("no time", "%Y%m%d") is None


@pytest.mark.parametrize(
    ("pattern", "reason"), [("%H%M%S", "no whole date"), ("%Y%m%d%Q", "%Q is not known")]
)
def test_a_pattern_that_is_none(pattern: str, reason: str) -> None:
    with pytest.raises(ConfigurationError, match=reason):
        start_in_name("20220101", pattern)


def bext(date: str, clock: str, reference: int) -> bytes:
    return bytes(320) + f"{date}{clock}".encode() + reference.to_bytes(8, "little") + bytes(256)


def test_the_broadcast_extension_tells_the_begin() -> None:
    path = Path("a.wav")
    half_past = int((12.5 * 3600 + 0.25) * RATE)
    plain = broadcast_origin(path, bext("2022-01-01", "12:30:00", 0), RATE)
    assert plain is not None and plain.instant == NOON
    fine = broadcast_origin(path, bext("2022-01-01", "12:30:00", half_past), RATE)
    assert fine is not None and fine.instant == NOON + 250_000_000 and not fine.doubt
    other = broadcast_origin(path, bext("2022-01-01", "12:30:00", 100 * RATE), RATE)
    assert other is not None and other.instant == NOON
    assert "100 s as time since midnight" in other.doubt
    assert broadcast_origin(path, bext("0000-00-00", "00:00:00", 0), RATE) is None
    assert broadcast_origin(path, b"short", RATE) is None
