"""How a node is started again: a source goes on behind what was received of it. No ROS."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

from sonar_tracking.graph.catalogue.resumption import VARIABLE
from sonar_tracking.graph.catalogue.topics import TopicRole
from sonar_tracking.graph.orchestration.finished_stamps import FinishedStamps
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan, resolved
from sonar_tracking.graph.orchestration.process_supervisor import ProcessPlan


def restarted_process(
    graph: GraphPlan,
    name: str,
    log_directory: Path,
    number: int,
    absent: Collection[str],
    finished: FinishedStamps,
) -> ProcessPlan:
    """Return how to start a node again.

    Parameters
    ----------
    graph : GraphPlan
        The graph.
    name : str
        Of the node.
    log_directory : Path
        Where parameter files and logs go.
    number : int
        How often it has been started again, this time included.
    absent : collection of str
        Nodes that do not live.
    finished : FinishedStamps
        How far the others have got.
    """
    node = next(each for each in graph.nodes if each.name == name)
    plan = graph.process(node, log_directory, number)
    if name not in graph.sources:
        return plan
    topics = [resolved(topic) for topic in node.publishers if topic.role is TopicRole.INPUT]
    alive = {
        topic: [consumer for consumer in consumers if consumer not in absent]
        for topic, consumers in graph.consumers().items()
    }
    received = finished.everywhere(topics, alive)
    if received is None:
        return plan
    return replace(plan, environment={**plan.environment, VARIABLE: str(received)})
