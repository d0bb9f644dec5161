"""Whether a target is heard: a direction finder goes on to report bearings of what fell silent.

Such bearings claim deviations ten and more times as large as those before, since their delays do
not agree; one in ten does by chance. So of each station the logarithm of the variance it claims is
averaged, over a few seconds and over minutes,

    m_k = m_(k-1) + max(1 - exp(-dt / tau), 1 / k) (log R_k - m_(k-1)),

and a target is not heard once the first average is above the second by more than a target overhead
makes it, until it is above by half of that at most. What is usual then changes only slowly.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.targets.target_records import TargetObservation

NOW, USUAL, SILENT = 10.0, 300.0, 1800.0
"""Time constants, s: of the bearings now, of usual ones, and of these while it is not heard."""

WORSE = 7.0
"""Deviations that many times as large as usual are those of bearings of nothing."""

GOOD_AGAIN = 3.5
"""Deviations fewer times as large as usual are those of what was not heard for a while."""


@dataclass(frozen=True)
class _Claimed:
    """Averages of the logarithm of the variance that a station claims, and their stamp, ns.

    And whether its bearings are about as good as usual, and how many there were.
    """

    now: float
    usual: float
    stamp: int
    heard: bool = True
    count: int = 1


@dataclass
class Hearing:
    """Of a target, by all of its stations."""

    claimed: dict[str, _Claimed] = field(default_factory=dict)

    def take(self, observation: TargetObservation) -> bool:
        """Return whether the station hears the target, and reports an azimuth of it."""
        elevated = np.isfinite(observation.elevation_variance)
        # That of an azimuth is large overhead, where the direction is as good as elsewhere.
        variance = observation.elevation_variance if elevated else observation.azimuth_variance
        value, stamp = float(np.log(variance)), observation.stamp
        before = self.claimed.get(observation.sensor_id)
        if before is None:
            self.claimed[observation.sensor_id] = _Claimed(value, value, stamp)
            return True
        passed = (stamp - before.stamp) / NANOSECONDS
        constant = USUAL if before.heard else SILENT
        # Of the first bearings each counts alike: by chance one is far better than usual ones.
        count = before.count + before.heard
        least = 1.0 / count if before.heard else 0.0
        lately, usually = (max(1.0 - np.exp(-passed / tau), least) for tau in (NOW, constant))
        now = before.now + lately * (value - before.now)
        usual = before.usual + usually * (value - before.usual)
        most = WORSE if before.heard else GOOD_AGAIN
        heard = bool(now - usual < 2.0 * np.log(most))
        self.claimed[observation.sensor_id] = _Claimed(now, usual, stamp, heard, count)
        return heard and bool(value - usual < 2.0 * np.log(WORSE))

    def hears(self, sensor_id: str) -> bool:
        """Return whether a station hears the target; it does if it has reported none so far."""
        known = self.claimed.get(sensor_id)
        return known is None or known.heard

    def any_of(self, sensor_ids: Iterable[str]) -> bool:
        """Return whether any of some stations hears the target."""
        return any(self.hears(one) for one in sensor_ids)
