"""Sentences of NMEA 0183 into a node, from UDP; what cannot be used is reported by kind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from sonar_tracking.bags.nmea.udp_lines import UdpLines
from sonar_tracking.errors import Severity
from sonar_tracking.graph.node_base.diagnostics import Diagnostics
from sonar_tracking.records.time import NANOSECONDS, seconds

SENTENCES = "sentences"
"""Concern: what is heard."""

LOOK_PERIOD = 0.05
"""Between two looks at what has come, s."""

QUIET = 3 * NANOSECONDS // 10
"""After so long without a line a burst of sentences is over, ns."""

SILENT = 5 * NANOSECONDS
"""After so long without a line it is said that nothing is heard, ns."""


class SentenceInput:
    """Gives a node the lines that come, and tells how many of each kind cannot be used.

    Parameters
    ----------
    node : Node
        The node.
    diagnostics : Diagnostics
        Of the node.
    address : str
        Where to listen.
    port : int
        UDP port.
    take : callable
        Called with each line.
    used, faults : Counter of str
        Sentences of each format that are used, and lines of each kind that are not.
    burst_is_over : callable, optional
        Called once nothing has come for a moment.
    """

    def __init__(
        self,
        node: Node,
        diagnostics: Diagnostics,
        address: str,
        port: int,
        take: Callable[[bytes], None],
        used: Counter[str],
        faults: Counter[str],
        burst_is_over: Callable[[], None] | None = None,
    ) -> None:
        self._lines = UdpLines(address, port)
        self._where = f"{address}, port {port}"
        self._diagnostics = diagnostics
        self._take = take
        self._used = used
        self._faults = faults
        self._burst_is_over = burst_is_over
        self._reported: Counter[str] = Counter()
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._heard = self._steady.now().nanoseconds
        self._in_burst = False
        diagnostics.add(SENTENCES, lambda: {**self._used, "not used": sum(self._faults.values())})
        node.create_timer(LOOK_PERIOD, self._look, clock=self._steady)

    def _look(self) -> None:
        now = self._steady.now().nanoseconds
        lines = self._lines.read()
        for line in lines:
            self._take(line)
        if lines:
            self._heard, self._in_burst = now, True
        elif self._in_burst and now - self._heard > QUIET:
            self._in_burst = False
            if self._burst_is_over is not None:
                self._burst_is_over()
        self._report(now)

    def _report(self, now: int) -> None:
        silent = now - self._heard > SILENT
        self._diagnostics.report(
            SENTENCES,
            "silence",
            Severity.WARN if silent else Severity.OK,
            f"nothing is heard at {self._where} for {seconds(now - self._heard):.0f} s; let the "
            "receiver or multiplexer send to this machine, or listen elsewhere.",
            lasting=True,
        )
        for kind, count in self._faults.items():
            if count != self._reported[kind]:
                self._reported[kind] = count
                # Lasting: it is logged once, and the count goes on.
                text = f"{count} times {kind}."
                self._diagnostics.report(SENTENCES, kind, Severity.WARN, text, lasting=True)
