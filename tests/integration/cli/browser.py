"""A page of `report` in a browser without a window: Debian's chromium, driven by selenium."""

import contextlib
import os
import pathlib
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

AXE = pathlib.Path(os.environ.get("STEREOTLM_AXE", "/usr/share/nodejs/axe-core/axe.min.js"))


def number(text):
    return float(text.replace(",", "").replace("−", "-").replace(" %", "").replace("+", ""))


class Browser:
    def __init__(self, downloads):
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.downloads = pathlib.Path(downloads)
        self.driver.execute_cdp_cmd(
            "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(downloads)}
        )

    def quit(self):
        self.driver.quit()

    def open(self, path, width=1280, theme="light"):
        """Opens a page, and waits until it is drawn."""
        metrics = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        begin = time.monotonic()
        self.driver.get(pathlib.Path(path).resolve().as_uri())
        while not self.all("footer") and time.monotonic() < begin + 10:
            pass  # the page waits until its data is unpacked
        self.drawn()
        self.choose("theme", theme)
        self.drawn()

    def visit(self, address, width=1280, height=900):
        """Opens the live page, and waits until its figures are there."""
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        self.driver.get(address)
        self.settled()

    def settled(self, timeout=30):
        """Waits until the live page shows all figures and charts of its board."""
        end = time.monotonic() + timeout
        while self.run("return !document.querySelector('#cards > *') || "
                       "(document.querySelector('.stale') && !document.querySelector('.refused'))"):
            if time.monotonic() > end:
                raise AssertionError("the live page still waits: " + self.text("#message"))
            time.sleep(0.02)
        self.drawn()

    def until(self, script, timeout=30):
        """Waits until a script returns something."""
        end = time.monotonic() + timeout
        while not self.run(script):
            if time.monotonic() > end:
                raise AssertionError(f"this does not come: {script}")
            time.sleep(0.02)

    def downloaded(self, name):
        """The path of a file, once it is there."""
        end = time.monotonic() + 10
        while not (self.downloads / name).exists() and time.monotonic() < end:
            time.sleep(0.05)
        return self.downloads / name

    def drawn(self):
        """Waits for two frames of the screen."""
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));"
        )

    def errors(self):
        """What the console has said since the last call."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def violations(self):
        """What axe-core finds, where it is installed."""
        return self.driver.execute_async_script(
            AXE.read_text() + "; const done = arguments[0]; axe.run().then(all => done("
            "all.violations.map(each => [each.id, each.nodes[0].html])))") if AXE.exists() else []

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def all(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def one(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def cells(self, rows, place):
        """The texts of one column of some rows."""
        return self.run(
            "return [...document.querySelectorAll(arguments[0])]"
            ".map(row => row.cells[arguments[1]].textContent)",
            rows,
            place,
        )

    def text(self, selector):
        return self.run("return document.querySelector(arguments[0]).textContent", selector)

    def choose(self, name, value):
        self.run(
            "const box = document.getElementById(arguments[0]); box.value = arguments[1];"
            "box.dispatchEvent(new Event('input')); box.dispatchEvent(new Event('change'));",
            name,
            value,
        )

    def click(self, selector):
        """By the keyboard's way: no other element may lie above it."""
        element = self.one(selector)
        self.run("arguments[0].scrollIntoView({block: 'center'})", element)
        element.click()
        self.drawn()

    def button(self, chart, label):
        """Clicks the button of a chart with this label or name."""
        for button in self.all(f"#{chart} button"):
            if label in (button.text, button.get_attribute("aria-label")):
                self.run("arguments[0].scrollIntoView({block: 'center'})", button)
                button.click()
                self.drawn()
                return
        raise AssertionError(f"no button {label} in {chart}")

    def table(self, chart):
        """The rows of the table of a chart, as dictionaries of texts."""
        self.button(chart, "Table")
        rows = self.run(
            "return [...document.querySelectorAll('#' + CSS.escape(arguments[0]) + ' .numbers tr')]"
            ".map(row => [...row.cells].map(cell => cell.textContent))",
            chart,
        )
        self.button(chart, "Table")
        return [dict(zip(rows[0], row)) for row in rows[1:]]

    def csv(self, chart):
        """The text of the CSV of a chart."""
        with contextlib.suppress(FileNotFoundError):
            (self.downloads / f"{chart}.csv").unlink()
        self.button(chart, "CSV")
        return self.downloaded(f"{chart}.csv").read_text()

    def drag(self, selector, start, end, steps=4):
        """Drags over an element, from one place to another; places are shares of its width and height."""
        element = self.one(selector)
        self.run("arguments[0].scrollIntoView({block: 'center'})", element)
        box = self.run("return arguments[0].getBoundingClientRect().toJSON()", element)
        at = [
            (box["width"] * (start[0] + (end[0] - start[0]) * i / steps - 0.5),
             box["height"] * (start[1] + (end[1] - start[1]) * i / steps - 0.5))
            for i in range(steps + 1)
        ]
        chain = ActionChains(self.driver, duration=10)
        chain.move_to_element_with_offset(element, *map(int, at[0])).click_and_hold()
        for place in at[1:]:
            chain.move_to_element_with_offset(element, *map(int, place))
        chain.release().perform()
        self.drawn()

    def keys(self, *keys):
        chain = ActionChains(self.driver, duration=10)
        for key in keys:
            chain.send_keys(key)
        chain.perform()
        self.drawn()

    def screenshot(self, name, whole=True):
        """Saves the whole page, or its window, if STEREOTLM_SCREENSHOTS names a folder."""
        folder = os.environ.get("STEREOTLM_SCREENSHOTS")
        if folder and not whole:
            self.driver.save_screenshot(f"{folder}/{name}.png")
        elif folder:
            size = self.run("return [innerWidth, document.documentElement.scrollHeight]")
            metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": False}
            self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
            self.drawn()
            self.driver.save_screenshot(f"{folder}/{name}.png")
