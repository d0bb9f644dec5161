"""Speed of the contact trackers, and side by side with Stone Soup where that is installed.

The scenes are those of the multi-target-clutter study. With more clutter fewer contacts are
targets: the initial existence probability falls in proportion, as a user would set it.
"""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.evaluation.multi_target_clutter_runs import CUTOFF, ORDER
from sonar_tracking.evaluation.multi_target_clutter_scene import (
    ENVIRONMENTS,
    PING_INTERVAL,
    SceneOptions,
    simulate_scene,
)
from sonar_tracking.evaluation.multi_target_clutter_systems import (
    HPDA_KALMAN,
    HPDA_PARTICLE,
    INTEGRATED,
    KALMAN_ACCELERATION_DEVIATION,
    PAPER_SYSTEMS,
)
from sonar_tracking.evaluation.set_distances import assign, ospa
from sonar_tracking.evaluation.stone_soup_peer import PeerParameters, stone_soup_positions
from sonar_tracking.evaluation.study import StudyRow
from sonar_tracking.evaluation.study_definition import Column, TableLayout
from sonar_tracking.passive.records import TrackStatus
from sonar_tracking.simulation.contact_simulation import SimulatedPing

FloatArray = NDArray[np.float64]

CLUTTER = (10, 50, 500, 2000)
"""Mean false contacts a ping; 10 is environment 1, the others environment 2 with more of them."""

FIRST_PING, PINGS = 150, 20
"""Four targets are there from the first one on."""

SETTLED_PINGS = 5
"""Not timed: the candidates of clutter are not all there yet."""

PEER_PINGS = 120
REFERENCE_CLUTTER = 50.0
SYSTEMS = (INTEGRATED, HPDA_KALMAN, HPDA_PARTICLE)
PEER, GATED_PEER = "peer: Stone Soup JPDA", "peer: Stone Soup JPDA, gated"
SIDE_BY_SIDE = "contacts beside Stone Soup"

CONTACT_LAYOUTS = (
    TableLayout(
        "Contact tracking, one core",
        (Column("milliseconds_per_ping", "ms/ping", ".2f"),),
        "Four targets in clutter; every false contact becomes a candidate for some pings.",
        "clutter",
    ),
    TableLayout(
        "Contact tracking beside Stone Soup, the same contacts, one core",
        (
            Column("milliseconds_per_scan", "ms/ping", ".2f"),
            Column("ospa_m", "OSPA, m", ".2f"),
            Column("speed_over_gated", "x gated", ".1f"),
        ),
        f"Environment 1 of multi-target-clutter, {PEER_PINGS} pings. Gated: its initiator and "
        "associator are only asked about contacts near a track.",
        SIDE_BY_SIDE,
    ),
)


def measure_clutter(clutter: int) -> tuple[StudyRow, ...]:
    """Measure the trackers among so many false contacts a ping.

    Parameters
    ----------
    clutter : int
        Mean number a ping.
    """
    options = SceneOptions(2 if clutter > 10 else 1, clutter_per_ping=float(clutter))
    pings = simulate_scene(options, np.random.SeedSequence(clutter), FIRST_PING + PINGS)
    share = min(1.0, REFERENCE_CLUTTER / clutter)
    rows = []
    for name in SYSTEMS:
        configuration = PAPER_SYSTEMS[name]
        scaled = replace(configuration, initial_existence=configuration.initial_existence * share)
        seconds, _ = _tracked(scaled, pings[FIRST_PING:])
        metrics = {"milliseconds_per_ping": 1e3 * float(np.median(seconds[SETTLED_PINGS:]))}
        rows.append(StudyRow(name, f"clutter {clutter} a ping", metrics))
    return tuple(rows)


def measure_side_by_side(n_pings: int) -> tuple[StudyRow, ...]:
    """Measure the trackers and Stone Soup on the same contacts; nothing where it is missing.

    Parameters
    ----------
    n_pings : int
        Of environment 1, from the first one on.
    """
    if importlib.util.find_spec("stonesoup") is None:
        return ()
    pings = simulate_scene(SceneOptions(1), np.random.SeedSequence(0), n_pings)
    figures = {}
    for name in SYSTEMS:
        seconds, positions = _tracked(PAPER_SYSTEMS[name], pings)
        figures[name] = (float(np.mean(seconds)), _mean_ospa(pings, positions))
    sensor = ENVIRONMENTS[1]
    parameters = PeerParameters(
        detection_probability=sensor.detection_probability,
        gate_probability=PROBABILITY_IN_GATE,
        clutter_density=sensor.clutter_per_ping / (np.pi * sensor.maximum_range**2),
        acceleration_deviation=KALMAN_ACCELERATION_DEVIATION,
        interval=PING_INTERVAL,
        speed_deviation=PAPER_SYSTEMS[INTEGRATED].initial_speed_deviation,
    )
    contacts = [ping.contacts for ping in pings]
    for name, gated in ((GATED_PEER, True), (PEER, False)):
        peer_positions, each = stone_soup_positions(contacts, parameters, gated)
        figures[name] = (each, _mean_ospa(pings, peer_positions))
    reference = figures[GATED_PEER][0]
    return tuple(
        StudyRow(
            name,
            SIDE_BY_SIDE,
            {
                "milliseconds_per_scan": 1e3 * each,
                "ospa_m": error,
                "speed_over_gated": reference / each,
            },
        )
        for name, (each, error) in figures.items()
    )


def _tracked(
    configuration: ContactTrackerConfiguration, pings: Sequence[SimulatedPing]
) -> tuple[FloatArray, list[FloatArray]]:
    """Return the processor time of each ping (s) and the positions of the confirmed tracks."""
    tracker = make_contact_tracker(configuration)
    seconds, positions = [], []
    for ping in pings:
        started = time.process_time()
        tracks = tracker.update(ping.contacts).tracks
        seconds.append(time.process_time() - started)
        shown = np.isin(tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
        positions.append(tracks.state[shown, :2])
    return np.array(seconds), positions


def _mean_ospa(pings: Sequence[SimulatedPing], positions: Sequence[FloatArray]) -> float:
    distances = []
    for ping, estimates in zip(pings, positions, strict=True):
        separation = ping.state[:, None, :2] - estimates[None]
        assignment = assign(np.hypot(separation[..., 0], separation[..., 1]), CUTOFF, ORDER)
        distances.append(ospa(assignment, CUTOFF, ORDER))
    return float(np.mean(distances))
