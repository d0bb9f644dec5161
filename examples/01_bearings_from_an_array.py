"""Bearings of three sources from the snapshots of a line array, in plain numpy.

Two of them are 4 degrees apart, less than the beam is wide: the conventional beamformer shows one
peak for both, MUSIC tells them apart. Sources are counted by their minimum description length.
"""

import numpy as np

from sonar_tracking.geometry import beamwidth, line_array, steering_vectors, wavenumber
from sonar_tracking.passive import beam_powers, music_bearings, sample_covariance, source_count

ELEMENTS, SPACING = 16, 0.75  # m
FREQUENCY, SOUND_SPEED = 1000.0, 1500.0  # Hz, m/s
ARRIVAL_ANGLES_DEG = (-30.0, 10.0, 14.0)  # from broadside
LEVEL_DB, SNAPSHOTS = 0.0, 200  # of each source, per element


def gaussian(generator: np.random.Generator, *shape: int) -> np.ndarray:
    """Return circular complex Gaussian noise of power 1."""
    pairs = generator.standard_normal((*shape, 2)) / np.sqrt(2.0)
    return pairs[..., 0] + 1j * pairs[..., 1]


def main() -> None:
    """Make snapshots, and find the bearings in them."""
    generator = np.random.default_rng(1)
    positions = line_array(ELEMENTS, SPACING)
    k = wavenumber(FREQUENCY, SOUND_SPEED)
    vectors = steering_vectors(positions, np.radians(ARRIVAL_ANGLES_DEG), k)
    signals = 10.0 ** (LEVEL_DB / 20.0) * gaussian(generator, SNAPSHOTS, len(ARRIVAL_ANGLES_DEG))
    snapshots = signals @ vectors.T + gaussian(generator, SNAPSHOTS, ELEMENTS)

    covariance = sample_covariance(snapshots)
    count = source_count(covariance, SNAPSHOTS)
    found = np.degrees(music_bearings(covariance, count, positions, k))

    grid = np.radians(np.linspace(-90.0, 90.0, 721))
    power = beam_powers(snapshots, positions, grid, k)
    peak = (power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:]) & (power[1:-1] > power.max() / 4)
    peaks = np.degrees(grid[1:-1][peak])

    print(f"{ELEMENTS} elements, {SNAPSHOTS} snapshots, {LEVEL_DB:g} dB per element")
    print(f"beamwidth      {np.degrees(beamwidth(positions, k)):.1f} deg")
    print(f"true           {np.array(ARRIVAL_ANGLES_DEG)} deg")
    print(f"sources by MDL {count}")
    print(f"beamformer     {peaks.round(1)} deg")
    print(f"MUSIC          {found.round(2)} deg")


if __name__ == "__main__":
    main()
