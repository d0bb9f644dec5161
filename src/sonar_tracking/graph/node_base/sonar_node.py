"""Base of the nodes: a thin shell that feeds a stage in event time and never dies of bad input.

A node's file says which topics it connects, how to make its stage, and what to do with one joined
input. Everything else is here: parameters, stamp checks, joining, progress, diagnostics, resets.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node

from sonar_tracking.errors import ConfigurationError, InputError, Notice, Severity
from sonar_tracking.graph.catalogue.flow_window import own_report_pause
from sonar_tracking.graph.catalogue.node_configuration import NodeConfiguration
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import DIAGNOSTICS_TOPIC, Topic
from sonar_tracking.graph.node_base import parameters, quality_of_service
from sonar_tracking.graph.node_base.changeable_parameters import ChangeableParameters
from sonar_tracking.graph.node_base.checkpoint import Checkpoint
from sonar_tracking.graph.node_base.command_input import CommandInput
from sonar_tracking.graph.node_base.data_flow import (
    DataInput,
    DataOutput,
    Received,
    any_needs,
    input_concern,
)
from sonar_tracking.graph.node_base.diagnostics import UNEXPECTED, Diagnostics, kind_of
from sonar_tracking.graph.node_base.event_time_join import EventTimeJoin, Interpolation, JoinedItem
from sonar_tracking.graph.node_base.node_watch import NodeWatch
from sonar_tracking.graph.node_base.progress_reporter import ProgressReporter
from sonar_tracking.graph.node_base.stamp_check import StampCheck, Verdict, seconds_text
from sonar_tracking.records.commands import OperatorCommand
from sonar_tracking.records.time import NANOSECONDS

ConfigurationType = TypeVar("ConfigurationType")
Convert = Callable[[Any], Any]


class SonarNode(Node):
    """Shell of one node of the graph.

    A subclass calls :meth:`configuration`, :meth:`data_publisher` and :meth:`data_subscriptions`
    in its constructor, and overrides :meth:`process` and, as needed, :meth:`substitute`,
    :meth:`warm_up` and :meth:`reset`.

    Parameters
    ----------
    description : NodeDescription
        Name, parameters and topics, from the node catalogue.
    """

    uses_rest_of_group = False
    """Whether a message that cannot be read leaves the others of its stamp; the node reports it."""

    def __init__(self, description: NodeDescription) -> None:
        super().__init__(description.name)
        self.data_inputs: list[DataInput] = []
        self.data_outputs: list[DataOutput] = []
        reports = self.create_publisher(
            DiagnosticArray, DIAGNOSTICS_TOPIC, quality_of_service.DIAGNOSTICS
        ).publish
        name = self.get_fully_qualified_name().lstrip("/")
        self.diagnostics = Diagnostics(name, self.get_logger(), reports, own_report_pause())
        self.progress = ProgressReporter(self)
        self._overrides = parameters.overrides_of(self)
        parameters.check_overrides(description.configurations, self._overrides, self.get_name())
        self.node_configuration = self.configuration(NodeConfiguration)
        self._own_inputs = {*description.inputs, *description.optional_inputs}
        placed = description.at_station(self.node_configuration.station)
        self._join = EventTimeJoin()
        self._series_topics: set[str] = set()
        self._checkpoint = Checkpoint(self.state, self.take_state, self.report)
        self._commands = CommandInput(
            self, placed.commanded_topic, self.progress, self.diagnostics, self.carry_out
        )
        self.watch = NodeWatch(
            self,
            self.data_inputs,
            self.data_outputs,
            self.diagnostics,
            self.progress,
            self.warm_up,
            self._waits_for,
            self._release,
        )

    def configuration(
        self,
        configuration: type[ConfigurationType],
        check: Callable[[ConfigurationType], object] = bool,
        take: Callable[[ConfigurationType], None] | None = None,
    ) -> ConfigurationType:
        """Return a configuration from the parameters given to the node, and declare them.

        Parameters
        ----------
        configuration : type
            Configuration dataclass.
        check : callable
            Called with the configuration; raises ConfigurationError on a combination that does
            not go together, e.g. the class of the stage.
        take : callable, optional
            Called between two data with another configuration, of which a user has changed what
            is declared changeable.

        Raises
        ------
        ConfigurationError
            If what was given cannot be used: the node is not to be started.
        """
        try:
            resolved = parameters.resolve(configuration, self._overrides, self.get_name())
            check(resolved)
        except ConfigurationError as error:
            raise ConfigurationError(f"{self.get_name()}: {error}") from error
        parameters.declare(self, resolved)
        if take is not None:
            ChangeableParameters(self, resolved, check, take)
        return resolved

    def data_publisher(self, topic: Topic) -> DataOutput:
        """Return a publisher that reports progress."""
        depth = self.node_configuration.flow_depth
        topic = topic.below(self.node_configuration.station)
        with quality_of_service.overriding(self.get_name(), topic.name) as overriding:
            output = DataOutput(self, topic, depth, self.progress, overriding)
        self.data_outputs.append(output)
        return output

    def data_subscriptions(
        self,
        streams: Mapping[Topic, Convert],
        groups: Sequence[Mapping[Topic, Convert]] = (),
        series: Mapping[Topic, tuple[Convert, Interpolation]] | None = None,
        needs_series: Callable[[Any], bool] | None = None,
    ) -> None:
        """Subscribe to all inputs of the node, joined in event time.

        Parameters
        ----------
        streams : mapping of Topic to callable
            Independent inputs, each with the conversion of its messages to records.
        groups : sequence of mappings
            Inputs made from the same datum, joined by equal stamps.
        series : mapping of Topic to (conversion, interpolation)
            Continuous quantities such as odometry.
        needs_series : callable, optional
            Tells whether a record waits for the series; default: every one does.
        """
        series = series or {}
        self._join = EventTimeJoin(
            [topic.name for topic in streams],
            [[topic.name for topic in group] for group in groups],
            {topic.name: interpolate for topic, (_, interpolate) in series.items()},
            needs_series=None if needs_series is None else any_needs(needs_series),
        )
        conversions = dict(streams) | {topic: convert for topic, (convert, _) in series.items()}
        for group in groups:
            conversions |= group
        self._series_topics = {topic.name for topic in series}
        for topic, convert in conversions.items():
            self._subscribe(topic, convert)

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice] | None:
        """Feed the stage with one joined input, publish what follows, return its notices if any.

        A source of data has no inputs and nothing to override.

        Parameters
        ----------
        item : JoinedItem
            Stamp, topic and interpolated series.
        records : mapping of str to record
            What arrived and can be used, by topic name.
        """
        return None

    def substitute(self, rejected: Received) -> None:
        """Publish the one output of an input that could not be used (nothing by default)."""

    def carry_out(self, command: OperatorCommand) -> Iterable[Notice]:
        """Do what an operator says, before the next datum; raise InputError if it cannot be done.

        A node whose description has no ``commanded_topic`` has nothing to override.
        """
        return ()

    def warm_up(self) -> None:
        """Do before the first data what takes long at its first use (nothing by default)."""

    def reset(self) -> None:
        """Begin again: the stage and everything learnt from the data are discarded."""

    def state(self) -> Any:
        """Return what a process in the place of this one is to go on with; None = nothing."""
        return None

    def take_state(self, state: Any) -> None:
        """Go on with the state of the process before; new identifiers are those of this one."""

    def report(self, concern: str, culprit: str, severity: Severity, sentence: str) -> None:
        """Report a problem on /diagnostics and in the log."""
        self.diagnostics.report(concern, culprit, severity, sentence)

    def report_state(self, topic: Topic, notice: Notice | None) -> None:
        """Report of an input what holds until a later notice on its culprit; None = nothing."""
        if notice is None:
            return
        source = self._input(topic)
        sentence = f"{source.name}: {notice.text}"
        self.diagnostics.report(
            input_concern(source), notice.culprit, notice.severity, sentence, lasting=True
        )

    def expects(self, topic: Topic) -> bool:
        """Return whether messages of an input have come, or somebody may publish some."""
        source = self._input(topic)
        known = source.received > 0 or source.subscription.get_publisher_count() > 0
        return known or self.watch.may_not_know_all()

    def _waits_for(self, source: DataInput) -> bool:
        """Return whether data wait for an input; for a stream there is always somebody waiting."""
        name = source.topic.name
        return name not in self._series_topics or name in self._join.waits_for()

    def _release(self) -> None:
        """Run what waits for nothing any more."""
        for item in self._join.released():
            self._run(item)

    def _input(self, topic: Topic) -> DataInput:
        return next(source for source in self.data_inputs if source.topic.name == topic.name)

    def _subscribe(self, topic: Topic, convert: Convert) -> None:
        configuration = self.node_configuration
        placed = topic.below(configuration.station) if topic in self._own_inputs else topic
        with quality_of_service.overriding(self.get_name(), placed.name) as overriding:
            source = DataInput(
                self,
                topic,
                placed.name,
                configuration.flow_depth,
                round(configuration.reset_after * NANOSECONDS),
                convert,
                self._receive,
                self.progress,
                overriding,
                answered=topic.name not in self._series_topics,
            )
        self.data_inputs.append(source)
        self.diagnostics.add(input_concern(source), source.values)

    def _receive(self, source: DataInput, message: Any) -> None:
        check, usable = source.judge(message)
        self._use(source, check, usable)
        # A message that waits in the join is finished as far as flow is concerned: it has left the
        # queue, and counting it would let a slow input stop the clock it waits for.
        source.finish(source.read_stamp(message))

    def _use(self, source: DataInput, check: StampCheck, usable: Iterable[Received]) -> None:
        """Run what is to be used of an input, and tell what is wrong with its stamps."""
        if check.verdict is Verdict.RESET:
            self._begin_again(source)
        self.tell(source, check)
        for received in usable:
            self.take_in(source, received)
        if check.verdict is Verdict.RESET:
            for other in self.data_inputs:
                for each in other.judge_held(source.guard.last_stamp):
                    self._use(other, *each)

    def take_in(self, source: DataInput, received: Received) -> None:
        """Take in a message whose stamp is sound, and run what may run now."""
        self.diagnostics.advance(received.stamp)
        for item in self._joined(received):
            self._run(item)

    def tell(self, source: DataInput, check: StampCheck) -> None:
        """Tell what is wrong with a stamp of an input."""
        if check.sentence:
            severity = Severity.ERROR if check.verdict is Verdict.REJECT else Severity.WARN
            self.report(input_concern(source), kind_of(check.sentence), severity, check.sentence)
        if check.verdict not in (Verdict.ACCEPT, Verdict.GAP, Verdict.RESET):
            self.watch.check_publishers(source)

    def _joined(self, received: Received) -> Iterable[JoinedItem]:
        """Give one message to the join and return what may run now."""
        topic, stamp, next_stamp = received.source.topic.name, received.stamp, received.next_stamp
        item = received.record if topic in self._series_topics else received
        return self._join.push(topic, stamp, next_stamp, item)

    def _begin_again(self, source: DataInput) -> None:
        begin = source.guard.last_stamp
        begun = {each.topic.name for each in self.data_inputs if each.guard.has_begun(begin)}
        for item in self._join.flush(begun & self._series_topics):
            self._run(item)
        for other in self.data_inputs:
            if other is not source:
                other.guard.expect_new_beginning(begin)
        self.diagnostics.forget()
        self.reset()
        self._commands.begin_again()

    def _run(self, item: JoinedItem) -> None:
        arrived: list[Received] = list(item.items.values())
        try:
            for received in arrived:
                if received.rejection and not self.uses_rest_of_group:
                    raise InputError(received.rejection)
            for topic in item.not_awaited:
                sentence = (
                    f"{item.topic} at {seconds_text(item.stamp)} was processed without "
                    f"{topic}, which is too far behind; check that its publisher is running."
                )
                self.report("join", topic, Severity.WARN, sentence)
            records = {name: one.record for name, one in item.items.items() if not one.rejection}
            self._commands.carry_out_due(item.stamp, self._checkpoint.take_up(item.stamp))
            for notice in self.process(item, records) or ():
                self.report(notice.culprit, notice.culprit, notice.severity, notice.text)
            self._checkpoint.keep(item.stamp)
        except Exception as error:
            self._reject(arrived, error)

    def tell_rejected(self, received: Received, error: Exception) -> tuple[str, str]:
        """Count and report an input that could not be used; return concern and sentence."""
        received.source.rejected += 1
        at = f"at {seconds_text(received.stamp)}"
        concern = input_concern(received.source)
        if isinstance(error, InputError):
            sentence = f"{received.source.name} {at}: rejected: {error}"
        else:
            concern = UNEXPECTED
            sentence = (
                f"{received.source.name} {at}: rejected after an unexpected "
                f"{type(error).__name__}: {error}; please report it with the recording."
            )
        self.report(concern, kind_of(str(error)), Severity.ERROR, sentence)
        return concern, sentence

    def _reject(self, arrived: Sequence[Received], error: Exception) -> None:
        for received in arrived:
            concern, sentence = self.tell_rejected(received, error)
            try:
                self.substitute(received)
            except Exception as second:
                self.report(concern, "substitute", Severity.ERROR, f"{sentence} ({second})")
