"""Protects the defaults and ranges of all parameters of the stages: none changes unnoticed.

When one is meant to change, ``python -m tests.regression.test_defaults`` records them anew, and the
commit says why.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.configuration import describe
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.lines.band_demodulator_configuration import BandDemodulatorConfiguration
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

RECORDED = Path(__file__).with_name("recorded") / "defaults.yaml"
STAGES = (
    BandDemodulatorConfiguration,
    BearingTrackerConfiguration,
    ContactTrackerConfiguration,
    LineTrackerConfiguration,
    SubspaceConfiguration,
    TmaTrackerConfiguration,
)


def declared() -> dict[str, dict[str, list[Any]]]:
    """Return default, minimum and maximum of each parameter of each stage."""
    return {
        stage.__name__: {
            each.name: [each.default, each.minimum, each.maximum] for each in describe(stage)
        }
        for stage in STAGES
    }


def test_defaults_and_ranges_are_as_recorded() -> None:
    as_written = yaml.safe_load(yaml.safe_dump(_plain(declared())))
    assert as_written == yaml.safe_load(RECORDED.read_text())


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return [_plain(each) for each in value] if isinstance(value, tuple | list) else value


if __name__ == "__main__":
    RECORDED.write_text(yaml.safe_dump(_plain(declared()), default_flow_style=None, width=100))
