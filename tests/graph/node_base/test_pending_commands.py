"""Commands take effect between the data that their stamps say, whenever they come."""

from __future__ import annotations

from sonar_tracking.graph.node_base.pending_commands import PendingCommands
from sonar_tracking.records.commands import CommandKind, OperatorCommand


def command(stamp: int, number: int = 1) -> OperatorCommand:
    return OperatorCommand(CommandKind.END_TRACK, "tracks", stamp, id=number)


def done(pending: PendingCommands, stamp: int) -> list[tuple[int, bool]]:
    return [(each.command.id, each.late) for each in pending.due(stamp)]


def test_a_command_waits_for_the_first_datum_at_or_after_it() -> None:
    pending = PendingCommands()
    pending.add(command(15))
    assert done(pending, 10) == []
    assert done(pending, 20) == [(1, False)]
    assert done(pending, 30) == []
    pending.add(command(40))
    assert done(pending, 40) == [(1, False)]


def test_their_order_is_that_of_the_stamps_and_then_that_of_arrival() -> None:
    pending = PendingCommands()
    for stamp, number in ((17, 1), (15, 2), (17, 3), (15, 4)):
        pending.add(command(stamp, number))
    assert [number for number, _ in done(pending, 20)] == [2, 4, 1, 3]


def test_one_that_came_behind_its_data_is_late_and_so_is_one_without_a_stamp() -> None:
    pending = PendingCommands()
    done(pending, 20)
    pending.add(command(15))
    pending.add(command(0, 2))
    pending.add(command(25, 3))
    assert done(pending, 30) == [(1, True), (3, False), (2, True)]


def test_a_process_in_the_place_of_another_repeats_only_what_came_after_its_state() -> None:
    pending = PendingCommands()
    for stamp, number in ((15, 1), (20, 2), (25, 3)):
        pending.add(command(stamp, number))
    pending.continue_from(20)
    assert done(pending, 30) == [(3, False)]


def test_data_that_begin_again_leave_behind_what_was_for_later() -> None:
    pending = PendingCommands()
    done(pending, 100)
    pending.add(command(105, 1))
    pending.add(command(15, 2))
    pending.begin_again()
    assert done(pending, 20) == [(2, False)]
    assert done(pending, 200) == []
