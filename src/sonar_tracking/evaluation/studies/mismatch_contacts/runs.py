"""Runs under one condition: the same contacts for both trackers, and their scores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.metrics.held_identities import HeldIdentities, held_identities
from sonar_tracking.evaluation.metrics.position_score import PositionScore, score_position_tracks
from sonar_tracking.evaluation.metrics.score_statistics import mean
from sonar_tracking.evaluation.monte_carlo.tracked_runs import track_runs
from sonar_tracking.evaluation.studies.mismatch_contacts.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_contacts.scene import Scene, as_told
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.positions import PositionTracks

DEFAULTS = "defaults"
TOLD = "told the truth"

DEFAULT_CONFIGURATION = ContactTrackerConfiguration(sound_speed=0.0)
"""A user knows how fast sound is: these scenes are instantaneous."""

SETTLED_PINGS = 10
"""Age of a target from which on it should have a track."""

FAST = 1.0
"""m/s; a track of a target at rest that claims more is wrong."""


@dataclass(frozen=True)
class MismatchTask:
    """Runs that are tracked together.

    Attributes
    ----------
    condition : str
        Name of the condition.
    seeds : tuple of numpy.random.SeedSequence
        One a run.
    n_pings : int
        Their length; 0 = that of the condition.
    timed : bool
        Whether processor times are measured, too.
    """

    condition: str
    seeds: tuple[np.random.SeedSequence, ...]
    n_pings: int = 0
    timed: bool = False


@dataclass(frozen=True)
class MismatchRun:
    """What both trackers did in one run.

    Attributes
    ----------
    condition : str
        Name of the condition.
    metrics : mapping of str to mapping of str to float
        Figures of each tracker; NaN = there is none.
    """

    condition: str
    metrics: Mapping[str, Mapping[str, float]]


def mismatch_runs(task: MismatchTask) -> tuple[MismatchRun, ...]:
    """Simulate runs and track them with the defaults and with what is true."""
    condition = CONDITIONS[task.condition]
    scenes = [condition.scene(seed, task.n_pings or condition.n_pings) for seed in task.seeds]
    told = [scene.pings for scene in scenes]
    reduced = [
        [as_told(ping, condition.hidden, condition.claimed) for ping in pings] for pings in told
    ]
    of_scenes = (scenes, [scene.truth() for scene in scenes], condition.cutoff_m, task.timed)
    by_default = _tracked(DEFAULT_CONFIGURATION, reduced, *of_scenes)
    by_truth = _tracked(condition.told, told, *of_scenes)
    return tuple(
        MismatchRun(task.condition, {DEFAULTS: one, TOLD: other})
        for one, other in zip(by_default, by_truth, strict=True)
    )


def _tracked(
    configuration: ContactTrackerConfiguration,
    runs: Sequence[Sequence[Contacts]],
    scenes: Sequence[Scene],
    truths: Sequence[Sequence[PositionTracks]],
    cutoff_m: float,
    timed: bool,
) -> list[dict[str, float]]:
    (tracked,) = track_runs([configuration], runs, timed)
    metrics = []
    for scene, truth, updates in zip(scenes, truths, tracked.updates, strict=True):
        tracks = [update.tracks for update in updates]
        score = score_position_tracks(truth, tracks, cutoff_m)
        held = held_identities(scene.true_state, tracks, cutoff_m)
        own = figures(score, held, scene.true_state)
        metrics.append({**own, "cpu_ms": 1e3 * tracked.seconds})
    return metrics


def figures(score: PositionScore, held: HeldIdentities, true_state: FloatArray) -> dict[str, float]:
    """Return the figures of one tracker in one run.

    Parameters
    ----------
    score : PositionScore
        Of its tracks.
    held : HeldIdentities
        Who had which target.
    true_state : ndarray, shape (n_pings, n_targets, 4)
        m and m/s; NaN = not there.
    """
    identities = score.identities
    metrics = {
        "held_share": identities.held_share,
        "settled_held_share": held.share_held_from(SETTLED_PINGS),
        "false_tracks_per_hour": identities.false_tracks_per_hour,
        "identity_swaps": float(identities.identity_swaps),
        "continuity": identities.continuity,
        "nees_per_dimension": score.nees_per_dimension,
        "ospa_m": score.ospa_m,
        "rmse_m": score.rmse_m,
        "identities_per_target": len(held.confirmed) / score.targets,
    }
    speed = np.hypot(true_state[..., 2], true_state[..., 3])
    present = held.present.any(axis=0)
    at_rest = present & (np.where(held.present, speed, 0.0).max(axis=0) == 0.0)
    moving = present & ~at_rest
    if np.any(at_rest):
        claimed = held.speed[:, at_rest][held.held[:, at_rest]]
        metrics["fast_share_of_fixed"] = mean((claimed > FAST).astype(float))
    if np.any(at_rest) and np.any(moving):
        metrics["moving_continuity"] = mean(held.continuities()[moving])
    return metrics
