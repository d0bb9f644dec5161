"""The targets of the fused picture: which there are, and of which tracks of other lists."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sonar_tracking.alignment.aligned_targets import STRENGTHS
from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.errors import InputError
from sonar_tracking.fusion.bearing_links import HIGHEST_EVIDENCE, BearingLinks
from sonar_tracking.fusion.bearing_trials import Trial
from sonar_tracking.fusion.copied_lists import LONGEST_SILENCE, CopiedLists
from sonar_tracking.fusion.echo_association import met_targets
from sonar_tracking.fusion.echo_targets import EchoTargets
from sonar_tracking.fusion.exchanges import ECHOES
from sonar_tracking.fusion.fused_rows import ShownRows
from sonar_tracking.fusion.fused_target import Contributor, FusedTarget
from sonar_tracking.fusion.fusion_records import ListKey
from sonar_tracking.fusion.target_filters import TargetFilters
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.records.time import NANOSECONDS, UNKNOWN_STAMP, nanoseconds

PAUSE = 60.0
"""After which a trial that failed is begun again, s: bearing tracks may change their targets. One
that has been found not to be of its target has no row of its own for as long."""

HIDDEN = 30.0
"""After it may have been another target one has to be confirmed for so long, s."""

SAME_PLACE = 9.21
"""Square of the normalised distance that 99 % of two estimates of one position are within."""

PRIOR_AGAINST_EXCHANGE = 3.0
"""Log of the odds that two targets which meet do not exchange their tracks."""


class FusedTargets:
    """All targets, and what is known of the tracks that they are made of.

    Parameters
    ----------
    configuration : TrackFusionConfiguration
        Its parameters.
    """

    def __init__(self, configuration: TrackFusionConfiguration) -> None:
        self.configuration = configuration
        self._next_id = configuration.first_of_all
        self.reset()

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""
        again = replace(self.configuration, first_id=first_id)
        self._next_id = max(self._next_id, again.first_of_all)

    def reset(self) -> None:
        """Forget all targets; identifiers go on."""
        settings = self.configuration
        self._stamp = UNKNOWN_STAMP
        self._filters = TargetFilters(
            STRENGTHS, settings.alignment_variance, settings.propagation_speed
        )
        self._links = BearingLinks()
        self._target_of = EchoTargets()
        self._spoken_for: set[BearingKey] = set()
        self._alive: dict[str, dict[BearingKey, Contributor]] = {}
        self._copies = CopiedLists(self._new_id)
        self._paused: dict[tuple[FusedTarget, BearingKey], int] = {}
        self._parted: dict[BearingKey, int] = {}
        self._not_fixed: set[ListKey] = set()
        self._dismissed: set[ListKey | BearingKey] = set()
        self._own_rows_shown = ShownRows()

    def end_track(self, number: int) -> None:
        """End a row since an operator says so: the tracks it is made of make no other.

        Parameters
        ----------
        number : int
            Its identifier.

        Raises
        ------
        InputError
            If own sensors have no such row.
        """
        target, copied = self._row_of(number)
        if target is None:
            self._dismissed.update(copied)
            return
        self._dismissed |= {*target.echoes, *target.heard}
        self._remove(target)

    def merge_tracks(self, number: int, other: int) -> None:
        """Let two rows be one target, since an operator says so: the first goes on.

        Of two filters the more certain one goes on, with the tracks of both. What was shown only,
        as another list tells it, gives its bearing tracks to the filter, and is shown no more.

        Parameters
        ----------
        number, other : int
            Identifiers.

        Raises
        ------
        InputError
            If own sensors have no such row.
        """
        (first, shown), (second, also_shown) = self._row_of(number), self._row_of(other)
        if first is not None and second is not None:
            self._join(first, second).id = number
        elif first is not None:
            self._give(first, also_shown)
        elif second is not None:
            self._give(second, shown)
            second.id = number
        else:
            self._dismissed.update(also_shown)

    def _row_of(self, number: int) -> tuple[FusedTarget | None, tuple[ListKey, ...]]:
        """Return the target of a row, or else the keys of the row that is copied."""
        for target in self._filters.targets:
            if target.id == number:
                return target, ()
        copied = self._copies.keys_named(number)
        if number == 0 or not copied or not self._own_rows_shown.has(number):
            shown = ", ".join(map(str, self._own_rows_shown.identifiers())) or "none"
            raise InputError(f"own sensors have no track {number}; there are {shown}.")
        return None, copied

    def _join(self, first: FusedTarget, second: FusedTarget) -> FusedTarget:
        """Let the more certain of two targets have the tracks of both, and return it."""
        spread = [
            float(np.trace(self._filters.state_of(one).covariance[:2, :2]))
            for one in (first, second)
        ]
        kept, gone = (second, first) if spread[1] < spread[0] else (first, second)
        echoes, heard = dict(gone.echoes), tuple(gone.heard)
        kept.initiated = min(first.initiated, second.initiated)
        self._remove(gone)
        for key, contributor in echoes.items():
            kept.echoes[key] = contributor
            self._target_of[key] = kept
        self._hear(kept, heard)
        return kept

    def _give(self, target: FusedTarget, copied: tuple[ListKey, ...]) -> None:
        """Let a target have the bearing tracks of a row that is copied, and the row be hidden."""
        heard = self._copies.heard_of(copied)
        self._hear(target, heard)
        if not any(self._links.target_of(key) is target for key in heard):
            self._dismissed.update(copied)

    def _remove(self, target: FusedTarget) -> None:
        for key in list(target.echoes):
            self._target_of.pop(key, None)
        for heard in list(target.heard):
            self._unlink(heard)
        self._filters.end([target])
        self._forget(target)

    def _hear(self, target: FusedTarget, keys: tuple[BearingKey, ...]) -> None:
        """Let bearing tracks that go on be of a target."""
        for key in keys:
            contributor = self._alive.get(key[0], {}).get(key)
            if contributor is not None and self._links.target_of(key) is None:
                target.heard[key] = contributor
                self._links.add(key, target, HIGHEST_EVIDENCE)

    def _decide(self) -> None:
        odds = self.configuration.association_odds
        trials = self._filters.trials
        for trial in trials.give_up(odds):
            self._paused[trial.target, trial.key] = self._stamp + nanoseconds(PAUSE)
        while rows := trials.winners(odds, len(self._filters.targets)):
            best = max(rows, key=lambda row: trials.trials[row].evidence)
            self._accept(self._filters.accept(best))
        self._exchange(odds)
        for key in self._links.broken(odds):
            target = self._links.target_of(key)
            self._unlink(key)
            self._parted[key] = self._stamp + nanoseconds(PAUSE)
            if target is not None and target.echoes:
                self._filters.forget_bearings(target)

    def _accept(self, trial: Trial) -> None:
        """Let a bearing track be of a target: what was shown for it becomes the same target."""
        target, key = trial.target, trial.key
        before = self._links.target_of(key)
        if before is not None:
            self._unlink(key)
            if not before.contributors:
                self._rename(target, before.id)
                self._filters.end([before])
                self._forget(before)
        for name in self._copies.confirmed_names(key, self._filters.state_of(target)):
            self._rename(target, name)
        target.heard[key] = self._alive[key[0]][key]
        self._links.add(key, target, trial.evidence)

    def _exchange(self, odds: float) -> None:
        """Let targets have each other's tracks of a source, if they have exchanged them."""
        exchanges = self._filters.exchanges
        exchanges.give_up(odds)
        exchanged: list[tuple[FusedTarget, FusedTarget]] = []
        while found := exchanges.best(math.log(odds) + PRIOR_AGAINST_EXCHANGE):
            exchange, copies = found
            self._filters.exchanged(exchange, copies)
            if exchange.source is ECHOES:
                self._target_of.exchange(exchange.pair)
                exchanged.append(exchange.pair)
            else:
                self._links.exchange(exchange.source, exchange.pair, exchange.evidence)
        for pair in exchanged:
            self._exchange_rivals(pair)

    def _exchange_rivals(self, pair: tuple[FusedTarget, FusedTarget]) -> None:
        """Let targets that may be one of a pair, its echoes being lost, be what lost them now.

        What is where that one is expected is the same target.
        """
        one, other = pair
        for target in [each for each in self._filters.targets if each.rival in pair]:
            lost = other if target.rival is one else one
            target.rival = lost
            if lost.echoes:
                continue
            own = self._filters.state_of(target)
            (met,) = met_targets(
                own.mean[None], own.covariance[None], [lost], self._filters, self.configuration
            )
            if met.target is lost and met.sure:
                number = lost.id
                self._join(lost, target).id = number

    def _rename(self, target: FusedTarget, number: int) -> None:
        """Let a target have the name of that of two which has been confirmed for longer."""
        since = self._own_rows_shown.confirmed_since
        if since(number) < since(target.id):
            target.id = number

    def _unlink(self, key: BearingKey) -> None:
        target = self._links.target_of(key)
        self._links.remove(key)
        if target is not None:
            target.heard.pop(key, None)

    def _end_orphans(self) -> None:
        """End targets without tracks some time after the last one, and forget old names."""
        now = self._stamp / NANOSECONDS
        over = []
        for target in self._filters.targets:
            target.settle_doubt(self._filters.targets, now)
            if target.contributors:
                target.orphaned = np.nan
            elif np.isnan(target.orphaned):
                target.orphaned = now
            longest, silence = self.configuration.coast_duration, now - target.updated
            target.silent = silence > longest
            if now - target.orphaned >= longest or silence > LONGEST_SILENCE:
                over.append(target)
        for target in over:
            self._remove(target)
        self._hide_what_may_be_another(now)

    def _hide_what_may_be_another(self, now: float) -> None:
        """Let a target that nobody hears, and no echo confirms, be tentative where one is heard.

        Where two targets meet, a tracker of echoes may begin a track of both, which nothing holds.
        """
        targets = self._filters.targets
        unsure = [one for one in targets if not one.heard and not one.is_confirmed]
        heard = [place for place, one in enumerate(targets) if one.heard and one.echoes]
        if unsure and heard:
            seen = self._filters.picture()
            mean, spread = seen.mean[:, :2], seen.covariance[:, :2, :2]
            for target in unsure:
                own = targets.index(target)
                apart = mean[heard] - mean[own]
                solved = np.linalg.solve(spread[heard] + spread[own], apart[..., None])[..., 0]
                if np.any(np.sum(apart * solved, axis=-1) < SAME_PLACE):
                    target.hidden_until = now + HIDDEN
        for target in targets:
            target.hidden = now < target.hidden_until and not target.heard

    def _forget(self, target: FusedTarget) -> None:
        for place in [place for place in self._paused if place[0] is target]:
            del self._paused[place]

    def _new_id(self) -> int:
        self._next_id += 1
        return self._next_id - 1

    def _stands_for(self, key: ListKey, heard: tuple[BearingKey, ...]) -> bool:
        """Return whether a target with echoes stands for a row of another list, or nothing may."""
        if (
            key in self._not_fixed
            or key in self._dismissed
            or any(one in self._dismissed for one in heard)
        ):
            return True
        return key in self._target_of or any(
            self._links.target_of(one) is not None
            or one in self._spoken_for
            or self._stamp < self._parted.get(one, UNKNOWN_STAMP)
            for one in heard
        )
