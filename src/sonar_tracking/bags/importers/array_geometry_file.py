"""Geometry of a recorded array: where the elements are and which channel each one is on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.configuration import from_mapping, parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.geometry import aperture, line_array
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH
from sonar_tracking.simulation.scenarios.scenario_file import read_yaml_mapping
from sonar_tracking.simulation.scenarios.scenario_mapping import checked_epoch


@dataclass(frozen=True)
class _Entries:
    """What a geometry file may say, apart from its epoch."""

    sensor_id: str = parameter("array", "name of the sensor in the messages")
    n_elements: int = parameter(0, "number of elements of a line array", minimum=0, maximum=65536)
    spacing: float = parameter(0.0, "between neighbours of a line array", unit="m", minimum=0.0)
    element_x: tuple[float, ...] = parameter((), "element coordinates", unit="m")
    element_y: tuple[float, ...] = parameter((), "element coordinates; empty = 0", unit="m")
    element_z: tuple[float, ...] = parameter((), "element coordinates; empty = 0", unit="m")
    channels: tuple[float, ...] = parameter(
        (), "channel of each element, numbered from 1; empty = channel 1, 2, ... in this order"
    )
    sound_speed: float = parameter(1500.0, "in the water", unit="m/s", minimum=1.0, maximum=1e5)
    mounting_x: float = parameter(0.0, "array ahead of own ship's reference", unit="m")
    mounting_y: float = parameter(0.0, "array to port of it", unit="m")
    mounting_yaw_deg: float = parameter(
        0.0, "direction of the array axis, anticlockwise from the bow", unit="deg"
    )


@dataclass(frozen=True)
class RecordedArray:
    """An array whose channels were recorded.

    Attributes
    ----------
    sensor_id : str
        Name of the sensor in the messages.
    element_positions : ndarray, shape (n_elements, 3)
        In the frame of the array (x from the first element to the last), m.
    channels : tuple of int
        Channel of each element, numbered from 1; empty = in this order, one for each.
    sound_speed : float
        m/s.
    epoch : int
        Instant of the first sample, ns.
    epoch_is_given, sound_speed_is_given : bool
        Whether the file says them, or they are assumed.
    mounting : tuple of float
        Origin of the array ahead of and to port of own ship's reference, m.
    mounting_yaw : float
        Direction of the array axis, anticlockwise from own ship's bow, rad.
    """

    sensor_id: str
    element_positions: FloatArray
    channels: tuple[int, ...]
    sound_speed: float
    epoch: int = DEFAULT_EPOCH
    mounting: tuple[float, float] = (0.0, 0.0)
    mounting_yaw: float = 0.0
    epoch_is_given: bool = True
    sound_speed_is_given: bool = True

    @property
    def aperture(self) -> float:
        """Largest distance between two elements, m."""
        return float(aperture(self.element_positions))

    def columns(self, n_channels: int, where: str) -> list[int]:
        """Return the column of each element in samples of ``n_channels`` channels.

        Raises
        ------
        ConfigurationError
            If there are fewer channels than the map needs, or they cannot be told apart.
        """
        n_elements = len(self.element_positions)
        if not self.channels:
            if n_channels != n_elements:
                raise ConfigurationError(
                    f"{where} has {n_channels} channels, the array has {n_elements} elements; say "
                    "in the geometry file which channel each element is on (channels: [1, 2, ...])."
                )
            return list(range(n_elements))
        if max(self.channels) > n_channels:
            raise ConfigurationError(
                f"The geometry file puts an element on channel {max(self.channels)}, but {where} "
                f"has {n_channels} channels; they are numbered from 1."
            )
        return [channel - 1 for channel in self.channels]


def read_array_geometry(path: Path | str) -> RecordedArray:
    """Read a geometry file.

    The YAML holds ``n_elements`` and ``spacing`` of a line array, or ``element_x`` (``element_y``,
    ``element_z``); and, all optional, ``channels``, ``sound_speed``, ``sensor_id``, ``epoch``,
    ``mounting_x``, ``mounting_y``, ``mounting_yaw_deg``.

    Raises
    ------
    ConfigurationError
        If it cannot be read, or does not describe an array.
    """
    return array_from_mapping(read_yaml_mapping(Path(path)), str(path))


def array_from_mapping(mapping: Mapping[str, Any], where: str) -> RecordedArray:
    """Make a recorded array from names and values; see :func:`read_array_geometry`.

    Raises
    ------
    ConfigurationError
        Naming ``where`` and what is wrong.
    """
    values = dict(mapping)
    prefix = f"{where}: "
    epoch = checked_epoch(values.pop("epoch", DEFAULT_EPOCH // 1_000_000_000), prefix)
    entries = from_mapping(_Entries, values, where)
    positions = _positions(entries, prefix)
    _check_channels(entries.channels, len(positions), prefix)
    channels = tuple(int(channel) for channel in entries.channels)
    return RecordedArray(
        sensor_id=entries.sensor_id,
        element_positions=positions,
        channels=channels,
        sound_speed=entries.sound_speed,
        epoch=epoch,
        mounting=(entries.mounting_x, entries.mounting_y),
        mounting_yaw=float(np.radians(entries.mounting_yaw_deg)),
        epoch_is_given="epoch" in mapping,
        sound_speed_is_given="sound_speed" in mapping,
    )


def _positions(entries: _Entries, prefix: str) -> FloatArray:
    if not entries.element_x:
        if entries.n_elements < 2 or entries.spacing <= 0.0:
            raise ConfigurationError(
                f"{prefix}the elements are not placed; give n_elements (2 or more) and spacing "
                "(m), or element_x."
            )
        return line_array(entries.n_elements, entries.spacing)
    count = len(entries.element_x)
    if entries.n_elements not in (0, count):
        raise ConfigurationError(
            f"{prefix}n_elements is {entries.n_elements}, but element_x has {count} values; leave "
            "one of them out."
        )
    for name in ("element_y", "element_z"):
        if len(getattr(entries, name)) not in (0, count):
            raise ConfigurationError(
                f"{prefix}{name} has {len(getattr(entries, name))} values, but element_x has "
                f"{count}; give one for each element."
            )
    positions = np.zeros((count, 3))
    for axis, name in enumerate(("element_x", "element_y", "element_z")):
        positions[:, axis] = getattr(entries, name) or 0.0
    if len(np.unique(positions, axis=0)) != count or count < 2:
        raise ConfigurationError(
            f"{prefix}{count} elements are not all in different places; check element_x."
        )
    return positions


def _check_channels(channels: tuple[float, ...], n_elements: int, prefix: str) -> None:
    if not channels:
        return
    if len(channels) != n_elements:
        raise ConfigurationError(
            f"{prefix}channels has {len(channels)} entries, the array has {n_elements} elements; "
            "give one channel for each element."
        )
    for channel in channels:
        if channel != int(channel) or channel < 1:
            raise ConfigurationError(
                f"{prefix}channels holds {channel:g}; channels are whole numbers from 1."
            )
        if channels.count(channel) > 1:
            raise ConfigurationError(
                f"{prefix}channels holds {channel:g} twice; each element has its own channel."
            )
