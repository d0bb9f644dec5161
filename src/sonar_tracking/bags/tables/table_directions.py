"""Directions in a table, in the ways people write them."""

from __future__ import annotations

import numpy as np

from sonar_tracking.bags.tables.number_table import NumberTable
from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.records.arrays import FloatArray


def direction_angles(table: NumberTable, column: str) -> FloatArray:
    """Return the directions of a column.

    Parameters
    ----------
    table : NumberTable
        Whose column.
    column : str
        ``bearing_deg`` (compass), ``azimuth_deg`` (anticlockwise from east),
        ``relative_bearing_deg`` (clockwise from the bow), ``cone_angle_deg`` (from the axis of a
        line array) or ``arrival_angle_deg`` (from its broadside).

    Returns
    -------
    ndarray, shape (n_rows,)
        rad: azimuths in ``map``, anticlockwise from the bow, or from broadside, positive ahead.
    """
    given = table.column(column)
    if column == "bearing_deg":
        return azimuth_from_compass(given)
    if column == "relative_bearing_deg":
        return -np.radians(given)
    return np.radians(90.0 - given if column == "cone_angle_deg" else given)
