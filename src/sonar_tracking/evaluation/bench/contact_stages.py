"""Speed of the contact trackers, and side by side with Stone Soup where that is installed.

The scenes are those of the multi-target-clutter study. With more clutter fewer contacts are
targets: the initial existence probability falls in proportion, as a user would set it.
"""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_method_registry import CONTACT_METHODS
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.evaluation.bench.stone_soup_peer import PeerParameters, stone_soup_positions
from sonar_tracking.evaluation.bench.timing import scaling_exponent
from sonar_tracking.evaluation.metrics.ospa_gospa import assign, ospa
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import Column, TableLayout
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    ENVIRONMENTS,
    PING_INTERVAL,
    SceneOptions,
    simulate_scene,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.system_run import CUTOFF, ORDER
from sonar_tracking.evaluation.studies.multi_target_clutter.systems import (
    HPDA_KALMAN,
    HPDA_PARTICLE,
    INTEGRATED,
    INTEGRATED_STRAIGHT,
    KALMAN_ACCELERATION_DEVIATION,
    PAPER_SYSTEMS,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.contact_simulation import SimulatedPing

CLUTTER = (50, 500, 5000)
"""Mean false contacts a ping, in environment 2."""

FIRST_PING, PINGS = 150, 12
"""Four targets are there from the first one on."""

SETTLED_PINGS = 6
"""Not timed: the candidates of clutter are not all there yet."""

PEER_PASSES = 2
"""In turns; the fastest one of each ping counts, since other work can only slow one down."""

REFERENCE_CLUTTER = 50.0
SYSTEMS = tuple(entry.label for entry in CONTACT_METHODS if entry.estimates_existence)
COMPARED_SYSTEMS = (INTEGRATED, INTEGRATED_STRAIGHT, HPDA_KALMAN, HPDA_PARTICLE)
PEER, GATED_PEER = "peer: Stone Soup JPDA", "peer: Stone Soup JPDA, gated"
SIDE_BY_SIDE = "beside Stone Soup, "


@dataclass(frozen=True)
class PeerScene:
    """Contacts of the multi-target-clutter study that both sides track.

    Attributes
    ----------
    condition : str
        Name in the table.
    environment : int
        Of the study.
    first_ping, n_pings : int
        Which part of it; tracking starts at the first one.
    peers : tuple of str
        Versions of the peer.
    """

    condition: str
    environment: int
    first_ping: int
    n_pings: int
    peers: tuple[str, ...]


PEER_SCENES = (
    PeerScene(f"{SIDE_BY_SIDE}environment 1, 40 pings", 1, 0, 40, (GATED_PEER, PEER)),
    PeerScene(f"{SIDE_BY_SIDE}environment 2, pings 150 to 169", 2, 150, 20, (GATED_PEER,)),
)
"""The ungated initiator is left out where it takes seconds a ping."""

CONTACT_LAYOUTS = (
    TableLayout(
        "Contact tracking, one thread",
        (
            Column("milliseconds_per_ping", "ms/ping", ".2f"),
            Column("exponent", "exponent", ".2f"),
        ),
        "Four targets in so many false contacts a ping, each of which becomes a candidate for some "
        "pings.",
    ),
    TableLayout(
        "Contact tracking beside Stone Soup, the same contacts, one thread",
        (
            Column("milliseconds_per_scan", "ms/ping", ".2f"),
            Column("ospa_m", "OSPA, m", ".2f"),
            Column("speed_over_gated", "x gated", ".1f"),
        ),
        "Scenes of multi-target-clutter. The peer has one straight motion mode and the noise of "
        "'integrated, no turns' and 'HPDA, Kalman'. Gated: its initiator and associator are only "
        "asked about contacts near a track.",
        SIDE_BY_SIDE,
    ),
)


def measure_clutter(system: str) -> tuple[StudyRow, ...]:
    """Measure a tracker among few and many false contacts.

    Parameters
    ----------
    system : str
        Of the multi-target-clutter study.
    """
    seconds = {clutter: _seconds_of_ping(system, clutter) for clutter in CLUTTER}
    rows = []
    for clutter, each in seconds.items():
        figures = {"milliseconds_per_ping": 1e3 * each}
        if clutter == CLUTTER[-1]:
            figures["exponent"] = scaling_exponent([*seconds], [*seconds.values()])
        rows.append(StudyRow(f"clutter {clutter}", system, figures))
    return tuple(rows)


def _seconds_of_ping(system: str, clutter: int) -> float:
    options = SceneOptions(2, clutter_per_ping=float(clutter))
    pings = simulate_scene(options, np.random.SeedSequence(clutter), FIRST_PING + PINGS)
    configuration = PAPER_SYSTEMS[system]
    share = min(1.0, REFERENCE_CLUTTER / clutter)
    scaled = replace(configuration, initial_existence=configuration.initial_existence * share)
    seconds, _ = _tracked(scaled, pings[FIRST_PING:])
    return float(np.median(seconds[SETTLED_PINGS:]))


def measure_side_by_side(scene: PeerScene) -> tuple[StudyRow, ...]:
    """Measure the trackers, and Stone Soup where it is installed, on the same contacts.

    Parameters
    ----------
    scene : PeerScene
        Which contacts, and which versions of the peer.
    """
    pings = _simulated(scene)
    calls: dict[str, Callable[[], tuple[FloatArray, float]]]
    calls = {name: partial(_tracked_error, PAPER_SYSTEMS[name], pings) for name in COMPARED_SYSTEMS}
    if stone_soup_installed():
        for name in scene.peers:
            calls[name] = partial(_peer_tracked, scene, pings, name == GATED_PEER)
    passes = [{name: call() for name, call in calls.items()} for _ in range(PEER_PASSES)]
    figures = {}
    for name, (_, error) in passes[0].items():
        fastest = np.min([one[name][0] for one in passes], axis=0)
        figures[name] = (float(np.mean(fastest)), error)
    rows = []
    for name, (each, error) in figures.items():
        metrics = {"milliseconds_per_scan": 1e3 * each, "ospa_m": error}
        if GATED_PEER in figures:
            metrics["speed_over_gated"] = figures[GATED_PEER][0] / each
        rows.append(StudyRow(name, scene.condition, metrics))
    return tuple(rows)


def stone_soup_installed() -> bool:
    """Return whether the peer is there."""
    return importlib.util.find_spec("stonesoup") is not None


def _simulated(scene: PeerScene) -> Sequence[SimulatedPing]:
    options = SceneOptions(scene.environment)
    last = scene.first_ping + scene.n_pings
    return simulate_scene(options, np.random.SeedSequence(0), last)[scene.first_ping :]


def _tracked_error(
    configuration: ContactTrackerConfiguration, pings: Sequence[SimulatedPing]
) -> tuple[FloatArray, float]:
    """Return the time of each ping (s) and the mean OSPA (m) of a tracker."""
    seconds, positions = _tracked(configuration, pings)
    return seconds, _mean_ospa(pings, positions)


def _peer_tracked(
    scene: PeerScene, pings: Sequence[SimulatedPing], gated: bool
) -> tuple[FloatArray, float]:
    """Return the time of each ping (s) and the mean OSPA (m) of Stone Soup."""
    sensor = ENVIRONMENTS[scene.environment]
    parameters = PeerParameters(
        detection_probability=sensor.detection_probability,
        gate_probability=PROBABILITY_IN_GATE,
        clutter_density=sensor.clutter_per_ping / (np.pi * sensor.maximum_range**2),
        acceleration_deviation=KALMAN_ACCELERATION_DEVIATION,
        interval=PING_INTERVAL,
        speed_deviation=PAPER_SYSTEMS[INTEGRATED].initial_speed_deviation,
    )
    contacts = [ping.contacts for ping in pings]
    positions, seconds = stone_soup_positions(contacts, parameters, gated)
    return seconds, _mean_ospa(pings, positions)


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
        shown = tracks.established
        positions.append(tracks.state[shown, :2])
    return np.array(seconds), positions


def _mean_ospa(pings: Sequence[SimulatedPing], positions: Sequence[FloatArray]) -> float:
    distances = []
    for ping, estimates in zip(pings, positions, strict=True):
        separation = ping.state[:, None, :2] - estimates[None]
        assignment = assign(np.hypot(separation[..., 0], separation[..., 1]), CUTOFF, ORDER)
        distances.append(ospa(assignment, CUTOFF, ORDER))
    return float(np.mean(distances))
