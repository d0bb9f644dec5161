"""Does the number of contacts agree with the clutter that the ping claims.

False-alarm probabilities are computed for exponential amplitudes; real reverberation has heavier
tails and gives several times as many contacts. A tracker that believes the claim then takes clutter
for targets. Contacts are therefore counted over the last pings; where there are clearly more than
claimed, the clutter density is raised, and the law of their amplitudes is found from those that no
track explains.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.active.detection.clutter_amplitudes import fit_excess_law
from sonar_tracking.active.detection.clutter_profile import ClutterProfile, clearly_more
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.errors import Notice, Severity
from sonar_tracking.records.arrays import FloatArray

FORGETTING = 0.9
"""Weight of the pings before, about ten of which count."""

CLEAR_RATIO = 1.5
"""By which counted must exceed claimed, or the claim is believed."""

FEWEST_AMPLITUDES, MOST_AMPLITUDES = 30, 2000
"""From which the law of amplitudes is found; with more of them it would be no better."""


@dataclass(frozen=True)
class ClutterMonitor:
    """Contacts of the last pings, older ones forgotten.

    Attributes
    ----------
    counted : float
        Contacts that are no confirmed track's.
    claimed : float
        False contacts to be expected.
    excess : ndarray, shape (n,)
        Of the latest contacts that no track explains above the threshold of the detector, linear
        powers.
    profile : ClutterProfile
        Where they were.
    """

    counted: float = 0.0
    claimed: float = 0.0
    excess: FloatArray = field(default_factory=lambda: np.zeros(0), compare=False)
    profile: ClutterProfile = field(default_factory=ClutterProfile, compare=False)

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
            FORGETTING * self.counted + counted,
            FORGETTING * self.claimed + claimed,
            self.excess,
            self.profile,
        )

    def with_unexplained(
        self, excess: FloatArray, distance: FloatArray, model: DetectionModel
    ) -> ClutterMonitor:
        """Return the monitor with contacts of the ping that no track explains.

        Parameters
        ----------
        excess : ndarray, shape (n,)
            Above the threshold of the detector, linear powers; NaN = not known.
        distance : ndarray, shape (n,)
            From the sensor, m.
        model : DetectionModel
            What is believed of the ping.
        """
        known = excess[np.isfinite(excess)]
        kept = np.concatenate((self.excess, known))[-MOST_AMPLITUDES:]
        reach = model.maximum_range
        if not math.isfinite(reach):
            reach = max(self.profile.reach, float(np.max(distance, initial=0.0)))
        expected = model.expected_in_rings(reach)
        profile = self.profile.after(distance, expected, reach)
        return ClutterMonitor(self.counted, self.claimed, kept, profile)

    def corrected(self, model: DetectionModel) -> DetectionModel:
        """Return the model with as much clutter as was counted.

        Clutter that does not follow the claimed law in number does not in its amplitudes, either:
        these have the law that was found, and are left aside until there is one.
        """
        if self.profile.is_contradicted:
            model = replace(model, clutter_profile=self.profile)
        factor = self.factor()
        if factor == 1.0:
            return model
        if len(self.excess) < FEWEST_AMPLITUDES:
            return replace(model, clutter_factor=factor, outlier_share=1.0)
        return replace(model, clutter_factor=factor, clutter_law=fit_excess_law(self.excess))

    def factor(self) -> float:
        """Return by what the claimed density has to be multiplied; 1 = the claim is believed."""
        # Mostly one look is enough.
        more = self.counted > CLEAR_RATIO * self.claimed > 0.0
        if more and clearly_more(self.counted, self.claimed, CLEAR_RATIO):
            return self.counted / self.claimed
        return 1.0

    def notices(self) -> tuple[Notice, ...]:
        """Return what a user should know."""
        factor = self.factor()
        if factor == 1.0:
            return ()
        text = (
            f"There are {factor:.1f} times as many contacts as the claimed clutter explains; the "
            "tracker expects as many, of the amplitudes they have. Check the detector's threshold."
        )
        return (Notice(Severity.WARN, "clutter", text),)
