"""A discovery server that is not there is named before anything starts."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.discovery_server import (
    check_discovery_server,
    server_problem,
    silence_in_words,
)


@pytest.fixture
def listening() -> Iterator[int]:
    """Yield the port of somebody who listens and says nothing, as a server does."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as server:
        server.bind(("127.0.0.1", 0))
        yield server.getsockname()[1]


@pytest.fixture
def closed() -> int:
    """Return a port nobody listens at."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port


def check(value: str) -> None:
    check_discovery_server({"ROS_DISCOVERY_SERVER": value})


def test_without_a_server_there_is_nothing_to_check() -> None:
    check_discovery_server({})
    check("")


def test_a_server_that_listens_is_believed(listening: int) -> None:
    check(f"127.0.0.1:{listening}")


def test_a_closed_port_is_named_with_the_remedy(closed: int) -> None:
    with pytest.raises(ConfigurationError, match=f"127.0.0.1:{closed}: .*refused.*unset"):
        check(f"127.0.0.1:{closed}")
    assert server_problem(f"TCPv4:[127.0.0.1]:{closed}")


def test_one_of_several_is_enough(closed: int, listening: int) -> None:
    check(f"127.0.0.1:{closed};;UDPv4:[127.0.0.1]:{listening}")


@pytest.mark.parametrize("text", ["127.0.0.1:99999", "a:b:c", "127.0.0.1:0", "[::1"])
def test_what_is_no_address_is_refused(text: str) -> None:
    with pytest.raises(ConfigurationError, match="HOST:PORT"):
        check(text)


def test_a_name_that_does_not_exist_is_refused() -> None:
    with pytest.raises(ConfigurationError, match="no such host"):
        check("nowhere.invalid:11811")


def test_a_server_that_nobody_hears_of_is_named() -> None:
    """As behind a firewall that drops what it does not know."""
    assert silence_in_words({}) == ""
    said = silence_in_words({"ROS_DISCOVERY_SERVER": "10.0.0.5:11811"})
    assert "10.0.0.5:11811" in said and "firewall" in said
