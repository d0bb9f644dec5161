"""Protects that every system of a figure is drawn, and that no two look alike."""

from __future__ import annotations

from sonar_tracking.evaluation.monte_carlo.plot_styles import LINES, PALETTE, Style, styles_of

OWN = {"ours": Style("#0072B2", "o"), "theirs": Style("#009E73", "s", ":")}


def test_systems_keep_their_own_styles_and_others_get_what_is_free() -> None:
    styles = styles_of(["new", "theirs", "newer", "ours"], OWN)
    assert list(styles) == ["ours", "theirs", "new", "newer"]
    assert styles["ours"] == OWN["ours"] and styles["theirs"] == OWN["theirs"]
    assert styles["new"].colour == "#D55E00" and styles["newer"].colour == "#CC79A7"
    assert styles["new"].marker and styles["new"].marker != styles["newer"].marker


def test_without_own_styles_the_palette_is_taken_in_order() -> None:
    styles = styles_of(f"system {number}" for number in range(len(PALETTE)))
    assert tuple(style.colour for style in styles.values()) == PALETTE
    assert all(style == Style(style.colour) for style in styles.values())


def test_however_many_systems_there_are_none_is_left_out_and_no_two_are_alike() -> None:
    names = [f"system {number}" for number in range(len(PALETTE) * len(LINES))]
    styles = styles_of(names)
    assert list(styles) == names
    assert len(set(styles.values())) == len(names)
    assert list(styles_of([*names, "one more"])) == [*names, "one more"]


def test_styles_of_systems_that_are_not_there_are_not_drawn() -> None:
    assert list(styles_of(["ours"], OWN)) == ["ours"]
