"""Responses without reflections, written like measured ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE = 48_000
SPEED = 343.0


def write_free_field(
    path: Path, n_elements: int, positions: tuple[tuple[float, float], ...]
) -> Path:
    """Write the responses of sources at some distances and places along an array; numbers from 1.

    Levels fall with the distance; the delays common to all elements are left out.
    """
    places = 0.03 * np.arange(n_elements)
    time = np.arange(512)
    responses = np.empty((len(positions), n_elements, 512))
    for source, (distance, place) in enumerate(positions):
        ranges = np.hypot(distance, place - places)
        delays = ranges / SPEED * RATE
        pulses = np.sinc(time - (delays - delays.mean() + 256.0)[:, None])
        responses[source] = pulses * (ranges.min() / ranges)[:, None]
    np.savez(
        path,
        rir=np.round(responses * 30_000).astype(np.int16),
        rir_scale=1 / 30_000,
        fs_hz=RATE,
        source_id=np.arange(1, len(positions) + 1),
        source_xz_m=np.array(positions),
        mic_xz_m=np.stack([np.zeros(n_elements), places], axis=-1),
    )
    return path
