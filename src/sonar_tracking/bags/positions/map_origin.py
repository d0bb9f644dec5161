"""Where on the Earth the map of an import lies: as told, or at the first place that is met.

Tables may give positions as ``east_m`` and ``north_m``, or as ``latitude_deg`` and
``longitude_deg``; logs of receivers give the latter. Files of both kinds go together only if the
place of the origin is told.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.geodesy import FARTHEST, surface_distances, surface_positions
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.datum import Datum, datum_at


class MapOrigin:
    """The datum of an import.

    Parameters
    ----------
    datum : Datum, optional
        As told.

    Attributes
    ----------
    datum : Datum or None
        As told, or the first place; None = not known, and nothing has asked for it.
    notes : list of str
        What was assumed.
    """

    def __init__(self, datum: Datum | None = None) -> None:
        self.datum = datum
        self.notes: list[str] = []
        self._is_told = datum is not None
        self._of_places = ""
        self._of_plane = ""

    def take_plane(self, source: str) -> None:
        """Note a file with positions in metres.

        Parameters
        ----------
        source : str
            The file.

        Raises
        ------
        ConfigurationError
            If another file has places on the Earth, and the datum was not told.
        """
        self._of_plane = self._of_plane or source
        self._refuse_both()

    def positions(
        self, latitude_deg: FloatArray, longitude_deg: FloatArray, source: str
    ) -> FloatArray:
        """Return x and y in ``map`` of places; the first of all is the datum if none was told.

        Parameters
        ----------
        latitude_deg, longitude_deg : ndarray, shape (n,)
            deg, at least one.
        source : str
            The file they come from.

        Returns
        -------
        ndarray, shape (n, 2)
            m; NaN farther than 200 km from the datum.

        Raises
        ------
        ConfigurationError
            If another file has positions in metres and the datum was not told, or all places lie
            too far from it.
        """
        self._of_places = self._of_places or source
        self._refuse_both()
        datum = self._known(float(latitude_deg[0]), float(longitude_deg[0]), source)
        positions = surface_positions(latitude_deg, longitude_deg, datum)
        # The far side of the Earth lies beneath the plane: it is the arc that counts.
        far = surface_distances(latitude_deg, longitude_deg, datum) > FARTHEST
        if far.all():
            nearest = float(np.min(surface_distances(latitude_deg, longitude_deg, datum)))
            raise ConfigurationError(
                f"{source} lies {nearest / 1000.0:.0f} km from the datum and farther; give "
                f"--datum within {FARTHEST / 1000.0:.0f} km of it."
            )
        return np.where(far[:, None], np.nan, positions)

    def scenario(self) -> dict[str, dict[str, float]]:
        """Return what a recording keeps of the datum; nothing if there is none."""
        return {} if self.datum is None else {"datum": self.datum.to_mapping()}

    def _known(self, latitude_deg: float, longitude_deg: float, source: str) -> Datum:
        if self.datum is None:
            self.datum = datum_at(latitude_deg, longitude_deg)
            self.notes.append(
                f"no --datum: the origin of map is the first place in {source}, "
                f"{self.datum.latitude_deg:g},{self.datum.longitude_deg:g}."
            )
        return self.datum

    def _refuse_both(self) -> None:
        if self._of_places and self._of_plane and not self._is_told:
            raise ConfigurationError(
                f"{self._of_places} has latitudes and longitudes, {self._of_plane} metres east and "
                "north of an origin that is not told; give --datum LATITUDE,LONGITUDE of it."
            )
