"""Whether an array can give bearings in a band: refused before a recording is imported for it.

The usual causes are named: positions in millimetres, the sound speed of air, an array that hangs.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.bags.importers.array_geometry_file import RecordedArray
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.geometry import has_grating_lobes, largest_spacing, wavenumber
from sonar_tracking.passive.subspaces.array_checks import check_array

WATER_SPEEDS = (1400.0, 1600.0)
AIR_SPEEDS = (310.0, 360.0)
"""Sound speeds that occur, m/s."""

_VERTICAL = (
    "the array is vertical: all elements have the same x and y, so that all bearings sound alike. "
    "Give element_x and element_y of an array that extends horizontally, or check whether x and z "
    "are exchanged."
)
_TYPICAL_WATER = 1500.0
_WIDE = 30.0
"""Spacing beyond which an array hears no bearing but of the lowest tones, m."""
_PLAUSIBLE = 0.02
"""Least spacing in wavelengths of an array that was made for bearings."""


def check_bearings(array: RecordedArray, frequency: float, where: str) -> list[str]:
    """Refuse an array that has no bearing at a frequency; return what is to be noted.

    Parameters
    ----------
    array : RecordedArray
        The array.
    frequency : float
        Centre of the band bearings are made of, Hz.
    where : str
        The geometry file, named in errors.

    Returns
    -------
    list of str
        A sentence for each thing that is assumed or unusual.

    Raises
    ------
    ConfigurationError
        If it is vertical, or bearings alias, or it is too long or too short.
    """
    positions = array.element_positions
    if _is_vertical(array):
        raise ConfigurationError(f"{where}: {_VERTICAL}")
    try:
        check_array(positions, frequency, array.sound_speed)
    except InputError as error:
        raise ConfigurationError(f"{where}: {error}{_likely_cause(array, frequency)}") from error
    if has_grating_lobes(positions, wavenumber(frequency, array.sound_speed)):
        spacing = largest_spacing(positions)
        half = 0.5 * array.sound_speed / frequency
        highest = highest_frequency(array)
        raise ConfigurationError(
            f"{where}: the elements are {spacing:.4g} m apart, more than half a wavelength "
            f"({half:.4g} m at {frequency:g} Hz), so that bearings alias. Give a frequency up to "
            f"{highest:.4g} Hz.{_likely_cause(array, frequency)}"
        )
    return _notes(array, where)


def highest_frequency(array: RecordedArray) -> float:
    """Return the frequency up to which bearings do not alias, Hz."""
    return 0.5 * array.sound_speed / largest_spacing(array.element_positions)


def doubts_of_geometry(array: RecordedArray, where: str) -> list[str]:
    """Return what is wrong with an array at any frequency, in sentences.

    Parameters
    ----------
    array : RecordedArray
        The array.
    where : str
        The geometry file, named in sentences.
    """
    if _is_vertical(array):
        return [f"{where}: {_VERTICAL}"]
    spacing = largest_spacing(array.element_positions)
    if spacing < _WIDE:
        return _notes(array, where)
    return [
        f"{where}: the elements are {spacing:g} m apart, so that bearings alias above "
        f"{highest_frequency(array):.3g} Hz. If these are millimetres, give metres.",
        *_notes(array, where),
    ]


def _is_vertical(array: RecordedArray) -> bool:
    across = float(np.ptp(array.element_positions[:, :2], axis=0).max())
    return across <= 1e-6 * array.aperture


def _likely_cause(array: RecordedArray, frequency: float) -> str:
    """Return a sentence if another unit or sound speed would do, else nothing."""
    spacing = largest_spacing(array.element_positions)
    wavelength = array.sound_speed / frequency
    metres = 1e-3 * spacing
    if _PLAUSIBLE <= metres / wavelength <= 0.5 and spacing >= 1.0:
        return f" Positions look like millimetres: {spacing:g} mm are {metres:g} m; give metres."
    slow = array.sound_speed < WATER_SPEEDS[0]
    if slow and _PLAUSIBLE <= spacing * frequency / _TYPICAL_WATER <= 0.5:
        return (
            f" sound_speed is {array.sound_speed:g} m/s, that of air or less; in water it is about "
            f"{_TYPICAL_WATER:g} m/s, at which they do not alias."
        )
    return ""


def _notes(array: RecordedArray, where: str) -> list[str]:
    speed = array.sound_speed
    if not array.sound_speed_is_given:
        return [f"{where} gives no sound_speed: {speed:g} m/s is assumed, as in water."]
    if any(low <= speed <= high for low, high in (WATER_SPEEDS, AIR_SPEEDS)):
        return []
    return [
        f"{where}: sound_speed is {speed:g} m/s; in water it is {WATER_SPEEDS[0]:g} to "
        f"{WATER_SPEEDS[1]:g} m/s, in air about 340 m/s: bearings are wrong by its error."
    ]
