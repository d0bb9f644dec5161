"""Records of the stages as messages."""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "bearing_tracks_to_message",
    "command_to_message",
    "contacts_to_message",
    "frequency_lines_to_message",
    "lofar_rows_to_message",
    "own_ship_to_message",
    "position_tracks_to_message",
    "samples_to_message",
    "snapshots_to_message",
    "subspaces_to_message",
    "thresholds_to_message",
    "truth_tracks_to_message",
]

if TYPE_CHECKING:
    from sonar_tracking.graph.message_writing.array_writing import (
        bearing_tracks_to_message,
        own_ship_to_message,
        snapshots_to_message,
        subspaces_to_message,
    )
    from sonar_tracking.graph.message_writing.command_writing import command_to_message
    from sonar_tracking.graph.message_writing.contact_writing import (
        contacts_to_message,
        thresholds_to_message,
    )
    from sonar_tracking.graph.message_writing.line_writing import frequency_lines_to_message
    from sonar_tracking.graph.message_writing.position_writing import (
        position_tracks_to_message,
        truth_tracks_to_message,
    )
    from sonar_tracking.graph.message_writing.sample_writing import (
        lofar_rows_to_message,
        samples_to_message,
    )
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "array_writing": [
                "bearing_tracks_to_message",
                "own_ship_to_message",
                "snapshots_to_message",
                "subspaces_to_message",
            ],
            "command_writing": ["command_to_message"],
            "contact_writing": ["contacts_to_message", "thresholds_to_message"],
            "line_writing": ["frequency_lines_to_message"],
            "position_writing": ["position_tracks_to_message", "truth_tracks_to_message"],
            "sample_writing": ["lofar_rows_to_message", "samples_to_message"],
        },
    )
