"""Passive and active sonar tracking as a ROS 2 node graph.

Conventions, stated once for the whole package:

- SI units and radians inside; names that end in ``_deg`` are for people.
- Arrival angle: from array broadside, radians, positive towards increasing element x.
- Azimuth: radians anticlockwise from +x (east) of the frame ``map`` (ENU).
- Compass bearing or course: degrees clockwise from north, only where a person reads or types.
- Stamps are integer nanoseconds since the epoch of the data; intervals are float seconds.
"""

import sys

if sys.version_info[:2] < (3, 10):  # noqa: UP036  (a sentence, where nothing else asks)
    raise ImportError(
        f"sonar_tracking needs Python 3.10 to 3.13, and this is {sys.version.split()[0]}",
        name="sonar_tracking",
    )


def __getattr__(name: str) -> str:
    """Look up ``__version__`` in package.xml, the one place where it is written."""
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from xml.etree.ElementTree import parse

    from sonar_tracking.resources import find_resource

    return parse(find_resource("package.xml")).findtext("version", "unknown")
