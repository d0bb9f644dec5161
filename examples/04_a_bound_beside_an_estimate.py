"""How good can a bearing be? The errors of MUSIC and of a fit beside the Cramer-Rao bound.

Two sources stand half a beamwidth apart. At high levels both estimators meet the bound; at low ones
MUSIC no longer resolves them. The fit starts from the truth, as a tracker's does from a prediction.
"""

import numpy as np

from sonar_tracking.geometry import beamwidth, line_array, steering_vectors, wavenumber
from sonar_tracking.passive import (
    ProjectionProblem,
    music_bearings,
    projection_fit,
    sample_covariance,
    signal_subspace,
    stochastic_fisher_information,
)
from sonar_tracking.simulation import circular_gaussian

RUNS, SNAPSHOTS, ELEMENTS = 200, 100, 16
POSITIONS, WAVENUMBER = line_array(ELEMENTS, 0.75), wavenumber(1000.0, 1500.0)
ANGLES = np.array([-0.25, 0.25]) * beamwidth(POSITIONS, WAVENUMBER)


def sample(level_db: float, generator: np.random.Generator) -> np.ndarray:
    """Return the sample covariance of two sources of a level in noise of power 1."""
    signals = 10.0 ** (level_db / 20.0) * circular_gaussian(generator, (SNAPSHOTS, 2))
    noise = circular_gaussian(generator, (SNAPSHOTS, ELEMENTS))
    vectors = steering_vectors(POSITIONS, ANGLES, WAVENUMBER)
    return sample_covariance(signals @ vectors.T + noise)


def deg(errors: list[np.ndarray]) -> float:
    """Return the root mean square of errors in rad, in deg."""
    return float(np.degrees(np.sqrt(np.mean(np.square(errors)))))


def main() -> None:
    """Estimate both bearings in many runs at every level."""
    print("level (dB)  resolved (%)  MUSIC (deg)  fit (deg)  bound (deg)")
    for level_db in (-10, -5, 0, 5, 10, 20):
        generator, music, fit = np.random.default_rng(1), [], []
        for covariance in (sample(level_db, generator) for _ in range(RUNS)):
            found = music_bearings(covariance, 2, POSITIONS, WAVENUMBER)
            music += [found - ANGLES] if len(found) == 2 else []
            combinations = signal_subspace(covariance, 2).steering_combinations()
            problem = ProjectionProblem(combinations, POSITIONS, WAVENUMBER)
            fit.append(projection_fit(problem, ANGLES) - ANGLES)
        powers = 10.0 ** (level_db / 10.0) * np.eye(2)
        information = stochastic_fisher_information(
            POSITIONS, ANGLES, WAVENUMBER, powers, 1.0, SNAPSHOTS
        )
        bound = np.degrees(np.sqrt(np.trace(np.linalg.inv(information)) / 2.0))
        errors = f"{deg(music):11.3f}  {deg(fit):9.3f}  {bound:11.3f}"
        print(f"{level_db:10d}  {100 * len(music) / RUNS:12.0f}  {errors}")


if __name__ == "__main__":
    main()
