"""Three stations and more: where two bearings cross, a third one must point.

Two bearings cross somewhere, whatever they are of: ghosts of two stations fall behind only as these
or the targets move. Of three stations hardly any three bearings meet by chance, and of four still
fewer. So where a trial says from which direction a further station should hear it, and a target of
that station is there, all of them are tried as one. The evidence goes on from that of the smaller
trial. What the further station says from then on is compared with a target that begins then, whose
first bearing may come from anywhere. A target of several stations points to others in the same way.
A target that is elsewhere is not looked for again before a pause is over: bearings that only cross
for a moment must not be waited for.

Targets are certain to be one if the best explanation of all leads the best one in which they are
not together by the odds. Explanations are trials that have no target in common.

References
----------
Bar-Shalom, Li, Multitarget-Multisensor Tracking: Principles and Techniques, YBS 1995, section 8.3
(ghosts of passive sensors, and association over several lists).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from sonar_tracking.filtering.set_packing import best_packing
from sonar_tracking.tma.stations.solver_likelihoods import log_likelihoods
from sonar_tracking.tma.stations.station_association import CHANCE_DENSITY
from sonar_tracking.tma.stations.station_trials import LEAST_BEARINGS, Key, Sighting, Trial
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver

POINTED = 10.0
"""How much more likely than from anywhere a bearing is where a trial points to it."""

MOST_OF_A_TARGET = 8
"""Larger trials that are begun with a target at one instant: those that point to it best."""


def pointed_at(
    trials: Sequence[Trial],
    located: Sequence[FollowedTarget],
    seen: Sequence[Sighting],
    known: Collection[Key],
    deviation: float,
) -> tuple[list[Trial], set[Key]]:
    """Return trials of what a station sees where those under way point to, and what is elsewhere.

    Parameters
    ----------
    trials : sequence of Trial
        Under way.
    located : sequence of FollowedTarget
        Of several stations already.
    seen : sequence of Sighting
        What one station observed at one instant, to be taken in next.
    known : collection of Key
        What is tried already, or not to be tried now.
    deviation : float
        Of the lasting error of a station's azimuths, rad.

    Returns
    -------
    list of Trial
        To be tried from now on.
    set of Key
        What is elsewhere than where it would have to be.
    """
    alone = [
        Trial((one,), one.solver, deviation=deviation)
        for one in located
        if isinstance(one.solver, TargetSolver)
    ]
    under_way = (*(one for one in trials if one.bearings), *alone)
    candidates = _heard_elsewhere(under_way, seen, known)
    found = log_likelihoods([(trial.solver, one) for trial, _, one in candidates])
    gain = found - np.log([CHANCE_DENSITY * len(one.azimuths) for _, _, one in candidates])
    begun: dict[Key, Trial] = {}
    elsewhere: set[Key] = set()
    count: dict[FollowedTarget, int] = {}
    for row in np.argsort(-gain, kind="stable").tolist():
        trial, target, observation = candidates[row]
        key = _key_of_both(trial, target)
        if key in begun:
            continue
        if gain[row] < 0.0:
            elsewhere.add(key)
        elif gain[row] >= np.log(POINTED) and count.get(target, 0) < MOST_OF_A_TARGET:
            count[target] = count.get(target, 0) + 1
            begun[key] = _extended(trial, target, observation.stamp, deviation)
    return list(begun.values()), elsewhere


def certain_crossings(trials: Sequence[Trial], threshold: float) -> list[Trial]:
    """Return the trials of three and more, or parts of such, whose targets are one for certain.

    Parameters
    ----------
    trials : sequence of Trial
        Under way.
    threshold : float
        Log odds by which they lead.

    Returns
    -------
    list of Trial
        Without a target in common.
    """
    best_of: dict[frozenset[FollowedTarget], Trial] = {}
    for one in sorted(trials, key=lambda one: -one.evidence):
        if one.evidence > 0.0:
            best_of.setdefault(frozenset(one.targets), one)
    likely = list(best_of.values())
    numbers = {target: n for n, target in enumerate(dict.fromkeys(_targets(likely)))}
    members = [frozenset(numbers[target] for target in one.targets) for one in likely]
    values = [one.evidence for one in likely]
    found = best_packing(members, values)
    if found is None:
        return []
    value, chosen = found
    enough = value - threshold
    certain: list[Trial] = []
    for row in chosen:
        if likely[row].is_pair or values[row] < threshold:
            continue
        parts = [part for part in range(len(likely)) if members[part] <= members[row]]
        for part in sorted(parts, key=lambda one: (-len(members[one]), -values[one])):
            together = [members[part] <= each for each in members]
            others = np.where(together, 0.0, values).tolist()
            ripe = likely[part].bearings >= LEAST_BEARINGS
            if ripe and best_packing(members, others, enough) == (enough, ()):
                certain.append(likely[part])
                break
    return certain


def _targets(trials: Sequence[Trial]) -> list[FollowedTarget]:
    return [target for one in trials for target in one.targets]


def _heard_elsewhere(
    trials: Sequence[Trial], seen: Sequence[Sighting], known: Collection[Key]
) -> list[tuple[Trial, FollowedTarget, TargetObservation]]:
    """Return each trial with what a station sees that hears none of the targets of the trial."""
    ripe = [
        (target, observation)
        for target, observation in seen
        if observation.azimuths and isinstance(target.solver, TargetSolver) and target.solutions
    ]
    found = []
    for trial in trials:
        stations = {station for one in trial.targets for station in one.members}
        found += [
            (trial, target, observation)
            for target, observation in ripe
            if stations.isdisjoint(target.members) and _key_of_both(trial, target) not in known
        ]
    return found


def _key_of_both(trial: Trial, added: FollowedTarget) -> Key:
    return frozenset((*trial.targets, added)), trial.agile


def _extended(trial: Trial, added: FollowedTarget, stamp: int, deviation: float) -> Trial:
    """Return the trial with a further target."""
    alone = {target: solver.copy() for target, solver in trial.alone.items()}
    alone[added] = TargetSolver(trial.solver.configuration, begins_anew=False)
    return Trial(
        targets=tuple(sorted((*trial.targets, added), key=lambda one: one.initiated)),
        solver=trial.solver.copy(),
        evidence=trial.evidence,
        alone=alone,
        agile=trial.agile,
        newest=added,
        base=trial if len(trial.targets) > 1 else None,
        begun=stamp,
        deviation=deviation,
        errors=dict(trial.errors),
        errors_alone=dict(trial.errors_alone),
    )
