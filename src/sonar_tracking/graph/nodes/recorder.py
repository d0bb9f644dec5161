"""Node ``recorder``: writes topics to a bag, bytes as received, and paces the clock meanwhile.

Inputs: the topics given by the parameters. Outputs: none but Progress on ``flow/done``, so that a
run waits for the recorder as for any other consumer. The bag is finished on SIGINT and SIGTERM; a
kill loses less than a second. A recorder that cannot write any more says so, keeps the run going
and ends with exit code 1.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, get_args

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from sonar_tracking.bags.contents.log_time import LogClock, begins_with_header, head_stamp
from sonar_tracking.bags.contents.message_definitions import installed_definition
from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.bags.contents.recording_information import (
    RecordingInformation,
    Role,
    role_of_type,
)
from sonar_tracking.bags.storage.writer import FLUSH_PERIOD, BagWriter
from sonar_tracking.errors import ConfigurationError, Severity
from sonar_tracking.graph.catalogue.flow_window import own_report_pause
from sonar_tracking.graph.catalogue.recorder_parameters import RECORDER_PARAMETERS
from sonar_tracking.graph.catalogue.topics import CLOCK_TOPIC, DIAGNOSTICS_TOPIC, FIXED_TRANSFORMS
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import parameters, quality_of_service
from sonar_tracking.graph.node_base.diagnostics import MATCHED, Diagnostics
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.node_watch import STATUS_PERIOD, clock_publishers
from sonar_tracking.graph.node_base.progress_reporter import ProgressReporter
from sonar_tracking.graph.node_base.ready_reports import ReadyReports

NAME = "recorder"
RECORDING = "recording"
"""Concern: what has been written, and whether it can be."""

_KEPT_TYPES = (
    "sonar_tracking_msgs/msg/BearingTracks",
    "sonar_tracking_msgs/msg/OperatorCommand",
    "sonar_tracking_msgs/msg/Tracks",
    "visualization_msgs/msg/MarkerArray",
)
"""Complete pictures, which are kept for late readers."""
_ROLES: tuple[Role, ...] = get_args(Role)


class Recorder(Node):
    """Records topics; see the module.

    Attributes
    ----------
    failed : bool
        True once something could not be recorded.
    """

    def __init__(self) -> None:
        super().__init__(NAME)
        self.failed = False
        publisher = self.create_publisher(
            DiagnosticArray, DIAGNOSTICS_TOPIC, quality_of_service.DIAGNOSTICS
        )
        name = self.get_fully_qualified_name().lstrip("/")
        self._diagnostics = Diagnostics(
            name, self.get_logger(), publisher.publish, own_report_pause()
        )
        self._progress = ProgressReporter(self)
        self._fixed_transforms = self.resolve_topic_name(FIXED_TRANSFORMS.name)
        self._counts: dict[str, int] = {}
        self._pacing: set[str] = set()
        self._topics: dict[str, Any] = {}
        self._writer: BagWriter | None = None
        self._log_clock = LogClock(frozenset())
        values = self._declared_parameters()
        self._depth = values["flow_depth"]
        try:
            self._start(values)
        except (ConfigurationError, OSError) as error:
            raise ConfigurationError(f"{self.get_name()}: {error}") from error
        self._diagnostics.add(MATCHED, self._matched)
        self._diagnostics.add(RECORDING, self._written)
        ReadyReports(self, self._diagnostics, self._matched, self._data_flow)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(FLUSH_PERIOD / 2, self._flush, clock=steady)
        self.create_timer(STATUS_PERIOD, self._diagnostics.publish_if_due)

    def finish(self) -> None:
        """Finish the bag."""
        try:
            if self._writer is not None:
                self._writer.close()
            self._writer = None
        except OSError as error:
            self._cannot_write(error)

    def destroy_node(self) -> None:
        """Finish the bag and release the node."""
        self.finish()
        super().destroy_node()

    def _declared_parameters(self) -> dict[str, Any]:
        defaults: dict[str, Any] = dict.fromkeys(RECORDER_PARAMETERS, "")
        # ROS cannot tell the type of an empty list; one empty text stands for it.
        defaults |= {name: [""] for name in ("topics", "types", "roles")}
        defaults["flow_depth"] = quality_of_service.DEFAULT_FLOW_DEPTH
        unknown = parameters.unknown_overrides(
            RECORDER_PARAMETERS, parameters.overrides_of(self), self.get_name()
        )
        if unknown:
            raise ConfigurationError("\n".join(unknown))
        values = {}
        for name, text in RECORDER_PARAMETERS.items():
            descriptor = ParameterDescriptor(description=text, read_only=True)
            value = self.declare_parameter(name, defaults[name], descriptor).value
            values[name] = [v for v in value if v] if isinstance(value, list) else value
        return values

    def _start(self, values: dict[str, Any]) -> None:
        topics, types, roles = values["topics"], values["types"], values["roles"]
        if not values["output"]:
            raise ConfigurationError("The parameter output is empty; give the directory of a bag.")
        if not topics or len(topics) != len(types) or len(roles) not in (0, len(topics)):
            raise ConfigurationError(
                f"There are {len(topics)} topics, {len(types)} types and {len(roles)} roles; "
                "give at least one topic, a type for each, and a role for each or none."
            )
        for role in roles:
            if role not in _ROLES:
                raise ConfigurationError(
                    f"The role {role!r} is not known; it must be one of {', '.join(_ROLES)}."
                )
        roles = roles or [role_of_type(*pair) for pair in zip(topics, types, strict=True)]
        definitions = {name: installed_definition(name) for name in types}
        self._log_clock = LogClock(
            frozenset(name for name, d in definitions.items() if begins_with_header(d.text))
        )
        output = free_path(Path(values["output"]))
        if output != Path(values["output"]):
            self._diagnostics.report(
                RECORDING,
                "output",
                Severity.WARN,
                f"{values['output']} exists already; {output} is recorded instead.",
                lasting=True,
            )
        self._writer = BagWriter(output, _recording_information(values["recording"]))
        for topic, type_name, role in zip(topics, types, roles, strict=True):
            kept = type_name in _KEPT_TYPES or topic == self._fixed_transforms
            quality = OfferedQuality(
                self._depth, durability="transient_local" if kept else "volatile"
            )
            self._writer.add_topic(topic, type_name, definitions[type_name], role, quality)
            self._subscribe(topic, type_name, role)

    def _subscribe(self, topic: str, type_name: str, role: Role) -> None:
        """Subscribe to serialised messages; /clock and pictures are recorded without pacing."""
        paces = role not in ("other", "display")
        if paces:
            self._pacing.add(topic)

        def record(data: Any) -> None:
            self._record(topic, type_name, paces, data)

        self._counts[topic] = 0
        profile = quality_of_service.subscription_profile(self._depth if paces else 1000)
        if topic == self._fixed_transforms:
            profile = quality_of_service.LATE_READER
        self._topics[topic] = self.create_subscription(
            message_class(type_name),
            topic,
            record,
            profile,
            raw=True,
        )

    def _record(self, topic: str, type_name: str, paces: bool, data: bytes) -> None:
        self._counts[topic] += 1
        log_time = self._log_clock.log_time(topic, type_name, data)
        self._diagnostics.advance(log_time)
        # What nodes say before the data have no time yet: it would stand decades before the rest.
        if self._writer is not None and (log_time or paces):
            try:
                self._writer.write(topic, log_time, data)
            except OSError as error:
                self._cannot_write(error)
        if paces:
            self._progress.finish(topic, self._counts[topic], head_stamp(data))

    def _flush(self) -> None:
        if self._writer is not None:
            try:
                self._writer.flush_if_due()
            except OSError as error:
                self._cannot_write(error)

    def _cannot_write(self, error: OSError) -> None:
        path = self._writer.path if self._writer is not None else "the bag"
        self._writer = None
        self._fail(
            RECORDING,
            f"{path} cannot be written any more ({error.strerror}); make room and record again. "
            "What was written so far can be read.",
        )

    def _fail(self, concern: str, sentence: str) -> None:
        self.failed = True
        self._diagnostics.report(concern, sentence, Severity.ERROR, sentence, lasting=True)

    def _data_flow(self) -> bool:
        """Return whether data have come; what nodes say of themselves comes before them."""
        return any(self._counts[topic] for topic in self._pacing)

    def _matched(self) -> dict[str, object]:
        counts: dict[str, object] = {
            topic: subscription.get_publisher_count()
            for topic, subscription in self._topics.items()
        }
        own = self._progress.publisher
        counts[own.topic_name] = own.get_subscription_count()
        counts[self.resolve_topic_name(CLOCK_TOPIC)] = clock_publishers(self)
        return counts

    def _written(self) -> dict[str, object]:
        path = self._writer.path if self._writer is not None else ""
        return {"output": path, "messages": sum(self._counts.values())}


def free_path(path: Path) -> Path:
    """Return the path, or the first of ``<path>_2``, ``<path>_3``, ... that does not exist."""
    candidate, number = path, 1
    while candidate.exists():
        number += 1
        candidate = path.with_name(f"{path.name}_{number}")
    return candidate


def _recording_information(text: str) -> RecordingInformation | None:
    """Return the information given as JSON or as the path of a JSON file."""
    if not text:
        return None
    if not text.lstrip().startswith("{"):
        return RecordingInformation.from_json(Path(text).read_text(encoding="utf-8"), text)
    return RecordingInformation.from_json(text, "the parameter recording")


def main() -> int:
    """Run the node until it is told to stop; return the exit code."""
    nodes: list[Recorder] = []

    def make_node() -> Recorder:
        nodes.append(Recorder())
        return nodes[0]

    return run_node(make_node, Recorder.finish) or int(any(node.failed for node in nodes))


if __name__ == "__main__":
    sys.exit(main())
