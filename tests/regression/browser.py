# SPDX-License-Identifier: LGPL-2.1-or-later
"""Chromium without a window, for pages: it opens them, runs JavaScript in them, takes
pictures, and says what went wrong.

It listens on a pipe (its protocol for developers), so that nothing but the program
`chromium` is needed.
"""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

BAD = ("error", "warning")
NAMES = ("chromium", "chromium-browser", "google-chrome")


def executable():
    """Chromium's path, or None."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """browser = Browser(); browser.open(path); browser.run("1 + 1"); browser.close()

    errors  what the console and exceptions of the page said, and requests over a
            network
    """

    def __init__(self, timeout=60.0):
        self.timeout = timeout
        self.errors = []
        self.number = 0
        self.profile = tempfile.mkdtemp(prefix="browser_")
        read_here, write_there = os.pipe()
        read_there, write_here = os.pipe()

        def connect():
            # Where it reads and writes: 3 and 4, once both are out of the way.
            ends = [os.dup(read_there), os.dup(write_there)]
            for end, place in zip(ends, (3, 4)):
                os.dup2(end, place)

        self.process = subprocess.Popen(
            [
                executable(),
                *("--headless=new", "--remote-debugging-pipe", "--no-sandbox"),
                *("--use-gl=angle", "--use-angle=swiftshader"),
                *("--enable-unsafe-swiftshader", "--disable-dev-shm-usage"),
                *("--no-first-run", "--disable-extensions", "--disable-sync"),
                *("--disable-background-networking", "--disable-component-update"),
                # Whatever a page asks a network for fails, and is an error.
                "--host-resolver-rules=MAP * ~NOTFOUND",
                f"--user-data-dir={self.profile}",
                "about:blank",
            ],
            preexec_fn=connect,
            close_fds=False,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(read_there)
        os.close(write_there)
        self.input, self.output = read_here, write_here
        self.left = b""
        self.session = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self.session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.input)
        os.close(self.output)
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, **parameters):
        """A command of the protocol and its answer."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.output, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + self.timeout
        while True:
            answer = self.receive(end)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise AssertionError(f"{method}: {answer['error']}")
                return answer["result"]
            self.note(answer)

    def receive(self, end):
        while b"\0" not in self.left:
            left = max(0.0, end - time.monotonic())
            if not select.select([self.input], [], [], left)[0]:
                raise AssertionError(f"no answer of {executable()}")
            more = os.read(self.input, 1 << 20)
            if not more:
                raise AssertionError(f"{executable()} has ended")
            self.left += more
        message, _, self.left = self.left.partition(b"\0")
        return json.loads(message)

    def note(self, event):
        """Keep what should not have happened."""
        method, about = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(about["exceptionDetails"])[:500])
        elif method == "Runtime.consoleAPICalled" and about["type"] in BAD:
            self.errors.append(json.dumps(about["args"])[:500])
        elif method == "Log.entryAdded" and about["entry"]["level"] in BAD:
            # SwiftShader is slow, and says so.  What the page asks a network for is
            # seen below; the browser, which asks as well, at times logs its own.
            text, url = about["entry"]["text"], about["entry"].get("url", "")
            if "GPU stall" not in text and not url.startswith("http"):
                self.errors.append(f"{text[:500]} {url}")
        elif method == "Network.requestWillBeSent":
            url = about["request"]["url"]
            if not url.startswith(("data:", "file:", "blob:", "about:")):
                self.errors.append(f"asks for {url}")

    def open(self, path):
        self.errors.clear()
        self.call("Page.navigate", url=path.resolve().as_uri())

    def run(self, script):
        """The value of an expression in the page; promises are awaited."""
        answer = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in answer:
            raise AssertionError(f"{script}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def wait(self, script):
        """Until an expression is true."""
        end = time.monotonic() + self.timeout
        while not self.run(script):
            if time.monotonic() > end:
                raise AssertionError(f"never true: {script}; {self.errors}")
            time.sleep(0.05)

    def size(self, width, height):
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )

    def dark(self, is_dark=True):
        value = "dark" if is_dark else "light"
        feature = {"name": "prefers-color-scheme", "value": value}
        self.call("Emulation.setEmulatedMedia", features=[feature])

    def picture(self, path, whole=False):
        """A PNG of what is seen, or of the whole page."""
        answer = self.call("Page.captureScreenshot", captureBeyondViewport=whole)
        path.write_bytes(base64.b64decode(answer["data"]))
