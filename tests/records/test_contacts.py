"""The record of a ping: chosen contacts keep all their columns, and the ping its description."""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.contacts import Contacts

KEEP = np.array([True, False, True])


def three_contacts(**changes: object) -> Contacts:
    values: dict[str, object] = {
        "stamp": 7,
        "range": np.array([100.0, 200.0, 300.0]),
        "azimuth": np.array([0.1, 0.2, 0.3]),
        "amplitude": np.array([5.0, 6.0, 7.0]),
        "range_standard_deviation": np.array([1.0, 2.0, 3.0]),
        "azimuth_standard_deviation": 0.01,
        "detection_threshold": 4.0,
    }
    return Contacts(**{**values, **changes})  # type: ignore[arg-type]


def test_chosen_contacts_keep_their_columns() -> None:
    chosen = three_contacts().selected(KEEP)
    assert chosen.range.tolist() == [100.0, 300.0]
    assert chosen.azimuth.tolist() == [0.1, 0.3]
    assert chosen.amplitude.tolist() == [5.0, 7.0]
    assert np.asarray(chosen.range_standard_deviation).tolist() == [1.0, 3.0]
    assert (chosen.azimuth_standard_deviation, chosen.detection_threshold) == (0.01, 4.0)
    assert chosen.stamp == 7


def test_what_was_not_measured_stays_so() -> None:
    assert three_contacts(amplitude=np.zeros(0)).selected(KEEP).amplitude.size == 0
