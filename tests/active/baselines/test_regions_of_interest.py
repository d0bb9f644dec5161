"""Protects which contacts of successive pings form a region: nearness, chains, each once."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.baselines import regions_of_interest
from sonar_tracking.active.baselines.regions_of_interest import PolarContacts, find_regions

RANGE, AZIMUTH = 10.0, 0.01
"""Errors: a difference of two contacts varies by twice their squares."""


def polar(*contacts: tuple[float, float]) -> PolarContacts:
    """Return contacts at (range, azimuth)."""
    values = np.array(contacts, dtype=float).reshape(-1, 2)
    distance, azimuth = values[:, 0], values[:, 1]
    position = distance[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
    return PolarContacts(position, distance, azimuth)


def regions(*pings: PolarContacts, limit: float = 4.0, detection: float = 0.9) -> list[list[float]]:
    found = find_regions(pings, RANGE, AZIMUTH, limit, detection)
    return np.round(found, 6).tolist()


def at(distance: float, azimuth: float) -> list[float]:
    return np.round([distance * np.cos(azimuth), distance * np.sin(azimuth)], 6).tolist()


@pytest.mark.parametrize(
    ("moved", "turned", "joined"),
    [
        (28.0, 0.0, True),  # (28 / 10)^2 / 2 = 3.92 of 4
        (29.0, 0.0, False),
        (-28.0, 0.0, True),
        (0.0, 0.028, True),
        (0.0, -0.029, False),
        (19.0, 0.02, True),  # 1.805 + 2
        (21.0, 0.02, False),
    ],
)
def test_contacts_are_near_by_their_errors(moved: float, turned: float, joined: bool) -> None:
    first, second = polar((1000.0, 0.5)), polar((1000.0 + moved, 0.5 + turned))
    found = regions(first, second, second)
    assert found == ([at(1000.0 + moved, 0.5 + turned)] if joined else [at(*second_of(second))])


def second_of(contacts: PolarContacts) -> tuple[float, float]:
    return float(contacts.distance[0]), float(contacts.azimuth[0])


def test_more_contacts_than_are_expected_make_a_region_wherever_they_are_missing() -> None:
    """Of three pings more than 2 P_D: two of three at P_D = 0.9, and at P_D = 0.4 one."""
    here, nothing = polar((1000.0, 0.5)), polar()
    assert regions(here, here, here) == [at(1000.0, 0.5)]
    for pings in ((here, here, nothing), (here, nothing, here), (nothing, here, here)):
        assert regions(*pings) == [at(1000.0, 0.5)]
        assert regions(*pings, detection=1.0) == []
    assert regions(here, nothing, nothing) == []
    assert regions(here, nothing, nothing, detection=0.4) == [at(1000.0, 0.5)]


def test_a_region_is_where_its_newest_contact_is_and_chains_go_on_from_there() -> None:
    assert regions(polar((1000.0, 0.5)), polar((1020.0, 0.5)), polar((1040.0, 0.5))) == [
        at(1040.0, 0.5)
    ]


def test_the_nearest_contact_goes_on_and_none_belongs_to_two_regions() -> None:
    first = polar((1000.0, 0.5), (1012.0, 0.5))
    second = polar((1011.0, 0.5), (1001.0, 0.5))
    # Each goes on with the nearer one, in whatever order they are listed.
    assert regions(first, second) == [at(1001.0, 0.5), at(1011.0, 0.5)]
    lone = polar((1006.0, 0.5))
    assert regions(first, lone) == [at(1006.0, 0.5)]
    assert len(regions(polar((1000.0, 0.5), (1500.0, 0.5)), polar((1500.0, 0.5)))) == 1


def test_a_region_is_not_begun_again_from_its_middle() -> None:
    """Its second contact has another free one near it in the third ping."""
    here = polar((1000.0, 0.5))
    assert regions(here, here, polar((1000.0, 0.5), (1010.0, 0.5))) == [at(1000.0, 0.5)]


def test_the_cut_at_180_degrees_is_no_border() -> None:
    assert len(regions(polar((1000.0, np.pi - 0.005)), polar((1000.0, 0.005 - np.pi)))) == 1


@pytest.mark.parametrize("at_once", [1, 3, 256])
def test_portions_change_nothing(at_once: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Against all pairs compared."""
    monkeypatch.setattr(regions_of_interest, "CONTACTS_AT_ONCE", at_once)
    generator = np.random.default_rng(1)
    pings = [
        polar(*zip(generator.uniform(900, 1500, 25), generator.uniform(0, 0.4, 25), strict=True))
        for _ in range(2)
    ]
    along = (pings[1].distance - pings[0].distance[:, None]) / RANGE
    across = (pings[1].azimuth - pings[0].azimuth[:, None]) / AZIMUTH
    near = 0.5 * (along**2 + across**2)
    taken: set[int] = set()
    expected = []
    for row in range(25):
        order = [column for column in np.argsort(near[row]) if near[row, column] < 9.0]
        free = [int(column) for column in order if int(column) not in taken]
        if free:
            taken.add(free[0])
            expected.append(at(pings[1].distance[free[0]], pings[1].azimuth[free[0]]))
    assert len(expected) > 5
    assert regions(*pings, limit=9.0) == expected


@pytest.mark.parametrize(("moved", "joined"), [(7.0, True), (-7.0, True), (9.0, False)])
def test_limits_far_below_one_are_squares_too(moved: float, joined: bool) -> None:
    """0.7 errors apart: 0.245; 0.9: 0.405."""
    here, there = polar((1000.0, 0.5)), polar((1000.0 + moved, 0.5))
    assert bool(regions(here, there, limit=0.32)) == joined


def test_two_pings_are_compared_once_unless_their_errors_differ() -> None:
    position = np.array([[1000.0, 0.0], [0.0, 500.0]])
    first, second = (
        PolarContacts(position, np.array([1000.0 + step, 500.0]), np.array([0.0, 0.5 * np.pi]))
        for step in (0.0, 30.0)
    )
    near = first.near(second, (40.0, 0.01), 9.0)
    assert near == {0: [0], 1: [1]}
    assert first.near(second, (40.0, 0.01), 9.0) is near
    assert first.near(second, (5.0, 0.01), 9.0) == {1: [1]}
    assert first.near(first, (5.0, 0.01), 9.0) == {0: [0], 1: [1]}
