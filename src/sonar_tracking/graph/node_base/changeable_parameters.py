"""Parameters that are changed while a node runs: checked by the stage's own rules, taken as one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.node_base.parameters import checked_values


class ChangeableParameters:
    """Watches the parameters of one configuration of a node.

    A change that cannot be used is refused with the sentence that says why, and nothing changes.
    Otherwise the node gets a fresh configuration, between two data.

    Parameters
    ----------
    node : Node
        Has declared the parameters.
    configuration : dataclass
        Their present values.
    check : callable
        Called with a changed configuration; raises ConfigurationError if it does not go together.
    take : callable
        Called with a changed configuration once all parameters are set.
    """

    def __init__(
        self,
        node: Node,
        configuration: Any,
        check: Callable[[Any], object],
        take: Callable[[Any], None],
    ) -> None:
        self._where = node.get_name()
        self._configuration = configuration
        self._check = check
        self._take = take
        node.add_on_set_parameters_callback(self._judge)
        node.add_post_set_parameters_callback(self._change)

    def _judge(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        try:
            changed = self._changed(parameters)
            if changed != self._configuration:
                self._check(changed)
        except ConfigurationError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _change(self, parameters: Sequence[Parameter]) -> None:
        changed = self._changed(parameters)
        if changed != self._configuration:
            self._configuration = changed
            self._take(changed)

    def _changed(self, parameters: Sequence[Parameter]) -> Any:
        given = {parameter.name: parameter.value for parameter in parameters}
        values = checked_values(type(self._configuration), given, self._where)
        return replace(self._configuration, **values)
