"""What a page hears: the frames of the messages of a server."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any

from tornado.websocket import WebSocketClientConnection

PATIENCE = 60.0


def decoded(said: str | bytes) -> list[dict[str, Any]]:
    """Return the frames of one message; of a row of a picture, its header."""
    if isinstance(said, bytes):
        length = int.from_bytes(said[:4], "little")
        return [json.loads(said[4 : 4 + length])]
    found = json.loads(said)
    return found if isinstance(found, list) else [found]


async def frames_from(link: WebSocketClientConnection) -> AsyncIterator[dict[str, Any]]:
    """Yield the frames that come, as long as the connection lasts."""
    while True:
        said = await asyncio.wait_for(link.read_message(), PATIENCE)
        if said is None:
            return
        for frame in decoded(said):
            yield frame


async def greeting(link: WebSocketClientConnection) -> list[dict[str, Any]]:
    """Return the frames of a new connection, up to those that are live."""
    found = []
    async for frame in frames_from(link):
        found.append(frame)
        if frame["kind"] == "live":
            return found
    raise AssertionError(f"the server has closed the connection: {link.close_reason}")


async def heard(link: WebSocketClientConnection, kind: str) -> dict[str, Any]:
    """Return the next frame of a kind."""
    async for frame in frames_from(link):
        if frame["kind"] == kind:
            return frame
    raise AssertionError(f"the server has closed the connection: {link.close_reason}")


async def close(link: WebSocketClientConnection) -> None:
    """Close a connection, and wait until it is."""
    is_open = link.close_code is None
    link.close()
    while is_open and await asyncio.wait_for(link.read_message(), PATIENCE) is not None:
        pass
