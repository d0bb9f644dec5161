"""Messages as the records of the stages, wherever they come from: no ROS import."""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "bearing_tracks_from_message",
    "command_from_message",
    "contacts_from_message",
    "directions_from_message",
    "frequency_lines_from_message",
    "lofar_rows_from_message",
    "own_ship_from_message",
    "position_tracks_from_message",
    "samples_from_message",
    "snapshots_from_message",
    "subspaces_from_message",
    "thresholds_from_message",
]

if TYPE_CHECKING:
    from sonar_tracking.message_reading.array_reading import (
        bearing_tracks_from_message,
        directions_from_message,
        own_ship_from_message,
        snapshots_from_message,
        subspaces_from_message,
    )
    from sonar_tracking.message_reading.command_reading import command_from_message
    from sonar_tracking.message_reading.contact_reading import (
        contacts_from_message,
        thresholds_from_message,
    )
    from sonar_tracking.message_reading.line_reading import frequency_lines_from_message
    from sonar_tracking.message_reading.position_reading import position_tracks_from_message
    from sonar_tracking.message_reading.sample_reading import (
        lofar_rows_from_message,
        samples_from_message,
    )
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "array_reading": [
                "bearing_tracks_from_message",
                "directions_from_message",
                "own_ship_from_message",
                "snapshots_from_message",
                "subspaces_from_message",
            ],
            "command_reading": ["command_from_message"],
            "contact_reading": ["contacts_from_message", "thresholds_from_message"],
            "line_reading": ["frequency_lines_from_message"],
            "position_reading": ["position_tracks_from_message"],
            "sample_reading": ["lofar_rows_from_message", "samples_from_message"],
        },
    )
