"""What a user is told of an array that is not as it is described."""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.passive.array_fit.array_fit import MOST_WHITENED, ArrayFit
from sonar_tracking.passive.array_fit.element_faults import Fault
from sonar_tracking.records.arrays import FloatArray, IntArray


def fit_notices(fit: ArrayFit, positions: FloatArray, elements: IntArray) -> list[Notice]:
    """Return what a user should know of the array.

    Parameters
    ----------
    fit : ArrayFit
        What the data have told.
    positions : ndarray, shape (n_elements, 3)
        Positions of the elements in use, m.
    elements : ndarray of int, shape (n_elements,)
        Their numbers in the whole array.
    """
    notices = [_fault_notice(fault) for fault in fit.faults.found]
    if fit.faults.votes:
        notices.append(_suspicion(fit.faults.suspected))
    elif not fit.steering.fits:
        notices.append(_no_fit())
    if fit.steering.error:
        notices.append(_error_notice(fit, elements))
    if fit.colour.coloured:
        whitened = len(positions) <= MOST_WHITENED
        notices.append(_noise_notice(fit.largest_correlation(positions), whitened))
    return notices


def _what(fault: Fault) -> str:
    if len(fault) == 1:
        return f"Element {fault[0]} looks inverted"
    return f"Channels {fault[0]} and {fault[1]} look exchanged"


def _fault_notice(fault: Fault) -> Notice:
    remedy = "it is used with the opposite sign" if len(fault) == 1 else "they are used so"
    text = (
        f"{_what(fault)} (they count from 0): the strongest sources fit the array only with that "
        f"undone, and {remedy}. Check the wiring and the order of the channels."
    )
    return Notice(Severity.WARN, f"fault {'-'.join(map(str, fault))}", text)


def _suspicion(fault: Fault) -> Notice:
    text = f"{_what(fault)} (they count from 0); the next snapshots will tell."
    return Notice(Severity.WARN, "array", text)


def _no_fit() -> Notice:
    return Notice(
        Severity.WARN,
        "array",
        "No plane wave fits the strongest source: bearings may be wrong and tracks false. Check "
        "the element positions, the order and the signs of the channels, the frequency and the "
        "sound speed.",
    )


def _error_notice(fit: ArrayFit, elements: IntArray) -> Notice:
    errors = fit.steering.of_elements
    worst = ""
    if len(errors) == len(elements):
        worst = f"; element {int(elements[np.argmax(errors)])} fits worst"
    return Notice(
        Severity.WARN,
        "calibration",
        f"The strongest sources fit the steering vectors within {100.0 * fit.steering.error:.0f} % "
        f"only (rms error of gain and phase{worst}): the array is not calibrated, or there are "
        "echoes. What such sources bring beside their own is taken for noise; calibrate the "
        "array, or state steering_error.",
    )


def _noise_notice(largest: float, whitened: bool) -> Notice:
    used = "is estimated from the data and used; give noise_covariance with the snapshots if it is"
    unused = f"is not used for more than {MOST_WHITENED} elements, and tracks may be false; give it"
    return Notice(
        Severity.WARN,
        "noise",
        f"The noise is not white: correlated between elements by up to {largest:.2f}. Its "
        f"covariance {used + ' known' if whitened else unused + ' in noise_covariance'}.",
    )
