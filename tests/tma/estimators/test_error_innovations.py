"""Protects what a bank learns of errors: no motion for an error, the same bits compiled or not."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators import error_innovations
from sonar_tracking.tma.estimators.bank_batch import RunRows
from sonar_tracking.tma.estimators.error_innovations import (
    BankInnovations,
    ErrorInnovations,
    as_of_first_side,
    without_common_doppler,
)
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank
from sonar_tracking.tma.estimators.measurement_model import LinearisedRows
from sonar_tracking.tma.estimators.recursion import rows_of
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement


def test_motion_that_all_lines_show_is_no_error_of_theirs() -> None:
    """A shift in proportion to the frequencies leaves nothing; one line alone stands out."""
    frequency = np.array([200.0, 300.0, 150.0, 250.0])
    variance, everything = np.full(4, 0.01), np.ones(4, dtype=bool)
    shift = 0.002 * frequency
    left, own = without_common_doppler(shift, np.ones(4), frequency, variance, everything)
    assert left == pytest.approx(np.zeros(4), abs=1e-12)
    # The first by the others: 200^2 0.01 / (300^2 + 150^2 + 250^2).
    assert own[0] == pytest.approx(0.01 * 200.0**2 / 175_000.0)
    shift[2] += 0.5
    left, _ = without_common_doppler(shift, np.ones(4), frequency, variance, everything)
    assert left[2] == pytest.approx(0.5)
    assert np.max(np.abs(left[[0, 1, 3]])) < 0.2


def test_of_two_lines_neither_is_judged_by_the_other() -> None:
    two = np.array([True, True, False])
    innovation, own = np.array([0.3, -0.2, 0.0]), np.array([0.1, 0.2, 0.3])
    left, spread = without_common_doppler(
        innovation, own, np.array([200.0, 300.0, np.nan]), np.full(3, 0.01), two
    )
    np.testing.assert_array_equal(left, innovation)
    np.testing.assert_array_equal(spread, own)


def seen_together(n_lines: int) -> ErrorInnovations:
    """Return what three runs of different sizes say, some rows of which are not there."""
    generator = np.random.default_rng(9)
    counts = np.array([4, 1, 9])
    runs, shape = RunRows(counts), (int(counts.sum()), 1, 2 + n_lines)
    present = (generator.random((3, 2 + n_lines)) < 0.8)[runs.owner][:, None]
    rows = LinearisedRows(
        generator.standard_normal(shape) * present,
        np.zeros((*shape, 4 + n_lines)),
        np.where(present, generator.uniform(0.5, 2.0, 2 + n_lines), 1.0),
        present,
    )
    weight = np.concatenate([generator.dirichlet(np.ones(count)) for count in counts])[:, None]
    frequency = generator.uniform(50.0, 900.0, (3, n_lines))
    frequency[~present[runs.starts, 0, 2:]] = np.nan
    usable = generator.random(3) < 0.7, generator.random((3, n_lines)) < 0.8
    seen = BankInnovations(runs, weight, rows, rows.variance + generator.random(shape), frequency)
    return error_innovations.error_innovations(
        seen, generator.uniform(0.5, 3.0, (3, 1 + n_lines)), usable
    )


@pytest.mark.skipif(error_innovations.COMPILED is None, reason="no compiler was there")
@pytest.mark.parametrize("n_lines", [0, 2, 6, 12])
def test_compiled_averages_give_the_bits_of_numpy(
    n_lines: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled = seen_together(n_lines)
    monkeypatch.setattr(error_innovations, "COMPILED", None)
    plain = seen_together(n_lines)
    for name in ("innovation", "own_variance", "telling"):
        np.testing.assert_array_equal(getattr(compiled, name), getattr(plain, name), name)
    assert compiled.telling.any()


def test_an_error_of_a_line_arrays_angle_looks_alike_on_both_of_its_sides() -> None:
    """Own ship at the origin, the array along x: sides are mirror images about it."""
    state = np.array([[[3000.0, 4000.0, 0.0, 0.0]], [[3000.0, -4000.0, 0.0, 0.0]]])
    angle = np.arctan2(4.0, 3.0) + 0.01
    measurement = TmaMeasurement(
        stamp=1,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.array([angle, -angle]),
        azimuth_variance=np.array(1e-4),
    )
    rows = rows_of(
        HypothesisBank(state, np.zeros((2, 1, 4, 4)), np.zeros((2, 1)), np.zeros((2, 0), bool)),
        measurement,
    )
    assert rows.innovation[:, 0, 0] == pytest.approx([0.01, -0.01])
    sided = as_of_first_side(rows, state, measurement)
    assert sided.innovation[:, 0, 0] == pytest.approx([0.01, 0.01])
    single = replace(measurement, azimuth=measurement.azimuth[:1])
    assert as_of_first_side(rows, state, single) is rows
