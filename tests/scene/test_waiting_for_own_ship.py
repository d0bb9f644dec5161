"""Protects the wait for odometry: nothing is shown before its time, twice, or out of order."""

from __future__ import annotations

from sonar_tracking.scene.waiting_for_own_ship import MOST_WAITING, WaitingForOwnShip


def test_items_are_released_once_in_the_order_in_which_they_came() -> None:
    waiting: WaitingForOwnShip[str] = WaitingForOwnShip()
    for stamp, item in ((3, "c"), (1, "a"), (2, "b"), (5, "e")):
        waiting.keep(stamp, item)
    assert not waiting.released(0)
    assert waiting.released(3) == ["c", "a", "b"]
    assert not waiting.released(4)
    assert waiting.released(9) == ["e"]
    assert not waiting.released(9)


def test_the_oldest_are_given_up_where_odometry_stays_away() -> None:
    waiting: WaitingForOwnShip[int] = WaitingForOwnShip()
    for stamp in range(MOST_WAITING + 5):
        waiting.keep(stamp, stamp)
    assert waiting.released(MOST_WAITING + 5) == list(range(5, MOST_WAITING + 5))


def test_a_new_beginning_forgets_what_waits() -> None:
    waiting: WaitingForOwnShip[int] = WaitingForOwnShip()
    waiting.keep(1, 1)
    waiting.clear()
    assert not waiting.released(2)
