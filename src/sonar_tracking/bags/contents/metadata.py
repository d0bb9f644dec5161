"""What a bag says of itself, as ROS 2 Jazzy writes it (version 9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

from sonar_tracking.bags.contents.bag_information import WRAPPING_KEY
from sonar_tracking.bags.contents.stored_text import yaml_text, yaml_value

_LARGEST_DEPTH = 1 << 20
_INFINITE = {"sec": 9223372036, "nsec": 854775807}


@dataclass(frozen=True)
class OfferedQuality:
    """Quality of service with which a topic was offered; a player offers it again.

    Attributes
    ----------
    depth : int
        Keep-last depth.
    reliability, durability : str
        As in the ROS 2 profiles.
    """

    depth: int = 10
    reliability: Literal["reliable", "best_effort"] = "reliable"
    durability: Literal["volatile", "transient_local"] = "volatile"

    def as_profile(self) -> dict[str, Any]:
        """Return the profile with the names and values of ``metadata.yaml``."""
        return {
            "history": "keep_last",
            "depth": self.depth,
            "reliability": self.reliability,
            "durability": self.durability,
            "deadline": dict(_INFINITE),
            "lifespan": dict(_INFINITE),
            "liveliness": "automatic",
            "liveliness_lease_duration": dict(_INFINITE),
            "avoid_ros_namespace_conventions": False,
        }

    def as_text(self) -> str:
        """Return the list of this one profile as YAML, as MCAP channels carry it."""
        return yaml_text([self.as_profile()])


@dataclass(frozen=True)
class TopicSummary:
    """One topic of ``metadata.yaml``."""

    name: str
    type_name: str
    type_hash: str
    quality: OfferedQuality
    message_count: int


def metadata_mapping(
    file_name: str,
    topics: Sequence[TopicSummary],
    times: tuple[int, int] | None,
    custom_data: Mapping[str, str],
) -> dict[str, Any]:
    """Return what a bag with one file says of itself.

    Parameters
    ----------
    file_name : str
        Name of the MCAP file in the directory.
    topics : sequence of TopicSummary
        In order of their first use.
    times : tuple of int, or None
        First and last log time, ns; None = no messages.
    custom_data : mapping
        Names and texts of the application.
    """
    first, last = times or (0, 0)
    starting_time = {"nanoseconds_since_epoch": first}
    duration = {"nanoseconds": last - first}
    message_count = sum(topic.message_count for topic in topics)
    return {
        "version": 9,
        "storage_identifier": "mcap",
        "duration": duration,
        "starting_time": starting_time,
        "message_count": message_count,
        "topics_with_message_count": [_topic_entry(topic) for topic in topics],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file_name],
        "files": [
            {
                "path": file_name,
                "starting_time": dict(starting_time),
                "duration": dict(duration),
                "message_count": message_count,
            }
        ],
        "custom_data": dict(custom_data),
        "ros_distro": "jazzy",
    }


def metadata_file_text(mapping: Mapping[str, Any]) -> str:
    """Return the text of ``metadata.yaml``: the mapping below a key of its own."""
    return yaml_text({WRAPPING_KEY: dict(mapping)})


def metadata_record_text(mapping: Mapping[str, Any]) -> str:
    """Return the text kept in the file itself: the bare mapping, its fields at the top level."""
    return yaml_text(dict(mapping))


def _topic_entry(topic: TopicSummary) -> dict[str, Any]:
    return {
        "topic_metadata": {
            "name": topic.name,
            "type": topic.type_name,
            "serialization_format": "cdr",
            "offered_qos_profiles": [topic.quality.as_profile()],
            "type_description_hash": topic.type_hash,
        },
        "message_count": topic.message_count,
    }


@lru_cache(maxsize=64)  # most topics of a bag are offered alike
def quality_from_text(text: str) -> OfferedQuality:
    """Return the first profile of a list written as YAML; the default where there is none.

    Older bags write numbers in place of names: 1 reliable, 2 best effort; 1 transient local,
    2 volatile.
    """
    try:
        profiles = yaml_value(text)
        profile = profiles[0] if isinstance(profiles, list) and profiles else {}
        depth = int(profile.get("depth", 0))
        reliability, durability = (
            str(value).lower() if isinstance(value, (str, int)) else ""
            for value in (profile.get("reliability"), profile.get("durability"))
        )
    except (AttributeError, TypeError, ValueError, OverflowError):
        return OfferedQuality()
    return OfferedQuality(
        depth=depth if 0 < depth <= _LARGEST_DEPTH else OfferedQuality.depth,
        reliability="best_effort" if reliability in ("best_effort", "2") else "reliable",
        durability="transient_local" if durability in ("transient_local", "1") else "volatile",
    )
