"""Many gates at once are the single gates, but for the rounding of a mean."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.detection.gate_association import GateModel, associate_by_rank
from sonar_tracking.active.detection.ranked_gates import associate_gates_by_rank

RATIO = 20.0


@pytest.mark.parametrize("seed", range(5))
def test_each_gate_is_as_if_it_were_alone(seed: int) -> None:
    generator = np.random.default_rng(seed)
    counts = generator.integers(1, 14, size=30)
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    n = int(counts.sum())
    densities = 1e-5 * generator.exponential(size=n)
    amplitudes = np.round(generator.exponential(10.0, size=n), 0)  # some equal ones
    amplitudes[generator.random(n) < 0.02] = np.nan
    clutter = 1e-6 * (1.0 + generator.random(n))
    volume, detection = 1e5 * (1.0 + generator.random(30)), generator.uniform(0.3, 1.0, 30)
    together = associate_gates_by_rank(
        first, densities, amplitudes, clutter, volume, detection, RATIO
    )
    for gate, (begin, count) in enumerate(zip(first, counts, strict=True)):
        own = slice(begin, begin + count)
        model = GateModel(volume[gate], float(np.mean(clutter[own])), detection[gate])
        alone = associate_by_rank(densities[own], amplitudes[own], model, RATIO)
        selected = int(np.argmax(alone.probabilities))
        assert together.selected[gate] == begin + selected
        expected = [alone.probabilities[selected], alone.likelihood_ratio]
        found = [together.probability[gate], together.likelihood_ratio[gate]]
        assert found == pytest.approx(expected, rel=1e-13)
