"""Protects how much a covariance tells of the errors of the elements: as much as is new in it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sonar_tracking.passive.bearings.steering_uncertainty import SteeringMisfit, SteeringUncertainty
from tests.passive.bearings.test_faint_tracks import estimates_of, source, tracked


def test_of_a_covariance_counts_what_is_new_and_after_a_gap_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """However long nothing came before it: no more than all of it."""
    shares: list[float] = []

    def update(
        self: SteeringUncertainty, misfit: SteeringMisfit | None, share: float
    ) -> SteeringUncertainty:
        shares.append(share)
        return self

    monkeypatch.setattr(SteeringUncertainty, "update", update)
    estimates = [
        replace(each, covariance_snapshots=2 * each.covariance_snapshots)
        for each in estimates_of(source(0.0), duration=20.0)
    ]
    tracked([*estimates[:20], estimates[30]])
    assert shares[-2:] == pytest.approx([0.5, 1.0])
