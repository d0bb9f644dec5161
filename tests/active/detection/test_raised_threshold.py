"""Protects that a raised threshold keeps what a detector with that threshold would have given."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.detection.detection_threshold import detection_probability
from sonar_tracking.active.detection.raised_threshold import with_raised_threshold
from sonar_tracking.errors import InputError
from sonar_tracking.records.contacts import Contacts

RATIO = 19.0


def contacts(**changes: object) -> Contacts:
    values: dict[str, object] = {
        "stamp": 1,
        "range": np.array([100.0, 200.0, 300.0]),
        "azimuth": np.array([0.1, 0.2, 0.3]),
        "amplitude": np.array([7.0, 4.7, 4.5]),
        "range_standard_deviation": np.array([1.0, 2.0, 3.0]),
        "azimuth_standard_deviation": 0.01,
        "detection_probability": float(detection_probability(0.1, RATIO)),
        "false_alarm_probability": 0.1,
        "clutter_density": 1e-4,
    }
    return Contacts(**{**values, **changes})  # type: ignore[arg-type]


def test_contacts_above_the_threshold_stay_with_all_their_columns() -> None:
    raised = with_raised_threshold(contacts(), 0.01)  # -ln 0.01 = 4.605
    assert raised.range.tolist() == [100.0, 200.0]
    assert raised.azimuth.tolist() == [0.1, 0.2]
    assert raised.amplitude.tolist() == [7.0, 4.7]
    assert np.asarray(raised.range_standard_deviation).tolist() == [1.0, 2.0]
    assert raised.azimuth_standard_deviation == 0.01


def test_detection_and_clutter_are_those_of_the_new_threshold() -> None:
    raised = with_raised_threshold(contacts(), 0.01)
    assert raised.detection_threshold == pytest.approx(4.60517, abs=1e-5)
    assert raised.detection_probability == pytest.approx(detection_probability(0.01, RATIO))
    assert raised.clutter_density == pytest.approx(1e-5)
    assert raised.false_alarm_probability == 0.01


def test_what_is_not_known_stays_unknown() -> None:
    raised = with_raised_threshold(
        contacts(detection_probability=np.nan, clutter_density=np.nan), 0.01
    )
    assert np.isnan(raised.detection_probability) and np.isnan(raised.clutter_density)


def test_a_lower_threshold_changes_nothing() -> None:
    before = contacts()
    assert with_raised_threshold(before, 0.2) is before


@pytest.mark.parametrize(
    ("changes", "wanted", "sentence"),
    [
        ({"amplitude": np.zeros(0)}, 0.01, "no amplitudes"),
        ({"false_alarm_probability": np.nan}, 0.01, "nan and 0.01 is wanted"),
        ({}, 0.0, "0.1 and 0 is wanted"),
        ({}, np.nan, "0.1 and nan is wanted"),
    ],
)
def test_what_does_not_tell_its_threshold_is_refused(
    changes: dict[str, object], wanted: float, sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        with_raised_threshold(contacts(**changes), wanted)
