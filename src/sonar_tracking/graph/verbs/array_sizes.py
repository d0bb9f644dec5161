"""What the number of elements of each array of a scenario decides (no ROS import)."""

from __future__ import annotations

from sonar_tracking.configuration import describe, from_mapping
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_settings import NodeSettings
from sonar_tracking.graph.catalogue.passive_nodes import SUBSPACE_ESTIMATOR
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.simulation.scenarios.scenario import Scenario


def check_source_counts(scenario: Scenario, settings: NodeSettings, where: str) -> None:
    """Refuse estimators that look for more sources than their array can tell apart.

    Parameters
    ----------
    scenario : Scenario
        With the arrays.
    settings : mapping
        Of every node.
    where : str
        Where they come from, named in errors.

    Raises
    ------
    ConfigurationError
        Naming the estimator and what to do.
    """
    for namespace, place in scenario.places.items():
        name = SUBSPACE_ESTIMATOR.at_station(namespace).name
        if name not in settings:
            continue
        n_elements = len(place.array.element_positions())
        source_count = settings[name]["source_count"]
        if isinstance(source_count, int) and source_count >= n_elements:
            raise ConfigurationError(
                f"{where}: nodes: {name}.source_count is {source_count}, but the "
                f"array has only {n_elements} elements; give at most {n_elements - 1} sources."
            )


def largest_message_bytes(scenario: Scenario, settings: NodeSettings) -> int:
    """Return the size of the largest message: a block of an array, or its subspaces.

    What other sensors deliver is small.
    """
    sizes = [scenario.block_bytes]
    for namespace, place in scenario.places.items():
        name = SUBSPACE_ESTIMATOR.at_station(namespace).name
        if name in settings:
            sizes.append(_subspace_bytes(place, settings, name))
    return max(sizes)


def _subspace_bytes(place: Scenario, settings: NodeSettings, name: str) -> int:
    n_elements = len(place.array.element_positions())
    names = [description.name for description in describe(SubspaceConfiguration)]
    known = {each: settings[name][each] for each in names}
    estimator = from_mapping(SubspaceConfiguration, known, name)
    columns = estimator.source_count or len(place.targets) + 1
    return (n_elements**2 + estimator.n_subspaces * n_elements * columns) * 2 * 8
