"""Names of the topics of a bag, as the graph calls them.

As ``ros2 bag play --remap`` does it: what is recorded as ``/a/contacts`` is taken for, say,
``/active/contacts``. A namespace stands for one such rule for each topic below it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

from sonar_tracking.errors import ConfigurationError


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

    def all_of(self, recorded: Collection[str], where: str) -> dict[str, str]:
        """Return the name in the graph of every recorded topic.

        Parameters
        ----------
        recorded : collection of str
            Full names.
        where : str
            Where they are from, named in errors.

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
        names = {name: self.of(name) for name in recorded}
        first: dict[str, str] = {}
        for name, new in names.items():
            if first.setdefault(new, name) != name:
                raise ConfigurationError(
                    f"{where}: {first[new]} and {name} would both be called {new}; "
                    "give one of them another name with --remap."
                )
        return names


RECORDED_NAMES = TopicNames()
"""Every topic is called as it was recorded."""


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
    for text in remaps:
        old, _, new = (part.strip() for part in text.partition(":="))
        if not (old.strip("/") and new.strip("/")):
            raise ConfigurationError(
                f"--remap is {text!r}; give the recorded name and the one in the graph, "
                "e.g. /ship/contacts:=/active/contacts."
            )
        if _full(old) in rules:
            raise ConfigurationError(f"--remap: {_full(old)} is given twice; give one name.")
        rules[_full(old)] = _full(new)
    return TopicNames(rules, _full(namespace))


def _full(name: str) -> str:
    return f"/{name.strip('/')}"
