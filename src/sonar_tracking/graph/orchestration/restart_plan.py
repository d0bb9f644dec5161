"""How a node is started again: a source goes on behind what was received of it. No ROS."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

from sonar_tracking.graph.catalogue.resumption import VARIABLE
from sonar_tracking.graph.catalogue.topics import TopicRole
from sonar_tracking.graph.orchestration.finished_stamps import FinishedStamps
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan, resolved
from sonar_tracking.graph.orchestration.process_supervisor import ProcessPlan, SupervisedProcess

DISPLAY_RESTARTS = 10
"""So often a display is started again that people look at from outside."""


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


def restarted_display(
    graph: GraphPlan, process: SupervisedProcess, log_directory: Path
) -> tuple[ProcessPlan | None, str]:
    """Return how to start a display again that has ended, and in words what becomes of it.

    Parameters
    ----------
    graph : GraphPlan
        The graph.
    process : SupervisedProcess
        The display.
    log_directory : Path
        Where parameter files and logs go.

    Returns
    -------
    plan : ProcessPlan or None
        None = the run goes on without it.
    words : str
        Which display, how it ended, and what follows.
    """
    node = next(each for each in graph.displays if each.name == process.plan.name)
    words = f"{node.name} {process.end_in_words}"
    if not node.comes_back or process.restarts >= DISPLAY_RESTARTS:
        return None, f"{words}; the run goes on without it"
    parameters = {**node.parameters, **node.parameters_again}
    node = replace(node, parameters=parameters)
    plan = graph.process(node, log_directory, process.restarts + 1)
    return plan, f"{words}; it was started again"
