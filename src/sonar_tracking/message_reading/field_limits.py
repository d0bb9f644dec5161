"""What a field of a message can hold at most: beyond it somebody has mistaken a unit, or lies.

Numbers that are finite and absurd overflow somewhere, and sizes that a message sets decide how long
the work takes: both end here, for all nodes. Values of single rows (contacts, bearings, lines) are
judged by the stages, which leave out the row and keep the rest.
"""

from __future__ import annotations

from collections.abc import Mapping

from sonar_tracking.errors import InputError

LIMITS: Mapping[str, tuple[float, str]] = {
    "element_x": (1e5, "m"),
    "element_y": (1e5, "m"),
    "element_z": (1e5, "m"),
    "sound_speed": (1e5, "m/s"),
    "sample_period": (3600.0, "s"),
    "sample_rate": (1e7, "Hz"),
    "center_frequency": (1e7, "Hz"),
    "bandwidth": (1e7, "Hz"),
    "data": (1e15, ""),
    "basis": (1e6, ""),
    "covariance": (1e31, ""),
    "noise_covariance": (1e9, ""),
    "noise_power": (1e31, ""),
    "eigenvalues": (1e35, ""),
    "effective_snapshots": (1e12, ""),
    "time_offsets": (3600.0, "s"),
    "sensor_pose.position": (1e8, "m"),
    "sensor_velocity": (1e4, "m/s"),
    "pose.pose.position": (1e8, "m"),
    "twist.twist.linear": (1e4, "m/s"),
    "twist.twist.angular": (1e3, "rad/s"),
    "ping_interval": (1e6, "s"),
    "minimum_range": (1e8, "m"),
    "maximum_range": (1e8, "m"),
    "minimum_azimuth": (1e3, "rad"),
    "azimuth_width": (1e3, "rad"),
    "range_resolution": (1e8, "m"),
    "azimuth_resolution": (1e3, "rad"),
    "clutter_density": (1e6, "1/m^2"),
    "detection_threshold": (1e12, ""),
    "expected_signal_to_noise_ratio": (1e15, ""),
}
"""Largest magnitude by name of the field, with its unit."""

SIZES: Mapping[str, int] = {
    "element_x": 2048,
    "n_snapshots": 20_000,
    "n_samples": 4_000_000,
    "n_subspaces": 256,
    "range": 12_000,
    "id": 1_000,
    "track_id": 1_000,
    "line_id": 5_000,
    "line_track": 20_000,
    "contributor_track": 20_000,
}
"""Most entries of a column, or value of a count."""

LONGEST_BLOCK = 60.0
"""Of snapshots or samples, s."""


def check_magnitude(where: str, name: str, magnitude: float) -> None:
    """Refuse a number that is too large for a field.

    Parameters
    ----------
    where : str
        Type of the message.
    name : str
        Field; one without a limit may hold anything.
    magnitude : float
        Largest absolute value in it; NaN and infinity are for others to judge.

    Raises
    ------
    InputError
        Naming field, value and limit.
    """
    if name not in LIMITS:
        return
    largest, unit = LIMITS[name]
    if largest < magnitude < float("inf"):
        raise InputError(
            f"{where}.{name} holds {magnitude:.7g} {unit}".rstrip()
            + f", and at most {largest:g} {unit}".rstrip()
            + " makes sense; the sender must check value and unit."
        )


def check_size(where: str, name: str, size: int) -> None:
    """Refuse more entries than there is time for.

    Parameters
    ----------
    where : str
        Type of the message.
    name : str
        Column or count; one without a limit may have any size.
    size : int
        Its number of entries, or its value.

    Raises
    ------
    InputError
        Naming field, size and limit.
    """
    if size > SIZES.get(name, size):
        raise InputError(
            f"{where}.{name} has {size} entries, and at most {SIZES[name]} are taken at once; the "
            "sender must send less in a message."
        )


def check_duration(where: str, duration: float) -> None:
    """Refuse a block that lasts too long.

    Parameters
    ----------
    where : str
        Type of the message.
    duration : float
        s.

    Raises
    ------
    InputError
        Naming duration and limit.
    """
    if duration > LONGEST_BLOCK:
        raise InputError(
            f"{where} holds {duration:.3g} s of data, and at most {LONGEST_BLOCK:g} s are taken at "
            "once; the sender must send shorter blocks."
        )
