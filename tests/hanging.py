"""A test that hangs ends its process, and where all its threads are is printed.

What waits for it is a thread that is started anew every half minute. One for each test, as of
pytest-timeout and of ``faulthandler_timeout``, takes as long as a short test itself.
"""

from __future__ import annotations

import faulthandler
import math
import os
import time
from collections.abc import Generator

import pytest

LONGEST = 600.0
"""A test may take, s."""
ANEW = 30.0
"""After so long the waiting begins anew, s; a test may take so much longer."""


class Watch:
    """Ends this process if it does not come to its next test.

    Parameters
    ----------
    longest, anew : float
        A test may take, and after so long the waiting begins anew, s.
    """

    def __init__(self, longest: float = LONGEST, anew: float = ANEW) -> None:
        self._wait, self._anew = longest + anew, anew
        self._begun = -math.inf
        self._errors = os.dup(2)  # what tests write there is captured

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(
        self, nextitem: pytest.Item | None
    ) -> Generator[None, object, object]:
        """Wait for the end of a test; for none once all have been run."""
        now = time.monotonic()
        if now - self._begun > self._anew:
            self._begun = now
            faulthandler.dump_traceback_later(self._wait, exit=True, file=self._errors)
        done = yield
        if nextitem is None:
            faulthandler.cancel_dump_traceback_later()
            self._begun = -math.inf
        return done


def pytest_configure(config: pytest.Config) -> None:
    """Watch over the tests, unless somebody looks into them."""
    if not config.getoption("usepdb") and not config.getoption("trace"):
        config.pluginmanager.register(Watch())
