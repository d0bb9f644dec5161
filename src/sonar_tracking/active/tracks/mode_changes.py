"""How often targets begin to manoeuvre: counted for each track, and for all of a scene.

A mode that is possible at every ping collects a little probability at every ping, however straight
a target goes: to add that up would be to learn what was assumed. A change counts where it shows,
once: when a mode or a harder one has become more probable than not. It has ended when hardly any
probability is left; until then there is no other one.

What counts for the rate is the time in which a target could have begun: that in calmer modes, at
rest not included. Both are forgotten in the course of time.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray

SHOWS = 0.5
"""Probability from which on a mode or a harder one has been entered."""

HAS_ENDED = 0.1
"""Probability below which it has been left."""

MEMORY = 1800.0
"""Time after which less than half of what was seen counts, s."""


def changes_after(
    probability: FloatArray,
    entered: FloatArray,
    calm: FloatArray,
    shown: BoolArray,
    interval: float,
    static_mode: int | None,
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return what has been seen of targets, another ping and the interval after it included.

    Parameters
    ----------
    probability : ndarray, shape (n, n_modes)
        Of the modes after the ping, the calmest first, pure numbers of sum 1.
    entered : ndarray, shape (n, n_modes)
        How often each mode or a harder one has been entered, pure numbers.
    calm : ndarray, shape (n, n_modes)
        Time spent in moving modes calmer than each, s.
    shown : ndarray of bool, shape (n, n_modes)
        Whether the target was in that mode or a harder one.
    interval : float
        s.
    static_mode : int or None
        In which nothing begins; None = there is none.

    Returns
    -------
    entered, calm : ndarray, shape (n, n_modes)
        Pure numbers and s.
    shown : ndarray of bool, shape (n, n_modes)
        True = is in that mode or a harder one.
    """
    harder = probability[:, ::-1].cumsum(axis=1)[:, ::-1]
    now = harder > np.where(shown, HAS_ENDED, SHOWS)
    kept = np.exp(-interval / MEMORY)
    calmer = 1.0 - harder
    if static_mode is not None:
        calmer = (calmer - probability[:, static_mode, None]).clip(0.0)
    return kept * entered + (now & ~shown), kept * calm + interval * calmer, now


def pooled_changes(entered: FloatArray, calm: FloatArray, confirmed: BoolArray) -> FloatArray:
    """Return what all confirmed targets of a scene have shown together.

    Parameters
    ----------
    entered, calm : ndarray, shape (n, n_modes)
        Of each track, pure numbers and s.
    confirmed : ndarray of bool, shape (n,)
        Which of them exist.

    Returns
    -------
    ndarray, shape (2, n_modes)
        How often each mode was entered, pure numbers; in which time, s.
    """
    return np.stack([entered[confirmed].sum(axis=0), calm[confirmed].sum(axis=0)])
