"""Parameters of the trackers of contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sonar_tracking.active.contacts.contact_method_registry import (
    CONTACT_METHODS,
    ContactMethodEntry,
)
from sonar_tracking.active.contacts.gate_threshold_registry import (
    AS_DETECTED,
    GATE_THRESHOLDS,
    GateThresholdEntry,
)
from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError

SLOWEST_SOUND = 100.0
"""m/s"""


@dataclass(frozen=True)
class ContactTrackerConfiguration:
    """Parameters of the stage that tracks several targets from contacts in clutter."""

    method: str = parameter(
        "integrated",
        "How contacts become tracks",
        methods=CONTACT_METHODS,
    )
    detection_probability: float = parameter(
        0.0,
        "P_D where the contacts do not carry it; 0 = unknown. Told or not, it is found for each "
        "track from how often it is detected",
        minimum=0.0,
        maximum=0.999,
    )
    signal_to_noise_ratio_db: float = parameter(
        0.0,
        "Of a target, where the contacts do not carry it; 0 = unknown: amplitudes are judged by "
        "the average over 3 to 20 dB",
        unit="dB",
        minimum=0.0,
    )
    outlier_share: float = parameter(
        0.01,
        "Of false contacts that are as strong as targets; bounds what a single amplitude can say",
        minimum=0.0,
        maximum=1.0,
    )
    clutter_density: float = parameter(
        0.0,
        "False contacts where the contacts do not tell; 0 = from their number and the largest "
        "range",
        unit="1/m^2",
        minimum=0.0,
    )
    sound_speed: float = parameter(
        1500.0, "For reflection times; 0 = a ping takes no time", unit="m/s", minimum=0.0
    )
    motion: str = parameter(
        "adaptive",
        "Of method integrated: adaptive, from fixed things to boats that turn with 0.3 g; turning, "
        "straight, left and right turns of one lateral acceleration, as published; straight alone "
        "(acceleration_deviation then has to cover turns)",
        choices=("adaptive", "turning", "straight"),
    )
    acceleration_deviation: float = parameter(
        0.05,
        "White acceleration of a target, where motion is not adaptive; other methods need it to "
        "cover turns",
        unit="m/s^2",
        minimum=0.0,
    )
    lateral_acceleration: float = parameter(
        0.05, "Of a target in a turn, where motion is turning", unit="m/s^2", minimum=0.0
    )
    turn_probability: float = parameter(
        0.01,
        "That a straight target turns at the next ping (particle filters take the published model "
        "instead: all changes of mode alike)",
        minimum=0.0,
        maximum=0.5,
    )
    stay_probability: float = parameter(
        0.9, "That a turn lasts until the next ping", minimum=0.34, maximum=0.999
    )
    initial_speed_deviation: float = parameter(
        8.0, "Speed per axis of a new target", unit="m/s", minimum=1e-3
    )
    initial_existence: float = parameter(
        0.003, "Existence probability of a candidate", minimum=1e-7, maximum=0.4
    )
    confirmation_probability: float = parameter(
        0.9, "Existence that confirms a candidate", minimum=0.1, maximum=0.9999, changeable=True
    )
    termination_probability: float = parameter(
        0.6,
        "Existence below which a confirmed track ends",
        minimum=1e-4,
        maximum=0.99,
        changeable=True,
    )
    mean_lifetime: float = parameter(
        10000.0, "Of a target in the field of view", unit="s", minimum=1.0
    )
    tentative_probability: float = parameter(
        0.1,
        "Existence from which a candidate is shown",
        minimum=1e-6,
        maximum=1.0,
        changeable=True,
    )
    maximum_position_variance: float = parameter(
        1e6, "Trace at which a track ends", unit="m^2", minimum=1.0
    )
    maximum_range: float = parameter(
        0.0,
        "Of the survey where the contacts do not tell; 0 = no limit",
        unit="m",
        minimum=0.0,
    )
    maximum_tracks: int = parameter(
        20000, "Candidates beyond it are dropped, least existence first", minimum=10
    )
    search_false_alarm_probability: float = parameter(
        0.0,
        "Outside the gates of confirmed tracks; 0 = every contact as detected",
        minimum=0.0,
        maximum=0.5,
    )
    gate_threshold: str = parameter(
        AS_DETECTED,
        "Which contacts are used in the gates of confirmed tracks",
        methods=GATE_THRESHOLDS,
    )
    gate_false_alarm_probability: float = parameter(
        1e-2, "For gate_threshold = fixed; the lower limit otherwise is 1e-6", minimum=1e-8
    )
    roi_distance: float = parameter(
        9.21,
        "Squared distance below which contacts of successive pings form a region of interest; the "
        "published 1 loses most targets",
        minimum=0.1,
    )
    n_particles: int = parameter(1000, "Of each particle filter", minimum=50)
    seed: int = parameter(1, "Root of the randomness of particle filters", minimum=0)
    first_id: int = parameter(1, "Identifier of the first track", minimum=1)

    def survival_probability(self, interval: float) -> float:
        """Return the probability that a target lasts for an interval (s)."""
        return math.exp(-interval / self.mean_lifetime)

    @property
    def entry(self) -> ContactMethodEntry:
        """What is known of the method."""
        return CONTACT_METHODS[self.method]

    @property
    def gate_threshold_entry(self) -> GateThresholdEntry:
        """What is known of the choice of thresholds in gates."""
        return GATE_THRESHOLDS[self.gate_threshold]


def check_configuration(configuration: ContactTrackerConfiguration) -> None:
    """Refuse parameters that do not fit together.

    Raises
    ------
    ConfigurationError
        With a sentence that names the parameters.
    """
    if configuration.termination_probability >= configuration.confirmation_probability:
        raise ConfigurationError(
            f"termination_probability is {configuration.termination_probability:g} but "
            f"confirmation_probability only {configuration.confirmation_probability:g}; a track "
            "would end as it is confirmed."
        )
    if configuration.initial_existence >= 0.5 * configuration.confirmation_probability:
        raise ConfigurationError(
            f"initial_existence is {configuration.initial_existence:g}; give less than half of "
            "confirmation_probability, or single contacts become tracks."
        )
    if 0.0 < configuration.sound_speed < SLOWEST_SOUND:
        raise ConfigurationError(
            f"sound_speed is {configuration.sound_speed:g} m/s; give about 1500 in water, or 0 if "
            "a ping takes no time."
        )
    if configuration.gate_threshold_entry.sets_thresholds and not configuration.entry.has_gates:
        raise ConfigurationError(
            f"gate_threshold {configuration.gate_threshold} needs gates that the method "
            f"{configuration.method} does not have; use {AS_DETECTED}."
        )
