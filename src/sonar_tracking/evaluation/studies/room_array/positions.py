"""Where the sources of measured responses really are: from the onsets of the responses.

The first arrival at every element comes straight from the source. With t_m the time at which the
response of element m first exceeds half its peak, the source at distance x and place z solves

    min over x, z, t_0 of sum_m rho(t_m - t_0 - sqrt(x^2 + (z - z_m)^2) / c),

rho bounding what a wrong onset can do. This uses the whole band and time alone, neither phases nor
directions, and so measures the positions independently of what is being judged by them. Surveyed
positions are those of a loudspeaker's case, a hand's breadth from where its sound seems to begin.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from sonar_tracking.evaluation.studies.room_array.responses import SOUND_SPEED, RoomResponses
from sonar_tracking.records.arrays import FloatArray

_SHARE_OF_PEAK = 0.5
_OVERSAMPLING = 16
_LONGEST = 1024
"""Samples of a response that are looked at: direct sound arrives in the first 20 ms."""
_OUTLIER = 1e-5
"""Residual beyond which an onset counts less, s."""


def onset_positions(room: RoomResponses, sources: Collection[int] | None = None) -> FloatArray:
    """Return the positions of the sources by the onsets of their responses.

    Parameters
    ----------
    room : RoomResponses
        Measured responses; the surveyed positions are where the search begins.
    sources : collection of int, optional
        Numbers of those that are located; others have their surveyed positions. None = all.

    Returns
    -------
    ndarray, shape (n_sources, 2)
        Distance from the array's line and place along it, m.
    """
    positions = np.array(room.source_positions, dtype=np.float64)
    for index, source in enumerate(room.source_ids):
        if sources is None or source in sources:
            onsets = _onsets(room.responses[index], room.sample_rate)
            positions[index] = _located(onsets, room.element_places, positions[index])
    return positions


def _onsets(responses: FloatArray, sample_rate: int) -> FloatArray:
    """Return the time of the first arrival at each element, s."""
    from scipy.signal import resample  # takes longer to load than any study

    begin = responses[:, :_LONGEST]
    level = np.abs(resample(begin, begin.shape[1] * _OVERSAMPLING, axis=1))
    threshold = _SHARE_OF_PEAK * level.max(axis=1, keepdims=True)
    return (level > threshold).argmax(axis=1) / (_OVERSAMPLING * sample_rate)


def _located(onsets: FloatArray, places: FloatArray, surveyed: FloatArray) -> FloatArray:
    from scipy.optimize import least_squares  # likewise

    def travel(point: FloatArray) -> FloatArray:
        return np.asarray(np.hypot(point[0], places - point[1]) / SOUND_SPEED)

    def residuals(unknowns: FloatArray) -> FloatArray:
        # In units of the expected error; the common delay is counted in milliseconds.
        return (onsets - 1e-3 * unknowns[2] - travel(unknowns[:2])) / _OUTLIER

    delay = 1e3 * float(np.median(onsets - travel(surveyed)))
    fit = least_squares(residuals, [*surveyed, delay], loss="soft_l1")
    return np.abs(fit.x[:2]) * np.array([1.0, np.sign(fit.x[1])])
