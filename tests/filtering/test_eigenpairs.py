"""Eigenpairs: in descending order, of one matrix or of several."""

from __future__ import annotations

import numpy as np

from sonar_tracking.filtering.eigenpairs import eigenpairs, stacked_eigenpairs


def test_eigenpairs_of_several_matrices_are_those_of_each() -> None:
    parts = np.random.default_rng(0).standard_normal((2, 3, 4, 9))
    columns = np.asarray(parts[0] + 1j * parts[1], dtype=np.complex128)
    matrices = np.asarray(columns @ np.swapaxes(columns, -1, -2).conj(), dtype=np.complex128)
    together = eigenpairs(matrices)
    assert (np.diff(together.values) <= 0.0).all()
    made = (together.vectors * together.values[:, None]) @ np.swapaxes(
        together.vectors, -1, -2
    ).conj()
    assert np.allclose(made, matrices)
    each = [eigenpairs(matrix) for matrix in matrices]
    assert np.array_equal(each[1].vectors, together.of(1).vectors)
    stacked = stacked_eigenpairs(each)
    assert stacked is not None
    assert np.array_equal(stacked.values, together.values)
    assert stacked_eigenpairs([each[0], None]) is None
