"""Protects the taking in of rows: the result of textbooks, and the same bits compiled or not."""

import numpy as np
import pytest

from sonar_tracking.tma.estimators import conditioning
from sonar_tracking.tma.estimators.conditioning import Conditioned, condition
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows

RUNS, COMPONENTS, STATES, SEEN, ROWS = 4, 5, 9, 6, 3
WHOLE = np.zeros((RUNS, COMPONENTS), dtype=bool)
WHOLE[1::2] = True


def states_and_rows() -> tuple[np.ndarray, LinearisedRows]:
    """Return covariances, and rows of which some components have only some."""
    generator = np.random.default_rng(6)
    root = generator.standard_normal((RUNS, COMPONENTS, STATES, STATES))
    root[~WHOLE, SEEN:] = 0.0
    present = generator.random((RUNS, COMPONENTS, ROWS)) < 0.7
    present[..., 1] = False
    derivative = generator.standard_normal((RUNS, COMPONENTS, ROWS, SEEN)) * present[..., None]
    innovation = generator.standard_normal((RUNS, COMPONENTS, ROWS)) * present
    variance = np.where(present, generator.uniform(0.1, 2.0, present.shape), 1.0)
    return root @ np.swapaxes(root, -1, -2), LinearisedRows(
        innovation, derivative, variance, present
    )


def conditioned() -> Conditioned:
    covariance, rows = states_and_rows()
    return condition(covariance, rows, WHOLE)


def test_rows_one_by_one_are_all_rows_at_once() -> None:
    covariance, rows = states_and_rows()
    matrix = np.concatenate(
        [rows.derivative, np.zeros((*rows.derivative.shape[:-1], STATES - SEEN))], axis=-1
    )
    crossed = covariance @ np.swapaxes(matrix, -1, -2)
    spread = matrix @ crossed + np.eye(ROWS) * rows.variance[..., None]
    gain = crossed @ np.linalg.inv(spread)
    seen = conditioned()
    np.testing.assert_allclose(
        seen.shift, (gain @ rows.innovation[..., None])[..., 0], rtol=1e-9, atol=1e-12
    )
    np.testing.assert_allclose(
        seen.covariance, covariance - gain @ np.swapaxes(crossed, -1, -2), rtol=1e-8, atol=1e-10
    )
    np.testing.assert_allclose(seen.log_spread, np.linalg.slogdet(spread)[1], rtol=1e-9)
    squared = rows.innovation[..., None, :] @ np.linalg.inv(spread) @ rows.innovation[..., None]
    np.testing.assert_allclose(seen.squared, squared[..., 0, 0], rtol=1e-9)


@pytest.mark.skipif(conditioning.COMPILED is None, reason="no compiler was there")
def test_compiled_rows_give_the_bits_of_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = conditioned()
    monkeypatch.setattr(conditioning, "COMPILED", None)
    plain = conditioned()
    for name in ("shift", "covariance", "squared", "log_spread"):
        assert np.array_equal(getattr(compiled, name), getattr(plain, name)), name
