"""Tracks as GeoJSON and as KML, with the standard library.

References
----------
H. Butler et al. (2016). The GeoJSON Format. RFC 7946.

Open Geospatial Consortium (2015). OGC KML 2.3, 12-007r2.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, TextIO
from xml.etree import ElementTree

from sonar_tracking.bags.exporters.export_rows import utc_text
from sonar_tracking.bags.exporters.track_lines import LineName, TrackLine

KML_NAMESPACE = "http://www.opengis.net/kml/2.2"

_COLOURS = {"truth": "ff00aa00", "own_ship": "ff000000", "": "ff0000ff"}
"""Of the lines: opacity, blue, green, red in hexadecimal digits."""


def write_geojson(lines: Mapping[LineName, TrackLine], file: TextIO) -> None:
    """Write a collection of features, one a track, with what its last row says."""
    file.write('{"type": "FeatureCollection", "features": [')
    for number, ((topic, _), line) in enumerate(lines.items()):
        feature = {
            "type": "Feature",
            "geometry": _geometry(line),
            "properties": {"name": track_name(topic, line), **_properties(line)},
        }
        # A digit more than 8 decimals of a degree would be below 1 mm.
        file.write((",\n" if number else "\n") + json.dumps(feature, allow_nan=False))
    file.write("\n]}\n")


def write_kml(lines: Mapping[LineName, TrackLine], file: TextIO) -> None:
    """Write a document with one placemark a track."""
    file.write('<?xml version="1.0" encoding="UTF-8"?>\n')
    file.write(f'<kml xmlns="{KML_NAMESPACE}">\n<Document>\n')
    for (topic, _), line in lines.items():
        file.write(ElementTree.tostring(_placemark(topic, line), encoding="unicode") + "\n")
    file.write("</Document>\n</kml>\n")


def track_name(topic: str, line: TrackLine) -> str:
    """Return what a chart calls a track: as an operator did, else topic and number."""
    number = line.last.get("id")
    given = str(line.last.get("name") or "")
    return given or ("own ship" if number is None else f"{topic} {number}")


def _properties(line: TrackLine) -> dict[str, Any]:
    """Return the cells that hold something, the time span and the times of the points."""
    told = {name: value for name, value in line.last.items() if _is_told(value)}
    for name in ("name", "time", "stamp_ns", "latitude_deg", "longitude_deg"):
        told.pop(name, None)
    if line.contributors:
        told["contributors"] = ";".join(line.contributors)
    told["begin"], told["end"] = utc_text(line.points[0][0]), utc_text(line.points[-1][0])
    told["times"] = [utc_text(stamp) for stamp, _, _ in line.points]
    return told


def _is_told(value: Any) -> bool:
    return value != "" and not (isinstance(value, float) and not math.isfinite(value))


def _geometry(line: TrackLine) -> dict[str, Any]:
    parts = [[[longitude, latitude] for _, latitude, longitude in part] for part in line.parts()]
    if len(line.points) == 1:
        return {"type": "Point", "coordinates": parts[0][0]}
    if len(parts) == 1:
        return {"type": "LineString", "coordinates": parts[0]}
    # A line has two points at least: RFC 7946, section 3.1.4.
    doubled = [part if len(part) > 1 else part * 2 for part in parts]
    return {"type": "MultiLineString", "coordinates": doubled}


def _placemark(topic: str, line: TrackLine) -> ElementTree.Element:
    placemark = ElementTree.Element("Placemark")
    ElementTree.SubElement(placemark, "name").text = track_name(topic, line)
    told = _properties(line)
    del told["times"]
    span = ElementTree.SubElement(placemark, "TimeSpan")
    for name in ("begin", "end"):
        ElementTree.SubElement(span, name).text = told[name]
    colour = _COLOURS.get(str(told.get("role")), _COLOURS.get(str(told.get("kind")), _COLOURS[""]))
    style = ElementTree.SubElement(ElementTree.SubElement(placemark, "Style"), "LineStyle")
    ElementTree.SubElement(style, "color").text = colour
    ElementTree.SubElement(style, "width").text = "2"
    data = ElementTree.SubElement(placemark, "ExtendedData")
    for name, value in told.items():
        entry = ElementTree.SubElement(data, "Data", name=name)
        ElementTree.SubElement(entry, "value").text = str(value)
    coordinates = " ".join(
        f"{longitude!r},{latitude!r},0" for _, latitude, longitude in line.points
    )
    shape = "Point" if len(line.points) == 1 else "LineString"
    geometry = ElementTree.SubElement(placemark, shape)
    ElementTree.SubElement(geometry, "coordinates").text = coordinates
    return placemark
