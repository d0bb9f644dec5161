"""Which faults a run suffers, and when: drawn from a seed, so that a run can be repeated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from sonar_tracking.errors import ConfigurationError, unknown_name_text

BETWEEN = (0.5, 3.0)
"""From when the run goes on as it should until the next fault, s of the wall clock."""

STOPPED = (0.5, 4.0)
"""A node is stopped for, s."""

LATEST_END = 12.0
"""A run is ended so long after its first line at the latest, s."""

MALFORMED_MESSAGES = 40
"""Sent at once."""

DELAYED, PARTED = 10.0, 30.0
"""The network is slow, or parted, for so long, s; before it is parted, it is slow, too."""


class FaultKind(Enum):
    """What happens."""

    NOTHING = "nothing"
    KILL = "kill"
    STOP = "stop"
    MALFORMED = "malformed"
    RECORDER = "recorder"
    DELAY = "delay"
    PARTITION = "partition"
    START = "start"
    ORCHESTRATION = "orchestration"
    INTERRUPT = "interrupt"


DESCRIPTIONS: Mapping[FaultKind, str] = {
    FaultKind.NOTHING: "nothing happens: what the other figures are compared with",
    FaultKind.KILL: "a node, drawn among those that compute or simulate, gets SIGKILL",
    FaultKind.STOP: "such a node is stopped for 0.5 to 4 s",
    FaultKind.MALFORMED: "40 malformed messages on an input of a node, from a second publisher",
    FaultKind.RECORDER: "the recorder gets SIGKILL",
    FaultKind.DELAY: "the network between all nodes delays by 50 ms and loses 10 %, for 10 s",
    FaultKind.PARTITION: (
        "the network is slow as by delay; after 10 s nothing arrives for 30 s, and it stays slow"
    ),
    FaultKind.START: "the run is started and, once data flow, ended by Ctrl-C",
    FaultKind.ORCHESTRATION: "the orchestration gets SIGKILL, at any moment of its life",
    FaultKind.INTERRUPT: "Ctrl-C, at any moment from the first line of the program on",
}
ENDS_THE_RUN = {FaultKind.START, FaultKind.ORCHESTRATION, FaultKind.INTERRUPT}
OF_THE_NETWORK = {FaultKind.DELAY, FaultKind.PARTITION}
USUAL = tuple(kind for kind in FaultKind if kind not in OF_THE_NETWORK)
"""What needs no privileges."""


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
        When: since the run goes on as it should; of what ends the run, since its first line. Wall
        clock, s.
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
    return tuple(known[name] for name in names) or USUAL


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
        return (Fault(kind, "", float(generator.uniform(0.0, LATEST_END)), 0.0, 0),)
    untargeted = ("",)
    targets = {
        FaultKind.KILL: nodes,
        FaultKind.STOP: nodes,
        FaultKind.MALFORMED: topics,
        FaultKind.RECORDER: ("recorder",),
    }.get(kind, untargeted)
    faults = []
    for _ in range(1 if kind in OF_THE_NETWORK else count):
        seconds = float(generator.uniform(*BETWEEN))
        target = targets[int(generator.integers(len(targets)))]
        stopped = float(generator.uniform(*STOPPED))
        duration = {
            FaultKind.STOP: stopped,
            FaultKind.DELAY: DELAYED,
            FaultKind.PARTITION: PARTED,
        }.get(kind, 0.0)
        faults.append(Fault(kind, target, seconds, duration, int(generator.integers(2**31))))
    return tuple(faults)
