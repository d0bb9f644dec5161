"""What is said of arrays that are not where they are said to be."""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.errors import Notice, Severity, shown
from sonar_tracking.records.alignments import ArrayAlignments

MEASURED = 0.5
"""An alignment has been measured once its deviation is this part of what it was before."""

BEYOND = 2.5
"""Deviations of the prior from which on a misalignment contradicts it."""


def beyond_prior(alignments: ArrayAlignments, deviation_deg: float) -> list[Notice]:
    """Return the notices of arrays that are turned by more than was to be expected.

    Parameters
    ----------
    alignments : ArrayAlignments
        As found.
    deviation_deg : float
        Standard deviation that was expected, degrees.
    """
    notices = []
    columns = alignments.misalignment, alignments.misalignment_standard_deviation
    for sensor, angle, deviation in zip(alignments.sensor_id, *columns, strict=True):
        found = abs(math.degrees(angle))
        known = 2.0 * np.degrees(deviation) < deviation_deg
        if known and found > BEYOND * deviation_deg:
            text = (
                f"{shown(sensor)} is turned by {math.degrees(angle):.1f} degrees from what its "
                f"data tell, with {deviation_deg:g} degrees expected; check its mounting_yaw_deg "
                "or its pose, or raise alignment_deviation_deg."
            )
            notices.append(Notice(Severity.WARN, f"alignment of {shown(sensor)}", text))
    return notices


def measured_alignments(
    alignments: ArrayAlignments, deviation: float
) -> dict[str, tuple[float, float]]:
    """Return the misalignments of which more is known than before, and their variances.

    Parameters
    ----------
    alignments : ArrayAlignments
        As found.
    deviation : float
        Standard deviation that was expected, rad.
    """
    columns = alignments.misalignment, alignments.misalignment_standard_deviation
    return {
        sensor: (float(angle), float(known) ** 2)
        for sensor, angle, known in zip(alignments.sensor_id, *columns, strict=True)
        if known < MEASURED * deviation
    }
