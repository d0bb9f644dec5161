"""Names of the topics of a bag, as the graph calls them.

As ``ros2 bag play --remap`` does it: what is recorded as ``/a/contacts`` is taken for, say,
``/active/contacts``. A namespace stands for one such rule for each topic below it.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from sonar_tracking.errors import ConfigurationError

_NAME = re.compile(r"/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")
_LONGEST_NAME = 247
"""Characters of a full name that the middleware can carry."""


@dataclass(frozen=True)
class TopicNames:
    """Rules for the names of topics.

    Attributes
    ----------
    remaps : mapping of str to str
        Recorded name to the name in the graph, both in full.
    namespace : str
        Topics below it are called as if they were in the root; ``"/"`` = nothing is.
    """

    remaps: Mapping[str, str] = field(default_factory=dict)
    namespace: str = "/"

    def of(self, recorded: str) -> str:
        """Return the name in the graph of a recorded topic; a rule of its own counts most."""
        if recorded in self.remaps:
            return self.remaps[recorded]
        inside = self.namespace != "/" and recorded.startswith(f"{self.namespace}/")
        return recorded.removeprefix(self.namespace) if inside else recorded

    def all_of(
        self, recorded: Collection[str], where: str, noted: Mapping[str, str] | None = None
    ) -> dict[str, str]:
        """Return the name in the graph of every recorded topic.

        Parameters
        ----------
        recorded : collection of str
            Full names.
        where : str
            Where they are from, named in errors.
        noted : mapping of str to str, optional
            Recorded name to the name in the graph, as the recorder has noted it; it counts more
            than the namespace, and less than a rule for the topic.

        Raises
        ------
        ConfigurationError
            If a rule fits no topic, or two topics would have one name.
        """
        there = f"its topics are {', '.join(sorted(recorded))}."
        for name in self.remaps:
            if name not in recorded:
                raise ConfigurationError(f"--remap: {where} holds no topic {name}; {there}")
        below = f"{self.namespace}/"
        if self.namespace != "/" and not any(name.startswith(below) for name in recorded):
            raise ConfigurationError(
                f"--namespace: {where} holds no topic below {self.namespace}; {there}"
            )
        known = {**(noted or {}), **self.remaps}
        names = {name: known.get(name) or self.of(name) for name in recorded}
        first: dict[str, str] = {}
        for name, new in names.items():
            if first.setdefault(new, name) != name:
                raise ConfigurationError(
                    f"{where}: {first[new]} and {name} would both be called {new}; "
                    "give one of them another name with --remap."
                )
        return names


RECORDED_NAMES = TopicNames()
"""No rules: a topic is called as it was recorded, or as its recorder has noted."""


def topic_names(remaps: Sequence[str], namespace: str) -> TopicNames:
    """Return the rules a person has typed.

    Parameters
    ----------
    remaps : sequence of str
        Each ``OLD:=NEW``.
    namespace : str
        With or without slashes around it; empty = none.

    Raises
    ------
    ConfigurationError
        If a rule has another form, or a topic has two rules.
    """
    rules: dict[str, str] = {}
    advice = "give the recorded name and the one in the graph, e.g. /a/contacts:=/active/contacts"
    for old, new in typed_rules(remaps, advice):
        if _full(old) in rules:
            raise ConfigurationError(f"--remap: {_full(old)} is given twice; give one name.")
        rules[_full(old)] = _full(new)
    return TopicNames(rules, _full(typed_namespace(namespace)))


def typed_rules(remaps: Sequence[str], advice: str) -> list[tuple[str, str]]:
    """Return the two sides of every rule ``OLD:=NEW``.

    Parameters
    ----------
    remaps : sequence of str
        As typed.
    advice : str
        What to write, told where a rule is none.

    Raises
    ------
    ConfigurationError
        If a rule has another form, or its new name is none.
    """
    rules = []
    for text in remaps:
        old, _, new = (part.strip() for part in text.partition(":="))
        if not (old.strip("/") and new.strip("/")):
            raise ConfigurationError(f"--remap is {text!r}; {advice}.")
        _check_name(new.rstrip("/"), f"--remap {text}")
        rules.append((old, new.rstrip("/")))
    return rules


def typed_namespace(text: str) -> str:
    """Return a namespace without slashes around it, empty = none.

    Raises
    ------
    ConfigurationError
        If it is no name.
    """
    namespace = text.strip().strip("/")
    if namespace:
        _check_name(namespace, "--namespace")
    return namespace


def _check_name(name: str, where: str) -> None:
    """Refuse what ROS cannot use for a name."""
    if not _NAME.fullmatch(name):
        raise ConfigurationError(
            f"{where}: {name!r} is no name in ROS; it is made of letters, digits and _ between "
            "slashes, and no part begins with a digit."
        )
    if len(name) > _LONGEST_NAME:
        raise ConfigurationError(
            f"{where}: the name has {len(name)} characters; give one of at most {_LONGEST_NAME}."
        )


def _full(name: str) -> str:
    return f"/{name.strip('/')}"
