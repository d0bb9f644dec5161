"""The scenarios, and the keys of a scenario file: from the files and their configurations."""

from __future__ import annotations

from docs.reference_writer.tables import parameter_cells, sentence, table
from sonar_tracking.configuration import describe
from sonar_tracking.records.datum import Datum
from sonar_tracking.simulation.scenarios.array_configuration import (
    ArrayConfiguration,
    NoiseConfiguration,
)
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration
from sonar_tracking.simulation.scenarios.hydrophone_configuration import HydrophoneConfiguration
from sonar_tracking.simulation.scenarios.platforms import OwnShipConfiguration, TurnConfiguration
from sonar_tracking.simulation.scenarios.scenario_file import scenario_names
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.scenarios.station_configuration import StationConfiguration
from sonar_tracking.simulation.scenarios.target import (
    MOTIONS,
    LineConfiguration,
    TargetConfiguration,
)

SECTIONS: dict[str, type] = {
    "datum": Datum,
    "array": ArrayConfiguration,
    "noise": NoiseConfiguration,
    "own_ship": OwnShipConfiguration,
    "consort": OwnShipConfiguration,
    "own_ship.turns[]": TurnConfiguration,
    "bearing_sensors[]": BearingSensorConfiguration,
    "active_sonar": ContactSensorConfiguration,
    "hydrophones": HydrophoneConfiguration,
    "stations[]": StationConfiguration,
    "targets[]": TargetConfiguration,
    "targets[].lines[]": LineConfiguration,
    **{f"targets[].motion, kind: {kind}": motion for kind, motion in MOTIONS.items()},
}


def scenarios() -> str:
    """Return the table of the scenarios that come with the project."""
    rows = []
    for name in scenario_names():
        scenario = load_scenario(name)
        rows.append((f"`{name}`", f"{scenario.duration:g}", sentence(scenario.description)))
    return table(("scenario", "seconds", "what it shows"), rows)


def scenario_keys() -> str:
    """Return one table a section of a scenario file."""
    parts = []
    for section, configuration in SECTIONS.items():
        rows = [(f"`{entry.name}`", *parameter_cells(entry)) for entry in describe(configuration)]
        keys = table(("key", "default", "unit", "allowed", "what it is"), rows)
        parts.append(f"### `{section}`\n\n{keys}")
    return "\n\n".join(parts)
