"""Contacts of successive pings that lie together: where a target may be.

References
----------
Ng, Li, Godsill, Vermaak (2005), as described in Kim, Song (2007): a window of the last pings; a
region of interest is a chain of nearest contacts through it that is longer than P_D times the
window.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IndexArray

WINDOW = 2
"""Pings before the present one that are looked at."""

CONTACTS_AT_ONCE = 256
"""Compared with all contacts of another ping, so that memory stays bounded."""

_ROUNDING = 1e-9
"""More than the rounding of a difference of azimuths, rad."""


@dataclass(frozen=True)
class PolarContacts:
    """Contacts of one ping in units of their errors.

    Attributes
    ----------
    position : ndarray, shape (n, 2)
        In ``map``, m.
    distance, azimuth : ndarray, shape (n,)
        From the sensor, m and rad.
    """

    position: FloatArray
    distance: FloatArray
    azimuth: FloatArray

    @cached_property
    def wrapped_azimuth(self) -> FloatArray:
        """The same from -pi to pi, shape (n,), rad."""
        return np.asarray(wrap_angle(self.azimuth))

    @cached_property
    def _compared(self) -> dict[tuple[object, ...], tuple[PolarContacts, dict[int, list[int]]]]:
        """Later contacts that these were compared with, and which were near each."""
        return {}

    def near(
        self, others: PolarContacts, deviations: tuple[float, float], limit: float
    ) -> dict[int, list[int]]:
        """Return the contacts of a later ping near each of these, the nearest first; kept.

        Parameters
        ----------
        others : PolarContacts
            Of the later ping.
        deviations : tuple of float
            Of range and azimuth, m and rad.
        limit : float
            Squared distance, in units of the covariance of a difference of two contacts.
        """
        key = (id(others), deviations, limit)
        if key not in self._compared:
            self._compared[key] = others, _near_contacts(self, others, deviations, limit)
        return self._compared[key][1]


def find_regions(
    window: Sequence[PolarContacts],
    range_standard_deviation: float,
    azimuth_standard_deviation: float,
    distance_limit: float,
    detection_probability: float,
) -> FloatArray:
    """Return the newest positions of all regions of interest.

    Parameters
    ----------
    window : sequence of PolarContacts
        Oldest ping first.
    range_standard_deviation, azimuth_standard_deviation : float
        m and rad.
    distance_limit : float
        Squared distance, in units of the covariance of a difference of two contacts.
    detection_probability : float
        P_D.

    Returns
    -------
    ndarray, shape (n, 2)
        m.
    """
    deviations = (range_standard_deviation, azimuth_standard_deviation)
    near = {
        (ping, later): window[ping].near(window[later], deviations, distance_limit)
        for ping in range(len(window))
        for later in range(ping + 1, len(window))
    }
    taken = [[False] * len(contacts.distance) for contacts in window]
    single = detection_probability * WINDOW < 1.0
    regions = []
    for first, contacts in enumerate(window):
        after = [near[first, later] for later in range(first + 1, len(window))]
        # Most contacts have none near them.
        starts = range(len(contacts.distance)) if single else sorted(set().union(*after))
        for start in starts:
            if taken[first][start]:
                continue
            chain = [(first, start)]
            for later in range(first + 1, len(window)):
                ping, row = chain[-1]
                found = near[ping, later].get(row, ())
                free = [contact for contact in found if not taken[later][contact]]
                if free:
                    chain.append((later, free[0]))
            if len(chain) > detection_probability * WINDOW:
                for ping, row in chain:
                    taken[ping][row] = True
                ping, row = chain[-1]
                regions.append(window[ping].position[row])
    return np.array(regions).reshape(-1, 2)


def _near_contacts(
    contacts: PolarContacts,
    others: PolarContacts,
    deviations: tuple[float, float],
    limit: float,
) -> dict[int, list[int]]:
    """Return the contacts of another ping within the limit of each contact, the nearest first."""
    near: dict[int, list[int]] = {}
    azimuth, others_azimuth = contacts.wrapped_azimuth, others.wrapped_azimuth
    reach = 1.001 * np.sqrt(2.0 * limit) * deviations[1] + _ROUNDING
    for rows, columns in _near_in_range(contacts, others, deviations, limit):
        along = (others.distance[columns] - contacts.distance[rows, None]) / deviations[0]
        # Most are apart in azimuth: that is seen before it is computed how far.
        apart = np.abs(others_azimuth[columns] - azimuth[rows, None])
        beside = (apart < reach) | (apart > 2.0 * np.pi - reach)
        row, column = np.nonzero((0.5 * along**2 < limit) & beside)
        turn = others.azimuth[columns[column]] - contacts.azimuth[rows[row]]
        across = wrap_angle(turn) / deviations[1]
        square = 0.5 * (along[row, column] ** 2 + across**2)
        inside = np.flatnonzero(square < limit)
        row, column, square = row[inside], column[inside], square[inside]
        nearest = np.lexsort((square, row))
        pairs = zip(rows[row[nearest]].tolist(), columns[column[nearest]].tolist(), strict=True)
        for contact, other in pairs:
            near.setdefault(contact, []).append(other)
    return near


def _near_in_range(
    contacts: PolarContacts,
    others: PolarContacts,
    deviations: tuple[float, float],
    limit: float,
) -> Iterator[tuple[IndexArray, IndexArray]]:
    """Yield some contacts and those of another ping that may be within the limit of them."""
    if max(len(contacts.distance), len(others.distance)) <= CONTACTS_AT_ONCE:
        yield np.arange(len(contacts.distance)), np.arange(len(others.distance))
        return
    order = np.argsort(contacts.distance, kind="stable")
    others_order = np.argsort(others.distance, kind="stable")
    distances = others.distance[others_order]
    reach = 1.001 * np.sqrt(2.0 * limit) * deviations[0]
    for first in range(0, len(order), CONTACTS_AT_ONCE):
        rows = order[first : first + CONTACTS_AT_ONCE]
        low = np.searchsorted(distances, contacts.distance[rows[0]] - reach)
        high = np.searchsorted(distances, contacts.distance[rows[-1]] + reach)
        yield rows, np.sort(others_order[low:high])
