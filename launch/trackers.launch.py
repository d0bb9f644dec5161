"""Starts the trackers behind a sensor of your own, without simulators.

    ros2 launch sonar_tracking trackers.launch.py chain:=contacts namespace:=ship_a

Parameters are those of the file given with ``parameters:=``, then those of the arguments.
"""

from dataclasses import asdict

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from sonar_tracking.graph.catalogue.launch_plan import CHAIN_ARGUMENTS, nodes_of_chain


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments, and start the nodes once these are known."""
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value=default, description=text)
                for name, (default, text) in CHAIN_ARGUMENTS.items()
            ),
            OpaqueFunction(function=start_nodes),
        ]
    )


def start_nodes(context: LaunchContext) -> list[Node]:
    """Describe the processes of the nodes."""
    given = {name: LaunchConfiguration(name).perform(context) for name in CHAIN_ARGUMENTS}
    return [
        Node(package="sonar_tracking", output="screen", **asdict(node))
        for node in nodes_of_chain(given)
    ]
