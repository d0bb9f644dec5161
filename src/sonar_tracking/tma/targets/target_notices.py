"""What is said when something known of a target turns out to be wrong."""

from __future__ import annotations

from sonar_tracking.errors import Notice, Severity, shown
from sonar_tracking.tma.targets.followed_target import FollowedTarget


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
