# SPDX-License-Identifier: Apache-2.0
"""A browser for the tests of pages."""

import json
import socket
import subprocess
import tempfile
import time
import urllib.request

import pytest

CUT = """const width = document.documentElement.clientWidth;
return [...document.querySelectorAll("body *")].filter((e) => { const r = e.getBoundingClientRect();
  return r.width > 0 && (r.right > width + 1 || r.left < -1) && !e.closest(".scroll"); })
  .map((e) => e.tagName + " " + (e.textContent || "").slice(0, 40))
  .concat([...document.querySelectorAll(".scroll")].filter((e) => e.scrollWidth > e.clientWidth + 1 && width < 640)
  .map((e) => "scrolls: " + e.getAttribute("aria-label")));"""


class Browser:
    """Chromium by its driver's protocol, at a width that phones have, too."""

    def __init__(self, folder):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.driver = subprocess.Popen(["chromedriver", f"--port={self.port}"], **quiet)
        flags = "headless no-sandbox disable-gpu disable-quic no-first-run disable-background-networking disable-component-update disable-sync"
        arguments = [f"--{flag}" for flag in flags.split()] + [f"--user-data-dir={folder}"]
        for _ in range(400):
            try:
                self.call("GET", "/status")
                break
            except OSError:
                time.sleep(0.05)
        wanted = {"capabilities": {"alwaysMatch": {"goog:chromeOptions": {"args": arguments}, "goog:loggingPrefs": {"browser": "ALL"}}}}
        self.session = self.call("POST", "/session", wanted)["sessionId"]

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def open(self, page, width):
        size = {"width": width, "height": 2000, "deviceScaleFactor": 1, "mobile": False}
        self.call("POST", f"/session/{self.session}/goog/cdp/execute", {"cmd": "Emulation.setDeviceMetricsOverride", "params": size})
        self.call("POST", f"/session/{self.session}/url", {"url": page.as_uri()})

    def run(self, script):
        return self.call("POST", f"/session/{self.session}/execute/sync", {"script": script, "args": []})

    def errors(self):
        return [e["message"] for e in self.call("POST", f"/session/{self.session}/se/log", {"type": "browser"}) if e["level"] == "SEVERE"]

    def close(self):
        self.call("DELETE", f"/session/{self.session}")
        self.driver.terminate()
        self.driver.wait()

    def devtools(self, command, **parameters):
        return self.call("POST", f"/session/{self.session}/goog/cdp/execute", {"cmd": command, "params": parameters})

    def choose_files(self, element, paths):
        """Chooses the files in the input of this id, as a user does in the system's dialogue."""
        (found,) = self.call("POST", f"/session/{self.session}/element", {"using": "css selector", "value": f"#{element}"}).values()
        self.call("POST", f"/session/{self.session}/element/{found}/value", {"text": "\n".join(map(str, paths))})

    def press(self, keys):
        """Presses keys, as the driver's protocol writes them, one after the other."""
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.call("POST", f"/session/{self.session}/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": actions}]})

    def wait_for(self, condition, seconds=60):
        """Waits until the expression of JavaScript is true."""
        end = time.monotonic() + seconds
        while not self.run(f"return Boolean({condition})"):
            assert time.monotonic() < end, f"not within {seconds} s: {condition}; the page says: " + self.run("return document.body.innerText")
            time.sleep(0.05)


@pytest.fixture(scope="module")
def browser():
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        made = Browser(folder)
        yield made
        made.close()
