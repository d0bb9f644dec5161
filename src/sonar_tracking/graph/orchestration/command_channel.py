"""How requests of operators come to a run, and commands get out of it."""

from __future__ import annotations

from sonar_tracking.graph.catalogue.topics import COMMANDS, REQUESTS
from sonar_tracking.graph.message_writing.command_writing import command_bytes
from sonar_tracking.graph.orchestration.command_desk import CommandDesk
from sonar_tracking.graph.orchestration.control_node import ControlNode
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan
from sonar_tracking.graph.orchestration.run_observer import RunObserver


def open_desk(
    plan: GraphPlan, control: ControlNode, ledger: FlowLedger, observer: RunObserver
) -> CommandDesk:
    """Return the commands of a run, which listens to requests from now on.

    Parameters
    ----------
    plan : GraphPlan
        The graph; it offers commands if a node takes any.
    control : ControlNode
        Publishes and hears.
    ledger : FlowLedger
        Counts.
    observer : RunObserver
        Told of every command.
    """
    topic = plan.naming.of(COMMANDS)
    desk = CommandDesk(
        topic if topic in plan.offered_names() else "",
        plan.commanded_lists(),
        plan.consumers().get(topic, ()),
        ledger,
        control,
        observer.replayed,
        command_bytes,
    )
    if desk.topic:
        control.hear(plan.naming.of(REQUESTS), REQUESTS.message_type, desk.take)
    return desk
