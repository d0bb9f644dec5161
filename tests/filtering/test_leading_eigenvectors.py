"""Leading eigenvectors span what all eigenvectors of the matrix say, at any size."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.filtering.leading_eigenvectors import leading_eigenvectors


@pytest.mark.parametrize("size", [3, 48, 49, 120])
@pytest.mark.parametrize("count", [1, 3])
def test_they_are_those_of_the_largest_eigenvalues(size: int, count: int) -> None:
    generator = np.random.default_rng(size)
    drawn = generator.normal(size=(2, size, size))
    matrix = drawn[0] + 1j * drawn[1]
    matrix = matrix @ matrix.conj().T
    found = leading_eigenvectors(matrix, count)
    values, vectors = np.linalg.eigh(matrix)
    expected = vectors[:, size - count :]
    assert np.allclose(found @ found.conj().T, expected @ expected.conj().T, atol=1e-11)
    quotients = (found.conj() * (matrix @ found)).sum(axis=0).real
    assert np.allclose(quotients, values[size - count :])


@pytest.mark.parametrize("size", [5, 60])
def test_what_is_not_finite_is_refused(size: int) -> None:
    with pytest.raises(np.linalg.LinAlgError):
        leading_eigenvectors(np.full((size, size), np.nan + 0j), 1)
