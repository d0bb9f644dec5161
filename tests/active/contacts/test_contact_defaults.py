"""Protects that each parameter fills in its own unknown, in the unit of the record."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_defaults import (
    ContactDefaultsConfiguration,
    with_defaults,
)
from sonar_tracking.records.contacts import Contacts

SILENT = Contacts(
    stamp=1,
    range=np.array([1000.0, 2000.0]),
    azimuth=np.array([0.1, 0.2]),
    amplitude=np.zeros(0),
    range_standard_deviation=np.nan,
    azimuth_standard_deviation=np.nan,
)


@pytest.mark.parametrize(
    "parameter", [field.name for field in fields(ContactDefaultsConfiguration)]
)
def test_each_parameter_fills_in_its_own_unknown(parameter: str) -> None:
    filled = with_defaults(SILENT, ContactDefaultsConfiguration(**{parameter: 0.25}))
    name = parameter.removesuffix("_deg")
    expected = np.radians(0.25) if parameter.endswith("_deg") else 0.25
    assert getattr(filled, name) == pytest.approx(expected)
    assert replace(filled, **{name: np.nan}) == SILENT  # type: ignore[arg-type]


def test_what_is_told_of_some_contacts_is_not_overwritten() -> None:
    told = replace(SILENT, range_standard_deviation=np.array([np.nan, 5.0]))
    defaults = ContactDefaultsConfiguration(range_standard_deviation=30.0)
    assert with_defaults(told, defaults) is told
    untold = replace(SILENT, range_standard_deviation=np.full(2, np.nan))
    assert with_defaults(untold, defaults).range_standard_deviation == 30.0
