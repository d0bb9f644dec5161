"""What a run comes to: the JSON of ``run`` and ``replay``, and the summary people read."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from sonar_tracking.errors import ConfigurationError


@dataclass(frozen=True)
class NodeReport:
    """How a node fared.

    Attributes
    ----------
    exit_code : int
        Of its last process; negative = killed by that signal.
    restarts : int
        How often it was started again.
    cpu_seconds : float
        Processor time over all its processes.
    messages_in, messages_out : int
        Data messages finished and published.
    """

    exit_code: int
    restarts: int
    cpu_seconds: float
    messages_in: int
    messages_out: int


@dataclass(frozen=True)
class TopicReport:
    """What passed over a topic.

    Attributes
    ----------
    messages : int
        Number of messages.
    digest : str
        sha256 over their canonical form.
    comparable : bool
        False if a node was restarted: then the digest says nothing.
    """

    messages: int
    digest: str
    comparable: bool


@dataclass(frozen=True)
class RunReport:
    """Result of ``run`` or ``replay``.

    Attributes
    ----------
    scenario : str
        Name of the scenario.
    data_seconds, wall_seconds : float
        Data time that passed and the wall time it took, start-up not counted.
    nodes, topics : mapping
        By name.
    latency_ms : mapping
        p50, p99 and first of the chain, the algorithmic delay, and how many messages were measured;
        fused_p50, fused_p99 and fused_count of the fused list, if there is one.
    score : mapping
        Metrics against truth; empty without truth.
    comparison : mapping
        Of a replay: output topic to "identical" or a phrase of what differs.
    failures, warnings : list of str
        Sentences; any failure makes the exit code 1.
    interrupted : bool
        Whether it was ended by the user.
    stop_code : int
        Exit code of a run that was: 128 and the number of the signal.
    namespace : str
        Of the graph; empty = the root.
    true_positions : str
        Topic of the true positions.
    """

    scenario: str
    data_seconds: float
    wall_seconds: float
    nodes: Mapping[str, NodeReport] = field(default_factory=dict)
    topics: Mapping[str, TopicReport] = field(default_factory=dict)
    latency_ms: Mapping[str, float] = field(default_factory=dict)
    score: Mapping[str, Any] = field(default_factory=dict)
    comparison: Mapping[str, str] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    interrupted: bool = False
    stop_code: int = 0
    namespace: str = ""
    true_positions: str = "/truth/tracks"

    @property
    def exit_code(self) -> int:
        """Of the run: 0 if nothing failed and nobody ended it."""
        return self.stop_code or (1 if self.failures else 0)

    def write_json(self, path: Path) -> None:
        """Write the report as JSON; numbers that do not exist become null.

        Raises
        ------
        ConfigurationError
            If the file cannot be written.
        """
        values = {**asdict(self), "exit_code": self.exit_code}
        del values["stop_code"]
        try:
            path.write_text(json.dumps(_finite(values), indent=2, sort_keys=True) + "\n")
        except OSError as error:
            raise ConfigurationError(
                f"the report {path} cannot be written ({error.strerror}); give another path."
            ) from error

    def lines(self) -> list[str]:
        """Return the summary for people."""
        rate = self.data_seconds / self.wall_seconds if self.wall_seconds else 0.0
        place = f" in {self.namespace}" if self.namespace else ""
        lines = [
            f"{self.scenario}{place}: {self.data_seconds:.1f} s of data in "
            f"{self.wall_seconds:.1f} s ({rate:.1f} x real time)"
            + (", ended by the user" if self.interrupted else "")
        ]
        lines += [_node_line(name, node) for name, node in self.nodes.items()]
        lines += [_topic_line(name, topic) for name, topic in self.topics.items()]
        lines += [f"  {name:<24} {text}" for name, text in self.comparison.items()]
        if self.latency_ms.get("count"):
            latency = self.latency_ms
            lines.append(
                f"  {'latency':<24} p50 {latency['p50']:.1f} ms, p99 {latency['p99']:.1f} ms after "
                "the data that complete an estimate; algorithmic delay "
                f"{latency['algorithmic']:.1f} ms"
            )
        if self.latency_ms.get("fused_count"):
            latency = self.latency_ms
            lines.append(
                f"  {'latency of fused tracks':<24} p50 {latency['fused_p50']:.1f} ms, "
                f"p99 {latency['fused_p99']:.1f} ms after the last ping or block they need"
            )
        lines += _score_lines(self.score, _BEARING_LINES)
        for topic, score in self.score.get("bearings", {}).items():
            lines.append(f"  {topic}:")
            lines += _score_lines(score, _BEARING_LINES)
        for topic, score in self.score.get("positions", {}).items():
            lines.append(f"  {topic} against {self.true_positions}:")
            lines += _score_lines(score, _POSITION_LINES)
        lines += [f"warning: {text}" for text in self.warnings]
        lines += [f"failed: {text}" for text in self.failures]
        return lines


_IDENTITY_LINES = (
    ("identity_swaps", "identity swaps", ""),
    ("lasting_identity_swaps", "  of these lasting", ""),
    ("lost_tracks", "lost tracks", ""),
    ("targets_never_held", "targets never tracked", ""),
    ("false_tracks", "false tracks", ""),
    ("held_share", "share of time tracked", ""),
)
_BEARING_LINES = (
    ("rmse_deg", "bearing RMSE", " deg"),
    ("median_error_deg", "median bearing error", " deg"),
    *_IDENTITY_LINES,
)
_POSITION_LINES = (
    ("rmse_m", "position RMSE", " m"),
    ("median_error_m", "median position error", " m"),
    ("median_nearest_m", "  to the nearest track", " m"),
    ("ospa_m", "OSPA", " m"),
    ("confirmation_delay", "confirmation delay", " s"),
    *_IDENTITY_LINES,
)
"""What people are shown of the score; the JSON holds all of it."""


def _score_lines(score: Mapping[str, Any], lines: tuple[tuple[str, str, str], ...]) -> list[str]:
    return [
        f"  {words:<24} {_number(score[name], unit)}"
        for name, words, unit in lines
        if name in score
    ]


def _node_line(name: str, node: NodeReport) -> str:
    restarts = f", restarted {node.restarts} x" if node.restarts else ""
    return (
        f"  {name:<24} exit {node.exit_code}{restarts}, {node.cpu_seconds:.1f} s of processor, "
        f"{node.messages_in} messages in, {node.messages_out} out"
    )


def _topic_line(name: str, topic: TopicReport) -> str:
    doubt = "" if topic.comparable else " (not comparable: a node was restarted)"
    return f"  {name:<24} {topic.messages} messages, digest {topic.digest[:12]}{doubt}"


def _number(value: Any, unit: str) -> str:
    if value is None:
        return "unknown"
    return (f"{value:.3f}" if isinstance(value, float) else str(value)) + unit


def _finite(value: Any) -> Any:
    """Return a value as strict JSON knows it: NaN and infinity become None."""
    if isinstance(value, Mapping):
        return {str(name): _finite(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
