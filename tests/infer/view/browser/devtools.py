"""Headless Chromium, driven by its DevTools protocol."""
import base64
import json
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
import urllib.request

from web_socket import WebSocket

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def find_browser():
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Page:
    """One tab. Notes what goes wrong in it: `errors` are lines."""

    def __init__(self, browser, width=1280, height=720, touch=False):
        target = browser.ask("/json/new?about:blank", "PUT")
        address = re.match(r"ws://([^:/]+):(\d+)(/.*)", target["webSocketDebuggerUrl"])
        self.socket = WebSocket(address[1], int(address[2]), address[3])
        self.number = 0
        self.errors = []
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.call("Page.bringToFront")  # a tab behind another draws no frames
        self.resize(width, height, touch)

    def resize(self, width, height, touch=False, scale=1):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=scale, mobile=touch)
        self.call("Emulation.setTouchEmulationEnabled", enabled=touch)

    def call(self, method, **params):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            message = json.loads(self.socket.receive()[1])
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']['message']}")
                return message["result"]
            self._note(message)

    def _note(self, message):
        params = message.get("params", {})
        if message["method"] == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            text = details.get("exception", {}).get("description", details["text"])
            self.errors.append(f"exception: {text}")
        elif message["method"] == "Runtime.consoleAPICalled" and params["type"] == "error":
            self.errors.append(f"console: {params['args']}")
        elif message["method"] == "Log.entryAdded" and params["entry"]["level"] == "error":
            self.errors.append(f"log: {params['entry']['text']} {params['entry'].get('url', '')}")

    def open(self, address):
        self.call("Page.navigate", url=address)

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, awaitPromise=True,
                           returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait(self, expression, seconds=120, what=None):
        """Until an expression is true."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if value := self.evaluate(expression):
                return value
            time.sleep(0.05)
        raise TimeoutError(f"{what or expression} has not come true within {seconds} s; "
                           f"errors: {self.errors}")

    def mouse(self, kind, x, y, button="left", buttons=1, modifiers=0, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=buttons,
                  modifiers=modifiers, clickCount=1, **more)

    def click(self, x, y):
        self.mouse("mouseMoved", x, y, button="none", buttons=0)
        self.mouse("mousePressed", x, y)
        self.mouse("mouseReleased", x, y, buttons=0)

    def drag(self, start, end, steps=8, button="left", modifiers=0):
        buttons = {"left": 1, "right": 2, "middle": 4}[button]
        self.mouse("mouseMoved", *start, button="none", buttons=0)
        self.mouse("mousePressed", *start, button=button, buttons=buttons, modifiers=modifiers)
        for step in range(1, steps + 1):
            share = step / steps
            self.mouse("mouseMoved", start[0] + share * (end[0] - start[0]),
                       start[1] + share * (end[1] - start[1]), button=button, buttons=buttons,
                       modifiers=modifiers)
            time.sleep(0.02)
        self.mouse("mouseReleased", *end, button=button, buttons=0, modifiers=modifiers)

    def key(self, code, key, seconds=0.0, text=None, modifiers=0):
        more = {"text": text} if text else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", code=code, key=key,
                  modifiers=modifiers, **more)
        time.sleep(seconds)
        self.call("Input.dispatchKeyEvent", type="keyUp", code=code, key=key, modifiers=modifiers)

    def screenshot(self, path):
        """PNG, or JPEG by the name."""
        how = {"format": "jpeg", "quality": 85} if str(path).endswith(".jpg") else {"format": "png"}
        picture = self.call("Page.captureScreenshot", **how)["data"]
        pathlib.Path(path).write_bytes(base64.b64decode(picture))

    def close(self):
        self.socket.close()


class Browser:
    def __init__(self, *arguments):
        self.profile = tempfile.mkdtemp(prefix="lte-browser-")
        self.log = open(pathlib.Path(self.profile) / "log", "w+")
        self.process = subprocess.Popen([
            find_browser(), "--headless=new", "--no-sandbox", "--disable-gpu",
            "--disable-dev-shm-usage", "--no-first-run", "--disable-extensions",
            "--disable-background-networking", "--hide-scrollbars", "--mute-audio",
            "--remote-debugging-port=0", f"--user-data-dir={self.profile}/profile", *arguments,
            "about:blank"
        ], stdout=self.log, stderr=self.log)
        self.port = self._port()

    def _port(self):
        file = pathlib.Path(self.profile) / "profile/DevToolsActivePort"
        end = time.monotonic() + 60
        while time.monotonic() < end and self.process.poll() is None:
            if file.exists() and (lines := file.read_text().splitlines()):
                return int(lines[0])
            time.sleep(0.05)
        raise RuntimeError("Chromium does not start: " +
                           (pathlib.Path(self.profile) / "log").read_text()[-2000:])

    def ask(self, path, method="GET"):
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", method=method)
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.load(answer)

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
        shutil.rmtree(self.profile, ignore_errors=True)
