"""The sensors of the study: what looks at the targets."""

from __future__ import annotations

from dataclasses import replace

from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration

STANDARD = ContactSensorConfiguration(
    ping_interval=10.0,
    sound_speed=0.0,
    range_standard_deviation=30.0,
    azimuth_standard_deviation_deg=0.5,
    maximum_range=10_000.0,
    signal_to_noise_ratio_db=10.0,
    detection_probability=0.9,
    clutter_per_ping=10.0,
)
FINE = replace(
    STANDARD,
    ping_interval=2.0,
    range_standard_deviation=4.0,
    azimuth_standard_deviation_deg=0.3,
    maximum_range=2000.0,
)
COARSE = replace(
    STANDARD,
    ping_interval=60.0,
    range_standard_deviation=50.0,
    azimuth_standard_deviation_deg=1.0,
    maximum_range=20_000.0,
)
CONVOY_COARSE = replace(COARSE, ping_interval=10.0, maximum_range=10_000.0)
CONVOY_FINE = replace(STANDARD, range_standard_deviation=10.0, azimuth_standard_deviation_deg=0.2)
BY_THRESHOLD = replace(STANDARD, detection_probability=0.0, clutter_per_ping=0.0)
HEAVY_TAILS = replace(
    BY_THRESHOLD,
    maximum_range=6000.0,
    signal_to_noise_ratio_db=15.0,
    false_alarm_probability=1e-4,
    clutter_shape=1.0,
)
HEAVIER_TAILS = replace(HEAVY_TAILS, clutter_shape=0.5)
HARBOUR = replace(
    STANDARD,
    ping_interval=5.0,
    range_standard_deviation=5.0,
    maximum_range=3000.0,
    clutter="area",
    clutter_per_ping=5.0,
)
WEAK_TARGETS = replace(
    STANDARD,
    signal_to_noise_ratio_db=7.0,
    # The threshold at which targets of 10 dB are detected with 0.9, as by STANDARD.
    detection_probability=float(0.9 ** (11.0 / (1.0 + 10.0**0.7))),
)
WEAKER_TARGETS = replace(BY_THRESHOLD, signal_to_noise_ratio_db=7.0, false_alarm_probability=1e-3)
RARE_DETECTIONS = replace(STANDARD, detection_probability=0.5)
