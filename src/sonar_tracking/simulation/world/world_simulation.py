"""Simulation of what no sensor measures: own ship's motion and the truth, instant by instant.

An instant that several sensors need is reported once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.world.world_instants import Instants, needed_instants
from sonar_tracking.simulation.world.world_state import consort_at, own_ship_at, true_tracks


@dataclass(frozen=True)
class WorldInstant:
    """The world at one instant.

    Attributes
    ----------
    stamp : int
        ns.
    own_ship : OwnShipState or None
        None = no sensor needs it then.
    truth_tracks : TruthTracks or None
        True positions of the targets; None = no data have this stamp.
    consort : OwnShipState or None
        The second ship of own side, at the instants of own ship; None = there is none.
    """

    stamp: int
    own_ship: OwnShipState | None
    truth_tracks: TruthTracks | None
    consort: OwnShipState | None = None

    @property
    def start_stamp(self) -> int:
        """The instant, ns."""
        return self.stamp

    @property
    def due_stamp(self) -> int:
        """The instant, ns: the world tells its state at once."""
        return self.stamp


class WorldSimulation:
    """Makes the instants of a scenario in order.

    Parameters
    ----------
    scenario : Scenario
        Its sensors decide which instants are needed.
    """

    def __init__(self, scenario: Scenario) -> None:
        needed = needed_instants(scenario)
        self._scenario = scenario
        self._own_ship = _Merged(needed.own_ship)
        self._truth = _Merged(needed.truth)

    def next_instant(self) -> WorldInstant | None:
        """Return the next instant, or None after the last one."""
        stamp = min(self._own_ship.stamp, self._truth.stamp)
        if stamp == END_OF_DATA:
            return None
        own_ship = truth = consort = None
        if self._own_ship.stamp == stamp:
            time = self._own_ship.take()
            own_ship = own_ship_at(self._scenario, time)
            consort = consort_at(self._scenario, time)
        if self._truth.stamp == stamp:
            time = self._truth.take()
            truth = true_tracks(self._scenario, time, self._truth.stamp)
        return WorldInstant(stamp, own_ship, truth, consort)


class _Merged:
    """Goes through several series of instants in the order of their stamps, each stamp once."""

    def __init__(self, series: Sequence[Instants]) -> None:
        self._series = tuple(series)
        self._numbers = [0] * len(self._series)
        self.stamp = self._earliest()

    def take(self) -> float:
        """Return the scenario time of the present stamp, s, and go on to the next one."""
        time = 0.0
        for index, instants in enumerate(self._series):
            instant = instants.at(self._numbers[index])
            if instant is not None and instant[0] == self.stamp:
                time = instant[1]
                self._numbers[index] += 1
        self.stamp = self._earliest()
        return time

    def _earliest(self) -> int:
        """Stamp of the next instant, ns; END_OF_DATA after the last one."""
        instants = (
            series.at(number) for series, number in zip(self._series, self._numbers, strict=True)
        )
        return min((each[0] for each in instants if each is not None), default=END_OF_DATA)
