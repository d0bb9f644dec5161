"""A node that publishes has not loaded what generates messages."""

from __future__ import annotations

from tests.graph.nodes.test_imports import loaded_after, within


def test_messages_are_used_without_their_generator() -> None:
    code = (
        "from sonar_tracking.graph.node_base.no_generators import do_without_generators\n"
        "do_without_generators()\n"
        "from rclpy.serialization import serialize_message\n"
        "from sonar_tracking_msgs.msg import Progress\n"
        "serialize_message(Progress())"
    )
    modules = loaded_after(((), [code]))[code]
    assert "rosidl_generator_py" in modules
    assert not within(modules, {"em", "lark", "rosidl_parser.parser"})
