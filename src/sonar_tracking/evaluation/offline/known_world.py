"""Own ship and its consort at any stamp, as the nodes know them from odometry."""

from __future__ import annotations

from sonar_tracking.motion import KinematicState
from sonar_tracking.own_ship_interpolation import motion_at
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import seconds
from sonar_tracking.simulation.scenarios.platforms import CONSORT
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.world.world_simulation import WorldSimulation
from sonar_tracking.simulation.world.world_state import true_tracks


class KnownWorld:
    """What odometry and truth tell of a simulated world.

    Parameters
    ----------
    scenario : Scenario
        The world.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._truth: dict[int, TruthTracks] = {}
        self._ships: dict[str, list[OwnShipState]] = {"": [], CONSORT: []}
        for instant in iter(WorldSimulation(scenario).next_instant, None):
            if instant.truth_tracks is not None:
                self._truth[instant.stamp] = instant.truth_tracks
            for place, ship in (("", instant.own_ship), (CONSORT, instant.consort)):
                if ship is not None:
                    self._ships[place].append(ship)
        self._stamps = {
            place: [each.stamp for each in states] for place, states in self._ships.items()
        }

    def truth(self, stamp: int) -> TruthTracks:
        """Return where the targets are at a stamp, ns."""
        if stamp in self._truth:
            return self._truth[stamp]
        return true_tracks(self._scenario, seconds(stamp - self._scenario.epoch))

    def ship(self, place: str, stamp: int) -> KinematicState | None:
        """Return the ship of a place at a stamp, ns; None = its odometry does not tell.

        Parameters
        ----------
        place : str
            Empty = own ship; its consort. Other places are no ships.
        stamp : int
            ns.
        """
        return motion_at(self._ships.get(place, ()), self._stamps.get(place, ()), stamp)
