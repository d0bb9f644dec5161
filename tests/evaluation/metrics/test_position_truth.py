"""True positions between samples: what the motion between them can be known to be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sonar_tracking.evaluation.metrics.position_truth import PositionTruth
from sonar_tracking.records.positions import PositionTracks

SECOND = 1_000_000_000


def sample(time: float, ids: list[int], states: np.ndarray) -> PositionTracks:
    n = len(ids)
    return PositionTracks(
        stamp=round(time * SECOND),
        id=np.array(ids, np.uint64),
        status=np.ones(n, np.uint8),
        source=np.full(n, 3, np.uint8),
        state=states,
    )


coefficients = st.tuples(*[st.floats(-5.0, 5.0)] * 4)


@pytest.mark.slow
@given(coefficients, coefficients, st.floats(0.0, 20.0))
def test_motion_of_constant_jerk_is_met_exactly(
    east: tuple[float, ...], north: tuple[float, ...], time: float
) -> None:
    """A cubic of time is determined by positions and velocities at both ends."""

    def state(at: float) -> np.ndarray:
        polynomials = [np.polynomial.Polynomial(row) for row in (east, north)]
        slopes = [polynomial.deriv() for polynomial in polynomials]
        return np.array([[*(p(at) for p in polynomials), *(s(at) for s in slopes)]])

    truth = PositionTruth([sample(at, [4], state(at)) for at in (0.0, 20.0)])
    stamp = round(time * SECOND)
    found = truth.at(stamp)
    assert found is not None and list(found.id) == [4]
    np.testing.assert_allclose(found.state, state(stamp * 1e-9), atol=1e-6)


def test_the_line_is_straight_where_a_velocity_is_unknown() -> None:
    states = [np.array([[x, 0.0, np.nan, np.nan]]) for x in (0.0, 10.0)]
    truth = PositionTruth([sample(10.0 * step, [4], state) for step, state in enumerate(states)])
    found = truth.at(3 * SECOND)
    assert found is not None
    np.testing.assert_allclose(found.state, [[3.0, 0.0, 1.0, 0.0]])
    last = truth.at(12 * SECOND)
    assert last is not None and last.state[0, 0] == pytest.approx(10.0)


def test_a_target_is_there_between_samples_that_both_have_it() -> None:
    truth = PositionTruth(
        [
            sample(0.0, [4, 5], np.zeros((2, 4))),
            sample(1.0, [5, 6], np.zeros((2, 4))),
            sample(2.0, [6], np.array([[np.nan] * 4])),
        ]
    )
    between = truth.at(SECOND // 2)
    assert between is not None and list(between.id) == [5]
    unplaced = truth.at(2 * SECOND)
    assert unplaced is not None and len(unplaced.id) == 0
    assert truth.at(-1) is None and truth.at(4 * SECOND) is None
    assert truth.first_seen() == {4: 0, 5: 0, 6: SECOND}
