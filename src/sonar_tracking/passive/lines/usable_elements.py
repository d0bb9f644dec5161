"""Which elements of an array a beam may use, from the spectra of one frame.

Far away sources and ambient noise reach all elements about equally loud, so that an element is
silent when it is 30 dB below the median of the array and faulty when it is 20 dB above it. Its
power is the median over the bins, which lines do not change. When more than half of the elements
are bad all are used: the fault is likely to be elsewhere.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.passive.subspaces.channel_monitor import LOUD_RATIO, SILENT_RATIO
from sonar_tracking.records.arrays import BoolArray, ComplexArray


def usable_elements(spectra: ComplexArray) -> BoolArray:
    """Return which elements can be used.

    Parameters
    ----------
    spectra : ndarray, shape (n_bins, n_elements), complex
        Of the elements, linear amplitude.

    Returns
    -------
    ndarray of bool, shape (n_elements,)
        True where an element can be used.
    """
    power = np.median(spectra.real**2 + spectra.imag**2, axis=0)
    heard = power > 0.0
    median = float(np.median(power[heard])) if heard.any() else 0.0
    good = heard & (power >= SILENT_RATIO * median) & (power <= LOUD_RATIO * median)
    return good if 2 * np.count_nonzero(good) > len(good) else np.ones_like(good)


def element_notices(used: BoolArray, before: BoolArray) -> tuple[Notice, ...]:
    """Return a notice for each element that is left out from now on.

    Parameters
    ----------
    used, before : ndarray of bool, shape (n_elements,)
        Elements used now and in the frame before.
    """
    return tuple(
        Notice(
            Severity.WARN,
            f"element {element}",
            f"Element {element} is silent, or far louder than the median of the array (elements "
            "count from 0); check its cable and its gain. No beam uses it until it is good again.",
        )
        for element in np.flatnonzero(before & ~used).tolist()
    )
