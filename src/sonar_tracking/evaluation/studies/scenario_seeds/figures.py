"""Picture of the scenario-seeds study: the median error of every run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path


def draw_errors(errors: Mapping[str, Sequence[float]], directory: Path) -> tuple[Path, ...]:
    """Draw the median error of every run of every system.

    Parameters
    ----------
    errors : mapping of str to sequence of float
        By system, one a seed, m; NaN = no position.
    directory : Path
        Where the picture goes.
    """
    import matplotlib.pyplot as plt

    directory.mkdir(parents=True, exist_ok=True)
    figure, axes = plt.subplots(figsize=(9, 4), layout="constrained")
    for number, values in enumerate(errors.values()):
        axes.semilogy([number] * len(values), values, "o", color="#0072B2", alpha=0.5)
    axes.set_xticks(range(len(errors)), list(errors))
    axes.set_ylabel("median error of a run, m")
    axes.grid(alpha=0.3, which="both")
    path = directory / "scenario_seeds.png"
    figure.savefig(path, dpi=150)
    plt.close(figure)
    return (path,)
