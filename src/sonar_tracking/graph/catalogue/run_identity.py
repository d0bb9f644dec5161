"""By what the processes of one run know each other, among all that speak in the same domain.

The orchestration draws an identity, hands it to the nodes it starts, and believes reports on
``flow/done`` and ``/diagnostics`` that bear it only. It keeps out what other runs, tools and nodes
say by mistake; against those who copy it, a network needs the security of DDS.
"""

from __future__ import annotations

import os
import secrets

VARIABLE = "SONAR_TRACKING_RUN"
"""Environment variable that holds the identity; nodes started by hand have none."""

CONTROL_NODE = "orchestration"
"""Name of the node of the orchestration."""


def new_identity() -> str:
    """Return the identity of a new run."""
    return secrets.token_hex(8)


def own_identity() -> str:
    """Return the identity of the run that this process was started for; empty = by hand."""
    return os.environ.get(VARIABLE, "")


def signed(node: str, identity: str | None = None) -> str:
    """Return how a node calls itself where only its run is to believe it.

    Parameters
    ----------
    node : str
        Its name.
    identity : str, optional
        Of the run; default: the one this process was given.
    """
    if identity is None:
        identity = own_identity()
    return f"{node}@{identity}" if identity else node
