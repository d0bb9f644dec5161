"""The server of the live page: who may look, who may command, and what it makes of nonsense."""

from __future__ import annotations

import asyncio
import json
import logging
import socket
from collections.abc import Awaitable, Callable, Mapping
from contextlib import closing, suppress
from email.message import Message
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import pytest
from tornado.websocket import (
    WebSocketClientConnection,
    WebSocketClosedError,
    websocket_connect,
)

from sonar_tracking.display.page.page_address import (
    TOKEN_VARIABLE,
    free_port,
    is_loopback,
    listening_socket,
    page_address,
    page_token,
)
from sonar_tracking.display.page.page_client import BURST, MISTAKES
from sonar_tracking.display.page.page_server import STATIC, PageServer
from sonar_tracking.errors import ConfigurationError
from tests.display.page.conftest import TOKEN
from tests.display.page.page_scene import show
from tests.display.page.socket_frames import close, greeting, heard

Start = Callable[..., PageServer]
Talk = Callable[[WebSocketClientConnection], Awaitable[Any]]

ABNORMAL = 1006

END_TRACK = {"kind": "command", "command": "end_track", "topic": "tracks", "id": 1}


def talk(server: PageServer, words: Talk, host: str = "localhost") -> Any:
    """Connect to a server as a page does, and let a coroutine talk to it."""

    async def connected() -> Any:
        link = await websocket_connect(
            f"ws://{host}:{server.port}/socket", max_message_size=1 << 24
        )
        try:
            return await asyncio.wait_for(words(link), 30.0)
        finally:
            await close(link)

    return asyncio.run(asyncio.wait_for(connected(), 60.0))


def fetch(server: PageServer, path: str, **headers: str) -> tuple[int, Message, bytes]:
    """Return code, headers and body of the answer to a request."""
    with closing(HTTPConnection("127.0.0.1", server.port, timeout=30.0)) as link:
        link.request("GET", path, headers=headers)
        answer = link.getresponse()
        return answer.status, answer.headers, answer.read()


def other_address() -> str:
    """Return an address of this machine that others see; without one the test is skipped."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
        except OSError:
            pytest.skip("this machine has no address but its own")
        found: str = probe.getsockname()[0]
    if is_loopback(found):
        pytest.skip("this machine has no address but its own")
    return found


def test_files_come_from_here_alone(start: Start) -> None:
    server = start()
    code, headers, body = fetch(server, "/")
    assert code == 200
    assert "default-src 'self'" in headers["Content-Security-Policy"]
    assert b"http" not in body
    assert fetch(server, "/uplot/uPlot.iife.js")[0] == 200
    for path in ("/../page_server.py", "/%2e%2e/page_server.py", "/uplot/../__init__.py"):
        assert fetch(server, path)[0] in (403, 404)


def test_all_files_of_the_page_are_where_a_wheel_takes_them_from() -> None:
    folders = {path.parent.relative_to(STATIC) for path in STATIC.rglob("*") if path.is_file()}
    assert {Path(), Path("views")} == folders
    setup = (Path(__file__).parents[3] / "setup.py").read_text()
    assert '"display/page/static/*"' in setup
    assert '"display/page/static/views/*"' in setup


def test_a_page_elsewhere_cannot_look(start: Start) -> None:
    server = start()
    assert fetch(server, "/", Host="evil.example")[0] == 403
    upgrade = {"Sec-WebSocket-Version": "13", "Sec-WebSocket-Key": "A" * 22 + "=="}
    upgrade |= {"Upgrade": "websocket", "Connection": "Upgrade"}
    assert fetch(server, "/socket", Origin="http://evil.example", **upgrade)[0] == 403


def test_a_page_gets_the_newest_picture_first_then_the_past(start: Start) -> None:
    server = start()
    show(server, 0, 20)

    kinds = [(frame["kind"], frame["t"]) for frame in talk(server, greeting)]
    begin = kinds.index(("history", None))
    assert kinds[0][0] == "hello"
    newest = [time for kind, time in kinds[:begin] if kind == "own_ship"]
    past = [time for kind, time in kinds[begin:] if kind == "own_ship"]
    assert newest == [past[-1]]
    assert len(past) == 20
    assert past == sorted(past)


@pytest.mark.parametrize("given", ["", "wrong", None, 7])
def test_a_command_without_the_token_is_refused_and_logged(
    start: Start,
    asked: list[Mapping[str, Any]],
    caplog: pytest.LogCaptureFixture,
    given: object,
) -> None:
    server = start()

    async def words(link: WebSocketClientConnection) -> dict[str, Any]:
        await link.write_message(json.dumps({**END_TRACK, "token": given}))
        return await heard(link, "command_result")

    with caplog.at_level(logging.WARNING, "sonar_tracking.page"):
        answer = talk(server, words)
    assert not answer["ok"]
    assert "token" in answer["sentence"]
    assert "refused a command from" in caplog.text
    assert server.refused == 1
    assert asked == []


@pytest.mark.parametrize("allowed", [False, True])
def test_other_machines_only_look_unless_told(
    start: Start, asked: list[Mapping[str, Any]], allowed: bool
) -> None:
    server = start(address="0.0.0.0", remote_commands=allowed)

    async def words(link: WebSocketClientConnection) -> tuple[dict[str, Any], dict[str, Any]]:
        hello = await heard(link, "hello")
        await link.write_message(json.dumps({**END_TRACK, "token": TOKEN}))
        return hello, await heard(link, "command_result")

    hello, answer = talk(server, words, other_address())
    assert hello["may_command"] is allowed
    assert answer["ok"] is allowed
    assert len(asked) == int(allowed)


def test_by_itself_a_server_listens_to_this_machine_alone(start: Start) -> None:
    server = start()
    with pytest.raises(OSError), socket.create_connection((other_address(), server.port), 2.0):
        pass


@pytest.mark.parametrize(
    "said", ["", "{", "[]", "7", "null", '{"kind": 3}', '{"kind": "sing"}', "[" * 5000, b"\x00\xff"]
)
def test_nonsense_is_answered_and_harms_nobody(start: Start, said: str | bytes) -> None:
    server = start()

    async def words(link: WebSocketClientConnection) -> dict[str, Any]:
        await link.write_message(said, binary=isinstance(said, bytes))
        return await heard(link, "command_result")

    assert not talk(server, words)["ok"]
    assert fetch(server, "/")[0] == 200


@pytest.mark.parametrize(
    ("said", "count"),
    [('{"kind": "select"}', int(BURST) + 50), ("nonsense", MISTAKES + 5), ("x" * 100_000, 1)],
    ids=["flood", "nonsense", "too_long"],
)
def test_who_floods_is_shut_out_and_others_are_served(start: Start, said: str, count: int) -> None:
    server = start()

    async def words(link: WebSocketClientConnection) -> int | None:
        with suppress(WebSocketClosedError):  # it may be shut out before it has said all
            for _ in range(count):
                await link.write_message(said)
        while await link.read_message() is not None:
            pass
        return link.close_code or ABNORMAL  # who speaks too late does not hear the reason

    assert talk(server, words) in (1008, 1009, ABNORMAL)
    assert talk(server, lambda link: heard(link, "hello"))["title"] == "scene"


def test_where_the_port_is_taken_the_next_free_one_is_used() -> None:
    with listening_socket("127.0.0.1", 0) as taken:
        port = taken.getsockname()[1]
        assert port < free_port("127.0.0.1", port) <= port + 50


def test_an_address_of_another_machine_is_refused_in_a_sentence() -> None:
    with pytest.raises(ConfigurationError, match=r"cannot listen at 192\.0\.2\.1, .*--page-port"):
        listening_socket("192.0.2.1", 0)


def test_the_address_is_for_a_browser_on_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    assert page_address("127.0.0.1", 8080, "abc") == "http://localhost:8080/#token=abc"
    assert page_address("0.0.0.0", 81) == "http://localhost:81/"
    assert page_address("192.0.2.7", 81) == "http://192.0.2.7:81/"
    monkeypatch.setenv(TOKEN_VARIABLE, "given")
    assert page_token() == "given"
    monkeypatch.delenv(TOKEN_VARIABLE)
    assert len({page_token() for _ in range(5)}) == 5


def test_all_modules_are_asked_for_at_once() -> None:
    """Else a browser learns of the last ones only when it has read those that need them."""
    page = (STATIC / "index.html").read_text()
    for path in STATIC.rglob("*.js"):
        assert f'"{path.relative_to(STATIC)}"' in page
