"""Which faults a run suffers, and when: drawn from a seed, so that a run can be repeated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from sonar_tracking.errors import ConfigurationError, unknown_name_text

FIRST, BETWEEN = 2.0, (4.0, 7.0)
"""Until the first fault, and between two of them, s of the wall clock."""

STOPPED = (0.5, 4.0)
"""A node is stopped for, s."""

MALFORMED_MESSAGES = 40
"""Sent at once."""


class FaultKind(Enum):
    """What happens."""

    KILL = "kill"
    STOP = "stop"
    MALFORMED = "malformed"
    RECORDER = "recorder"
    ORCHESTRATION = "orchestration"
    INTERRUPT = "interrupt"


DESCRIPTIONS: Mapping[FaultKind, str] = {
    FaultKind.KILL: "a node, drawn among those that compute or simulate, gets SIGKILL",
    FaultKind.STOP: "such a node is stopped for 0.5 to 4 s",
    FaultKind.MALFORMED: "40 malformed messages on an input of a node, from a second publisher",
    FaultKind.RECORDER: "the recorder gets SIGKILL",
    FaultKind.ORCHESTRATION: "the orchestration gets SIGKILL, at any moment of its life",
    FaultKind.INTERRUPT: "Ctrl-C, at any moment of its life",
}
ENDS_THE_RUN = {FaultKind.ORCHESTRATION, FaultKind.INTERRUPT}


@dataclass(frozen=True)
class Fault:
    """One thing that happens to a run.

    Attributes
    ----------
    kind : FaultKind
        What.
    target : str
        Node, or topic of malformed messages; empty = the run itself.
    seconds : float
        When: after data flow; of what ends the run, after its start. Wall clock, s.
    duration : float
        For how long, s.
    seed : int
        Of what else is drawn.
    """

    kind: FaultKind
    target: str
    seconds: float
    duration: float
    seed: int


def fault_kinds(text: str) -> tuple[FaultKind, ...]:
    """Return the kinds named in a text, with commas between.

    Raises
    ------
    ConfigurationError
        If there is no such kind.
    """
    known = {kind.value: kind for kind in FaultKind}
    names = [name.strip() for name in text.split(",") if name.strip()]
    for name in names:
        if name not in known:
            raise ConfigurationError(unknown_name_text("--faults", name, known))
    return tuple(known[name] for name in names) or tuple(FaultKind)


def plan_faults(
    kind: FaultKind,
    nodes: Sequence[str],
    topics: Sequence[str],
    count: int,
    generator: np.random.Generator,
) -> tuple[Fault, ...]:
    """Return the faults of one run, in order of time.

    Parameters
    ----------
    kind : FaultKind
        Of all of them.
    nodes : sequence of str
        That compute or simulate.
    topics : sequence of str
        Inputs of nodes.
    count : int
        Of what does not end the run.
    generator : numpy.random.Generator
        Draws targets and times.
    """
    if kind in ENDS_THE_RUN:
        return (Fault(kind, "", float(generator.uniform(0.0, 12.0)), 0.0, 0),)
    targets = {FaultKind.MALFORMED: topics, FaultKind.RECORDER: ("recorder",)}.get(kind, nodes)
    seconds, faults = FIRST, []
    for _ in range(count):
        seconds += float(generator.uniform(*BETWEEN))
        target = targets[int(generator.integers(len(targets)))]
        duration = float(generator.uniform(*STOPPED)) if kind is FaultKind.STOP else 0.0
        faults.append(Fault(kind, target, seconds, duration, int(generator.integers(2**31))))
    return tuple(faults)
