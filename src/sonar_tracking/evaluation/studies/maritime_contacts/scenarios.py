"""Recorded radar scans of a ferry with the true positions of two boats, scenario by scenario.

A scan is stamped when it is complete, up to one turn of the antenna after the boat was hit: the
contacts trail the boats. The latency that brings them together is estimated from the *other*
scenarios, so that no scenario is corrected by its own truth.

References
----------
Helgesen et al., "Heterogeneous multi-sensor tracking for an autonomous surface vehicle in a
littoral environment", Ocean Engineering 252, 2022: the data.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.bags.positions.own_ship_track import interpolated
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.ospa_gospa import Assignment, assign
from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS

RANGE_DEVIATION = 4.0
BEARING_DEVIATION_DEG = 2.0
"""Of a contact: boats of 10 to 30 m, hit anywhere, at 20 to 350 m."""

MAXIMUM_RANGE = 500.0
CUTOFF = 20.0
ORDER = 2.0
LATENCIES = np.arange(0.0, 3.05, 0.1)
"""Tried, s; a turn of the antenna takes 1.7 s."""


@dataclass(frozen=True)
class MaritimeScenario:
    """Scans of one scenario.

    Attributes
    ----------
    name : str
        Of the scenario.
    times : ndarray, shape (n_scans,)
        When the scans were stamped, s from the first second of the recording.
    start : int
        Instant of time zero, ns.
    own_ship : ndarray, shape (n_scans, 2)
        East, north, m.
    truth : ndarray, shape (n_scans, n_targets, 2)
        East, north, m, at ``times``.
    range, azimuth : tuple of ndarray, shape (n_contacts,)
        Of the contacts of each scan, m and rad.
    """

    name: str
    times: FloatArray
    start: int
    own_ship: FloatArray
    truth: FloatArray
    range: tuple[FloatArray, ...]
    azimuth: tuple[FloatArray, ...]

    def positions(self, scan: int) -> FloatArray:
        """Return where the contacts of a scan are, shape (n_contacts, 2), m."""
        azimuth = self.azimuth[scan]
        direction = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
        return np.asarray(self.own_ship[scan] + self.range[scan][:, None] * direction)

    def true_states(self, latency: float) -> FloatArray:
        """Return the states of the targets a latency before the stamps.

        Parameters
        ----------
        latency : float
            s.

        Returns
        -------
        ndarray, shape (n_scans, n_targets, 4)
            x, y, vx, vy, m and m/s.
        """
        flat = self.truth.reshape(len(self.times), -1)
        position, velocity = interpolated(self.times, flat, self.times - latency)
        shape = self.truth.shape
        return np.concatenate([position.reshape(shape), velocity.reshape(shape)], axis=-1)

    def pings(self, latency: float) -> tuple[Contacts, ...]:
        """Return the scans as the tracker takes them, stamped a latency earlier."""
        return tuple(
            Contacts(
                stamp=self._stamp(scan, latency),
                range=self.range[scan],
                azimuth=self.azimuth[scan],
                amplitude=np.zeros(0),
                range_standard_deviation=RANGE_DEVIATION,
                azimuth_standard_deviation=float(np.radians(BEARING_DEVIATION_DEG)),
                sensor_position=(float(own[0]), float(own[1])),
                maximum_range=MAXIMUM_RANGE,
            )
            for scan, own in enumerate(self.own_ship)
        )

    def true_tracks(self, latency: float) -> tuple[PositionTracks, ...]:
        """Return the targets at the stamps of :meth:`pings`."""
        n_targets = self.truth.shape[1]
        return tuple(
            PositionTracks(
                stamp=self._stamp(scan, latency),
                id=np.arange(1, n_targets + 1, dtype=np.uint64),
                status=np.full(n_targets, TrackStatus.CONFIRMED, np.uint8),
                source=np.full(n_targets, TrackSource.TRUTH, np.uint8),
                state=state,
            )
            for scan, state in enumerate(self.true_states(latency))
        )

    def nearest_contacts(self, latency: float) -> tuple[Assignment, ...]:
        """Return which contact of each scan is assigned to which target."""
        return tuple(
            assign(_distances(states[:, :2], self.positions(scan)), CUTOFF, ORDER)
            for scan, states in enumerate(self.true_states(latency))
        )

    def _stamp(self, scan: int, latency: float) -> int:
        return self.start + round(float(self.times[scan] - latency) * NANOSECONDS)


def read_scenarios(path: Path | str) -> tuple[MaritimeScenario, ...]:
    """Read the radar scans of a scenario, or of all scenarios of a folder.

    Parameters
    ----------
    path : Path or str
        ``scenarioNN.npz``, or a folder of them.

    Raises
    ------
    ConfigurationError
        If there is none, or a file is not of this kind.
    """
    path = Path(path)
    files = sorted(path.glob("scenario*.npz")) if path.is_dir() else [path]
    if not files:
        raise ConfigurationError(f"The folder {path} holds no scenario*.npz of radar scans.")
    return tuple(_read(file) for file in files)


def estimated_latency(scenarios: Sequence[MaritimeScenario]) -> float:
    """Return the latency (s) at which the contacts are nearest to the targets."""
    costs = [
        np.mean([_capped_square(scenario, float(latency)) for scenario in scenarios])
        for latency in LATENCIES
    ]
    return float(LATENCIES[int(np.argmin(costs))])


def _capped_square(scenario: MaritimeScenario, latency: float) -> float:
    """Return the mean square distance from a target to its contact, beyond the cut-off CUTOFF."""
    assigned = scenario.nearest_contacts(latency)
    cost = sum(a.cost + CUTOFF**2 * (a.n_truths - len(a.truths)) for a in assigned)
    return cost / sum(a.n_truths for a in assigned)


def _read(path: Path) -> MaritimeScenario:
    try:
        with np.load(path, allow_pickle=False) as file:
            data = {name: file[name] for name in file.files if not name.startswith(("eo_", "ir_"))}
    except (OSError, ValueError) as error:
        raise ConfigurationError(f"The file {path} cannot be read as npz ({error}).") from error
    if "radar_scan_t_s" not in data or "t0_unix_s" not in data:
        raise ConfigurationError(
            f"The file {path} holds no radar scans; it needs t0_unix_s, radar_scan_t_s, "
            "radar_scan_own_ne_m, radar_truth_ne_m, radar_det_scan, radar_det_range_m and "
            "radar_det_bearing_deg."
        )
    times = data["radar_scan_t_s"]
    azimuth = azimuth_from_compass(data["radar_det_bearing_deg"])
    rows = [np.flatnonzero(data["radar_det_scan"] == scan) for scan in range(len(times))]
    return MaritimeScenario(
        name=path.stem,
        times=times,
        start=round(float(data["t0_unix_s"])) * NANOSECONDS,
        own_ship=data["radar_scan_own_ne_m"][:, ::-1],
        truth=data["radar_truth_ne_m"][:, :, ::-1],
        range=tuple(data["radar_det_range_m"][row] for row in rows),
        azimuth=tuple(azimuth[row] for row in rows),
    )


def _distances(truth: FloatArray, points: FloatArray) -> FloatArray:
    separation = truth[:, None] - points[None]
    return np.hypot(separation[..., 0], separation[..., 1])
