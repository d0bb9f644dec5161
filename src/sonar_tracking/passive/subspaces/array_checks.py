"""Is an array one that bearings can be computed for: what grids and narrowband phases rest on."""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import aperture
from sonar_tracking.records.arrays import FloatArray

SMALLEST_APERTURE, LARGEST_APERTURE = 1e-4, 600.0
"""Wavelengths; grids of bearings grow with them."""


def check_array(positions: FloatArray, center_frequency: float, sound_speed: float) -> None:
    """Refuse an array or a wave that is none, and one that no grid can resolve.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    center_frequency : float
        Hz.
    sound_speed : float
        m/s.

    Raises
    ------
    InputError
        Naming what is wrong.
    """
    for name, value in (("center_frequency", center_frequency), ("sound_speed", sound_speed)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{name} is {value:g}; it must be above zero.")
    if not np.isfinite(positions).all():
        raise InputError("An element position is not a finite number; give all positions in m.")
    length = aperture(positions)
    wavelengths = length * center_frequency / sound_speed
    if not SMALLEST_APERTURE <= wavelengths <= LARGEST_APERTURE:
        raise InputError(
            f"The array is {length:g} m long, {wavelengths:.3g} wavelengths at "
            f"{center_frequency:g} Hz and {sound_speed:g} m/s; {SMALLEST_APERTURE:g} to "
            f"{LARGEST_APERTURE:g} can be searched for bearings. Check the units of positions, "
            "frequency and sound speed."
        )
