"""What is said when something known of a target turns out to be wrong."""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import Notice, Severity, shown
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.tma.targets.followed_target import FollowedTarget

CERTAIN = 3.0
"""Standard deviations from which on it is said that a station is turned."""


def unconfirmed(target: FollowedTarget) -> Notice:
    """Return the notice that a confirmed solution is not good enough any more."""
    return Notice(
        Severity.WARN,
        f"position of {_name(target)}",
        f"the position of {_name(target)} is not confirmed any more: its measurements contradict "
        "it, or the target turned.",
    )


def misled(target: FollowedTarget) -> Notice:
    """Return the notice that the bearings of a target are of something else by now."""
    return Notice(
        Severity.WARN,
        f"position of {_name(target)}",
        f"the bearings of {_name(target)} do not fit its position any more: it is predicted, and "
        "they are taken for another target.",
    )


def _name(target: FollowedTarget) -> str:
    sensors = " and ".join(shown(one) for one in target.members)
    return f"bearing track {target.bearing_track_id} of {sensors}"


def turned(alignments: ArrayAlignments) -> list[Notice]:
    """Return the notices of stations some of which are turned from what their data tell."""
    notices = []
    columns = alignments.misalignment, alignments.misalignment_standard_deviation
    for sensor, angle, deviation in zip(alignments.sensor_id, *columns, strict=True):
        if abs(angle) > CERTAIN * deviation:
            text = (
                f"{shown(sensor)} is turned by {np.degrees(angle):.1f} degrees from what its data "
                f"tell, known to {np.degrees(deviation):.1f}: its bearings are corrected; check "
                "its mounting_yaw_deg or its pose."
            )
            notices.append(Notice(Severity.WARN, f"alignment of {shown(sensor)}", text))
    if not notices:
        names = " and ".join(map(shown, alignments.sensor_id))
        text = (
            f"the bearings of {names} do not agree: a station is turned from what its data tell, "
            "and which is not certain yet; check their mounting_yaw_deg or their poses."
        )
        notices.append(Notice(Severity.WARN, "alignment of stations", text))
    return notices
