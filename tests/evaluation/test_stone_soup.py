"""Protects: OSPA and GOSPA are those of Stone Soup on the same tracks, to 1e-9.

Stone Soup 1.9.1 assigns by the plain distance for OSPA, the definition by its power: for orders
above 1 its OSPA may be larger where targets are as close as the errors. GOSPA has no such reserve.
"""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime
from itertools import product
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.evaluation.metrics.ospa_gospa import assign, gospa, ospa
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    SceneOptions,
    simulate_scene,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.systems import INTEGRATED, PAPER_SYSTEMS
from sonar_tracking.records.bearings import TrackStatus

TIME = datetime(2026, 1, 1)


def peer(name: str, cutoff: float, order: float) -> Any:
    """Return a metric of Stone Soup; skip the test where it is not installed."""
    reason = "Stone Soup is not installed; ./scripts/test.sh installs it"
    module = pytest.importorskip("stonesoup.metricgenerator.ospametric", reason=reason)
    return getattr(module, name)(c=cutoff, p=order)


def states(positions: np.ndarray) -> list[Any]:
    state = pytest.importorskip("stonesoup.types.state").State
    return [state(position[:, None], timestamp=TIME) for position in positions]


def both_distances(
    truth: np.ndarray, estimates: np.ndarray, cutoff: float, order: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return our OSPA and GOSPA, and those of Stone Soup."""
    separation = truth[:, None] - estimates[None]
    assignment = assign(np.hypot(separation[..., 0], separation[..., 1]), cutoff, order)
    sets = states(estimates), states(truth)
    their_ospa = peer("OSPAMetric", cutoff, order).compute_OSPA_distance(*sets).value
    metric, _ = peer("GOSPAMetric", cutoff, order).compute_gospa_metric(*sets)
    ours = ospa(assignment, cutoff, order), gospa(assignment, cutoff, order)
    return ours, (float(their_ospa), float(metric.value["distance"]))


def tracked_pictures() -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield true and estimated positions of a run in dense clutter, ping by ping."""
    tracker = make_contact_tracker(PAPER_SYSTEMS[INTEGRATED])
    for ping in simulate_scene(SceneOptions(2), np.random.SeedSequence(5), 170):
        tracks = tracker.update(ping.contacts).tracks
        shown = np.isin(tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
        yield ping.state[:, :2], tracks.state[shown, :2]


@pytest.mark.slow
def test_distances_of_tracks_are_those_of_stone_soup() -> None:
    sizes = set()
    for truth, estimates in tracked_pictures():
        sizes.add((len(truth), len(estimates)))
        ours, theirs = both_distances(truth, estimates, cutoff=200.0, order=2.0)
        assert ours == pytest.approx(theirs, abs=1e-9, rel=0.0)
    assert len(sizes) >= 5  # too few, enough and too many estimates were among them


@pytest.mark.parametrize(("cutoff", "order"), [(20.0, 2.0), (5.0, 1.0), (50.0, 3.0)])
def test_distances_of_any_sets_are_those_of_stone_soup(cutoff: float, order: float) -> None:
    generator = np.random.default_rng(6)
    for n_truths, n_estimates in product(range(5), range(5)):
        if n_truths + n_estimates == 0:
            continue  # Stone Soup takes the time from the states and needs one
        truth = generator.normal(0.0, 20.0, (n_truths, 2))
        estimates = generator.normal(0.0, 20.0, (n_estimates, 2))
        ours, theirs = both_distances(truth, estimates, cutoff, order)
        assert ours[1] == pytest.approx(theirs[1], abs=1e-9, rel=0.0)
        if order == 1.0:
            assert ours[0] == pytest.approx(theirs[0], abs=1e-9, rel=0.0)
        assert ours[0] <= theirs[0] + 1e-9
