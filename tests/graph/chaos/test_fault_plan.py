"""A disturbed run can be repeated: the seed alone decides what happens, to whom and when."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.chaos.fault_plan import (
    BETWEEN,
    ENDS_THE_RUN,
    OF_THE_NETWORK,
    FaultKind,
    fault_kinds,
    plan_faults,
)

NODES, TOPICS = ("simulator", "tracker"), ("active/contacts",)


@pytest.mark.parametrize("kind", FaultKind)
def test_the_same_seed_gives_the_same_faults(kind: FaultKind) -> None:
    first, again, other = (
        plan_faults(kind, NODES, TOPICS, 3, np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    assert first == again != other


@pytest.mark.parametrize("kind", FaultKind)
def test_faults_come_one_after_the_other_and_hit_what_they_can(kind: FaultKind) -> None:
    faults = plan_faults(kind, NODES, TOPICS, 4, np.random.default_rng(3))
    targets = {fault.target for fault in faults}
    if kind in ENDS_THE_RUN:
        assert len(faults) == 1 and targets == {""}
        return
    assert len(faults) == (1 if kind in OF_THE_NETWORK else 4)
    assert all(BETWEEN[0] <= fault.seconds <= BETWEEN[1] for fault in faults)
    nodes = (FaultKind.KILL, FaultKind.STOP)
    allowed = {FaultKind.MALFORMED: set(TOPICS), FaultKind.RECORDER: {"recorder"}}
    assert targets <= allowed.get(kind, set(NODES) if kind in nodes else {""})
    lasting = {FaultKind.STOP, *OF_THE_NETWORK}
    assert all((fault.duration > 0.0) == (kind in lasting) for fault in faults)


def test_kinds_are_named_with_commas_between() -> None:
    assert fault_kinds("kill, interrupt") == (FaultKind.KILL, FaultKind.INTERRUPT)
    assert set(fault_kinds("")) == set(FaultKind) - OF_THE_NETWORK, "no privileges are needed"
    with pytest.raises(ConfigurationError, match="kill"):
        fault_kinds("kil")
