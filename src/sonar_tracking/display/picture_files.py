"""Pictures on disk: each as PNG, and as SVG for print."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

DOTS_PER_INCH = 160

_STYLE: Any = {
    "font.family": ["DejaVu Sans", "sans-serif"],
    "axes.titlesize": 10,
    "axes.labelsize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "figure.autolayout": False,
    "figure.constrained_layout.use": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "sonar_tracking",
}
"""Text of an SVG stays text; the same picture has the same bytes."""

_LOUD = ("#fcfcfa", "#d0e0e8", "#82b2ce", "#3e7aa8", "#1e4278", "#0c1230")
"""From quiet to loud: lightness falls steadily, in print and for the colour-blind."""


def picture_style() -> AbstractContextManager[None]:
    """Return the context in which all pictures are drawn: sizes of text, spines, text in SVG."""
    from matplotlib import rc_context

    return rc_context(_STYLE)


def new_figure(
    width: float, height: float, layout: Literal["constrained"] | None = "constrained"
) -> Figure:
    """Return a figure of a size in inches, drawn without a screen; layout None = by hand."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def save_picture(figure: Figure, path: Path) -> tuple[Path, Path]:
    """Write a figure as PNG and as SVG, and return both files.

    Parameters
    ----------
    figure : Figure
        From :func:`new_figure`.
    path : Path
        Of the PNG; the SVG stands beside it.
    """
    vector = path.with_suffix(".svg")
    # Room is made for the texts once: each file would do it twice, which takes as long as drawing.
    # With a layout that only keeps what is there, each would still be drawn once for nothing.
    figure.set_dpi(DOTS_PER_INCH)
    if figure.get_layout_engine() is not None:
        figure.draw_without_rendering()
        figure.set_layout_engine(None)
    figure.savefig(path, dpi=DOTS_PER_INCH)
    figure.savefig(vector, dpi=DOTS_PER_INCH, metadata={"Date": None})
    return path, vector


def loudness_colours() -> Colormap:
    """Return the colours of power, from quiet to loud."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("loudness", _LOUD)
