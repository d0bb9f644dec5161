"""The live page as a web server, in a thread of its own.

It serves its files, those of the curves from the wheel ``uplot-python``, and one socket a browser;
nothing is loaded from elsewhere. The feed belongs to its thread: others call :meth:`PageServer.do`.
"""

from __future__ import annotations

import asyncio
import hashlib
import threading
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop, PeriodicCallback
from tornado.web import Application, RequestHandler, StaticFileHandler

from sonar_tracking.display.page.page_address import is_loopback, listening_socket, page_address
from sonar_tracking.display.page.page_client import PageClient, Span
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_feed import PageFeed
from sonar_tracking.display.page.page_frames import Frame
from sonar_tracking.errors import InputError

STATIC = Path(__file__).parent / "static"

LONGEST_MESSAGE = 16 * 1024
"""Of what a browser may say, bytes."""

HEALTH_PERIOD = 1.0
"""Between two reports of the state of the graph, s."""

PING_PERIOD = 20.0
PATIENCE = 3.0
GOING_AWAY = 1001

_OWN_NAMES = {"localhost", "127.0.0.1", "[::1]"}
_POLICY = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "connect-src 'self' ws: wss:; frame-ancestors 'none'"
)

Command = Callable[[Mapping[str, Any]], tuple[bool, str]]
"""Takes the fields of a command; returns whether it was taken, and a sentence."""


class PageServer:
    """Serves one feed to any number of browsers.

    Parameters
    ----------
    configuration : PageConfiguration
        Parameters of the page.
    token : str
        What commands need.
    command : callable, optional
        Does what a browser commands; None = nothing is commanded here.
    recording : str
        State of a recording that is shown; empty = what is shown is live.
    namespace : str
        Of the graph; empty = the root.
    span : (float, float), optional
        Data times of the first and last message of a recording, s.
    show_part : callable, optional
        Shows the part of the recording around a data time, s; called in the thread of the server.

    Attributes
    ----------
    feed : PageFeed
        What is shown.
    clients : set of PageClient
        The browsers.
    refused : int
        Commands that were not taken.
    run : str
        The same for all pages of a run, whatever is started again, and of a recording.
    """

    def __init__(
        self,
        configuration: PageConfiguration,
        token: str,
        command: Command | None = None,
        recording: str = "",
        namespace: str = "",
        span: Span | None = None,
        show_part: Callable[[float], None] | None = None,
    ) -> None:
        self.clients: set[PageClient] = set()
        self.feed = PageFeed(configuration, self._send)
        self.token = token
        self.title = configuration.title
        self.recording = recording
        self.namespace = namespace
        self.run = _run_name(token or f"{configuration.title} {span}")
        self.span = span
        self._show_part = show_part
        self.remote_commands = configuration.remote_commands
        self.refused = 0
        self._command = command
        self._configuration = configuration
        self._socket = listening_socket(configuration.address, configuration.port)
        self.port: int = self._socket.getsockname()[1]
        self._loop: IOLoop | None = None
        self._thread = threading.Thread(target=self._run, name="page", daemon=True)
        self._ready = threading.Event()

    @property
    def address(self) -> str:
        """What to type into a browser on this machine."""
        token = self.token if self.takes_commands else ""
        return page_address(self._configuration.address, self.port, token)

    @property
    def takes_commands(self) -> bool:
        """Whether there is anything to command."""
        return self._command is not None

    def start(self) -> None:
        """Begin to serve."""
        self._thread.start()
        self._ready.wait()

    def stop(self) -> None:
        """Serve no longer; browsers are told."""
        if self._loop is not None:
            self._loop.add_callback(self._close)
            self._thread.join(PATIENCE)

    def do(self, work: Callable[..., None], *arguments: Any) -> None:
        """Let the thread of the server call something; from any thread."""
        if self._loop is not None:
            self._loop.add_callback(work, *arguments)

    def command(self, fields: Mapping[str, Any]) -> tuple[bool, str]:
        """Do what a browser commands; return whether it was done, and a sentence."""
        if self._command is None:
            return False, "nothing here takes commands."
        return self._command(fields)

    def select(self, fields: Mapping[str, Any]) -> list[Frame]:
        """Return what is known of what a browser has selected; it is sent from now on.

        Raises
        ------
        InputError
            If it makes no sense.
        """
        return self.feed.select(fields)

    def seek(self, time: float) -> None:
        """Show the part of a recording around a data time, s.

        Raises
        ------
        InputError
            If what is shown is no recording, or has no such time.
        """
        if self._show_part is None or self.span is None:
            raise InputError("what is shown here is no recording that could be looked through.")
        if not self.span[0] <= time <= self.span[1]:
            raise InputError(f"the recording has no time {time:.3f} s.")
        self._show_part(time)

    def check_host(self, handler: RequestHandler) -> None:
        """Refuse a request by a name that is not this machine's: a page elsewhere has made it."""
        name = handler.request.host.rpartition(":")[0] or handler.request.host
        local = is_loopback(self._configuration.address)
        if local and name not in _OWN_NAMES and not is_loopback(name):
            handler.set_status(403)
            handler.finish("This page is for localhost.")

    def _send(self, frame: Frame) -> None:
        for client in tuple(self.clients):
            client.send(frame)

    def _run(self) -> None:
        asyncio.run(self._serve())

    async def _serve(self) -> None:
        self._loop, self._end = IOLoop.current(), asyncio.Event()
        server = HTTPServer(self._application())
        server.add_socket(self._socket)
        reports = PeriodicCallback(self.feed.report_health, 1000.0 * HEALTH_PERIOD)
        reports.start()
        self._ready.set()
        await self._end.wait()
        reports.stop()
        server.stop()
        for client in tuple(self.clients):
            client.close(GOING_AWAY, "the server ends")
        await asyncio.sleep(0.05)  # until the browsers have heard it
        await server.close_all_connections()

    def _close(self) -> None:
        self._end.set()

    def _application(self) -> Application:
        return Application(
            [
                (r"/socket", PageClient, {"server": self}),
                (r"/uplot/(.*)", _File, {"path": str(_uplot_files())}),
                (r"/(.*)", _File, {"path": str(STATIC), "default_filename": "index.html"}),
            ],
            page_server=self,
            websocket_max_message_size=LONGEST_MESSAGE,
            websocket_ping_interval=PING_PERIOD,
            log_function=lambda handler: None,
        )


class _File(StaticFileHandler):
    """A file of the page."""

    def prepare(self) -> None:
        self.application.settings["page_server"].check_host(self)

    def set_extra_headers(self, path: str) -> None:
        self.set_header("Cache-Control", "no-cache")
        self.set_header("Content-Security-Policy", _POLICY)
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("Referrer-Policy", "no-referrer")


def _run_name(secret: str) -> str:
    """Return what tells one run from others, and does not tell its token."""
    return hashlib.sha256(secret.encode()).hexdigest()[:16]


def _uplot_files() -> Path:
    """Return the folder of the files that draw curves, without loading the package."""
    found = find_spec("uplot")
    if found is None or found.origin is None:
        raise ModuleNotFoundError("No module named 'uplot'", name="uplot-python")
    return Path(found.origin).parent / "static"
