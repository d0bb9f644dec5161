"""A real Chromium without a window, driven over its DevTools protocol."""

from __future__ import annotations

import asyncio
import base64
import json
import os
import shutil
import signal
import subprocess
import time
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from tornado.websocket import WebSocketClientConnection, websocket_connect

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
PATIENCE = 30.0
"""Longest wait for anything, s: generous, because machines may be busy."""


def chromium_path() -> str:
    """Return the path of Chromium; without one, the test is skipped."""
    for name in NAMES:
        found = shutil.which(name)
        if found is not None:
            return found
    pytest.skip("there is no Chromium on this machine; install it with: apt-get install chromium")


class Chromium:
    """One browser process.

    Parameters
    ----------
    folder : Path
        Where it keeps its files.
    """

    def __init__(self, folder: Path) -> None:
        port_file = folder / "DevToolsActivePort"
        options = ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars")
        quiet = ("--no-first-run", "--disable-extensions", "--disable-background-networking")
        self._process = subprocess.Popen(
            [
                *(chromium_path(), *options, *quiet, "--remote-debugging-port=0"),
                *(f"--user-data-dir={folder}", "--window-size=1280,720", "about:blank"),
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        deadline = time.monotonic() + PATIENCE
        while not port_file.exists() or "\n" not in port_file.read_text():
            assert self._process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.05)
        self._port = int(port_file.read_text().splitlines()[0])
        self.loop = asyncio.new_event_loop()
        self._free: list[Tab] = []

    def close(self) -> None:
        """End the process, and all it has started."""
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self.loop.close()

    def open(self, address: str, width: int = 1280, height: int = 720) -> Tab:
        """Open a page in a tab, which may have shown another one before."""
        tab = self._free.pop() if self._free else self._new_tab()
        tab.call("Emulation.setScriptExecutionDisabled", value=False)
        tab.call("Page.bringToFront")
        tab.complaints.clear()
        tab.resize(width, height)
        tab.call("Page.navigate", url=address)
        tab.wait_for("window.page !== undefined")
        return tab

    def leave(self, tab: Tab) -> None:
        """Stop the page of a tab, which the next page may have: to make one takes long."""
        tab.value("delete window.page")
        tab.call("Emulation.setEmulatedMedia", features=[])
        tab.call("Emulation.setScriptExecutionDisabled", value=True)
        self._free.append(tab)

    def _new_tab(self) -> Tab:
        request = urllib.request.Request(
            f"http://127.0.0.1:{self._port}/json/new?about:blank", method="PUT"
        )
        with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
            target = json.load(answer)
        tab = Tab(self.loop, target["webSocketDebuggerUrl"])
        tab.call("Runtime.enable")
        tab.call("Page.enable")
        return tab


class Tab:
    """One page of the browser.

    Attributes
    ----------
    complaints : list of str
        Exceptions and errors of its scripts.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop, address: str) -> None:
        self._loop = loop
        self._number = 0
        self.complaints: list[str] = []
        self._link = loop.run_until_complete(self._connected(address))

    @staticmethod
    async def _connected(address: str) -> WebSocketClientConnection:
        return await websocket_connect(address, max_message_size=1 << 26)

    def call(self, method: str, **parameters: Any) -> Any:
        """Call a method of the protocol and return its result."""
        return self._loop.run_until_complete(self._call(method, parameters))

    async def _call(self, method: str, parameters: dict[str, Any]) -> Any:
        self._number += 1
        call = {"id": self._number, "method": method, "params": parameters}
        await self._link.write_message(json.dumps(call))
        while True:
            said = await asyncio.wait_for(self._link.read_message(), PATIENCE)
            assert said is not None, "the browser has ended"
            message = json.loads(said)
            self._note(message)
            if message.get("id") == self._number:
                assert "error" not in message, message["error"]
                return message["result"]

    def _note(self, message: dict[str, Any]) -> None:
        parameters = message.get("params", {})
        if message.get("method") == "Runtime.exceptionThrown":
            self.complaints.append(json.dumps(parameters["exceptionDetails"])[:500])
        if message.get("method") == "Runtime.consoleAPICalled" and parameters["type"] == "error":
            self.complaints.append(json.dumps(parameters["args"])[:500])

    def value(self, expression: str) -> Any:
        """Return the value of an expression in the page."""
        answer = self.call(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def text(self, selector: str) -> str:
        """Return the text of the first element a selector finds."""
        return str(self.value(f"document.querySelector({json.dumps(selector)}).textContent"))

    def wait_for(self, expression: str) -> None:
        """Wait until an expression is true."""
        deadline = time.monotonic() + PATIENCE
        while not self.value(f"Boolean({expression})"):
            assert time.monotonic() < deadline, f"{expression}; {self.complaints}"
            time.sleep(0.05)

    def key(self, key: str, shift: bool = False, control: bool = False) -> None:
        """Press a key."""
        text = {"text": key} if len(key) == 1 else {}
        modifiers = 8 * shift + 2 * control
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, modifiers=modifiers, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, modifiers=modifiers)

    def click(self, x: float, y: float, count: int = 1) -> None:
        """Click at a place of the page, CSS pixels; twice is a double click."""
        for number in range(1, count + 1):
            where = {"x": x, "y": y, "button": "left", "clickCount": number}
            self.call("Input.dispatchMouseEvent", type="mousePressed", **where)
            self.call("Input.dispatchMouseEvent", type="mouseReleased", **where)

    def resize(self, width: int, height: int) -> None:
        """Give the page another size, CSS pixels."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )

    def colours(self, scheme: str) -> None:
        """Prefer ``light`` or ``dark``; return when the page has followed."""
        feature = {"name": "prefers-color-scheme", "value": scheme}
        self.call("Emulation.setEmulatedMedia", features=[feature])
        self.wait_for(f"document.documentElement.dataset.theme === {scheme!r}")

    def picture(self, path: Path) -> None:
        """Write what is seen as PNG."""
        path.write_bytes(
            base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        )
