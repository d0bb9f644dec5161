"""Parameters of the subspace stage."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.passive.subspaces.subspace_method_registry import (
    SUBSPACE_METHODS,
    SubspaceMethodEntry,
)


@dataclass(frozen=True)
class SubspaceConfiguration:
    """Parameters of the stage that follows the signal subspace."""

    method: str = parameter(
        "covariance",
        "How the signal subspace is followed",
        methods=SUBSPACE_METHODS,
    )
    forgetting_factor: float = parameter(
        0.97, "Weight beta of the past, per snapshot", minimum=0.01, maximum=0.99999
    )
    period: float = parameter(
        0.5, "Time between estimates, at its multiples in stamp time", unit="s", minimum=1e-3
    )
    source_count: int = parameter(
        0, "Columns of the subspace; 0 = found by MDL at the start", minimum=0
    )
    n_subspaces: int = parameter(
        1,
        "Adjacent subspaces P published with each estimate, odd; ml_fusion takes their mean, but "
        "half of them are later than the sample time",
        minimum=1,
        maximum=999,
    )
    update_snapshots: int = parameter(
        10,
        "Snapshots L between adjacent subspaces; 1 where a method takes a step each snapshot",
        minimum=1,
    )
    covariance_snapshots: int = parameter(
        100, "Snapshots of the sample covariance published with each estimate; 0 = none", minimum=0
    )
    covariance_alignment: str = parameter(
        "causal",
        "Which snapshots those are: the last ones up to the sample time (causal), or half of them "
        "before and half after it (centred), which delays the estimate by as much",
        choices=("causal", "centred"),
    )
    maximum_rate_deg: float = parameter(
        5.0,
        "Fastest bearing that the source count must not take for two sources",
        unit="deg/s",
        minimum=0.0,
    )
    steering_error: float = parameter(
        0.0,
        "Relative rms error of the steering vectors (gain and phase errors, reflections): what a "
        "strong source brings beside its own is noise and no source; 0 = estimated on strong "
        "sources",
        minimum=0.0,
        maximum=1.0,
    )

    @property
    def entry(self) -> SubspaceMethodEntry:
        """What is known of the method."""
        return SUBSPACE_METHODS[self.method]

    @property
    def step(self) -> int:
        """Snapshots between adjacent subspaces."""
        return 1 if self.entry.snapshot_by_snapshot else self.update_snapshots

    @property
    def covariance_lookahead(self) -> int:
        """Snapshots of the sample covariance after the sample time."""
        return self.covariance_snapshots // 2 if self.covariance_alignment == "centred" else 0


def check_configuration(configuration: SubspaceConfiguration) -> None:
    """Refuse parameters that do not fit together.

    Raises
    ------
    ConfigurationError
        With a sentence that names the parameters.
    """
    if configuration.n_subspaces % 2 == 0:
        raise ConfigurationError(
            f"n_subspaces is {configuration.n_subspaces}; it must be odd, so that the window "
            "is centred on the sample time."
        )
    if configuration.source_count == 0 and configuration.covariance_snapshots == 0:
        raise ConfigurationError(
            "source_count = 0 finds the number of sources from the sample covariance; set "
            "covariance_snapshots above zero, or give source_count."
        )
