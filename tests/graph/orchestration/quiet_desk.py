"""A run in which nobody gives commands."""

from __future__ import annotations

from typing import Any

from sonar_tracking.graph.orchestration.command_desk import CommandDesk
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger


def quiet_desk() -> CommandDesk:
    """Return the desk of such a run."""
    nobody: Any = None
    return CommandDesk("", {}, (), FlowLedger({}, {}), nobody, nobody, nobody)
