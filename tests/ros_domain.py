"""A ROS domain for every process of tests: no other test, checkout or user has the same."""

from __future__ import annotations

import atexit
import os
import socket
import zlib
from contextlib import suppress
from functools import cache
from pathlib import Path
from unittest import mock

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.orchestration.domain_lock import domain_lock

LARGEST_DOMAIN = 101
"""Above it, the UDP ports of DDS are among those that Linux gives to any program."""


@cache
def ros_domain() -> int:
    """Return the ROS domain of this process, which is claimed by the first call.

    A claim is a name in the kernel: it holds for all users that share a network, and ends with
    the process. Where the search begins depends on checkout, user and worker, so that claims
    seldom meet; a domain in which somebody runs the pipeline, or works (``ROS_DOMAIN_ID``), is
    passed over.
    """
    worker = os.environ.get("PYTEST_XDIST_WORKER", "")
    first = zlib.crc32(f"{Path(__file__)} {os.getuid()} {worker}".encode())
    for step in range(LARGEST_DOMAIN):
        domain = 1 + (first + step) % LARGEST_DOMAIN
        if str(domain) != os.environ.get("ROS_DOMAIN_ID") and _claim(domain):
            return domain
    raise RuntimeError(f"other tests hold all {LARGEST_DOMAIN} ROS domains: wait for their end.")


def _claim(domain: int) -> bool:
    """Return whether the domain was free and is now held for the life of this process."""
    claim = socket.socket(socket.AF_UNIX)
    with suppress(OSError, ConfigurationError):
        claim.bind(f"\0sonar_tracking-tests-domain-{domain}")
        with mock.patch.dict(os.environ, ROS_DOMAIN_ID=str(domain)), domain_lock():
            atexit.register(claim.close)
            return True
    claim.close()
    return False
