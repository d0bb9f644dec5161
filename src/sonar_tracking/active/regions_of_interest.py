"""Contacts of successive pings that lie together: where a target may be.

References
----------
Ng, Li, Godsill, Vermaak (2005), as described in Kim, Song (2007): a window of the last pings; a
region of interest is a chain of nearest contacts through it that is longer than P_D times the
window.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.motion import wrap_angle

FloatArray = NDArray[np.float64]

WINDOW = 2
"""Pings before the present one that are looked at."""


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
    taken = [np.zeros(len(contacts.distance), dtype=bool) for contacts in window]
    regions = []
    for first, contacts in enumerate(window):
        for start in range(len(contacts.distance)):
            if taken[first][start]:
                continue
            chain = [(first, start)]
            for later in range(first + 1, len(window)):
                ping, row = chain[-1]
                found = _nearest(
                    window[ping],
                    row,
                    window[later],
                    taken[later],
                    (range_standard_deviation, azimuth_standard_deviation),
                    distance_limit,
                )
                if found >= 0:
                    chain.append((later, found))
            if len(chain) > detection_probability * WINDOW:
                for ping, row in chain:
                    taken[ping][row] = True
                ping, row = chain[-1]
                regions.append(window[ping].position[row])
    return np.array(regions).reshape(-1, 2)


def _nearest(
    contacts: PolarContacts,
    row: int,
    others: PolarContacts,
    taken: NDArray[np.bool_],
    deviations: tuple[float, float],
    limit: float,
) -> int:
    """Return the nearest free contact of another ping within the limit, -1 if there is none."""
    if not len(taken):
        return -1
    along = (others.distance - contacts.distance[row]) / deviations[0]
    across = wrap_angle(others.azimuth - contacts.azimuth[row]) / deviations[1]
    square = np.where(taken, np.inf, 0.5 * (along**2 + across**2))
    best = int(np.argmin(square))
    return best if square[best] < limit else -1
