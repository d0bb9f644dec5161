"""The figures of a run report, from what was counted while it ran."""

from __future__ import annotations

from collections.abc import Mapping

from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.latency_meter import LatencyMeter
from sonar_tracking.graph.orchestration.process_supervisor import SupervisedProcess
from sonar_tracking.graph.orchestration.run_report import NodeReport, TopicReport
from sonar_tracking.graph.orchestration.topic_record import TopicRecord


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


def topic_reports(
    records: Mapping[str, TopicRecord], processes: Mapping[str, SupervisedProcess]
) -> dict[str, TopicReport]:
    """Return what passed over each topic; after a restart digests say nothing."""
    comparable = not any(process.restarts for process in processes.values())
    return {
        name: TopicReport(record.messages, record.hexdigest(), comparable)
        for name, record in records.items()
    }


def latency_figures(meter: LatencyMeter) -> dict[str, float]:
    """Return the latency of the chain, ms, and how many messages were measured."""
    latency = meter.summary()
    return {
        "p50": latency.median,
        "p99": latency.percentile_99,
        "algorithmic": latency.algorithmic,
        "count": latency.count,
    }
