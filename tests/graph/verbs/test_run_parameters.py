"""A parameter file goes before the scenario, and is checked before anything is started."""

from __future__ import annotations

from pathlib import Path

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.cutoff import CUTOFF_M

pytest.importorskip("rclpy")

from sonar_tracking.graph.verbs import run_command
from sonar_tracking.graph.verbs.display_choice import DisplayChoice


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("hpda_tracker: {seed: -1}", "mine.yaml: nodes: hpda_tracker.seed is -1; it must be"),
        ("hpda_tracker: {termination_probability: 0.95}", "a track would end as it is confirmed"),
        ("hpda_trackr: {}", "did you mean hpda_tracker?"),
        ("line_tracker: {}", "line_tracker has nothing to do in this scenario"),
        ("hpda_tracker: 3", "must be a mapping of parameter names to values"),
    ],
)
def test_what_a_file_says_is_checked_together_with_the_scenario(
    tmp_path: Path, text: str, sentence: str
) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text(text)
    with pytest.raises(ConfigurationError) as caught:
        run_command.run("active", 10.0, "1", None, mine, DisplayChoice(), None, CUTOFF_M, True)
    assert sentence in str(caught.value)
