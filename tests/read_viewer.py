#!/usr/bin/env python3
"""Turns the surface of a report in a real browser, and says what it finds.

usage: read_viewer.py REPORT.html [SCREENSHOT.png]

Chromium is driven through pipes (`--remote-debugging-pipe`), so that the standard library is enough. The page must ask nothing
from a network and put no error on its console; the sheet must show more than one colour; dragging, the wheel, another quantity
and a view from above must each change it; a value must stand under the pointer. Ends with 0 and a line where no browser starts.
"""
import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

NAMES = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"]
FLAGS = """--headless --no-sandbox --disable-quic --no-first-run --disable-background-networking --disable-component-update
--disable-sync --disable-extensions --hide-scrollbars --use-angle=swiftshader --enable-unsafe-swiftshader --remote-debugging-pipe
--window-size=1200,1000""".split()
PATIENCE = 30.0  # seconds until an answer counts as none
SHEET = "document.querySelector('figure.surface canvas')"


class Browser:
    """A page of Chromium."""

    def __init__(self, program, folder):
        theirs, self.to = os.pipe()
        self.back, ours = os.pipe()

        def places():
            # the browser reads commands from 3 and answers on 4
            spare = [os.dup(theirs), os.dup(ours)]
            os.dup2(spare[0], 3)
            os.dup2(spare[1], 4)

        command = [program, *FLAGS, f"--user-data-dir={folder}", "about:blank"]
        self.process = subprocess.Popen(
            command, preexec_fn=places, close_fds=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        os.close(theirs)
        os.close(ours)
        self.number, self.rest, self.events, self.session = 0, b"", [], None
        pages = [t for t in self.ask("Target.getTargets")["targetInfos"] if t["type"] == "page"]
        self.session = self.ask("Target.attachToTarget", targetId=pages[0]["targetId"], flatten=True)["sessionId"]

    def ask(self, method, **params):
        """The answer to a command; events on the way are kept."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise SystemExit(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def message(self):
        end = time.monotonic() + PATIENCE
        while b"\0" not in self.rest:
            piece = os.read(self.back, 1 << 20)
            if not piece or time.monotonic() > end:
                raise SystemExit("the browser does not answer")
            self.rest += piece
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def value(self, script):
        """What a script of the page gives."""
        told = self.ask("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in told:
            raise SystemExit(f"{script}: {told['exceptionDetails']}")
        return told["result"].get("value")

    def mouse(self, kind, x, y, **more):
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **{"button": "none", **more})

    def drawn(self):
        """What the sheet shows once the next frame is drawn."""
        wait = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 30))))"
        self.value(wait)
        return self.value(f"{SHEET}.toDataURL()")


def main(report, screenshot=None):
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        print("no browser here: the surface viewer was not tried")
        return
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        try:
            browser = Browser(program, folder)
        except (SystemExit, OSError) as reason:
            print(f"{program} does not start here ({reason}): the surface viewer was not tried")
            return
        try:
            turn(browser, Path(report).resolve(), screenshot)
        finally:
            browser.process.terminate()
            browser.process.wait()


def turn(browser, report, screenshot):
    for domain in ["Page", "Runtime", "Log", "Network"]:
        browser.ask(f"{domain}.enable")
    browser.ask("Page.navigate", url=report.as_uri())
    end = time.monotonic() + PATIENCE
    while browser.value("document.readyState") != "complete":
        assert time.monotonic() < end, "the page does not load"
        time.sleep(0.05)
    assert browser.value(f"!!{SHEET}"), "the page has no surface that turns: " + str(browser.value("document.querySelector('figure.surface')?.textContent.slice(0, 300)"))
    box = browser.value(f"(() => {{ {SHEET}.scrollIntoView({{block: 'center', behavior: 'instant'}}); const b = {SHEET}.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; }})()")
    left, top, width, height = box
    x, y = left + 0.45 * width, top + 0.5 * height
    seen = [("at first", browser.drawn())]
    colours = browser.value(f"(() => {{ const s = {SHEET}; const d = s.getContext('2d').getImageData(0, 0, s.width * 0.85, s.height).data; const c = new Set(); for (let k = 0; k < d.length; k += 4) c.add(d[k] << 16 | d[k + 1] << 8 | d[k + 2]); return c.size; }})()")
    assert colours > 50, f"the surface has {colours} colours only"

    browser.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    for k in range(1, 6):
        browser.mouse("mouseMoved", x + 16 * k, y + 6 * k, button="left", buttons=1)
    browser.mouse("mouseReleased", x + 80, y + 30, button="left", clickCount=1)
    seen.append(("turned", browser.drawn()))
    browser.mouse("mouseWheel", x, y, deltaX=0, deltaY=-300)
    seen.append(("nearer", browser.drawn()))
    browser.mouse("mousePressed", x, y, button="right", buttons=2, clickCount=1)
    browser.mouse("mouseMoved", x + 40, y, button="right", buttons=2)
    browser.mouse("mouseReleased", x + 40, y, button="right", clickCount=1)
    seen.append(("moved", browser.drawn()))
    browser.value("(() => { const c = document.querySelector('figure.surface select'); c.value = 1; c.dispatchEvent(new Event('change')); })()")
    seen.append(("another quantity", browser.drawn()))
    browser.value("[...document.querySelectorAll('figure.surface button')].find((b) => b.textContent === 'top').click()")
    seen.append(("from above", browser.drawn()))
    for (before, a), (after, b) in zip(seen, seen[1:]):
        assert a != b, f"nothing changes from {before} to {after}"

    # somewhere in the middle of the sheet there is a wall
    told = ""
    for part in [0.5, 0.45, 0.55, 0.4, 0.6, 0.35, 0.65]:
        browser.mouse("mouseMoved", left + part * (width - 100), top + 0.47 * height)
        browser.drawn()
        told = browser.value("(() => { const t = document.querySelector('figure.surface .tip'); return t.hidden ? '' : t.textContent; })()")
        if told:
            break
    assert told.startswith("body") and "Cp" in told, f"no value under the pointer: {told!r}"
    browser.value("[...document.querySelectorAll('figure.surface button')].find((b) => b.textContent === 'iso').click()")
    browser.mouse("mouseMoved", left + 0.45 * width, top + 0.5 * height)
    browser.drawn()
    if screenshot:
        Path(screenshot).write_bytes(base64.b64decode(browser.ask("Page.captureScreenshot", format="png")["data"]))

    wrong = [e for e in browser.events if e["method"] == "Runtime.exceptionThrown"]
    wrong += [e for e in browser.events if e["method"] == "Log.entryAdded" and e["params"]["entry"]["level"] == "error"]
    wrong += [e for e in browser.events if e["method"] == "Runtime.consoleAPICalled" and e["params"]["type"] in ["error", "warning"]]
    assert not wrong, f"the console of the page says {wrong[0]}"
    asked = [e["params"]["request"]["url"] for e in browser.events if e["method"] == "Network.requestWillBeSent"]
    outside = [url for url in asked if not url.startswith(("file:", "data:"))]
    assert not outside, f"the page asks for {outside}"
    print(f"the surface turns in {Path(shutil.which(next(n for n in NAMES if shutil.which(n)))).name}: {colours} colours, {told}")


if __name__ == "__main__":
    main(*sys.argv[1:])
