"""Node ``hpda_tracker``: contacts in, the complete picture of position tracks out."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from sonar_tracking.active.contact_tracker import (
    CommandedTracker,
    ContactTracker,
    make_contact_tracker,
)
from sonar_tracking.active.contacts.contact_defaults import (
    ContactDefaultsConfiguration,
    with_defaults,
)
from sonar_tracking.active.contacts.contact_method_registry import CONTACT_METHODS
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.contacts.sensor_location import (
    MountingConfiguration,
    located,
    needs_own_ship,
    with_pose_judged,
)
from sonar_tracking.active.lasting_error import ClaimedError, claimed_error
from sonar_tracking.active.unresolved_tracks import unresolved_tracks
from sonar_tracking.errors import InputError, Notice
from sonar_tracking.graph.catalogue.active_nodes import HPDA_TRACKER
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_THRESHOLD,
    ACTIVE_TRACKS,
    CONTACTS,
    ODOMETRY,
)
from sonar_tracking.graph.message_writing.contact_writing import thresholds_to_message
from sonar_tracking.graph.message_writing.position_writing import position_tracks_to_message
from sonar_tracking.graph.node_base.data_flow import Received
from sonar_tracking.graph.node_base.event_time_join import JoinedItem
from sonar_tracking.graph.node_base.node_process import run_node
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.contact_reading import contacts_from_message
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.own_ship_interpolation import interpolate_own_ship, motion_in_map
from sonar_tracking.records.commands import CommandKind, OperatorCommand
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate
from sonar_tracking.records.positions import PositionTracks

UNRESOLVED = "unresolved tracks"


class HpdaTracker(SonarNode):
    """Shell around a :class:`sonar_tracking.active.contact_tracker.ContactTracker`.

    Every ping, usable or not, gives exactly one picture and one list of thresholds: over a ping
    that cannot be used the tracks are predicted. Odometry is waited for only where a ping does not
    tell where its sensor is, or as a new message does, and somebody publishes odometry.
    """

    def __init__(self) -> None:
        super().__init__(HPDA_TRACKER)
        self._configuration = self.configuration(
            ContactTrackerConfiguration, check=make_contact_tracker, take=self._reconfigure
        )
        self._defaults = self.configuration(ContactDefaultsConfiguration)
        self._mounting = self.configuration(MountingConfiguration)
        self._tracker = make_contact_tracker(self._configuration)
        self._tracks = self.data_publisher(ACTIVE_TRACKS)
        self._thresholds = self.data_publisher(ACTIVE_THRESHOLD)
        own_ship = OwnShipReader(partial(self.report_state, ODOMETRY))
        self.data_subscriptions(
            {CONTACTS: contacts_from_message},
            series={ODOMETRY: (own_ship, interpolate_own_ship)},
            needs_series=self._needs_own_ship,
        )
        self._picture: PositionTracks | None = None
        self._claimed: ClaimedError | None = None
        self.diagnostics.add(UNRESOLVED, self._unresolved)

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> Iterable[Notice]:
        """Feed one ping and publish tracks and thresholds."""
        own_ship = item.series[ODOMETRY.name]
        motion = None if own_ship is None else motion_in_map(own_ship)
        contacts, notice = with_pose_judged(
            records[CONTACTS.name], motion, self._mounting, self.expects(ODOMETRY)
        )
        self.report_state(CONTACTS, notice)
        contacts = located(contacts, motion, self._mounting)
        contacts = with_defaults(contacts, self._defaults)
        self._claimed = claimed_error(contacts) or self._claimed
        update = self._tracker.update(contacts)
        self._publish(update)
        return update.notices

    def substitute(self, rejected: Received) -> None:
        """Publish the tracks predicted to a ping that could not be used."""
        if rejected.source.topic is CONTACTS:
            self._publish(self._tracker.coast(rejected.stamp, rejected.next_stamp))

    def carry_out(self, command: OperatorCommand) -> Iterable[Notice]:
        """Start, end or merge tracks."""
        tracker = self._tracker
        if not isinstance(tracker, CommandedTracker):
            able = ", ".join(CONTACT_METHODS.names_with("estimates_existence"))
            method = self._configuration.method
            raise InputError(f"method {method} takes no commands; these do: {able}.")
        if command.kind is CommandKind.START_TRACK:
            tracker.start_track(command.position)
        elif command.kind is CommandKind.END_TRACK:
            tracker.end_track(command.id)
        else:
            tracker.merge_tracks(command.id, command.other_id)
        return ()

    def warm_up(self) -> None:
        """Let the tracker load what the first ping needs."""
        self._tracker.warm_up()

    def reset(self) -> None:
        """Forget all tracks; identifiers go on."""
        self._picture = None
        first_id = self._tracker.next_id
        self._tracker = make_contact_tracker(replace(self._configuration, first_id=first_id))

    def state(self) -> ContactTracker:
        """Return the tracker."""
        return self._tracker

    def take_state(self, state: ContactTracker) -> None:
        """Go on with the tracks of the process before."""
        self._tracker = state
        self._tracker.configuration = self._configuration
        self._tracker.continue_from(self._configuration.first_id)

    def _reconfigure(self, configuration: ContactTrackerConfiguration) -> None:
        self._configuration = self._tracker.configuration = configuration

    def _needs_own_ship(self, contacts: Contacts) -> bool:
        return needs_own_ship(contacts) or (contacts.unset_pose and self.expects(ODOMETRY))

    def _unresolved(self) -> dict[str, object]:
        if self._picture is None or self._claimed is None:
            return {}
        beside = unresolved_tracks(self._picture, self._claimed)
        return {f"track {one}": f"beside {', '.join(map(str, two))}" for one, two in beside.items()}

    def _publish(self, update: ContactTrackerUpdate) -> None:
        self._picture = update.tracks
        self._thresholds.publish(thresholds_to_message(update.thresholds))
        self._tracks.publish(position_tracks_to_message(update.tracks))


def main() -> int:
    """Run the node."""
    return run_node(HpdaTracker)


if __name__ == "__main__":
    sys.exit(main())
