"""Where the sensor was, for results that stand for an instant before the newest block."""

from __future__ import annotations

from dataclasses import replace

from sonar_tracking.passive.records import NANOSECONDS, Sensor


class SensorHistory:
    """The sensors of the latest blocks, oldest first."""

    def __init__(self) -> None:
        self._known: list[tuple[int, Sensor]] = []

    def append(self, stamp: int, sensor: Sensor) -> None:
        """Take in the sensor of a block that begins at a stamp, ns."""
        self._known.append((stamp, sensor))

    def at(self, stamp: int) -> Sensor:
        """Return the sensor at an instant, and forget what is older.

        It is that of the latest block that began before, or else of the oldest one known, moved
        along its velocity; instants must not go back.
        """
        while len(self._known) > 1 and self._known[1][0] <= stamp:
            del self._known[0]
        begin, sensor = self._known[0]
        seconds = (stamp - begin) / NANOSECONDS
        x, y, z = (
            position + seconds * speed
            for position, speed in zip(sensor.position, sensor.velocity, strict=True)
        )
        return replace(sensor, position=(x, y, z))
