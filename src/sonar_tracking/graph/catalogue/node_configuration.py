"""Parameters every node has, and those of the nodes that are no stage."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter


@dataclass(frozen=True)
class NodeConfiguration:
    """Parameters of the shell around a stage, the same for every node."""

    flow_depth: int = parameter(
        10,
        "messages kept per data topic; at least twice the flow window of the time master",
        minimum=1,
        maximum=10_000,
    )
    reset_after: float = parameter(
        10.0,
        "a step back of the stamps by more than this, and than five messages of slow data, resets "
        "the node; a smaller one is rejected",
        unit="s",
        minimum=0.0,
        maximum=1e9,
    )
    station: str = parameter(
        "",
        "namespace of the sensor or ship that the node is for: before the names of its topics, but "
        "not of those in lists; empty = none",
    )


@dataclass(frozen=True)
class TmaInputConfiguration:
    """What the node ``tma_tracker`` listens to."""

    bearing_topics: tuple[str, ...] = parameter(
        ("passive/bearing_tracks",), "bearing tracks, one topic per station"
    )
    line_topics: tuple[str, ...] = parameter(
        ("",),
        "frequency lines, e.g. passive/frequency_lines; an empty name = none, and positions come "
        "from bearings alone",
    )


@dataclass(frozen=True)
class FusionInputConfiguration:
    """What the node ``track_fusion`` listens to; an empty name stands for none."""

    active_topics: tuple[str, ...] = parameter(
        ("active/tracks",), "tracks of what returns echoes, one topic per sonar"
    )
    bearing_topics: tuple[str, ...] = parameter(
        ("passive/bearing_tracks",), "bearing tracks, one topic per station"
    )
    passive_topics: tuple[str, ...] = parameter(
        ("passive/tracks",), "positions from bearings and lines, one topic per tracker"
    )
    foreign_topics: tuple[str, ...] = parameter(
        ("",),
        "fused tracks of other ships, e.g. /ship_b/tracks; of those that take own ones in turn, "
        "their own_tracks",
    )


@dataclass(frozen=True)
class SimulatorConfiguration:
    """Parameters of every node that simulates a sensor."""

    scenario: str = parameter(
        "doa_fusion", "name of a scenario, path of a YAML file, or the YAML text itself"
    )
