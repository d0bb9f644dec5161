"""What the orchestration tells its nodes so that, started again, they go on where they were."""

from __future__ import annotations

import os

VARIABLE = "SONAR_TRACKING_RESUME_AFTER"
"""Environment variable that holds the stamp, ns."""

CHECKPOINT = "SONAR_TRACKING_CHECKPOINT"
"""Environment variable that holds the path of a tracker's checkpoint; without, it writes none."""


def resumes_after() -> int | None:
    """Return the stamp up to which all have received the data of this source, ns, if known."""
    text = os.environ.get(VARIABLE, "")
    return int(text) if text.isdecimal() else None
