"""One browser: what it is sent, at its own pace, and what it may say."""

from __future__ import annotations

import hmac
import json
import logging
import time
from collections import deque
from collections.abc import Mapping
from typing import Any, Protocol

from tornado.ioloop import IOLoop
from tornado.iostream import StreamClosedError
from tornado.web import RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from sonar_tracking.display.page.page_address import is_loopback
from sonar_tracking.display.page.page_feed import PageFeed
from sonar_tracking.display.page.page_frames import VERSION, Frame, text_frame
from sonar_tracking.errors import InputError

LONGEST_BACKLOG = 64 * 1024 * 1024
"""Bytes that may wait for a browser before it is told to begin anew."""

LARGEST_LIST = 64 * 1024
"""Text that is sent in one message, bytes, as far as it is several frames."""

MESSAGES_PER_SECOND, BURST = 50.0, 200.0
"""What a browser may say; one that says more is shut out."""

MISTAKES = 20
"""Messages that make no sense, until a browser is shut out."""

POLICY_VIOLATION, TRY_AGAIN = 1008, 1013


Span = tuple[float, float]
"""Data times of the first and last message of a recording, s."""


class ServedPage(Protocol):
    """What a browser needs of the server."""

    feed: PageFeed
    clients: set[PageClient]
    token: str
    title: str
    namespace: str
    run: str
    recording: str
    span: Span | None
    remote_commands: bool
    refused: int

    @property
    def takes_commands(self) -> bool:
        """Whether there is anything to command."""

    def check_host(self, handler: RequestHandler) -> None:
        """Refuse a request by a name that is not this machine's."""

    def command(self, fields: Mapping[str, Any]) -> tuple[bool, str]:
        """Do what a browser commands."""

    def select(self, fields: Mapping[str, Any]) -> list[Frame]:
        """Return what is known of what a browser has selected."""

    def seek(self, time: float) -> None:
        """Show the part of a recording around a data time, s."""


_log = logging.getLogger("sonar_tracking.page")


class PageClient(WebSocketHandler):
    """The socket of one browser."""

    def initialize(self, server: ServedPage) -> None:
        """Take what the application knows."""
        self._server = server
        self._waiting: deque[Frame] = deque()
        self._waiting_bytes = 0
        self._pumping = False
        self._allowance, self._heard = BURST, time.monotonic()
        self._mistakes = 0

    @property
    def is_remote(self) -> bool:
        """Whether the browser is on another machine."""
        return not is_loopback(str(self.request.remote_ip))

    def prepare(self) -> None:
        """Refuse whoever calls this machine by a name that is not its own."""
        self._server.check_host(self)

    def open(self, *_: str, **__: str) -> None:
        """Greet a browser: what the page is, the newest picture, the past."""
        self.set_nodelay(True)
        commands = self._server.takes_commands
        hello = text_frame(
            "hello",
            float("nan"),
            version=VERSION,
            title=self._server.title,
            namespace=self._server.namespace,
            run=self._server.run,
            token_needed=commands,
            may_command=commands and not (self.is_remote and not self._server.remote_commands),
            recording=self._server.recording,
            span=self._server.span,
        )
        for frame in (hello, *self._server.feed.past()):
            self._keep(frame)
        self._server.clients.add(self)
        self._pump()

    def on_close(self) -> None:
        """Forget a browser."""
        self._server.clients.discard(self)
        self._waiting.clear()

    def send(self, frame: Frame) -> None:
        """Send a frame as soon as the browser takes it."""
        self._keep(frame)
        if self._waiting_bytes > LONGEST_BACKLOG:
            self._waiting.clear()
            self.close(TRY_AGAIN, "the page takes less than comes: begin anew")
            return
        self._pump()

    def on_message(self, message: str | bytes) -> None:
        """Take what a browser says."""
        now = time.monotonic()
        grown = self._allowance + MESSAGES_PER_SECOND * (now - self._heard)
        self._allowance, self._heard = min(BURST, grown) - 1.0, now
        if self._allowance < 0.0:
            _log.warning("%s says too much and was shut out", self.request.remote_ip)
            self.close(POLICY_VIOLATION, "too many messages")
            return
        try:
            said = json.loads(message)
            kind = said["kind"]
        except (ValueError, KeyError, TypeError, RecursionError):
            self._refuse("what the page has sent makes no sense; load it anew.")
            return
        if kind == "command":
            self._command(said)
        elif kind == "select" and isinstance(said, dict):
            self._select(said)
        elif kind == "seek" and isinstance(said.get("t"), int | float):
            self._seek(float(said["t"]))
        else:
            self._refuse(f"the page has sent {str(kind)[:40]!r}, which is not known.")

    def _select(self, said: dict[str, Any]) -> None:
        """Send what is known of what is selected."""
        try:
            frames = self._server.select(said)
        except InputError as error:
            self._refuse(str(error))
            return
        for frame in frames:
            self._keep(frame)
        self._pump()

    def _seek(self, time: float) -> None:
        """Show another part of a recording."""
        try:
            self._server.seek(time)
        except InputError as error:
            self._refuse(str(error))

    def _command(self, said: dict[str, Any]) -> None:
        """Do what is asked by who may ask."""
        token = str(said.pop("token", ""))
        if not self._server.takes_commands:
            self._answer(False, "nothing here takes commands: this is a recording.")
        elif self.is_remote and not self._server.remote_commands:
            self._refuse_command("commands from other machines are not taken (remote_commands).")
        elif not hmac.compare_digest(token.encode(), self._server.token.encode()):
            self._refuse_command("a command without the token of the page is not taken.")
        else:
            self._answer(*self._server.command(said))

    def _refuse_command(self, sentence: str) -> None:
        _log.warning("refused a command from %s: %s", self.request.remote_ip, sentence)
        self._server.refused += 1
        self._answer(False, f"{sentence} Open the page by the address that was printed.")

    def _refuse(self, sentence: str) -> None:
        self._mistakes += 1
        if self._mistakes > MISTAKES:
            _log.warning("%s makes no sense and was shut out", self.request.remote_ip)
            self.close(POLICY_VIOLATION, "too many messages that make no sense")
        else:
            self._answer(False, sentence)

    def _answer(self, ok: bool, sentence: str) -> None:
        self.send(text_frame("command_result", float("nan"), ok=ok, sentence=sentence))

    def _keep(self, frame: Frame) -> None:
        self._waiting.append(frame)
        self._waiting_bytes += len(frame.data)

    def _pump(self) -> None:
        if not self._pumping:
            self._pumping = True
            IOLoop.current().add_callback(self._send_waiting)

    def _next(self) -> str | bytes:
        """Take what is sent next: a frame, or, of text, all that wait, up to a size, as a list."""
        first = self._taken()
        if isinstance(first, bytes):
            return first
        texts = [first]
        size = len(first)
        while self._waiting and isinstance(self._waiting[0].data, str) and size < LARGEST_LIST:
            text = str(self._taken())
            size += len(text)
            texts.append(text)
        return f"[{','.join(texts)}]" if len(texts) > 1 else first

    def _taken(self) -> str | bytes:
        data = self._waiting.popleft().data
        self._waiting_bytes -= len(data)
        return data

    async def _send_waiting(self) -> None:
        try:
            while self._waiting:
                data = self._next()
                await self.write_message(data, binary=isinstance(data, bytes))
        except (WebSocketClosedError, StreamClosedError):
            self._waiting.clear()
        finally:
            self._pumping = False
