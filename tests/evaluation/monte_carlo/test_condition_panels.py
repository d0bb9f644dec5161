"""Protects the picture of many conditions: a zero is drawn, what is missing is not."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from sonar_tracking.evaluation.monte_carlo.condition_panels import _draw_metric
from sonar_tracking.evaluation.monte_carlo.plot_styles import Style
from sonar_tracking.evaluation.monte_carlo.study import StudyRow


def test_zero_is_a_figure_and_what_is_missing_is_none() -> None:
    rows = [
        StudyRow("one", "first", {"false": 0.0}),
        StudyRow("one", "second", {"rmse": 1.0}),
        StudyRow("other", "first", {"false": 2.0}),
    ]
    axes = Figure().subplots()
    styles = {"one": Style("#000000", "o"), "other": Style("#999999", "x")}
    _draw_metric(axes, rows, ["first", "second"], "false", styles)
    drawn = [np.asarray(line.get_xdata(), float) for line in axes.lines]
    np.testing.assert_array_equal(drawn, [[0.0, np.nan], [2.0, np.nan]])
