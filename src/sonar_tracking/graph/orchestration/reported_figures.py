"""The figures of a run report, from what was counted while it ran."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.fused_latency_meter import FusedLatencyMeter
from sonar_tracking.graph.orchestration.latency_meter import LatencyMeter
from sonar_tracking.graph.orchestration.process_supervisor import SupervisedProcess
from sonar_tracking.graph.orchestration.run_report import NodeReport, TopicReport
from sonar_tracking.graph.orchestration.topic_record import TopicRecord

SOON, ENOUGH = 10.0, 10
"""Length of the data, s, and messages received, after which a node has put out something."""


def node_reports(
    processes: Mapping[str, SupervisedProcess], ledger: FlowLedger
) -> dict[str, NodeReport]:
    """Return how each node fared, after the processes were stopped."""
    return {
        name: NodeReport(
            exit_code=process.exit_code if process.exit_code is not None else -9,
            restarts=process.restarts,
            cpu_seconds=round(process.cpu_seconds, 3),
            messages_in=ledger.messages_in(name),
            messages_out=ledger.messages_out(name),
        )
        for name, process in processes.items()
    }


def silent_nodes(
    nodes: Mapping[str, NodeReport],
    planned: Mapping[str, PlannedNode],
    data_seconds: float,
    rejecting: Collection[str] = (),
) -> list[str]:
    """Return a sentence for each node that has heard enough and put out nothing.

    Where all was rejected, one message is enough.

    Parameters
    ----------
    nodes : mapping of str to NodeReport
        By name.
    planned : mapping of str to PlannedNode
        The same nodes, which may have nothing to publish.
    data_seconds : float
        Length of the data, s.
    rejecting : collection of str
        Nodes that have rejected all of an input.
    """
    silent = {
        name: nodes[name].messages_in
        for name, node in planned.items()
        if node.publishers and nodes[name].messages_in and nodes[name].messages_out == 0
    }
    refused = [
        f"{name} has rejected its whole input, {count} messages: the warnings say why."
        for name, count in silent.items()
        if name in rejecting
    ]
    if data_seconds < SOON:
        return refused
    return refused + [
        f"{name} has received {count} messages and put out nothing: what it says of them is in "
        "its log."
        for name, count in silent.items()
        if count >= ENOUGH and name not in rejecting
    ]


def topic_reports(
    records: Mapping[str, TopicRecord], processes: Mapping[str, SupervisedProcess]
) -> dict[str, TopicReport]:
    """Return what passed over each topic; after a restart digests say nothing."""
    comparable = not any(process.restarts for process in processes.values())
    return {
        name: TopicReport(record.messages, record.hexdigest(), comparable)
        for name, record in records.items()
    }


def latency_figures(meter: LatencyMeter, fused: FusedLatencyMeter) -> dict[str, float]:
    """Return the latency of the chain and of fused lists, ms, and how many were measured."""
    latency = meter.summary()
    return {
        "p50": latency.median,
        "p99": latency.percentile_99,
        "first": latency.first,
        "algorithmic": latency.algorithmic,
        "count": latency.count,
        **fused.figures(),
    }
