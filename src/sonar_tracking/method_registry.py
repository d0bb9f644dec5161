"""Registries of methods: what a stage can do its work with, each method listed once.

A stage that has a choice of methods lists them in one registry: the value a parameter takes, where
the method is made, one line on what it does, and what the stage has to know of it. The parameter's
allowed values and its text, the documentation's table of methods, the rows and legends of studies
follow from it. A method is given as an object reference, so that a registry imports none of them
and a node imports the one it runs.

A method of one's own is added in the same way without a change of this package::

    SUBSPACE_METHODS.add(
        SubspaceMethodEntry(
            "mine", "my_package.my_subspace:make", "what it does in one line", label="Mine"
        )
    )
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

from sonar_tracking.errors import ConfigurationError, unknown_name_text
from sonar_tracking.lazy_imports import load_object


@dataclass(frozen=True)
class MethodEntry:
    """What is known of one method; stages add to it what they have to know, see :func:`trait`.

    Attributes
    ----------
    name : str
        Value of the parameter.
    factory : str
        Object reference, ``"package.module:name"``, of a callable that takes the configuration of
        the stage and returns the method.
    description : str
        One line of what it does.
    label : str
        Its name in tables and legends.
    paper : str
        Authors and year; empty = none.
    """

    name: str
    factory: str
    description: str
    label: str
    paper: str = ""

    def make(self, configuration: Any) -> Any:
        """Import the method and return it with the parameters of its stage.

        Parameters
        ----------
        configuration : dataclass
            Of the stage.
        """
        factory: Callable[[Any], Any] = load_object(self.factory)
        return factory(configuration)

    @property
    def traits(self) -> tuple[str, ...]:
        """What the stage has to know of it, in words."""
        return tuple(
            field.metadata["text"]
            for field in dataclasses.fields(self)
            if "text" in field.metadata and getattr(self, field.name)
        )


def trait(text: str) -> Any:
    """Declare a field of a method entry that is true or false; false unless given.

    Parameters
    ----------
    text : str
        What it means where it is true, for the documentation.
    """
    return dataclasses.field(default=False, metadata={"text": text})


class MethodRow(NamedTuple):
    """One row of the documentation's table of methods; all texts."""

    name: str
    description: str
    traits: str
    paper: str


Entry = TypeVar("Entry", bound=MethodEntry)


class MethodRegistry(Generic[Entry]):
    """The methods of one stage by their names, in the order of the documentation.

    Parameters
    ----------
    parameter : str
        The parameter that chooses among them, e.g. ``"bearing_tracker.method"``.
    entries : MethodEntry
        The methods there are.

    Raises
    ------
    ConfigurationError
        If two have the same name.
    """

    def __init__(self, parameter: str, *entries: Entry) -> None:
        self.parameter = parameter
        self._entries: dict[str, Entry] = {}
        for entry in entries:
            self.add(entry)

    def add(self, entry: Entry) -> None:
        """Take one more method in.

        Raises
        ------
        ConfigurationError
            If there is one of that name already.
        """
        if entry.name in self._entries:
            raise ConfigurationError(
                f"{self.parameter} has a method {entry.name} already; choose another name."
            )
        self._entries[entry.name] = entry

    def __getitem__(self, name: str) -> Entry:
        """Return a method by its name.

        Raises
        ------
        ConfigurationError
            If there is none; the nearest name is suggested.
        """
        if name not in self._entries:
            raise ConfigurationError(
                unknown_name_text(f"{self.parameter} {name}", name, self._entries)
            )
        return self._entries[name]

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._entries.values())

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the methods."""
        return tuple(self._entries)

    def names_with(self, trait_name: str) -> tuple[str, ...]:
        """Return the names of the methods that have a trait, given by its field."""
        return tuple(entry.name for entry in self if getattr(entry, trait_name))

    @property
    def text(self) -> str:
        """Names and descriptions of the methods in one line, for the text of a parameter."""
        return "; ".join(f"{entry.name}: {entry.description}" for entry in self)

    def table(self) -> tuple[MethodRow, ...]:
        """Return the rows of the documentation's table of methods."""
        return tuple(
            MethodRow(entry.name, entry.description, "; ".join(entry.traits), entry.paper)
            for entry in self
        )
