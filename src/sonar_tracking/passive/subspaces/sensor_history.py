"""Where the sensor was, for results that stand for an instant before the newest block."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.time import NANOSECONDS


@dataclass(frozen=True)
class SensorHistory:
    """The sensors of the latest blocks.

    Attributes
    ----------
    known : tuple of (int, Sensor)
        Stamp of each block, ns, and its sensor, oldest first.
    """

    known: tuple[tuple[int, Sensor], ...] = ()

    def append(self, stamp: int, sensor: Sensor) -> SensorHistory:
        """Return the history with the sensor of a block that begins at a stamp, ns."""
        return SensorHistory((*self.known, (stamp, sensor)))

    def since(self, stamp: int) -> SensorHistory:
        """Return the history without what no instant from the stamp on needs."""
        before = sum(begin <= stamp for begin, _ in self.known)
        return SensorHistory(self.known[max(before - 1, 0) :])

    def at(self, stamp: int) -> Sensor:
        """Return the sensor at an instant, ns.

        Between two blocks its pose and velocity are interpolated; after the newest and before the
        oldest it moves along its velocity. What is not known stays so.
        """
        after = next((n for n, (begin, _) in enumerate(self.known) if begin > stamp), None)
        if not after:
            begin, sensor = self.known[0] if after == 0 else self.known[-1]
            seconds = (stamp - begin) / NANOSECONDS
            return replace(sensor, position=_mixed(sensor.position, sensor.velocity, 1.0, seconds))
        (begin, old), (end, new) = self.known[after - 1 : after + 1]
        later = (stamp - begin) / (end - begin)
        turn = np.dot(old.orientation, new.orientation)
        x, y, z, w = _quaternion(
            (1.0 - later) * np.array(old.orientation)
            + np.copysign(later, turn) * np.array(new.orientation)
        )
        return replace(
            old,
            position=_mixed(old.position, new.position, 1.0 - later, later),
            orientation=(x, y, z, w),
            velocity=_mixed(old.velocity, new.velocity, 1.0 - later, later),
        )


def _mixed(
    first: tuple[float, float, float],
    second: tuple[float, float, float],
    first_weight: float,
    second_weight: float,
) -> tuple[float, float, float]:
    x, y, z = (
        first_weight * one + second_weight * other for one, other in zip(first, second, strict=True)
    )
    return (x, y, z)


def _quaternion(values: FloatArray) -> list[float]:
    length = float(np.linalg.norm(values))
    return [float(value) for value in (values / length if length else values)]
