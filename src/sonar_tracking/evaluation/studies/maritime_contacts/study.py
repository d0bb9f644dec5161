"""Study maritime-contacts: boats tracked in recorded scans of a ferry's radar, GNSS as truth.

Range and bearing contacts in clutter from a moving own ship, a stand-in for an active sonar. One
set of parameters serves all scenarios. It is no set that never saw them: the clutter density, the
one that matters, was chosen for scenarios 03, 13 and 16 with the scores of the others in view, and
the delay of the stamps was found on all of them. Only two boats carried GNSS receivers: tracks of
other boats, of the shore and of multiple reflections count as false. The last row is not a
tracker: it takes the contacts nearest to the boats, so that it tells what the radar leaves to be
gained.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_method_registry import CONTACT_METHODS
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.metrics.position_score import PositionScore, score_position_tracks
from sonar_tracking.evaluation.monte_carlo.batch_runner import Task
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.studies.maritime_contacts.figures import draw_scenario
from sonar_tracking.evaluation.studies.maritime_contacts.scenarios import (
    CUTOFF,
    ORDER,
    MaritimeScenario,
    estimated_latency,
    read_scenarios,
)
from sonar_tracking.records.positions import PositionTracks, TrackSource

MARITIME_CONTACTS = "maritime-contacts"

INTEGRATED = CONTACT_METHODS["integrated"].label
AS_STAMPED = "integrated, as stamped"
DEFAULTS = "integrated, defaults"
MOVING = "integrated, defaults, moving"
NEAREST = "nearest contacts"
ALL = "all scenarios"

CONFIGURATION = ContactTrackerConfiguration(
    sound_speed=0.0,
    motion="turning",
    detection_probability=0.85,
    clutter_density=2e-4,
    acceleration_deviation=0.2,
    lateral_acceleration=0.3,
    initial_speed_deviation=3.0,
    initial_existence=0.01,
    confirmation_probability=0.99,
)
"""Of all scenarios: small boats, a scan every 1.7 s, clutter that comes in clumps."""

SYSTEMS: Mapping[str, ContactTrackerConfiguration] = {
    DEFAULTS: ContactTrackerConfiguration(sound_speed=0.0),
    **{entry.label: replace(CONFIGURATION, method=entry.name) for entry in CONTACT_METHODS},
}
"""Trackers by name: the defaults, then all methods with the parameters of the study; the times of
their scans are corrected for the latency."""

LAYOUTS = (
    TableLayout(
        "Two boats in recorded radar scans, means",
        (
            Column("ospa_m", "OSPA", ".1f"),
            Column("gospa_m", "GOSPA", ".1f"),
            Column("rmse_m", "RMSE", ".1f"),
            Column("held_share", "maintained", ".2f"),
            Column("continuity", "contin.", ".2f"),
            Column("identity_swaps", "swaps", ".1f"),
            Column("false_tracks_per_hour", "false/h", ".0f"),
            Column("confirmation_delay_scans", "conf.", ".1f"),
        ),
        "m, cut-off 20 m, order 2. false/h: also boats without receiver, shore and multiple "
        "reflections. conf.: scans until the first confirmed track, inclusive. The times of a "
        "scenario are corrected by the latency that suits the others; as stamped: they are not.",
        ALL,
    ),
    TableLayout(
        "Scenario by scenario",
        (
            Column("ospa_m", "OSPA", ".1f"),
            Column("gospa_m", "GOSPA", ".1f"),
            Column("rmse_m", "RMSE", ".1f"),
            Column("held_share", "maintained", ".2f"),
            Column("continuity", "contin.", ".2f"),
            Column("false_tracks_per_hour", "false/h", ".0f"),
        ),
        "In scenarios 13 to 17 the boats pass abreast, at times with one echo for both.",
        "scenario",
    ),
)


@dataclass(frozen=True)
class ScenarioRun:
    """What one system did in one scenario.

    Attributes
    ----------
    system, scenario : str
        Names.
    metrics : mapping of str to float
        Figures.
    tracks : tuple of PositionTracks
        Of the tracker, one list a scan.
    """

    system: str
    scenario: str
    metrics: Mapping[str, float]
    tracks: tuple[PositionTracks, ...] = ()


def run_scenarios(path: Path) -> tuple[ScenarioRun, ...]:
    """Track all scenarios with all systems.

    Parameters
    ----------
    path : Path
        Scenario, or folder of scenarios.
    """
    scenarios = read_scenarios(path)
    runs = []
    for scenario in scenarios:
        others = [other for other in scenarios if other is not scenario] or [scenario]
        latency = estimated_latency(others)
        for name, configuration in SYSTEMS.items():
            runs.append(track_scenario(name, configuration, scenario, latency))
            if name == DEFAULTS:
                runs.append(without_static_tracks(runs[-1], scenario, latency))
        runs.append(track_scenario(AS_STAMPED, CONFIGURATION, scenario, 0.0))
        runs.append(nearest_contacts(scenario, latency))
    return tuple(runs)


def track_scenario(
    name: str,
    configuration: ContactTrackerConfiguration,
    scenario: MaritimeScenario,
    latency: float,
) -> ScenarioRun:
    """Track one scenario with one system.

    Parameters
    ----------
    name : str
        Of the system.
    configuration : ContactTrackerConfiguration
        Its method and parameters.
    scenario : MaritimeScenario
        The scans.
    latency : float
        By which they are stamped too late, s.
    """
    tracker = make_contact_tracker(configuration)
    pings = scenario.pings(latency)
    started = time.process_time()
    tracks = tuple(tracker.update(ping).tracks for ping in pings)
    seconds = (time.process_time() - started) / len(pings)
    score = score_position_tracks(scenario.true_tracks(latency), tracks, CUTOFF)
    metrics = {**_figures(score), "scan_ms": 1e3 * seconds, "latency_s": latency}
    return ScenarioRun(name, scenario.name, metrics, tracks)


def without_static_tracks(
    run: ScenarioRun, scenario: MaritimeScenario, latency: float
) -> ScenarioRun:
    """Return a run of which what is told to be fixed is left out.

    Parameters
    ----------
    run : ScenarioRun
        Of a tracker.
    scenario : MaritimeScenario
        The scans.
    latency : float
        By which they are stamped too late, s.
    """
    tracks = tuple(each.selected(each.source != TrackSource.STATIC) for each in run.tracks)
    score = score_position_tracks(scenario.true_tracks(latency), tracks, CUTOFF)
    return ScenarioRun(MOVING, scenario.name, {**run.metrics, **_figures(score)}, tracks)


def nearest_contacts(scenario: MaritimeScenario, latency: float) -> ScenarioRun:
    """Take the contacts nearest to the boats for their positions, and no others."""
    assigned = scenario.nearest_contacts(latency)
    squares = [a.cost + CUTOFF**ORDER * (a.n_truths - len(a.truths)) for a in assigned]
    halved = [a.cost + 0.5 * CUTOFF**ORDER * (a.n_truths - len(a.truths)) for a in assigned]
    n_held, n_truths = sum(len(a.truths) for a in assigned), sum(a.n_truths for a in assigned)
    metrics = {
        "ospa_m": float(np.mean(np.sqrt(np.array(squares) / assigned[0].n_truths))),
        "gospa_m": float(np.mean(np.sqrt(halved))),
        "rmse_m": float(np.sqrt(sum(a.cost for a in assigned) / n_held)),
        "held_share": n_held / n_truths,
    }
    return ScenarioRun(NEAREST, scenario.name, metrics)


def rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Return the means over all scenarios, then one row a scenario and system."""
    runs: list[ScenarioRun] = [run for result in results for run in result]
    table = []
    for system in dict.fromkeys(run.system for run in runs):
        own = [run.metrics for run in runs if run.system == system]
        means = {name: float(np.nanmean([metrics[name] for metrics in own])) for name in own[0]}
        table.append(StudyRow(system, ALL, means))
    table.extend(StudyRow(run.system, run.scenario, run.metrics) for run in runs)
    return tuple(table)


def maritime_contacts(path: Path) -> StudyDefinition:
    """Return the study of recorded scans; it has no random runs.

    Parameters
    ----------
    path : Path
        Scenario, or folder of scenarios.
    """

    def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
        tracked = {
            run.scenario: run for result in results for run in result if run.system == INTEGRATED
        }
        return tuple(
            draw_scenario(
                directory / f"{scenario.name}.png",
                scenario,
                tracked[scenario.name].tracks,
                tracked[scenario.name].metrics["latency_s"],
            )
            for scenario in read_scenarios(path)
        )

    return StudyDefinition(
        name=MARITIME_CONTACTS,
        description="two boats tracked in recorded radar scans from a moving ferry",
        default_runs=1,
        tasks=lambda runs, seed: (Task(run_scenarios, path),),
        rows=rows,
        layouts=LAYOUTS,
        draw=draw,
    )


def _figures(score: PositionScore) -> dict[str, float]:
    identities = score.identities
    return {
        "ospa_m": score.ospa_m,
        "gospa_m": score.gospa_m,
        "rmse_m": score.rmse_m,
        "median_error_m": score.median_error_m,
        "velocity_rmse_m_per_s": score.velocity_rmse_m_per_s,
        "nees_per_dimension": score.nees_per_dimension,
        "held_share": identities.held_share,
        "continuity": identities.continuity,
        "identity_swaps": float(identities.identity_swaps),
        "lost_tracks": float(identities.lost_tracks),
        "false_tracks_per_hour": identities.false_tracks_per_hour,
        "confirmation_delay_scans": identities.confirmation_delay_periods,
    }
