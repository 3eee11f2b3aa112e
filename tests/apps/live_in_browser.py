#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Watches runs in headless Chromium: their maps must grow on the page, which must become the report, or say how the run ended.

usage: live_in_browser.py PROGRAM SEQUENCE [--slow-down] [--screenshots FOLDER]
Exit code 77 (skipped) where Chromium, its driver or Selenium is missing (Debian: chromium-driver, python3-selenium), or the program
has no server.
"""
import argparse
import atexit
import base64
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

from report_in_browser import SKIPPED, check_accessibility, errors_of, expect, missing, open_browser

TIMEOUT_S = 240


class Run:
    """The program with --live, and where its page is."""

    is_to_be_slowed = False

    def __init__(self, program, arguments):
        self.process = subprocess.Popen([program, "map", *arguments, "--quiet", "--live"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)  # where a check fails
        line = self.process.stdout.readline()
        if not line.startswith("live view: "):
            message = self.process.stderr.read().strip()
            print(("skipped: " if "built without" in message else "FAILED: ") + message)
            sys.exit(SKIPPED if "built without" in message else 1)
        self.url = line.split("live view: ")[1].strip()
        self.is_slowed = self.is_to_be_slowed
        self.slowing = threading.Thread(target=self.slow_down, daemon=True)
        self.slowing.start()

    def slow_down(self):
        """Lets it work for a share of the time, so that a run of few small images takes as long as one of many."""
        while self.is_slowed and self.process.poll() is None:
            self.process.send_signal(signal.SIGSTOP)
            time.sleep(0.19)
            self.process.send_signal(signal.SIGCONT)
            time.sleep(0.01)

    def at_full_speed(self):
        self.is_slowed = False
        self.slowing.join()

    def kill(self):
        self.at_full_speed()
        self.process.kill()
        self.process.communicate()

    def end(self):
        self.at_full_speed()
        _, error = self.process.communicate(timeout=TIMEOUT_S)
        return self.process.returncode, error


def until(condition, what):
    end = time.monotonic() + TIMEOUT_S
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    expect(False, f"{what} within {TIMEOUT_S} s")
    return None


class Page:
    def __init__(self, browser, screenshots):
        self.browser, self.screenshots = browser, screenshots

    def ask(self, script):
        return self.browser.execute_script("return " + script)

    def words(self, name):
        return self.ask(f"document.getElementById('{name}').textContent")

    def check(self, name):
        """In both themes."""
        for theme in ("light", "dark"):
            self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": theme}]})
            time.sleep(0.2)
            if self.screenshots:
                self.screenshots.mkdir(parents=True, exist_ok=True)
                shot = self.browser.execute_cdp_cmd("Page.captureScreenshot", {})
                (self.screenshots / f"{name}-{theme}.png").write_bytes(base64.b64decode(shot["data"]))
            check_accessibility(self.browser)


def grows_and_becomes_the_report(program, page, arguments, out):
    run = Run(program, [*arguments, "--out", str(out)])
    page.browser.get(run.url)
    expect(page.ask("document.documentElement.dataset.ready") == "yes", f"the live page did not come up: {errors_of(page.browser)}")
    first = until(lambda: page.ask("finalTrack.size >= 3 && finalTrack.size"), "a map")
    expect(page.ask("document.documentElement.dataset.live") == "running", "the map came only at the end")
    bar = page.ask("(({role, ariaValueNow, ariaValueMax}) => [role, ariaValueNow, ariaValueMax])(document.getElementById('live-bar'))")
    expect(bar[0] == "progressbar" and 0 < float(bar[1]) <= float(bar[2]), f"the bar is {bar}")
    until(lambda: page.ask("finalTrack.size") > first, "a map that grows")
    page.check("growing")
    for layer in page.browser.find_elements("css selector", "#layers label:not([hidden]) input"):
        page.browser.execute_script("arguments[0].click(); arguments[0].click()", layer)
    run.at_full_speed()
    until(lambda: page.ask("!report.live && document.documentElement.dataset.ready === 'yes'"), "the report")
    code, error = run.end()
    expect(code == 0, f"the run failed: {error}")
    expect(str(out / "report.html") in page.words("note"), "the page does not say where its report is")
    expect(page.ask("report.ledger.query.length") > 0 and page.ask("report.images !== null"), "the report is not whole")
    time.sleep(1.5)  # in which a live page would have asked again
    expect(page.ask("document.querySelector('#above').clientWidth") > 0, "the report did not stay")
    page.check("ended")


def says_that_there_is_no_report(program, page, arguments, out):
    run = Run(program, [*arguments, "--no-report", "--out", str(out)])
    page.browser.get(run.url)
    run.at_full_speed()
    until(lambda: page.ask("document.documentElement.dataset.live") == "ended", "the end")
    expect(run.end()[0] == 0, "the run failed")
    expect("without a report" in page.words("note") and page.ask("finalTrack.size") > 0, "the page does not keep its last state")
    page.check("no-report")


def says_that_it_no_longer_answers(program, page, arguments, out):
    run = Run(program, [*arguments, "--out", str(out)])
    page.browser.get(run.url)
    until(lambda: page.ask("live.since > 0"), "a map")
    run.kill()
    until(lambda: "no longer answers" in page.words("note"), "a word about the end")
    expect(page.ask("finalTrack.size") > 0, "the page does not keep its last state")
    page.check("killed")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("sequence", type=pathlib.Path)
    parser.add_argument("--screenshots", type=pathlib.Path)
    parser.add_argument("--slow-down", action="store_true")
    arguments = parser.parse_args()
    Run.is_to_be_slowed = arguments.slow_down
    if missing():
        print("skipped: " + missing())
        return SKIPPED
    with_odometry = [str(arguments.sequence), "--odometry", str(arguments.sequence / "odometry.tum")]
    browser = open_browser(1440, 1000, reachable="127.0.0.1")
    browser.set_script_timeout(60)
    folder = lambda name: arguments.screenshots / name if arguments.screenshots else None
    try:
        with tempfile.TemporaryDirectory() as scratch:
            out = pathlib.Path(scratch)
            grows_and_becomes_the_report(arguments.program, Page(browser, folder("odometry")), with_odometry, out / "a")
            grows_and_becomes_the_report(arguments.program, Page(browser, folder("images")), [str(arguments.sequence)], out / "b")
            says_that_there_is_no_report(arguments.program, Page(browser, folder("odometry")), with_odometry, out / "c")
            errors = errors_of(browser)
            expect(not errors, f"console: {errors[:5]}")
            says_that_it_no_longer_answers(arguments.program, Page(browser, folder("odometry")), with_odometry, out / "d")
    finally:
        browser.quit()
    print("the maps grew, the pages became the reports and said how the runs ended; no console error")
    return 0


if __name__ == "__main__":
    sys.exit(main())
