"""Parameters of the line tracker."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError


@dataclass(frozen=True)
class LineTrackerConfiguration:
    """Parameters of the stage that finds and follows narrowband lines on each bearing track."""

    frame_length: float = parameter(
        2.0,
        "Length of a Hann frame; frames overlap by half, at multiples of half of it in stamp time",
        unit="s",
        minimum=1.0,
        maximum=4.0,
    )
    minimum_frequency: float = parameter(
        10.0, "Lowest frequency analysed", unit="Hz", minimum=0.0, maximum=1e6
    )
    maximum_frequency: float = parameter(
        0.0,
        "Highest frequency analysed; 0 = 0.8 of half the sample rate",
        unit="Hz",
        minimum=0.0,
        maximum=1e6,
    )
    false_alarm_probability: float = parameter(
        1e-3,
        "That noise alone exceeds the threshold, for each bin, frame and beam",
        minimum=1e-9,
        maximum=0.1,
    )
    background_half_width: float = parameter(
        20.0,
        "Width of the window on either side of a bin that its background is estimated from",
        unit="Hz",
        minimum=0.1,
        maximum=1e5,
    )
    confirmation_hits: int = parameter(
        3, "A line is confirmed by so many detections M among N frames", minimum=1, maximum=100
    )
    confirmation_frames: int = parameter(
        5, "The N frames of the confirmation", minimum=1, maximum=100
    )
    deletion_frames: int = parameter(
        10, "A confirmed line ends after so many frames without a detection", minimum=1
    )
    gate: float = parameter(
        4.0,
        "Largest innovation in standard deviations; never less than half a bin",
        minimum=1.0,
        maximum=20.0,
    )
    drift_noise: float = parameter(
        1e-4,
        "Spectral density of the change of a line's drift",
        unit="Hz^2/s^3",
        minimum=0.0,
        maximum=1e3,
    )
    maximum_drift: float = parameter(
        0.05, "Standard deviation of the drift of a new line", unit="Hz/s", minimum=0.0
    )
    ownership_margin_db: float = parameter(
        3.0,
        "A line heard in several directions belongs to the one where it is strongest; it changes "
        "owner only if another beam hears it so much stronger, and it is dropped if a direction "
        "without a track does",
        unit="dB",
        minimum=0.0,
        maximum=40.0,
    )
    own_ship_frequencies: tuple[float, ...] = parameter(
        (), "Lines of own ship, left out in every beam", unit="Hz", minimum=0.0
    )
    own_ship_tolerance: float = parameter(
        1.0, "Half width left out around each of them", unit="Hz", minimum=0.0
    )
    first_id: int = parameter(1, "Identifier of the first line", minimum=1)


def check_line_tracker(configuration: LineTrackerConfiguration) -> None:
    """Refuse parameters that do not fit together.

    Raises
    ------
    ConfigurationError
        With a sentence that names the parameters.
    """
    if configuration.confirmation_hits > configuration.confirmation_frames:
        raise ConfigurationError(
            f"confirmation_hits is {configuration.confirmation_hits} but confirmation_frames only "
            f"{configuration.confirmation_frames}; give at least as many frames as hits."
        )
    highest = configuration.maximum_frequency
    if highest and highest <= configuration.minimum_frequency:
        raise ConfigurationError(
            f"maximum_frequency is {highest:g} Hz and minimum_frequency "
            f"{configuration.minimum_frequency:g} Hz; give a higher maximum, or 0 for 0.8 of half "
            "the sample rate."
        )
