"""Position and orientation of one frame in another, in three dimensions."""

from __future__ import annotations

import math
from dataclasses import dataclass

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


@dataclass(frozen=True)
class RigidPose:
    """Pose of a frame in its parent.

    Attributes
    ----------
    position : tuple of float
        x, y, z of its origin, m.
    orientation : tuple of float
        Unit quaternion x, y, z, w that turns its axes from those of the parent.
    """

    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = (0.0, 0.0, 0.0, 1.0)

    def placed_in(self, parent: RigidPose) -> RigidPose:
        """Return the pose in the frame in which the parent's pose is given."""
        return RigidPose(
            _sum(parent.position, _rotated(parent.orientation, self.position)),
            _unit(_product(parent.orientation, self.orientation)),
        )

    def seen_from(self, other: RigidPose) -> RigidPose:
        """Return the pose in another frame, both given in the same parent."""
        back = _inverse(other.orientation)
        return RigidPose(
            _rotated(back, _sum(self.position, other.position, -1.0)),
            _unit(_product(back, self.orientation)),
        )

    def towards(self, later: RigidPose, fraction: float) -> RigidPose:
        """Return the pose between two, the orientation by the shortest arc.

        Parameters
        ----------
        later : RigidPose
            The pose at fraction 1; the turn between the two is small.
        fraction : float
            0 = this one, 1 = the later one.
        """
        same_side = _dot(self.orientation, later.orientation) >= 0.0
        x, y, z, w = (
            first + fraction * ((second if same_side else -second) - first)
            for first, second in zip(self.orientation, later.orientation, strict=True)
        )
        step = _sum(later.position, self.position, -1.0)
        return RigidPose(_sum(self.position, step, fraction), _unit((x, y, z, w)))

    def angle_to(self, other: RigidPose) -> float:
        """Return the angle by which another pose is turned, rad in [0, pi]."""
        x, y, z, w = _product(_inverse(self.orientation), other.orientation)
        return 2.0 * math.atan2(math.hypot(x, y, z), abs(w))


def turned_about_z(yaw: float) -> Quaternion:
    """Return the orientation turned anticlockwise by an angle in the horizontal plane, rad."""
    return (0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw))


def unit_quaternion(values: Quaternion) -> Quaternion | None:
    """Return a quaternion x, y, z, w with length one; None if it is no orientation."""
    length = math.hypot(*values)
    if not (math.isfinite(length) and length > 0.0):
        return None
    return _unit(values)


def _unit(quaternion: Quaternion) -> Quaternion:
    length = math.hypot(*quaternion)
    x, y, z, w = (value / length for value in quaternion)
    return (x, y, z, w)


def _inverse(quaternion: Quaternion) -> Quaternion:
    x, y, z, w = quaternion
    return (-x, -y, -z, w)


def _product(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the orientation that turns by the second and then by the first."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _rotated(turn: Quaternion, vector: Vector) -> Vector:
    turned = _product(_product(turn, (*vector, 0.0)), _inverse(turn))
    return turned[:3]


def _sum(first: Vector, second: Vector, factor: float = 1.0) -> Vector:
    x, y, z = (a + factor * b for a, b in zip(first, second, strict=True))
    return (x, y, z)


def _dot(first: Quaternion, second: Quaternion) -> float:
    return sum(a * b for a, b in zip(first, second, strict=True))
