"""The array of a scenario, the snapshots it delivers and the noise they contain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.geometry import line_array, wavenumber
from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class ArrayConfiguration:
    """Element positions, carrier and snapshots of the array.

    A line array is given by ``n_elements`` and its spacing, in metres or in wavelengths; any
    other one by the coordinates of its elements in the frame of the array (x from the first
    element to the last, y to the left), which take precedence.
    """

    sensor_id: str = parameter("array", "name of the sensor in the messages")
    n_elements: int = parameter(
        0, "number of elements of a line array; 0 = taken from element_x", minimum=0, maximum=65536
    )
    spacing: float = parameter(
        0.0, "between neighbours; 0 = spacing_wavelengths counts", unit="m", minimum=0.0
    )
    spacing_wavelengths: float = parameter(
        0.5, "between neighbours, in wavelengths at center_frequency", minimum=1e-3
    )
    element_x: tuple[float, ...] = parameter((), "element coordinates", unit="m")
    element_y: tuple[float, ...] = parameter((), "element coordinates; empty = 0", unit="m")
    element_z: tuple[float, ...] = parameter((), "element coordinates; empty = 0", unit="m")
    center_frequency: float = parameter(20_000.0, "of the narrow band", unit="Hz", minimum=1e-3)
    bandwidth: float = parameter(
        200.0, "two-sided, of the complex baseband; snapshots are independent", unit="Hz", minimum=0
    )
    sound_speed: float = parameter(1500.0, "in the water", unit="m/s", minimum=1.0, maximum=1e5)
    snapshot_rate: float = parameter(
        200.0, "snapshots per second", unit="Hz", minimum=1e-3, maximum=1e8
    )
    block_snapshots: int = parameter(20, "snapshots in one message", minimum=1, maximum=1_000_000)
    mounting_yaw_deg: float = parameter(
        0.0, "direction of the array axis, anticlockwise from the bow", unit="deg"
    )
    misalignment_deg: float = parameter(
        0.0,
        "by how much the array is really turned anticlockwise from what its data tell",
        unit="deg",
        minimum=-180.0,
        maximum=180.0,
    )

    def element_positions(self) -> FloatArray:
        """Return the element positions in the frame of the array, shape (n_elements, 3), m."""
        if not self.element_x:
            spacing = self.spacing or (
                self.spacing_wavelengths * self.sound_speed / self.center_frequency
            )
            return line_array(self.n_elements, spacing)
        positions = np.zeros((len(self.element_x), 3))
        positions[:, 0] = self.element_x
        positions[:, 1] = self.element_y or 0.0
        positions[:, 2] = self.element_z or 0.0
        return positions

    @property
    def misalignment(self) -> float:
        """In rad."""
        return float(np.radians(self.misalignment_deg))

    def wavenumber(self) -> float:
        """Return the wavenumber at the carrier, rad/m."""
        return wavenumber(self.center_frequency, self.sound_speed)


@dataclass(frozen=True)
class NoiseConfiguration:
    """Gaussian noise of power 1 on every element."""

    correlation: float = parameter(
        0.0,
        "noise covariance rho^|i-j| between elements i and j; 0 = white",
        minimum=0.0,
        maximum=0.99,
    )

    def covariance(self, n_elements: int) -> FloatArray | None:
        """Return the covariance of the noise.

        Parameters
        ----------
        n_elements : int
            Of the array.

        Returns
        -------
        ndarray, shape (n_elements, n_elements), or None
            Pure numbers with trace n_elements; None = white.
        """
        if self.correlation == 0.0:
            return None
        index = np.arange(n_elements)
        return self.correlation ** np.abs(index[:, None] - index)
