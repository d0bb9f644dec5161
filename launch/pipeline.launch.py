"""Starts the nodes of a scenario.

    ros2 launch sonar_tracking pipeline.launch.py scenario:=doa_fusion

Parameters come from the scenario and then from the file given with ``parameters:=``; quality of
service is a matter of parameters too, e.g. ``qos_overrides./array/subspaces.publisher.depth``.
Without simulation time the simulator paces itself by the clock of the machine.
"""

from pathlib import Path

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from sonar_tracking.graph.catalogue.scenario_graph import started_nodes, with_published_topics
from sonar_tracking.graph.catalogue.transport_profile import choose_transport
from sonar_tracking.simulation.scenarios.scenario_file import read_yaml_mapping
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

# The linear algebra of a node is small: threads of its own cost more than they give, and results
# stay the same whatever the machine.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments, and start the nodes once these are known."""
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "scenario", default_value="doa_fusion", description="name or path of a scenario"
            ),
            DeclareLaunchArgument("namespace", default_value="", description="of all nodes"),
            DeclareLaunchArgument(
                "parameters",
                default_value="",
                description="parameter file read after the scenario, for all nodes",
            ),
            DeclareLaunchArgument(
                "use_sim_time",
                default_value="false",
                description="true if another program publishes /clock",
            ),
            OpaqueFunction(function=start_nodes),
        ]
    )


def start_nodes(context: LaunchContext) -> list[Node]:
    """Describe the processes of the nodes with the parameters of the chosen scenario."""
    name = LaunchConfiguration("scenario").perform(context)
    parameter_file = LaunchConfiguration("parameters").perform(context)
    if parameter_file:
        # ROS starts every node and lets each of them fail over a file that is not there.
        read_yaml_mapping(Path(parameter_file))
    use_sim_time = LaunchConfiguration("use_sim_time").perform(context) == "true"
    scenario = load_scenario(name)
    nodes = started_nodes(scenario, name)
    transport = choose_transport(scenario.block_bytes, n_publishers=1)
    given = with_published_topics(nodes, scenario.nodes, scenario.namespaces)
    parameters: dict[str, dict[str, object]] = {
        node.name: {key: value for key, value in given.get(node.name, {}).items() if value != ()}
        for node in nodes
    }
    for node in nodes:
        if node.serves_clock:
            parameters[node.name]["scenario"] = name
    return [
        Node(
            package="sonar_tracking",
            executable=node.name,
            name=node.name,
            namespace=LaunchConfiguration("namespace"),
            parameters=[
                parameters[node.name],
                {"use_sim_time": use_sim_time},
                *([parameter_file] if parameter_file else []),
            ],
            additional_env={
                **ONE_THREAD,
                **(transport.large_publishers if node.serves_clock else transport.others),
            },
            output="screen",
        )
        for node in nodes
    ]
