"""Colours and markers of the curves of a figure: every system is drawn, also one without a style.

The colours are Okabe and Ito's palette, which colour-blind readers tell apart, and a few more.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import chain, cycle, product, repeat

PALETTE = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#000000",
    "#882255",
    "#999933",
    "#999999",
)

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "*")

LINES = ("-", "--", "-.", ":")


@dataclass(frozen=True)
class Style:
    """How one system is drawn.

    Attributes
    ----------
    colour : str
        Of line and markers.
    marker : str
        Empty = none.
    line : str
        Line style.
    """

    colour: str
    marker: str = ""
    line: str = "-"


def styles_of(systems: Iterable[str], own: Mapping[str, Style] | None = None) -> dict[str, Style]:
    """Return a style for every system; those without one of their own get the next free ones.

    Parameters
    ----------
    systems : iterable of str
        Names of what is drawn.
    own : mapping of str to Style, optional
        Styles that are fixed; their colours are given to others only when no colour is left.

    Returns
    -------
    dict of str to Style
        First those with a style of their own, in its order, then the others.
    """
    fixed, names = own or {}, list(dict.fromkeys(systems))
    taken = {style.colour for style in fixed.values()}
    unused = [(colour, LINES[0]) for colour in PALETTE if colour not in taken]
    free = chain(unused, ((colour, line) for line, colour in cycle(product(LINES[1:], PALETTE))))
    markers = cycle(MARKERS) if any(style.marker for style in fixed.values()) else repeat("")
    styles = {name: style for name, style in fixed.items() if name in names}
    for name in names:
        if name not in fixed:
            colour, line = next(free)
            styles[name] = Style(colour, next(markers), line)
    return styles
