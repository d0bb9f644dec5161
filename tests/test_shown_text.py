"""Texts of messages cannot forge what a terminal or a log shows."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sonar_tracking.errors import LONGEST_TEXT, InputError, shown
from sonar_tracking.tma.targets.bearing_observations import left_out


@given(st.text())
def test_what_is_shown_is_printable_and_short(text: str) -> None:
    assert shown(text).isprintable()
    assert len(shown(text)) <= 10 * LONGEST_TEXT + 3


@given(st.text(st.characters(categories=["L", "N", "P"]), max_size=LONGEST_TEXT))
def test_ordinary_names_are_as_they_are(text: str) -> None:
    assert shown(text) == text


@pytest.mark.parametrize("text", ["\x1b[2Kfailed: all", "bow\nfailed: all", "\u202ewob", "\x9b2J"])
def test_a_sensor_forges_no_line(text: str) -> None:
    assert left_out(text, "a line is doubtful").text.isprintable()


def test_a_long_name_does_not_fill_the_log() -> None:
    sentence = str(InputError(f"observation of {shown('x' * 10**6)} is late."))
    assert len(sentence) < 100 and "..." in sentence
