"""What the orchestration tells a source that it starts again: after which stamp to go on."""

from __future__ import annotations

import os

VARIABLE = "SONAR_TRACKING_RESUME_AFTER"
"""Environment variable that holds the stamp, ns."""


def resumes_after() -> int | None:
    """Return the stamp up to which all have received the data of this source, ns, if known."""
    text = os.environ.get(VARIABLE, "")
    return int(text) if text.isdecimal() else None
