"""Where the page is: a free port, its address, and the token that commands need."""

from __future__ import annotations

import ipaddress
import os
import secrets
import socket

from sonar_tracking.errors import ConfigurationError

TOKEN_VARIABLE = "SONAR_TRACKING_PAGE_TOKEN"
"""Environment variable with the token of the page; unset = a new one."""

PORTS_TRIED = 50
"""Next ports tried where the one asked for is taken."""


def page_token() -> str:
    """Return the token of this page: the one of the environment, or a new one."""
    return os.environ.get(TOKEN_VARIABLE) or secrets.token_urlsafe(16)


def page_address(address: str, port: int, token: str = "") -> str:
    """Return what to type into a browser on this machine.

    The token stands behind ``#``, which browsers keep to themselves.
    """
    unspecified = address in ("", "0.0.0.0", "::")
    host = "localhost" if unspecified or is_loopback(address) else address
    host = f"[{host}]" if ":" in host else host
    return f"http://{host}:{port}/" + (f"#token={token}" if token else "")


def is_loopback(address: str) -> bool:
    """Return whether an address is one of this machine to itself."""
    if address == "localhost":
        return True
    try:
        return ipaddress.ip_address(address.partition("%")[0]).is_loopback
    except ValueError:
        return False


def listening_socket(address: str, port: int) -> socket.socket:
    """Return a socket that listens at a port, or at the next free one.

    Parameters
    ----------
    address : str
        E.g. ``"127.0.0.1"``.
    port : int
        0 = any.

    Raises
    ------
    ConfigurationError
        If the address is none of this machine, or no port is free.
    """
    last = min(port + PORTS_TRIED, 65535) if port else 0
    reason = ""
    for candidate in range(port, last + 1):
        try:
            return _listening(address, candidate)
        except OSError as error:
            reason = error.strerror or str(error)
            if isinstance(error, socket.gaierror):
                break
    raise ConfigurationError(
        f"the page cannot listen at {address}, port {port} to {last} ({reason}); give another "
        "--page-port or --page-address."
    )


def free_port(address: str, port: int) -> int:
    """Return the port at which :func:`listening_socket` would listen now."""
    with listening_socket(address, port) as found:
        number: int = found.getsockname()[1]
        return number


def _listening(address: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in address else socket.AF_INET
    found = socket.socket(family, socket.SOCK_STREAM)
    try:
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        found.bind((address, port))
        found.listen(128)
        found.setblocking(False)
    except OSError:
        found.close()
        raise
    return found
