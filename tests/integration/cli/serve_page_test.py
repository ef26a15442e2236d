"""The page of `serve` in a browser: a board is changed by dragging, by keys and by switches, and each figure
is that of `run`."""

import functools
import json
import os
import pathlib
import re
import shlex
import signal
import subprocess
import tempfile
import unittest

import program
from browser import Browser
from program import ProgramTest, run
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

ALL_FIGURES = {"preloaded": "core", "camera": "steady"}
# From the paper's board to two banks: each buffer with its bank.
MOVES = [("left_image[0]", "bank1"), ("left_image[1]", "bank1"), ("right_image[0]", "bank1"),
         ("right_image[1]", "bank1"), ("disparity[0]", "bank1"), ("disparity[1]", "bank1"),
         ("left_lut", "bank0"), ("right_lut", "bank0")]
SWITCHES = [("fpga.tables", "joint"), ("fpga.pixel_cache", "word")]
# What the preset sdram has, too.
SDRAM = {"cas_latency": "2", "row_words": "256", "internal_banks": "4", "activate_cycles": "1",
         "precharge_cycles": "1", "refresh_interval_cycles": "625", "refresh_cycles": "3"}
NASTY = "<img src=x onerror=hacked=1>"

# Texts whose colour is too near that of what lies behind them (WCAG 2.1, 1.4.3), outside of drawings.
FAINT = """
const channel = value => value <= 10.31 ? value / 3294.6 : ((value / 255 + 0.055) / 1.055) ** 2.4;
const light = ([r, g, b]) => 0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
const numbers = text => text.match(/[\\d.]+/g).map(Number);
const behind = element => {
  for (let each = element; each; each = each.parentElement) {
    const colour = numbers(getComputedStyle(each).backgroundColor);
    if (colour.length === 3 || colour[3] === 1) return colour;
  }
  return [255, 255, 255];
};
return [...document.querySelectorAll('main *')]
    .filter(each => !each.closest('svg') && each.checkVisibility() && !each.closest('[disabled]') &&
        [...each.childNodes].some(node => node.nodeType === 3 && node.textContent.trim()))
    .map(each => {
      const [a, b] = [numbers(getComputedStyle(each).color), behind(each)].map(light).sort((x, y) => y - x);
      return [(a + 0.05) / (b + 0.05), each.textContent.slice(0, 40)];
    }).filter(([ratio]) => ratio < 4.5);
"""


@functools.cache
def browser():
    downloads = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(downloads.cleanup)
    made = Browser(downloads.name)
    unittest.addModuleCleanup(made.quit)
    return made


class LiveTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.browser = browser()
        self.browser.errors()

    def tearDown(self):
        self.assertEqual(self.browser.errors(), [])
        super().tearDown()

    def served(self, *arguments):
        """The address of a page."""
        server = subprocess.Popen([program.PROGRAM, "serve", *map(str, arguments), "--folder", self.folder],
                                  stdout=subprocess.PIPE, text=True)

        def end():
            self.browser.driver.get("about:blank")
            server.send_signal(signal.SIGINT)
            self.assertEqual(server.wait(10), 0)
            server.stdout.close()

        self.addCleanup(server.kill)  # if it has not ended
        self.addCleanup(end)
        return server.stdout.readline().split()[-1]

    def output(self, *arguments):
        process = run(*arguments)
        self.assertEqual(process.returncode, 0, process.stderr)
        return process.stdout

    def becomes(self, address):
        """Waits until the page shows the board of this address."""
        self.browser.until(f"return decodeURIComponent(location.hash) === {json.dumps(address)}")
        self.browser.settled()

    def opened(self, *arguments, width=1500, height=1800):
        self.browser.visit(self.served(*arguments), width, height)

    def value(self, source):
        return float(self.browser.run(
            "return document.querySelector(`#figures [data-source=${arguments[0]}] dd`).dataset.value",
            source))

    def is_as_run(self, view="preloaded"):
        """The command of the page has its figures."""
        command = self.browser.text("#command code")
        words = shlex.split(command)
        self.assertEqual(words[:2], ["stereotlm", "run"])
        found = json.loads(self.output(*words[1:], "--json"))
        self.assertEqual(self.value(view), found["frames_per_second"][ALL_FIGURES[view]], command)
        return found

    def set(self, path, value):
        self.browser.choose(f"key-{path}", value)
        self.browser.settled()

    def drag(self, buffer, bank):
        handle = self.browser.one(f'.buffer[data-key="allocation.{buffer}"] .handle')
        self.browser.run("arguments[0].scrollIntoView({block: 'center'})", handle)
        target = self.browser.one("#new-bank" if bank is None else f"#bank-{bank}")
        chain = ActionChains(self.browser.driver, duration=20)
        chain.click_and_hold(handle).move_by_offset(6, 6).move_to_element(target).perform()
        self.browser.drawn()
        chain = ActionChains(self.browser.driver, duration=20)
        chain.release().perform()
        self.browser.settled()

    def carry(self, buffer, bank):
        """The same by keys alone."""
        self.browser.run("document.querySelector(arguments[0]).focus()",
                         f'.buffer[data-key="allocation.{buffer}"]')
        self.browser.keys(Keys.ENTER)
        for _ in range(20):
            if re.search(rf": (not into )?{bank}\b", self.browser.text("#chart-status")):
                break
            self.browser.keys(Keys.ARROW_UP)
        self.browser.keys(Keys.ENTER)
        self.browser.settled()
        focused = self.browser.run("return document.activeElement.dataset.key")
        self.assertEqual(focused, f"allocation.{buffer}")  # so that the next key goes on from there

    def address(self):
        return self.browser.run("return location.hash")

    def holders(self):
        """bank -> its buffers."""
        return self.browser.run(
            "return Object.fromEntries([...document.querySelectorAll('.block[id^=bank-]')].map(bank => "
            "[bank.id.slice(5), [...bank.querySelectorAll('.buffer')]"
            ".map(each => each.dataset.key.slice('allocation.'.length))]))")


@program.slow
class Change(LiveTest):
    def test_two_banks_by_dragging_and_two_switches(self):
        self.opened()
        self.is_as_run()
        first = self.address()
        rates = [self.value("preloaded")]
        for buffer, bank in MOVES:
            with self.subTest(buffer=buffer):
                if bank == "bank1" and buffer == "left_image[1]":
                    continue  # it is there
                self.drag(buffer, bank)
                if buffer == "right_lut":  # the bank is too small for two tables
                    self.assertIn("set fpga.tables to joint", self.browser.text("#message"))
                    continue
                self.assertIn(buffer, self.holders()[bank])
                self.is_as_run()
                rates.append(self.value("preloaded"))
        self.assertLess(rates[-1], 18)
        for path, value in SWITCHES:
            self.set(path, value)
            self.is_as_run()
        self.assertEqual(self.holders()["bank0"], ["left_lut"])  # the joint table
        self.assertAlmostEqual(self.value("preloaded"), 18.596, 3)
        self.browser.choose("view", "camera")
        self.browser.settled()
        self.is_as_run("camera")
        self.browser.choose("view", "preloaded")
        self.browser.settled()
        self.browser.screenshot("live_two_banks")
        last, rate = self.address(), self.value("preloaded")
        address = self.browser.run("return location.href")
        for _ in range(len(rates) + len(SWITCHES)):
            self.browser.click("#undo")
        self.browser.settled()
        self.assertEqual((self.address(), self.value("preloaded")), (first, rates[0]))
        self.assertFalse(self.browser.one("#undo").is_enabled())
        ActionChains(self.browser.driver).key_down(Keys.CONTROL).send_keys("y").key_up(Keys.CONTROL).perform()
        self.becomes("#board=fpl2003&allocation.left_image=[bank1,+bank1]")
        self.assertEqual(self.value("preloaded"), rates[1])
        # An address without a board, and the link, in another page of the same browser.
        self.browser.driver.switch_to.new_window("tab")
        self.browser.visit(re.sub("#.*", "#board=", address))
        self.assertEqual(self.address(), first)
        self.browser.driver.get("about:blank")
        self.browser.visit(address, 1500, 1800)
        self.assertEqual((self.address(), self.value("preloaded")), (last, rate))
        self.browser.driver.close()
        self.browser.driver.switch_to.window(self.browser.driver.window_handles[0])

    def test_the_same_by_keys(self):
        self.opened()
        for buffer, bank in MOVES:
            if buffer not in self.holders()[bank]:
                self.carry(buffer, bank)
        for path, value in SWITCHES:
            self.browser.run("document.getElementById(arguments[0]).closest('details').open = true; "
                             "document.getElementById(arguments[0]).focus()", f"key-{path}")
            self.browser.keys(value)
        self.browser.until("return !document.querySelector('.refused')")
        self.browser.settled()
        self.assertAlmostEqual(self.value("preloaded"), 18.596, 3)
        self.assertEqual(sum(map(bool, self.holders().values())), 2)

    def test_a_drag_shows_what_it_would_give_and_keeps_nothing(self):
        self.opened(width=1400, height=1300)  # as in sw/report/live_board.md
        self.browser.screenshot("live", whole=False)
        before = self.address(), self.value("preloaded")
        self.browser.run("document.querySelector('#bank-bank4').scrollIntoView({block: 'center'})")
        handle = self.browser.one('.buffer[data-key="allocation.left_lut"] .handle')
        chain = ActionChains(self.browser.driver, duration=20)
        chain.click_and_hold(handle).move_by_offset(6, 6)
        chain.move_to_element(self.browser.one("#bank-bank0")).perform()
        self.browser.until("return Number(document.querySelector('#figures dd').dataset.value) < 15")
        self.assertIn("Links that change, MB/s: left_lut – bank6 159.0 → 0.0",
                      self.browser.text("#chart-changes"))
        self.browser.keys(Keys.ESCAPE)
        ActionChains(self.browser.driver).release().perform()
        self.browser.settled()
        self.assertEqual((self.address(), self.value("preloaded")), before)
        self.drag("left_lut", "bank0")
        self.browser.run("document.querySelector('#bank-bank0').scrollIntoView({block: 'center'})")
        self.browser.screenshot("live_drag", whole=False)

    def test_a_bank_that_refuses_the_held_buffer_stays_under_the_pointer(self):
        self.opened("fpl2003", "--set", "allocation.left_lut=bank0")
        place = "return document.querySelector('#bank-bank0').getBoundingClientRect().top + scrollY"
        before = self.browser.run(place)
        handle = self.browser.one('.buffer[data-key="allocation.right_lut"] .handle')
        chain = ActionChains(self.browser.driver, duration=20).click_and_hold(handle)
        chain.move_by_offset(6, 6).move_to_element(self.browser.one("#bank-bank0")).perform()
        self.browser.until("return document.querySelector('.refused')")
        self.assertIn("set fpga.tables to joint", self.browser.text("#chart-status"))
        self.assertEqual(self.browser.run(place), before)
        self.browser.keys(Keys.ESCAPE)
        ActionChains(self.browser.driver).release().perform()
        self.browser.settled()
        self.assertEqual(self.browser.all(".refused"), [])

    def test_a_joint_table_is_dragged_as_one(self):
        self.opened("two-banks")
        self.drag("left_lut", None)
        self.assertEqual(self.holders()["bank2"], ["left_lut"])
        self.is_as_run()

    def test_lanes_in_the_whole_computer(self):
        self.opened("eight-banks-four-lanes")
        self.browser.choose("view", "camera")
        self.browser.settled()
        self.is_as_run("camera")
        self.assertNotIn("NaN", self.browser.text("#cards"))

    def test_banks_are_added_removed_and_changed(self):
        self.opened()
        self.drag("left_lut", None)
        self.assertEqual(self.holders()["bank8"], ["left_lut"])
        self.is_as_run()
        self.browser.run("document.querySelector('[data-group=\"ssram.banks.bank6\"]').open = true")
        self.browser.click('[data-group="ssram.banks.bank6"] button')
        self.browser.settled()
        self.assertNotIn("bank6", self.holders())
        self.is_as_run()
        self.browser.click("#add-bank")
        self.browser.settled()
        self.assertEqual(self.holders()["bank9"], [])
        self.set("ssram.banks.bank0.kind", "sync_burst")
        self.is_as_run()

    def test_a_refused_board_says_why_beside_its_key(self):
        self.opened()
        self.browser.choose("key-matcher.disparities", "300")
        self.browser.until("return document.querySelector('#message').textContent")
        self.assertIn("matcher.disparities = 300: 1..254", self.browser.text("#message"))
        self.assertEqual(self.browser.text('[data-key="matcher.disparities"] .bad'), "1..254")
        self.assertEqual(self.value("preloaded"), 18.595863536115026)
        self.set("matcher.disparities", "")  # that of the preset
        self.assertEqual((self.browser.text("#message"), self.address()), ("", "#board=fpl2003"))
        self.set("matcher.disparities", "")
        self.assertEqual(self.browser.run("return document.getElementById('key-matcher.disparities').value"),
                         "80")
        self.browser.choose("key-name", NASTY)
        self.browser.until("return document.querySelector('#message').textContent || "
                           "document.querySelector('.top b').textContent.includes('<')")
        self.assertIsNone(self.browser.run("return window.hacked ?? null"))

    def test_a_bank_becomes_sdram_by_its_keys(self):
        self.opened()
        bank = "ssram.banks.bank0"
        self.browser.choose(f"key-{bank}.kind", "sdram")
        for key, value in SDRAM.items():  # refresh_cycles is missing once there is an interval
            self.browser.until(f"return document.querySelector('[data-key=\"{bank}.{key}\"] .bad')"
                               "?.textContent.startsWith('missing: ')")
            self.browser.choose(f"key-{bank}.{key}", value)
        self.browser.settled()
        self.is_as_run()
        filled = self.address()
        mark = "return document.querySelector('#figures .stale .state')?.textContent"  # at once
        self.assertEqual(self.browser.run(f"document.getElementById('undo').click(); {mark}"), " …")
        self.browser.until("return document.querySelector('#message').textContent")
        last = f"return document.getElementById('key-{bank}.refresh_cycles')?.value"
        self.assertEqual(self.browser.run(last), "")
        self.set(f"{bank}.kind", "qdr")  # what was set for the other kind goes
        self.assertEqual((self.address(), self.browser.run(last)), (f"#board=fpl2003&{bank}.kind=qdr", None))
        link = re.sub("#.*", f"#board=fpl2003&{bank}.kind=sdram", self.browser.run("return location.href"))
        self.browser.driver.get("about:blank")
        self.browser.driver.get(link)
        self.browser.until("return document.querySelector('.key button')")
        self.browser.click(f'[data-key="{bank}.kind"] button')
        self.becomes(filled)

    def test_stripes_of_a_buffer_change_places(self):
        self.opened("fpl2003", "--set", "allocation.left_lut={rows: [bank6, bank5]}")
        self.drag("left_lut.rows[0]", "bank5")
        self.becomes("#board=fpl2003&allocation.left_lut={rows:+[bank5,+bank6]}")
        self.is_as_run()

    def test_differences_from_a(self):
        self.opened()
        self.browser.click("#pin")
        self.set("matcher.rows", "2")
        self.assertEqual(self.browser.text("#figures .difference"), "A: 18.60, +13.94")
        table = {row["figure"]: row for row in self.browser.table("differences")}
        self.assertEqual(table["cycles"]["A"], "12,906,000")
        self.assertIn("A: 159.0 MB/s", self.browser.run(
            "return document.querySelector('#edge-left_lut-bank6').getAttribute('aria-label')"))


@program.slow
class Ask(LiveTest):
    def test_gains_and_apply(self):
        self.opened()
        self.browser.click("#explain")
        self.browser.choose("view", "camera")
        self.browser.until("return document.querySelector('#best-changes')", 60)
        self.assertIn("for the core alone", self.browser.text("#best-changes .note"))
        self.browser.choose("view", "preloaded")
        self.browser.settled()
        row = self.browser.run("return [...document.querySelectorAll('#best-changes tbody tr')]"
                               ".map(row => row.textContent)")[1]
        self.assertIn("matcher.rows: 1 → 2", row)
        rate = float(re.search(r"2(\d+\.\d\d)", row)[1])
        self.assertTrue(self.browser.all("#knobs"))
        self.browser.run("document.querySelector('#best-changes tbody tr:nth-child(2) button').click()")
        self.browser.settled()
        self.assertEqual(self.address(), "#board=fpl2003&matcher.rows=2")
        self.assertAlmostEqual(self.value("preloaded"), rate, 2)

    def test_gains_end_with_a_change_of_the_board(self):
        self.opened()
        self.browser.choose("view", "camera")
        self.browser.click("#explain")
        self.browser.until("return document.querySelector('#gains progress')", 20)
        self.set("matcher.rows", "2")
        self.browser.until("return document.querySelector('#gains').textContent.includes('ask again')", 20)
        self.browser.settled()
        self.assertFalse(self.browser.all("#gains progress"))
        self.assertIn("ask again", self.browser.text("#gains"))

    def test_a_sweep_of_two_keys_whose_points_open(self):
        self.opened()
        self.browser.click("#to-sweep")
        for number, (path, values) in enumerate([("matcher.window", "5, 7"), ("matcher.rows", "1,2")], 1):
            self.browser.choose(f"sweep-key-{number}", path)
            self.browser.choose(f"sweep-values-{number}", values)
        self.browser.click("#start-sweep")
        self.browser.until("return document.querySelector('#points tbody tr')", 60)
        self.assertEqual(len(self.browser.all("#points tbody tr")), 4)
        self.browser.run("document.querySelector('#points button[data-row]').click()")
        self.browser.click("#open-point")
        self.becomes("#board=fpl2003&matcher.window=5&matcher.rows=2")
        self.is_as_run()
        self.browser.click("#to-sweep")  # no figure differs
        self.browser.choose("sweep-key-1", "matcher.rows")
        self.browser.click("#start-sweep")
        self.assertIn("two different ones", self.browser.text("#message"))
        self.browser.choose("sweep-key-1", "name")
        self.browser.choose("sweep-values-1", "a, b")
        self.browser.choose("sweep-key-2", "")
        self.browser.click("#start-sweep")
        self.browser.until("return document.querySelectorAll('#points tbody tr').length === 2", 60)
        self.browser.drawn()

    def test_a_scene_with_its_truth(self):
        board = ["fpl2003-qvga", "--set", "matcher.disparities=32"]
        self.opened(*board)
        self.browser.click("#to-pictures")
        self.browser.click("#show-scene")
        self.browser.until("return document.querySelector('#truth')", 60)
        found = json.loads(self.output("run", *board, "--synthetic", "1", "--source", "preloaded", "--json"))
        self.assertIn(f"{found['disparities_percent']:.2f} % of the pixels",
                      self.browser.text("#tab-pictures [role=status]"))
        self.assertIn(f"{found['accuracy']['bad_1_percent']:.2f} % are off by more than 1",
                      self.browser.text("#tab-pictures [role=status]"))

    def test_files(self):
        (self.folder / "mine.yaml").write_text("extends: fpl2003\nname: mine\nmatcher: {window: 5}\n")
        self.opened("fpl2003", "--set", "matcher.rows=2")
        self.browser.choose("boards", "./mine.yaml")
        self.becomes("#board=fpl2003&name=mine&matcher.window=5")
        self.browser.run("document.querySelector('#save').closest('details').open = true")
        self.browser.choose("save-name", "other.yaml")
        self.browser.click("#save")
        self.browser.until("return document.querySelector('#saved').textContent")
        self.assertEqual(json.loads(self.output("check", self.folder / "other.yaml", "--json"))["window"], 5)
        self.browser.choose("save-name", "mine.yaml")
        self.browser.click("#save")
        self.browser.until("return document.querySelector('#message').textContent")
        self.assertIn("mine.yaml", self.browser.text("#message"))
        self.browser.click("#report")
        page = self.browser.downloaded("report.html")
        self.browser.open(page)
        self.assertIn("25.98 frames/s", self.browser.text("h1"))

    def test_a_run_and_a_database(self):
        out = self.folder / "points.db"
        plan = self.folder / "plan.yaml"
        plan.write_text("board: fpl2003\nrun: {source: preloaded}\nvary: {matcher.window: [5, 7]}\n")
        self.output("sweep", plan, "--out", out)
        self.opened(out)
        self.browser.run("document.querySelector('#points button[data-row]').click()")
        self.browser.click("#open-point")
        self.becomes("#board=fpl2003&matcher.window=5")
        out = self.folder / "run"
        self.output("run", "two-banks", "--timing-only", "--source", "preloaded", "--out", out)
        self.opened(out)
        self.assertEqual(self.address(), "#board=two-banks")


@program.slow
class Look(LiveTest):
    def test_at_all_widths_light_and_dark(self):
        address = self.served()
        self.browser.visit(address)
        for width in (390, 820, 1280, 2560):
            for theme in ("light", "dark"):
                with self.subTest(width=width, theme=theme):
                    self.browser.visit(address, width)
                    self.browser.choose("theme", theme)
                    self.browser.drawn()
                    wide = self.browser.run("return document.documentElement.scrollWidth")
                    self.assertLessEqual(wide, width)
                    self.assertEqual(self.browser.run(FAINT), [])
                    self.browser.screenshot(f"live_{width}_{theme}")

    def test_every_control_has_a_name(self):
        self.opened()
        self.browser.run("for (const each of document.querySelectorAll('details')) each.open = true")
        for tab in ("board", "pictures", "sweep"):
            self.browser.click(f"#to-{tab}")
            nodes = self.browser.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
            roles = {"button", "textbox", "combobox", "spinbutton", "searchbox", "slider", "checkbox", "tab",
                     "progressbar", "img", "Canvas"}
            unnamed = [node["role"]["value"] for node in nodes if not node["ignored"]
                       and node["role"]["value"] in roles and not node.get("name", {}).get("value")]
            self.assertEqual(unnamed, [])
            self.assertEqual(self.browser.violations(), [])


program.main()
