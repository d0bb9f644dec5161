"""How arrays are turned from what their data tell."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import UNKNOWN_STAMP


@dataclass(frozen=True)
class ArrayAlignments:
    """What is known of the alignment of all arrays at one instant; entry n belongs to array n.

    Attributes
    ----------
    stamp : int
        ns.
    sensor_id : tuple of str
        The arrays.
    misalignment : ndarray, shape (n,)
        By how much each is turned anticlockwise from what its data tell, rad.
    misalignment_standard_deviation : ndarray, shape (n,)
        rad.
    next_stamp : int
        Watermark, ns.
    """

    stamp: int
    sensor_id: tuple[str, ...]
    misalignment: FloatArray
    misalignment_standard_deviation: FloatArray
    next_stamp: int = UNKNOWN_STAMP
