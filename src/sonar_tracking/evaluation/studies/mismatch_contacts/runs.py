"""One run under one condition: the same contacts for both trackers, and their scores."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.metrics.held_identities import HeldIdentities, held_identities
from sonar_tracking.evaluation.metrics.position_score import PositionScore, score_position_tracks
from sonar_tracking.evaluation.metrics.score_statistics import mean
from sonar_tracking.evaluation.studies.mismatch_contacts.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_contacts.scene import Scene, as_told
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts

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
    """One run.

    Attributes
    ----------
    condition : str
        Name of the condition.
    seed : numpy.random.SeedSequence
        Of the run.
    n_pings : int
        Its length; 0 = that of the condition.
    """

    condition: str
    seed: np.random.SeedSequence
    n_pings: int = 0


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


def mismatch_run(task: MismatchTask) -> MismatchRun:
    """Simulate one run and track it with the defaults and with what is true."""
    condition = CONDITIONS[task.condition]
    scene = condition.scene(task.seed, task.n_pings or condition.n_pings)
    reduced = [as_told(ping, condition.hidden, condition.claimed) for ping in scene.pings]
    return MismatchRun(
        task.condition,
        {
            DEFAULTS: _tracked(DEFAULT_CONFIGURATION, reduced, scene, condition.cutoff_m),
            TOLD: _tracked(condition.told, scene.pings, scene, condition.cutoff_m),
        },
    )


def _tracked(
    configuration: ContactTrackerConfiguration,
    pings: Sequence[Contacts],
    scene: Scene,
    cutoff_m: float,
) -> dict[str, float]:
    tracker = make_contact_tracker(configuration)
    started = time.process_time()
    tracks = [tracker.update(ping).tracks for ping in pings]
    seconds = (time.process_time() - started) / len(pings)
    score = score_position_tracks(scene.truth(), tracks, cutoff_m)
    held = held_identities(scene.true_state, tracks, cutoff_m)
    return {**figures(score, held, scene.true_state), "cpu_ms": 1e3 * seconds}


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
