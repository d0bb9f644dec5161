"""The datum of ``map`` as a message tells it."""

from __future__ import annotations

from typing import Any

from sonar_tracking.records.datum import Datum, datum_from_mapping


def datum_from_message(message: Any, where: str) -> Datum:
    """Return the datum that a ``sensor_msgs/NavSatFix`` tells.

    Parameters
    ----------
    message : NavSatFix
        Of a graph or a bag.
    where : str
        Its topic, named in errors.

    Raises
    ------
    ConfigurationError
        If it is no place on the Earth.
    """
    values = {
        "latitude_deg": message.latitude,
        "longitude_deg": message.longitude,
        "height": message.altitude,
    }
    return datum_from_mapping(values, where)
