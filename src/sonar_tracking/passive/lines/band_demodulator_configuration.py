"""Parameters of the band demodulator."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter


@dataclass(frozen=True)
class BandDemodulatorConfiguration:
    """Parameters of the stage that takes one narrow band out of broadband samples."""

    center_frequency: float = parameter(300.0, "Centre of the band", unit="Hz", minimum=1e-3)
    bandwidth: float = parameter(
        0.0,
        "Two-sided width of the band; 0 = half of what is narrow for the array, "
        "0.05 sound_speed / aperture, but at most a tenth of center_frequency",
        unit="Hz",
        minimum=0.0,
    )
    block_snapshots: int = parameter(4, "Snapshots in one message", minimum=1, maximum=100_000)
