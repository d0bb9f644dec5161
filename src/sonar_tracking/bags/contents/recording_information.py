"""What a bag knows of its own making: scenario, node parameters, the role of each topic."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from sonar_tracking.bags.contents.stored_text import StoredTextError, json_value
from sonar_tracking.errors import ConfigurationError

Role = Literal["input", "output", "truth", "display", "other"]
"""What a topic is to the chain: replayed, compared, scored against, a picture for people, or none
of these."""

CUSTOM_DATA_KEY = "sonar_tracking.scenario"
"""Key of the information in ``custom_data`` of the bag and name of its MCAP metadata record."""

_INPUT_TYPES = (
    "sonar_tracking_msgs/msg/ArraySnapshots",
    "sonar_tracking_msgs/msg/ArraySamples",
    "sonar_tracking_msgs/msg/Contacts",
    "nav_msgs/msg/Odometry",
    "sonar_tracking_msgs/msg/OperatorCommand",
)
_OUTPUT_TYPES = (
    "sonar_tracking_msgs/msg/SubspaceEstimates",
    "sonar_tracking_msgs/msg/BearingTracks",
    "sonar_tracking_msgs/msg/FrequencyLines",
    "sonar_tracking_msgs/msg/DetectionThreshold",
    "sonar_tracking_msgs/msg/Tracks",
)
_DISPLAY_TYPES = (
    "diagnostic_msgs/msg/DiagnosticArray",
    "tf2_msgs/msg/TFMessage",
    "visualization_msgs/msg/MarkerArray",
)


@dataclass(frozen=True)
class RecordingInformation:
    """Everything a replay needs besides the messages.

    Attributes
    ----------
    scenario : mapping
        The resolved scenario, as plain YAML values.
    node_parameters : mapping of mapping
        Every parameter of every node: node name, parameter name, value.
    topic_roles : mapping
        Resolved topic name to its :data:`Role`.
    topic_names : mapping
        Resolved topic name to the name the nodes know it by, where a namespace or a rule of the
        run made them differ.
    """

    scenario: Mapping[str, Any] = field(default_factory=dict)
    node_parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    topic_roles: Mapping[str, Role] = field(default_factory=dict)
    topic_names: Mapping[str, str] = field(default_factory=dict)

    def to_json(self) -> str:
        """Return the information as one line of JSON."""
        values = {
            "scenario": self.scenario,
            "node_parameters": self.node_parameters,
            "topic_roles": self.topic_roles,
        }
        if self.topic_names:
            values["topic_names"] = self.topic_names
        return json.dumps(values, sort_keys=True, default=_plain)

    @staticmethod
    def from_json(text: str, where: str) -> RecordingInformation:
        """Read what :meth:`to_json` wrote.

        Parameters
        ----------
        text : str
            JSON.
        where : str
            Where the text comes from, named in errors.

        Raises
        ------
        ConfigurationError
            If the text is not such information.
        """
        try:
            values = json_value(text)
        except StoredTextError as error:
            raise ConfigurationError(
                f"The recording information in {where} cannot be read as JSON ({error})."
            ) from error
        names = ("scenario", "node_parameters", "topic_roles", "topic_names")
        if not isinstance(values, dict) or not all(
            isinstance(values.get(name, {}), dict) for name in names
        ):
            raise ConfigurationError(
                f"The recording information in {where} must be a mapping of {', '.join(names)}."
            )
        roles = values.get("topic_roles", {})
        parameters = values.get("node_parameters", {})
        if not all(isinstance(of_node, dict) for of_node in parameters.values()):
            raise ConfigurationError(
                f"The node parameters in {where} must be a mapping of node, parameter, value."
            )
        for topic, role in roles.items():
            if role not in get_args(Role):
                raise ConfigurationError(
                    f"The role of {topic} in {where} is {role!r}; it must be one of "
                    f"{', '.join(get_args(Role))}."
                )
        return RecordingInformation(
            scenario=values.get("scenario", {}),
            node_parameters=parameters,
            topic_roles=roles,
            topic_names=values.get("topic_names", {}),
        )


def role_of_type(topic: str, type_name: str) -> Role:
    """Return the role of a topic of a bag that does not say it, from its name and type."""
    if "/truth/" in f"/{topic.lstrip('/')}":
        return "truth"
    if type_name in _INPUT_TYPES:
        return "input"
    if type_name in _OUTPUT_TYPES:
        return "output"
    if type_name in _DISPLAY_TYPES:
        return "display"
    return "other"


def _plain(value: Any) -> Any:
    """Return a value JSON does not know as one it knows (tuples are known, mappings are not)."""
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "isoformat"):
        return value.isoformat()
    return value.item()
