#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Opens a report in headless Chromium, uses every control, and fails on a console error or a control that does nothing.

usage: report_in_browser.py REPORT.html [--screenshots FOLDER]
Exit code 77 (skipped) where Chromium, its driver or Selenium is missing (Debian: chromium-driver, python3-selenium).
"""
import argparse
import base64
import pathlib
import shutil
import sys
import time

SKIPPED = 77


def missing():
    """What a browser cannot be opened without; empty where nothing is missing."""
    try:
        import selenium  # noqa: F401
    except ImportError:
        return "Selenium is not installed (Debian: python3-selenium)"
    return "" if shutil.which("chromedriver") and shutil.which("chromium") else "Chromium is not installed (Debian: chromium-driver)"


def open_browser(width, height, reachable="nothing"):
    """A browser that reaches no address but this one."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader", "--use-angle=swiftshader",
                     f"--window-size={width},{height}", f"--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE {reachable}", "--force-device-scale-factor=1"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))


def errors_of(browser):
    """Console messages that a page of ours causes; WebGL's performance notes of a software renderer are not."""
    return [entry["message"] for entry in browser.get_log("browser")
            if entry["level"] in ("SEVERE", "WARNING") and "GPU stall" not in entry["message"]]


def expect(condition, what):
    if not condition:
        print(f"FAILED: {what}")
        sys.exit(1)


def use_controls(browser):
    script = browser.execute_script
    by_id = lambda name: browser.find_element("id", name)
    words = lambda name: script(f"return document.getElementById('{name}').textContent")
    picture = lambda name: script(f"return document.getElementById('{name}').toDataURL()")
    settle = lambda: browser.execute_async_script("const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(done));")

    def changes(name, look, act):
        before = look()
        act()
        settle()
        expect(look() != before, f"{name} does nothing")

    click = lambda element: script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'}); arguments[0].click()", element)
    for box in browser.find_elements("css selector", "#layers input"):
        changes("a layer of the map", lambda: picture("above"), lambda: click(box))
        click(box)
    keys = lambda element, text: script(
        "arguments[0].focus(); arguments[0].dispatchEvent(new KeyboardEvent('keydown', {key: arguments[1], bubbles: true, cancelable: true}))", element, text)
    for key in ("ArrowLeft", "ArrowUp", "+", "-"):
        changes(f"{key} on the map", lambda: picture("above"), lambda: keys(by_id("above"), key))
    changes("Fit", lambda: picture("above"), lambda: click(by_id("view-reset")))
    if by_id("view-space").is_enabled():
        click(by_id("view-space"))
        settle()
        space = lambda: script("return document.querySelector('#space canvas')?.toDataURL()")
        if space():
            box = browser.find_elements("css selector", "#layers input")[-1]
            changes("a layer in 3-D", space, lambda: click(box))
            click(box)
        click(by_id("view-above"))
        settle()
    changes("ArrowDown in the table", lambda: words("pair-title"), lambda: keys(by_id("scroller"), "ArrowDown"))
    changes("End in the table", lambda: words("pair-title"), lambda: keys(by_id("scroller"), "End"))
    changes("Previous", lambda: words("pair-title"), lambda: click(by_id("previous")))
    changes("Next", lambda: words("pair-title"), lambda: click(by_id("next")))
    rows = browser.find_elements("css selector", "#scroller tbody tr:not(.gap)")
    changes("a click on a row", lambda: words("pair-title"), lambda: click(rows[len(rows) // 2]))
    for head in range(len(browser.find_elements("css selector", "#scroller th button"))):
        button = browser.find_elements("css selector", "#scroller th button")[head]
        changes("sorting", lambda: script("return document.querySelector('#scroller thead').innerHTML"), lambda: click(button))
    number = lambda: words("count")
    enter = lambda name, value: script(
        "const e = document.getElementById(arguments[0]); e.value = arguments[1]; e.dispatchEvent(new Event('input', {bubbles: true}))", name, value)
    changes("the filter by frame", number, lambda: enter("filter-frame", words("pair-title").split()[0]))
    changes("Reset", number, lambda: click(by_id("filter-reset")))
    changes("the filter by probability", number, lambda: enter("filter-probability", "0.9"))
    click(by_id("filter-reset"))
    for name in ("filter-category", "filter-verdict"):
        options = script(f"return [...document.getElementById('{name}').options].map((option) => option.value)")
        if len(options) > 2:
            changes(name, number, lambda: enter(name, options[1]))
            click(by_id("filter-reset"))
    if script("return report.images !== null && report.inliers !== null"):
        enter("filter-verdict", "Accepted")
        keys(by_id("scroller"), "Home")
        settle()
        expect(script("return document.querySelectorAll('#pair-picture svg image').length") == 2, "an accepted pair shows no two images")
        expect(script("return document.querySelectorAll('#pair-picture svg line').length") > 5, "an accepted pair shows no inliers")
        changes("Lines", lambda: script("return document.querySelectorAll('#pair-picture svg line').length"), lambda: click(by_id("show-lines")))
        click(by_id("show-lines"))
        changes("Blink", lambda: script("return document.querySelectorAll('#pair-picture svg image').length"), lambda: click(by_id("blink")))
        click(by_id("blink"))
        click(by_id("filter-reset"))
    changes("the colour of the matrix", lambda: picture("matrix"), lambda: script(
        "const e = document.getElementById('matrix-colour'); e.value = 'category'; e.dispatchEvent(new Event('change'))"))
    changes("Theme", lambda: words("theme"), lambda: click(by_id("theme")))
    changes("Theme", lambda: script("return getComputedStyle(document.body).backgroundColor"), lambda: click(by_id("theme")))


def check_accessibility(browser):
    problems = browser.execute_script("""
        const problems = [];
        const shown = (element) => element.offsetParent !== null;
        for (const element of document.querySelectorAll('button, input, select, a[href]')) {
          const name = element.textContent.trim() || element.getAttribute('aria-label') || (element.labels && element.labels.length && element.labels[0].textContent.trim());
          if (shown(element) && !name) problems.push('no name: ' + element.outerHTML.slice(0, 80));
        }
        for (const element of document.querySelectorAll('canvas, svg[role=img]')) if (!element.getAttribute('aria-label') && shown(element)) problems.push('no label: ' + element.outerHTML.slice(0, 60));
        const ids = [...document.querySelectorAll('[id]')].map((element) => element.id);
        if (new Set(ids).size !== ids.length) problems.push('an id twice');
        const canvas = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
        const rgb = (text) => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = text; canvas.fillRect(0, 0, 1, 1); return [...canvas.getImageData(0, 0, 1, 1).data]; };
        const luminance = ([r, g, b]) => [r, g, b].map((v) => { v /= 255; return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }).reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
        const background = (element) => { for (let e = element; e; e = e.parentElement) { const c = rgb(getComputedStyle(e).backgroundColor); if (c[3] === 255) return c; } return [255, 255, 255, 255]; };
        for (const element of document.querySelectorAll('p, h1, h2, h3, td, th, dt, dd, small, label, button, a, summary, figcaption, span, b')) {
          if (!shown(element) || element.disabled || ![...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim())) continue;
          const a = luminance(rgb(getComputedStyle(element).color)), b = luminance(background(element));
          const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
          if (contrast < 4.5) problems.push(`contrast ${contrast.toFixed(2)}: ${element.tagName} ${element.textContent.slice(0, 30)}`);
        }
        const width = document.documentElement.clientWidth;
        if (document.documentElement.scrollWidth > width + 1) {
          const wide = [...document.querySelectorAll('main *, header *')].filter((element) => element.getBoundingClientRect().right > width + 1 && !element.closest('#scroller, .wide, #pair-ledger'));
          problems.push('scrolls sideways: ' + wide.slice(0, 4).map((element) => element.tagName + '#' + element.id + '.' + element.className).join(', '));
        }
        return [...new Set(problems)];""")
    expect(not problems, "accessibility: " + "; ".join(problems[:12]))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("report", type=pathlib.Path)
    parser.add_argument("--screenshots", type=pathlib.Path)
    arguments = parser.parse_args()
    if missing():
        print("skipped: " + missing())
        return SKIPPED
    for name, width, height in (("desktop", 1440, 1000), ("narrow", 500, 900)):
        browser = open_browser(width, height)
        browser.set_script_timeout(60)
        begin = time.monotonic()
        browser.get(arguments.report.absolute().as_uri())
        expect(browser.execute_script("return document.documentElement.dataset.ready") == "yes", f"the page did not come up: {errors_of(browser)}")
        print(f"{name}: usable after {browser.execute_script('return performance.now()') / 1000:.2f} s ({time.monotonic() - begin:.2f} s with the driver)")
        for theme in ("light", "dark"):
            browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": theme}]})
            time.sleep(0.3)
            if arguments.screenshots:
                arguments.screenshots.mkdir(parents=True, exist_ok=True)
                size = browser.execute_cdp_cmd("Page.getLayoutMetrics", {})["cssContentSize"]
                shot = browser.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "clip": {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}})
                (arguments.screenshots / f"{name}-{theme}.png").write_bytes(base64.b64decode(shot["data"]))
                if name == "desktop" and theme == "light":
                    pdf = browser.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})
                    (arguments.screenshots / "print.pdf").write_bytes(base64.b64decode(pdf["data"]))
            check_accessibility(browser)
        if name == "desktop":
            use_controls(browser)
        errors = errors_of(browser)
        browser.quit()
        expect(not errors, f"console: {errors[:5]}")
    print("every control did something; no console error")
    return 0


if __name__ == "__main__":
    sys.exit(main())
