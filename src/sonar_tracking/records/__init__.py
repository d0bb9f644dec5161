"""What flows between the stages: plain arrays in frozen dataclasses, time, array types."""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "END_OF_DATA",
    "NANOSECONDS",
    "UNKNOWN_STAMP",
    "AngleKind",
    "ArraySamples",
    "ArraySnapshots",
    "BearingTracks",
    "CommandKind",
    "ContactTrackerUpdate",
    "Contacts",
    "Datum",
    "FrequencyLines",
    "GateThresholds",
    "LofarRows",
    "OperatorCommand",
    "OwnShipLine",
    "OwnShipState",
    "PositionTracks",
    "Sensor",
    "SubspaceEstimates",
    "TrackHypothesis",
    "TrackSource",
    "TrackStatus",
    "TruthTracks",
    "nanoseconds",
    "seconds",
]

if TYPE_CHECKING:
    from sonar_tracking.records.bearings import (
        AngleKind,
        ArraySnapshots,
        BearingTracks,
        Sensor,
        SubspaceEstimates,
        TrackStatus,
    )
    from sonar_tracking.records.commands import CommandKind, OperatorCommand, OwnShipLine
    from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate, GateThresholds
    from sonar_tracking.records.datum import Datum
    from sonar_tracking.records.lines import FrequencyLines, LofarRows
    from sonar_tracking.records.own_ship import OwnShipState
    from sonar_tracking.records.positions import (
        PositionTracks,
        TrackHypothesis,
        TrackSource,
        TruthTracks,
    )
    from sonar_tracking.records.samples import ArraySamples
    from sonar_tracking.records.time import (
        END_OF_DATA,
        NANOSECONDS,
        UNKNOWN_STAMP,
        nanoseconds,
        seconds,
    )
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "bearings": [
                "AngleKind",
                "ArraySnapshots",
                "BearingTracks",
                "Sensor",
                "SubspaceEstimates",
                "TrackStatus",
            ],
            "commands": ["CommandKind", "OperatorCommand", "OwnShipLine"],
            "contacts": ["Contacts", "ContactTrackerUpdate", "GateThresholds"],
            "datum": ["Datum"],
            "lines": ["FrequencyLines", "LofarRows"],
            "own_ship": ["OwnShipState"],
            "positions": ["PositionTracks", "TrackHypothesis", "TrackSource", "TruthTracks"],
            "samples": ["ArraySamples"],
            "time": ["END_OF_DATA", "NANOSECONDS", "UNKNOWN_STAMP", "nanoseconds", "seconds"],
        },
    )
