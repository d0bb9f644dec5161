"""Does the number of contacts agree with the clutter that the ping claims.

False-alarm probabilities are computed for exponential amplitudes; real reverberation has heavier
tails and gives several times as many contacts. A tracker that believes the claim then takes clutter
for targets. Contacts are therefore counted over the last pings, and the clutter density is raised
where there are clearly more than claimed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.errors import Notice, Severity

FORGETTING = 0.9
"""Weight of the pings before, about ten of which count."""

CLEAR_RATIO = 1.5
CLEAR_DEVIATIONS = 4.0
"""Counted must exceed claimed by both, or the claim is believed."""


@dataclass(frozen=True)
class ClutterMonitor:
    """Contacts of the last pings, older ones forgotten.

    Attributes
    ----------
    counted : float
        Contacts that are no confirmed track's.
    claimed : float
        False contacts to be expected.
    """

    counted: float = 0.0
    claimed: float = 0.0

    def after(self, n_contacts: int, n_tracks: int, model: DetectionModel) -> ClutterMonitor:
        """Return the monitor after another ping.

        Parameters
        ----------
        n_contacts : int
            In the ping.
        n_tracks : int
            Confirmed tracks, which explain some of them.
        model : DetectionModel
            What the ping claims.
        """
        claimed = model.expected_clutter()
        if not math.isfinite(claimed):
            return self
        counted = max(0.0, n_contacts - n_tracks * model.detection_probability)
        return ClutterMonitor(
            FORGETTING * self.counted + counted, FORGETTING * self.claimed + claimed
        )

    def corrected(self, model: DetectionModel) -> DetectionModel:
        """Return the model with as much clutter as was counted.

        Clutter that does not follow the claimed law is not told from targets by its amplitude,
        either: amplitudes are then left aside.
        """
        factor = self.factor()
        if factor == 1.0:
            return model
        return replace(model, clutter_factor=factor, outlier_share=1.0)

    def factor(self) -> float:
        """Return by what the claimed density has to be multiplied; 1 = the claim is believed."""
        clear = self.claimed + CLEAR_DEVIATIONS * math.sqrt(max(self.claimed, 1.0))
        if self.claimed <= 0.0 or self.counted <= max(CLEAR_RATIO * self.claimed, clear):
            return 1.0
        return self.counted / self.claimed

    def notices(self) -> tuple[Notice, ...]:
        """Return what a user should know."""
        factor = self.factor()
        if factor == 1.0:
            return ()
        text = (
            f"There are {factor:.1f} times as many contacts as the claimed clutter explains; the "
            "tracker expects as many and does not trust amplitudes. Check the detector's threshold."
        )
        return (Notice(Severity.WARN, "clutter", text),)
