"""Leading eigenvectors span what all eigenvectors of the matrix say, at any size."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.filtering.leading_eigenvectors import leading_eigenvectors, leading_left_vectors


@pytest.mark.parametrize("size", [3, 48, 49, 120, 200])
@pytest.mark.parametrize("count", [1, 3])
def test_they_are_those_of_the_largest_eigenvalues(size: int, count: int) -> None:
    generator = np.random.default_rng(size)
    drawn = generator.normal(size=(2, size, size))
    matrix = drawn[0] + 1j * drawn[1]
    matrix = matrix @ matrix.conj().T
    values, vectors = leading_eigenvectors(matrix, count)
    all_values, all_vectors = np.linalg.eigh(matrix)
    expected = all_vectors[:, size - count :]
    assert np.allclose(vectors @ vectors.conj().T, expected @ expected.conj().T, atol=1e-11)
    assert np.allclose(values, all_values[: -count - 1 : -1], rtol=1e-12)
    assert np.allclose(matrix @ vectors, vectors * values, atol=1e-12 * all_values[-1])
    again = leading_eigenvectors(matrix, count)[1]
    assert again.tobytes() == vectors.tobytes()


@pytest.mark.parametrize("size", [20, 100, 200])
def test_equal_eigenvalues_have_orthonormal_vectors(size: int) -> None:
    matrix = np.diag(np.where(np.arange(size) < 3, 5.0, 1.0)).astype(complex)
    values, vectors = leading_eigenvectors(matrix, 3)
    assert np.allclose(values, 5.0)
    assert np.allclose(vectors.conj().T @ vectors, np.eye(3))
    assert np.allclose(np.abs(vectors[3:]), 0.0, atol=1e-12)


@pytest.mark.parametrize("size", [5, 60])
def test_what_is_not_finite_is_refused(size: int) -> None:
    with pytest.raises(np.linalg.LinAlgError):
        leading_eigenvectors(np.full((size, size), np.nan + 0j), 1)


@pytest.mark.parametrize("shape", [(12, 40), (40, 12), (60, 50), (9, 9)])
def test_left_vectors_are_those_of_the_singular_values(shape: tuple[int, int]) -> None:
    generator = np.random.default_rng(shape)
    drawn = generator.normal(size=(2, 3, *shape))
    columns = drawn[0] + 1j * drawn[1]
    vectors = leading_left_vectors(columns, 4)
    expected = np.linalg.svd(columns)[0][..., :4]
    adjoint = np.swapaxes(vectors, -1, -2).conj()
    assert np.allclose(adjoint @ vectors, np.eye(4), atol=1e-12)
    # Each is known but for its phase.
    assert np.allclose(np.abs((adjoint @ expected).sum(axis=-1)), 1.0, atol=1e-10)


def test_matrices_together_have_the_vectors_of_each() -> None:
    generator = np.random.default_rng(1)
    drawn = generator.normal(size=(2, 2, 3, 60, 60))
    matrices = drawn[0] + 1j * drawn[1]
    matrices = matrices @ np.swapaxes(matrices, -1, -2).conj()
    values, vectors = leading_eigenvectors(matrices, 5)
    for place in np.ndindex(2, 3):
        alone = leading_eigenvectors(matrices[place], 5)
        assert values[place].tobytes() == alone[0].tobytes()
        assert vectors[place].tobytes() == alone[1].tobytes()
