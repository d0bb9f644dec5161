"""The scenario ``active`` in one process: what it promises is kept, and it is reproducible."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.offline.offline_contact_chain import (
    OfflineActiveRun,
    run_offline_active_chain,
)
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario


def scenario(seed: int = 1, **parameters: float | str) -> Scenario:
    shipped = load_scenario("active")
    tracker = {**shipped.nodes["hpda_tracker"], **parameters}
    return replace(shipped, seed=seed, nodes={"hpda_tracker": tracker})


@pytest.fixture(scope="module")
def run() -> OfflineActiveRun:
    return run_offline_active_chain(scenario())


def test_all_targets_are_followed_under_their_names_among_clutter(run: OfflineActiveRun) -> None:
    contacts = [len(ping.contacts.range) for ping in run.pings]
    assert 35 < np.mean(contacts) < 55
    score = run.score()
    assert score.targets == 5
    assert score.rmse_m < 30.0
    assert score.ospa_m < 40.0
    assert 0.3 < score.nees_per_dimension < 1.5
    identities = score.identities
    assert identities.held_share > 0.95
    assert identities.continuity > 0.9
    assert identities.false_tracks == 0
    assert identities.confirmation_delay_periods < 6.0


def test_every_ping_has_its_picture(run: OfflineActiveRun) -> None:
    for ping, update in zip(run.pings, run.updates, strict=True):
        assert update.tracks.stamp == update.thresholds.stamp == ping.contacts.stamp
        assert update.tracks.next_stamp == update.thresholds.next_stamp == ping.contacts.next_stamp
        assert not update.notices
    assert run.updates[-1].tracks.next_stamp == END_OF_DATA


def test_a_track_that_has_ended_is_told_once_and_never_again(run: OfflineActiveRun) -> None:
    """The submarine dives: among others its track ends."""
    ended: list[int] = []
    for update in run.updates:
        tracks = update.tracks
        assert not set(ended) & set(tracks.id.tolist())
        ended += tracks.id[tracks.status == TrackStatus.TERMINATED].tolist()
    assert ended
    assert len(set(ended)) == len(ended)


def test_the_chain_is_reproducible(run: OfflineActiveRun) -> None:
    again = run_offline_active_chain(scenario())
    assert np.array_equal(again.updates[-1].tracks.state, run.updates[-1].tracks.state)
    other = run_offline_active_chain(replace(scenario(seed=2), duration=10.0))
    assert not np.array_equal(other.pings[0].contacts.range, run.pings[0].contacts.range)


@pytest.fixture(scope="module")
def default() -> OfflineActiveRun:
    return run_offline_active_chain(replace(scenario(), duration=400.0))


@pytest.mark.parametrize("method", ["hpda_kalman", "hpda_particle", "roi_clustering", "smc_phd"])
def test_every_method_runs_the_scenario(method: str, default: OfflineActiveRun) -> None:
    """None does better than the default."""
    short = replace(scenario(method=method, n_particles=300), duration=400.0)
    other = run_offline_active_chain(short)
    assert len(other.updates) == 40
    assert default.score().ospa_m < other.score().ospa_m


def test_thresholds_in_the_gates_do_no_harm(run: OfflineActiveRun) -> None:
    closed = run_offline_active_chain(scenario(gate_threshold="closed_form"))
    thresholds = [update.thresholds for update in closed.updates if len(update.thresholds.track_id)]
    assert all(one.method == "closed_form" for one in thresholds)
    assert closed.score().ospa_m < 1.1 * run.score().ospa_m


def test_wrong_parameters_are_refused() -> None:
    with pytest.raises(ConfigurationError, match="hpda_tracker"):
        run_offline_active_chain(scenario(method="hpda"))
