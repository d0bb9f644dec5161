"""Which nodes get malformed messages, and where their good ones come from (no ROS import)."""

from __future__ import annotations

from typing import NamedTuple


class Chain(NamedTuple):
    """Where the messages of a node come from.

    Attributes
    ----------
    scenario : str
        Its name.
    in_front : tuple of str
        Nodes that make the messages, the simulators first.
    length : float
        Of the stream before it begins again, s.
    """

    scenario: str
    in_front: tuple[str, ...]
    length: float


CHAINS = {
    "subspace_estimator": Chain("doa_fusion", ("array_simulator",), 8.0),
    "bearing_tracker": Chain("doa_fusion", ("array_simulator", "subspace_estimator"), 8.0),
    "band_demodulator": Chain("tonals", ("hydrophone_simulator",), 12.0),
    "line_tracker": Chain(
        "tonals",
        ("hydrophone_simulator", "band_demodulator", "subspace_estimator", "bearing_tracker"),
        12.0,
    ),
    "tma_tracker": Chain("tma", ("world_simulator", "bearing_simulator"), 300.0),
    "hpda_tracker": Chain("active", ("world_simulator", "contact_simulator"), 600.0),
}
"""By the name of the node."""
