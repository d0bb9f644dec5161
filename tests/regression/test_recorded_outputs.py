"""Protects every number of every method: short runs give what they gave when they were recorded.

Whether the numbers are right is for the other tests to say; this one notices that they change. When
they are meant to change, ``python -m tests.regression.test_recorded_outputs NAME ...`` records the
cases anew (all of them without names), and the commit says why.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from tests.regression.cases import CASES, Outputs

RECORDED = Path(__file__).with_name("recorded")
TOLERANCE = 1e-5
"""Relative to the number, and to a thousandth of the largest of its kind: other machines round
otherwise."""

LONG = {
    *("appearing_targets", "batch_estimates", "coloured_noise", "cross_fix", "crossing_targets"),
    *("range_bank", "fused_line", "stacked_lines", "stacked_lines_restarted", "summed_lines"),
    "tonals",
}
"""Cases of more than half a second."""


def largest(values: np.ndarray) -> float:
    """Return the largest finite magnitude."""
    return float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))


def record(name: str, outputs: Outputs) -> None:
    """Keep the outputs of a case."""
    RECORDED.mkdir(exist_ok=True)
    kept = {key: np.asarray(values, np.float32) for key, values in outputs.items()}
    np.savez_compressed(RECORDED / f"{name}.npz", allow_pickle=False, **kept)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in LONG)) for name in CASES]
)
def test_outputs_are_as_recorded(name: str) -> None:
    outputs = CASES[name]()
    with np.load(RECORDED / f"{name}.npz") as kept:
        assert set(kept) == set(outputs)
        for key, values in outputs.items():
            floor = 1e-3 * TOLERANCE * largest(kept[key])
            np.testing.assert_allclose(values, kept[key], TOLERANCE, floor, err_msg=key)


def test_every_recording_has_a_case() -> None:
    assert {path.stem for path in RECORDED.glob("*.npz")} == set(CASES)


if __name__ == "__main__":
    for each in sys.argv[1:] or CASES:
        record(each, CASES[each]())
        print(f"recorded {each}")
