"""Protects which elements a beam uses: 30 dB below to 20 dB above the median of the array."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.lines.usable_elements import element_notices, usable_elements
from sonar_tracking.records.arrays import ComplexArray


def spectra(*powers: float) -> ComplexArray:
    """Return 9 bins of elements with these powers, the phases of which differ."""
    phases = np.exp(1j * np.arange(9.0))[:, None]
    return np.asarray(phases * np.sqrt(np.array(powers)))


@pytest.mark.parametrize(
    ("power", "used"),
    [(1.01e-3, True), (0.99e-3, False), (99.0, True), (101.0, False), (0.0, False)],
)
def test_an_element_is_compared_with_the_median_of_those_that_hear(
    power: float, used: bool
) -> None:
    assert usable_elements(spectra(1.0, power, 1.0, 1.0, 0.0)).tolist() == [
        True,
        used,
        True,
        True,
        False,
    ]


def test_a_line_in_one_bin_is_no_fault() -> None:
    strong = spectra(1.0, 1.0, 1.0)
    strong[4, 1] *= 1e6
    assert usable_elements(strong).all()
    strong[:5, 1] *= 1e6  # most of its bins
    assert usable_elements(strong).tolist() == [True, False, True]


def test_when_half_of_the_elements_are_bad_all_are_used() -> None:
    assert usable_elements(spectra(1.0, 1.0, 1.0, 0.0, 0.0)).sum() == 3
    assert usable_elements(spectra(1.0, 1.0, 0.0, 0.0)).all()
    assert usable_elements(spectra(0.0, 0.0)).all()


def test_only_what_becomes_bad_is_named() -> None:
    before, used = np.array([True, False, True, True]), np.array([True, False, False, True])
    (notice,) = element_notices(used, before)
    assert notice.culprit == "element 2"
    assert notice.text.startswith("Element 2 is silent")
    assert element_notices(before, used) == ()
