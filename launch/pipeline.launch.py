"""Starts the nodes of a scenario, simulators included.

    ros2 launch sonar_tracking pipeline.launch.py scenario:=active hpda_tracker_method:=hpda_kalman

Parameters come from the scenario, then from the file given with ``parameters:=``, then from the
arguments; quality of service is a matter of parameters too, e.g.
``qos_overrides./array/subspaces.publisher.depth``. Without simulation time the simulator paces
itself by the clock of the machine.
"""

from dataclasses import asdict

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from sonar_tracking.graph.catalogue.launch_plan import SCENARIO_ARGUMENTS, nodes_of_scenario


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments, and start the nodes once these are known."""
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value=default, description=text)
                for name, (default, text) in SCENARIO_ARGUMENTS.items()
            ),
            OpaqueFunction(function=start_nodes),
        ]
    )


def start_nodes(context: LaunchContext) -> list[Node]:
    """Describe the processes of the nodes."""
    given = {name: LaunchConfiguration(name).perform(context) for name in SCENARIO_ARGUMENTS}
    return [
        Node(package="sonar_tracking", output="screen", **asdict(node))
        for node in nodes_of_scenario(given)
    ]
