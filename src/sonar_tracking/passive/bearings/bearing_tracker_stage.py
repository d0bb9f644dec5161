"""Signal subspaces -> bearing tracks, without data association.

Either each target has its own Kalman filter, with a measurement that starts from its own predicted
steering vector (Ryu, Park, Choi 2003, eq. 6; Hwang et al. 2005, eqs. 18-21), so that every target
knows which measurement is its own; or one filter holds all targets and takes the likelihood of all
their angles at once (:mod:`sonar_tracking.passive.bearings.bearing_method_registry`). The filters
run unbounded in angle; what is reported is folded into the half circle a line array can tell apart,
which changes nothing but the names of angles: a line array cannot distinguish theta from
pi - theta.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
    check_configuration,
    subspace_methods_of_covariance,
)
from sonar_tracking.passive.bearings.estimate_checks import check_runs
from sonar_tracking.passive.bearings.operator_steps import with_ended, with_merged, with_started
from sonar_tracking.passive.bearings.tracker_state import TrackerState, TrackerUpdate
from sonar_tracking.passive.bearings.tracking_steps import TrackingSteps
from sonar_tracking.passive.bearings.tracking_together import follow_together, weak_sources
from sonar_tracking.passive.subspaces.rehearsal import rehearsed_estimates
from sonar_tracking.passive.subspaces.subspace_method_registry import SUBSPACE_METHODS
from sonar_tracking.records.bearings import SubspaceEstimates
from sonar_tracking.records.time import seconds

__all__ = [
    "BearingTrackerConfiguration",
    "BearingTrackerStage",
    "TrackerUpdate",
    "update_together",
]


class BearingTrackerStage:
    """Tracks the bearings of several targets.

    Parameters
    ----------
    configuration : BearingTrackerConfiguration
        Parameters.

    Raises
    ------
    ConfigurationError
        If the parameters do not fit together.
    """

    def __init__(self, configuration: BearingTrackerConfiguration) -> None:
        check_configuration(configuration)
        self.configuration = configuration
        self._steps = TrackingSteps(configuration, configuration.entry.make(configuration))
        self._next_id = configuration.first_id
        self._state: TrackerState | None = None
        self._last: SubspaceEstimates | None = None

    def warm_up(self) -> None:
        """Let a stage like this one track in made-up data: its first use of much is slow."""
        angles = np.deg2rad(self.configuration.initial_bearings_deg or (-20.0, 10.0))
        twin = BearingTrackerStage(self.configuration)
        with suppress(InputError):
            for second in range(3):
                twin.update(rehearsed_estimates(angles, "covariance", second))

    def reset(self) -> None:
        """Forget all tracks; identifiers go on."""
        self._state = self._last = None

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""
        self._next_id = max(self._next_id, first_id)
        if self._state is not None:
            start = replace(self._state.start, next_id=self._next_id)
            self._state = replace(self._state, start=start)

    def update(self, estimates: SubspaceEstimates) -> TrackerUpdate:
        """Take the subspaces of one sample time.

        With ``start = given`` the first estimate only tells the instant of the given bearings;
        measurements are taken from the next one on.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Later than the one before.

        Returns
        -------
        TrackerUpdate
            All tracks at the stamp of the estimate.

        Raises
        ------
        InputError
            If the estimate cannot be used; the stage is then as before.
        """
        return update_together([self], [estimates])[0]

    def start_track(self, arrival_angle: float) -> None:
        """Start a track at an angle, rad, since an operator says so.

        Raises
        ------
        InputError
            If that cannot be; see :mod:`sonar_tracking.passive.bearings.operator_steps`.
        """
        self._change(with_started(self._steps, *self._known(), arrival_angle))

    def end_track(self, number: int) -> None:
        """End a track, by its identifier; it is reported once more, as terminated.

        Raises
        ------
        InputError
            If there is no such track.
        """
        self._change(with_ended(self._steps, self._known()[0], number))

    def merge_tracks(self, number: int, other: int) -> None:
        """Let two tracks, by their identifiers, be one that has the first.

        Raises
        ------
        InputError
            If there is no such track.
        """
        self._change(with_merged(self._steps, self._known()[0], number, other))

    def _known(self) -> tuple[TrackerState, SubspaceEstimates]:
        if self._state is None or self._last is None:
            raise InputError("no data have come yet; repeat it when there are some.")
        return self._state, self._last

    def _change(self, state: TrackerState) -> None:
        self._state = state
        self._next_id = max(self._next_id, state.start.next_id)

    def _check_method(self, estimates: SubspaceEstimates) -> None:
        configuration = self.configuration
        suitable = SUBSPACE_METHODS.names_with("of_covariance")
        if self._steps.needs_covariance and estimates.method not in suitable:
            names = subspace_methods_of_covariance()
            raise InputError(
                f"method {configuration.method} needs estimates of method {names}, but these are "
                f"of method {estimates.method}; set method = {names} in the subspace estimator."
            )

    def _before(self, estimates: SubspaceEstimates) -> tuple[TrackerState, float | None]:
        """Return the state before an estimate and how long before, s; None = it is the first."""
        self._check_method(estimates)
        state = self._state
        if state is None:
            return self._steps.begin(estimates, self._next_id), None
        interval = seconds(estimates.stamp - state.stamp)
        if interval <= 0.0:
            raise InputError(
                f"The estimate is {-interval:g} s earlier than the one before or repeats it; "
                "estimates must follow each other in time."
            )
        return state, interval


def update_together(
    trackers: Sequence[BearingTrackerStage], estimates: Sequence[SubspaceEstimates]
) -> list[TrackerUpdate]:
    """Take an estimate of each of several independent runs, as each tracker would by itself.

    Parameters
    ----------
    trackers : sequence of BearingTrackerStage
        One a run, all of the same configuration.
    estimates : sequence of SubspaceEstimates
        One a run.

    Returns
    -------
    list of TrackerUpdate
        One a run.

    Raises
    ------
    InputError
        If an estimate cannot be used; all trackers are then as before.
    """
    steps = trackers[0]._steps
    check_runs(estimates)
    before = [tracker._before(own) for tracker, own in zip(trackers, estimates, strict=True)]
    try:
        followed = follow_together(steps, estimates, before)
        weak = [0] * len(trackers)
        if steps.automatic:
            weak = weak_sources(estimates, [state.start for state, _ in before])
        after = [
            steps.finish(own, state, tracks, n_weak)
            for own, (state, _), tracks, n_weak in zip(
                estimates, before, followed, weak, strict=True
            )
        ]
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"No bearings can be computed from the subspaces and covariance ({error})."
        ) from error
    for tracker, own, (state, _) in zip(trackers, estimates, after, strict=True):
        tracker._last = own
        tracker._change(state)
    return [update for _, update in after]
