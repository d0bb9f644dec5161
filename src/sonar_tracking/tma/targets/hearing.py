"""Whether a target is heard: a direction finder goes on to report bearings of what fell silent.

Such bearings claim deviations ten and more times as large as those before, since their delays do
not agree; one in ten does by chance. So of each station the logarithm of the variance it claims is
averaged, over a few seconds and over minutes,

    m_k = m_(k-1) + (1 - exp(-dt / tau)) (log R_k - m_(k-1)),

and a target is not heard while the first average is above the second by more than a target overhead
makes it. What is usual then changes only slowly.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.targets.target_records import TargetObservation

NOW, USUAL, SILENT = 10.0, 300.0, 1800.0
"""Time constants, s: of the bearings now, of usual ones, and of these while it is not heard."""

WORSE = 7.0
"""Deviations that many times as large as usual are those of bearings of nothing."""


@dataclass(frozen=True)
class _Claimed:
    """Averages of the logarithm of the variance that a station claims, and their stamp, ns."""

    now: float
    usual: float
    stamp: int

    @property
    def heard(self) -> bool:
        """Whether bearings are about as good as usual."""
        return bool(self.now - self.usual < 2.0 * np.log(WORSE))


@dataclass
class Hearing:
    """Of a target, by all of its stations."""

    claimed: dict[str, _Claimed] = field(default_factory=dict)

    def take(self, observation: TargetObservation) -> bool:
        """Return whether the station hears the target whose azimuth it reports."""
        elevated = np.isfinite(observation.elevation_variance)
        # That of an azimuth is large overhead, where the direction is as good as elsewhere.
        variance = observation.elevation_variance if elevated else observation.azimuth_variance
        value, stamp = float(np.log(variance)), observation.stamp
        before = self.claimed.get(observation.sensor_id, _Claimed(value, value, stamp))
        passed = (stamp - before.stamp) / NANOSECONDS
        constant = USUAL if before.heard else SILENT
        known = _Claimed(
            before.now + (1.0 - np.exp(-passed / NOW)) * (value - before.now),
            before.usual + (1.0 - np.exp(-passed / constant)) * (value - before.usual),
            stamp,
        )
        self.claimed[observation.sensor_id] = known
        return known.heard
