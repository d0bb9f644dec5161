"""The targets of tracks of echoes."""

from __future__ import annotations

from collections.abc import Container

from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import ListKey


class EchoTargets(dict[ListKey, FusedTarget]):
    """Which target each track of echoes is of."""

    def end_others(self, topic: str, going_on: Container[ListKey]) -> None:
        """Forget the tracks of a list that do not go on."""
        for key in [key for key in self if key[0] == topic and key not in going_on]:
            del self.pop(key).echoes[key]

    def exchange(self, pair: tuple[FusedTarget, FusedTarget]) -> None:
        """Let two targets have each other's tracks."""
        one, other = pair
        one.echoes, other.echoes = other.echoes, one.echoes
        for target in pair:
            self.update(dict.fromkeys(target.echoes, target))
