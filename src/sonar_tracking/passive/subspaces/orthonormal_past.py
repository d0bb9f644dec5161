"""OPAST: PAST whose basis is kept orthonormal, at linear cost.

The recursion itself is in :mod:`sonar_tracking.passive.subspaces.past_recursion`.

References
----------
K. Abed-Meraim, A. Chkeif, Y. Hua, "Fast orthonormal PAST algorithm", IEEE Signal Processing
Letters 7(3), 2000.
"""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.passive.subspaces.past import Past, PastState
from sonar_tracking.passive.subspaces.past_recursion import lead_through
from sonar_tracking.records.arrays import ComplexArray


@dataclass(frozen=True)
class OrthonormalPast(Past):
    """OPAST with an exponential window; it starts as PAST does and has the same state."""

    def update(self, state: PastState, data: ComplexArray) -> PastState:
        """Return the state after all snapshots.

        Parameters
        ----------
        state : PastState
            Before them.
        data : ndarray, shape (..., n_snapshots, n_elements), complex
            Linear amplitude.
        """
        basis, inverse = lead_through(
            data, state.basis, state.inverse_correlation, self.forgetting_factor, True
        )
        return PastState(basis=basis, inverse_correlation=inverse)
