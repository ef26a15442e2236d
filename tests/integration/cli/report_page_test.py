"""The pages of `report` in a browser: every chart shown, used and read back."""

import contextlib
import csv
import functools
import html
import io
import json
import math
import re
import shlex
import sqlite3
import tempfile
import time
import unittest

import program
from browser import Browser, number
from plots import draw, make_database
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run, sets, shared_folder
from report_data import data_of, with_data
from selenium.common.exceptions import WebDriverException
from selenium.webdriver.common.keys import Keys

SCENE = [*SMALL, "--synthetic", "1"]
SHARED = sets("allocation.left_lut=bank0")
UNWANTED = (r"stall|refused|knob|\bpaint|counted|all together|places of|heavy "
            r"frame|blocked|starved|passed|10\^")
NASTY = "<script>hacked=1</script><img src=x onerror=hacked=1> \"q\" 'a' $x & {{y}}"
NASTY_FOLDER = "<img src=x onerror=hacked=1> \"q\" 'a' $x & y"


@functools.cache
def browser():
    downloads = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(downloads.cleanup)
    made = Browser(downloads.name)
    unittest.addModuleCleanup(made.quit)
    return made


def made(process):
    assert process.returncode == 0, process.stderr


@functools.cache
def shared_run(name, *arguments):
    out = shared_folder() / name
    made(run("run", "fpl2003", *SCENE, *arguments, "--out", out))
    return out


@functools.cache
def core():
    """A run of the core alone, in which left_lut waits in every second frame."""
    return shared_run("core", *PRELOADED, *SHARED, "--frames", "4")


@functools.cache
def computer():
    return shared_run("computer", *CAMERA_RATES, *SHARED, "--frames", "6")


def two_computers():
    """That computer behind one in which left_lut has a bank of its own."""
    return shared_run("plain_computer", *CAMERA_RATES, "--frames", "6"), computer()


@functools.cache
def page_of(*inputs):
    out = shared_folder() / ("_".join(path.name.replace(".", "_") for path in inputs) + ".html")
    made(run("report", *inputs, "--out", out))
    return out


@functools.cache
def database():
    plan = shared_folder() / "plan.yaml"
    plan.write_text(
        "board: fpl2003\n"
        "run: {source: preloaded}\n"
        "set: {image.width: 32, image.height: 24}\n"
        "vary:\n"
        "  matcher.window: [3, 5, 7]\n"
        "  matcher.disparities: [8, 12, 16, 20]\n"
        "  matcher.fetch: [column, line_buffer]\n"
        "  allocation.left_lut: [bank6, bank0]\n"
        "  matcher.filter: [none, log7, {kernel: [[0, 0, 0], [1, -2, 1], [0, 0, 0]], shift: 0}]\n"
    )
    out = shared_folder() / "points.db"
    made(run("sweep", plan, "--out", out))
    return out


class PageTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.browser = browser()
        self.browser.errors()

    def tearDown(self):
        self.assertEqual(self.browser.errors(), [])
        super().tearDown()

    def opened(self, page, change):
        """Opens the page with data that `change(data)` has changed."""
        data = data_of(page)
        change(data)
        self.browser.open(with_data(page, data, self.folder / "page.html"))

    def selected_points(self):
        return int(self.browser.text("#front-text").split()[0])

    def charts(self):
        return [card.get_attribute("id") for card in self.browser.all("section.card")]

    def answer(self, question):
        texts = self.browser.run(
            "return [...document.querySelectorAll('.answers > div')]"
            ".find(each => each.firstChild.textContent === arguments[0]).textContent", question)
        return texts.removeprefix(question).replace("\u00a0", " ")

    def rows_by_name(self, chart):
        return {row["name"]: row for row in self.browser.table(chart)}


class EveryChart(PageTest):
    """At both widths, light and dark."""

    CHARTS = {
        "core": "memory bounds roofline banks blame ports rows picture frames knobs area audit configuration",
        "computer": "memory bounds roofline banks blame ports rows picture frames time latency knobs area "
        "audit configuration",
        "two": "rows picture frames blame memory ports-A ports-B settings totals",
        "database": "scatter chosen filters parallel points constants",
    }

    def test_is_drawn_at_both_widths_and_in_both_themes(self):
        pages = {
            "core": page_of(core()),
            "computer": page_of(computer()),
            "two": page_of(shared_run("plain", *PRELOADED, "--frames", "4"), core()),
            "database": page_of(database()),
        }
        for name, page in pages.items():
            for width, theme in ((390, "light"), (390, "dark"), (1280, "light"), (1280, "dark"),
                                 (2560, "light")):
                with self.subTest(page=name, width=width, theme=theme):
                    self.browser.open(page, width, theme)
                    self.assertEqual(self.charts(), self.CHARTS[name].split())
                    self.assertEqual(self.browser.violations(), [])
                    self.is_whole(width, theme)
                    self.browser.screenshot(f"{name}_{width}_{theme}")

    def is_whole(self, width, theme):
        self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), width)
        self.assertEqual(self.browser.run("return document.documentElement.dataset.theme"), theme)
        empty = "return [...document.querySelectorAll('.plot')].filter(plot => !plot.firstChild).length"
        self.assertEqual(self.browser.run(empty), 0)
        outside = (
            "return [...document.querySelectorAll('.plot svg text')].filter(text => {"
            " const box = text.getBoundingClientRect();"
            " const card = text.closest('.card').getBoundingClientRect();"
            " return box.width && (box.left < card.left - 1 || box.right > card.right + 1);"
            "}).map(text => text.textContent)"
        )
        self.assertEqual(self.browser.run(outside), [])
        self.reads_well()
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('svg [d*=NaN], svg [cx=NaN], "
                                          "svg [points*=NaN], svg [x=NaN], svg [width=NaN]')].length"), 0)

    def reads_well(self):
        """One word for a thing, one style of numbers, no full stop in a title."""
        texts = self.browser.run(
            "return [...document.querySelectorAll('dd, h2, section .note, .legend, .plot text, .memory "
            "text')].map(element => element.textContent)"
        )
        for text in texts:
            self.assertNotRegex(text.lower(), UNWANTED)
            self.assertNotRegex(text, r"(?<![\d.,_])\d,\d{3}(?![,\d])", "grouped below 10,000")
            self.assertNotRegex(text, r"(?<![\d.,_/])\d{5}", "not grouped")
        for title in self.browser.run("return [...document.querySelectorAll('h1, h2')].map(each => "
                                      "each.textContent)"):
            self.assertFalse(title.endswith("."), title)

    def test_tells_its_numbers_to_the_keyboard(self):
        self.browser.open(page_of(computer()))
        for chart in "bounds roofline banks blame ports rows frames time latency knobs area memory".split():
            with self.subTest(chart=chart):
                marks = f"#{chart} .mark"
                self.browser.run("document.querySelector(arguments[0]).focus()", marks)
                first = self.browser.text("#tooltip")
                self.assertNotEqual(first, "")
                self.assertFalse(self.browser.run("return document.getElementById('tooltip').hidden"))
                if len(self.browser.all(marks)) > 1:
                    self.browser.keys(Keys.ARROW_RIGHT)
                    self.assertNotEqual(self.browser.text("#tooltip"), first)
                self.browser.keys(Keys.ESCAPE)
                self.assertTrue(self.browser.run("return document.getElementById('tooltip').hidden"))

    def test_is_there_in_print_too(self):
        self.browser.open(page_of(core()), theme="dark")
        self.browser.run("dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(self.browser.run("return document.documentElement.dataset.theme"), "light")
        self.assertGreater(len(self.browser.driver.print_page()), 100000)


class Numbers(PageTest):
    """What the page shows is what the files hold."""

    def test_of_a_run_equal_stats_json(self):
        for folder in (core(), computer()):
            stats = self.stats(folder)
            self.browser.open(page_of(folder))
            for chart, list_name in (("ports", "ports"), ("banks", "banks")):
                shown = self.rows_by_name(chart)
                self.assertEqual(list(shown), [item["name"] for item in stats[list_name]])
                for item in stats[list_name]:
                    for key, text in shown[item["name"]].items():
                        if key != "name":
                            self.assertEqual(number(text), item[key], (chart, item["name"], key))
            causes = lambda rows, read: sorted(
                (row["port"], row["bank"], row["by"], read(row["cycles"])) for row in rows
            )
            self.assertEqual(causes(self.browser.table("blame"), number), causes(stats["blame"], float))
            frames = self.browser.table("frames")
            self.assertEqual([number(row["cycles"]) for row in frames], stats["frame_cycles"])
            rows = self.browser.table("rows")
            self.assertEqual(sum(number(row["cycles"]) for row in rows), stats["cycles"])
            for row in stats["blame"]:
                column = f"{row['port']} on {row['bank']} for {row['by']}"
                if column in rows[0]:  # not the host, whose traffic is divided
                    self.assertEqual(sum(number(line[column]) for line in rows), row["cycles"])
            self.assertIn("identities hold", self.browser.text("#audit h2"))

    def test_of_the_time_line_equal_what_the_run_has_recorded(self):
        self.browser.open(page_of(computer()))
        for chart, name in (("time", "timeline.csv"), ("latency", "latency.csv")):
            recorded = list(csv.DictReader(io.StringIO((computer() / name).read_text())))
            if chart == "latency":
                recorded.sort(key=lambda row: int(row["latency_ps"]))
            shown = list(csv.DictReader(io.StringIO(self.browser.csv(chart))))
            none = lambda row: {key: "-1" if value == "" and "frame" in key else value
                                for key, value in row.items()}
            self.assertEqual(shown, [none(row) for row in recorded])

    def test_of_a_database_equal_the_database(self):
        page = page_of(database())
        self.browser.open(page)
        stored = sqlite3.connect(database())
        stored.row_factory = sqlite3.Row
        points = list(stored.execute("SELECT * FROM points ORDER BY hash"))
        text = self.browser.csv("points")
        rows = list(csv.DictReader(io.StringIO(text)))
        self.assertEqual(len(rows), len(points))
        names = [name for name in rows[0] if name in points[0].keys()]
        self.assertGreater(len(names), 20)
        plain = lambda value: "" if value is None else value if isinstance(value, str) else float(value)
        read = lambda text, value: text if isinstance(value, str) or value is None else float(text)
        expected = sorted([plain(point[name]) for name in names] for point in points)
        found = sorted([read(row[name], points[0][name]) for name in names] for row in rows)
        self.assertEqual(found, expected)
        name = "banks.bank0.utilization"  # not in the data: follows from busy_cycles
        self.assertEqual(sorted(float(row[name]) for row in rows), sorted(point[name] for point in points))


class Lanes(PageTest):
    """Of four lanes a side, whose ports are one row until the page is asked for every lane."""

    def page(self):
        out = shared_folder() / "lanes"
        if not out.exists():
            made(run("run", "eight-banks-four-lanes", *SCENE, *PRELOADED, "--frames", "2", "--record",
                     "--out", out))
        return page_of(out), json.loads((out / "stats.json").read_text())

    def follow(self, text):
        """Follows the link to the other view, and waits until the page is loaded again and has this text."""
        self.browser.one("#lanes a").click()
        end = time.monotonic() + 20
        is_loaded = False
        while not is_loaded:
            self.assertLess(time.monotonic(), end)
            with contextlib.suppress(WebDriverException):  # a call while the page is replaced
                is_loaded = bool(self.browser.all("footer")) and text in self.browser.text("#lanes")
        self.browser.drawn()

    def test_are_one_row_with_their_mean(self):
        page, stats = self.page()
        self.browser.open(page)
        ports = {row["name"]: row for row in self.browser.table("ports")}
        self.assertEqual(list(ports), "left_lut right_lut left_pixel right_pixel result host".split())
        for name, row in ports.items():
            lanes = [port for port in stats["ports"] if port["name"].split(".")[0] == name]
            self.assertEqual(len(lanes), 1 if name in ("result", "host") else 4)
            for key in ("grants", "stall_cycles", "starved_cycles"):
                mean = sum(port[key] for port in lanes) / len(lanes)
                self.assertAlmostEqual(number(row[key]), mean, places=6)
        for chart in ("bounds", "blame", "rows"):
            self.assertNotRegex(self.browser.text(f"#{chart}"), r"(lut|pixel)\.\d")
        self.assertEqual({text.text for text in self.browser.all("#blame tr:last-child td")}, {"✓"})

    def test_are_a_row_each_if_asked_for(self):
        page, stats = self.page()
        self.browser.open(page)
        self.follow("Each of the 4 lanes")
        names = [row["name"] for row in self.browser.table("ports")]
        self.assertEqual(names, [port["name"] for port in stats["ports"]])
        self.assertIn("left_pixel.3", names)
        self.follow("one row, with the mean")


class Drawing(PageTest):
    """Bars, dots and cells are as long, high and far as their numbers say."""

    def boxes(self, selector):
        return self.browser.run("return [...document.querySelectorAll(arguments[0])]"
                                ".map(each => each.getBoundingClientRect().toJSON())", selector)

    def test_bars_of_a_port_are_its_states_one_behind_the_other(self):
        self.browser.open(page_of(core()))
        stats = self.stats(core())
        names = ["grants", "stall_cycles", "passed_cycles", "blocked_cycles", "starved_cycles", "idle_cycles"]
        lane = self.boxes("#ports .lane")[0]
        bars = iter(self.boxes("#ports .bar-part"))
        for port in stats["ports"]:
            begin = lane["left"]
            for name in names:
                if port[name]:
                    bar = next(bars)
                    self.assertAlmostEqual(bar["left"], begin, delta=1.5)
                    begin += lane["width"] * port[name] / stats["cycles"]
                    self.assertAlmostEqual(bar["right"], begin, delta=1.5)
            self.assertAlmostEqual(begin, lane["right"], delta=0.1)

    def test_dots_ticks_and_the_present_rate_share_a_logarithmic_scale(self):
        self.browser.open(page_of(core()))
        rates = [number(row["frames_per_second"]) for row in self.browser.table("bounds")]
        dots = [(box["left"] + box["right"]) / 2 for box in self.boxes("#bounds .dot")]
        place = lambda rate: dots[0] + (dots[-1] - dots[0]) * math.log(rate / rates[0], rates[-1] / rates[0])
        self.assertGreater(dots[-1] - dots[0], 200)
        for dot, rate in zip(dots, rates, strict=True):
            self.assertAlmostEqual(dot, place(rate), delta=1.5)
        now = place(self.stats(core())["frames_per_second"]["core"])
        self.assertAlmostEqual(self.boxes("#bounds .now-line")[0]["left"], now, delta=1.5)
        labels = self.boxes("#bounds .bars-axis span")
        texts = self.browser.run("return [...document.querySelectorAll('#bounds .bars-axis span')]"
                                 ".map(each => each.textContent)")
        self.assertGreater(len(labels), 2)
        for text, label, line in zip(texts, labels, self.boxes("#bounds .tick-line"), strict=True):
            tick = place(float(text.replace("k", "e3")))
            self.assertAlmostEqual((label["left"] + label["right"]) / 2, tick, delta=1.5)
            self.assertAlmostEqual(line["left"], tick, delta=1.5)


class Database(PageTest):
    def setUp(self):
        super().setUp()
        self.browser.open(page_of(database()))
        self.size = sqlite3.connect(database()).execute("SELECT count(*) FROM points").fetchone()[0]

    def rows(self, chart):
        """Those of the CSV of a chart."""
        return list(csv.DictReader(io.StringIO(self.browser.csv(chart))))

    def test_is_brushed_in_the_scatter_and_along_an_axis(self):
        self.assertEqual(self.selected_points(), self.size)
        self.browser.drag("#scatter .brush-xy", (0.01, 0.02), (0.6, 0.98))
        part = self.selected_points()
        self.assertGreater(part, 0)
        self.assertLess(part, self.size)
        self.browser.drag("#parallel .brush-y", (0.5, 0.02), (0.5, 0.45))
        self.assertLess(self.selected_points(), part)
        self.assertEqual({row["allocation.left_lut"] for row in self.rows("points")}, {"bank6"})
        self.browser.button("filters", "Select all points")
        self.assertEqual(self.selected_points(), self.size)

    def test_is_filtered_by_values(self):
        self.browser.click("#filters input[data-key='matcher.window'][data-value='7']")
        self.assertEqual(self.selected_points(), self.size * 2 // 3)
        self.assertEqual({row["matcher.window"] for row in self.rows("points")}, {"3", "5"})
        self.browser.click("#filters input[data-key='matcher.window'][data-value='7']")
        self.assertEqual(self.selected_points(), self.size)

    def test_gives_the_board_of_a_point_on_the_front_and_in_the_table(self):
        stored = sqlite3.connect(database())
        boards = {config for (config,) in stored.execute("SELECT config FROM points")}
        seen = set()
        front = self.browser.all("#scatter .on-front")
        self.browser.run("arguments[0].focus()", front[0])
        self.browser.keys(Keys.ENTER)
        seen.add(self.browser.text("#board pre"))
        last = self.browser.all("#scatter .on-front")[-1]
        self.browser.run("arguments[0].dispatchEvent(new MouseEvent('click'))", last)
        seen.add(self.browser.text("#board pre"))
        for row in range(self.size):
            found = self.browser.all(f"#points button[data-row='{row}']")
            if found:
                self.browser.run("arguments[0].click()", found[0])
                seen.add(self.browser.text("#board pre"))
        self.assertLessEqual(seen, boards)
        self.assertGreater(len(seen), 90)
        config = self.file("point.yaml", self.browser.text("#board pre"))
        self.succeeds(run("check", config))

    def test_shows_other_columns_and_sorts_by_them(self):
        drawn = lambda: self.browser.run("return document.querySelector('#scatter canvas').toDataURL()")
        before = drawn()
        self.browser.choose("scatter-x", "matcher.filter")
        self.browser.choose("scatter-colour", "matcher.disparities")
        self.browser.drawn()
        self.assertNotEqual(drawn(), before)
        self.browser.run("document.querySelectorAll('#points button.sort')[1].click()")
        self.browser.run("document.querySelectorAll('#points button.sort')[1].click()")
        cells = self.browser.cells("#points tbody tr", 2)
        self.assertEqual([number(cell) for cell in cells], sorted(number(cell) for cell in cells))


class Rates(PageTest):
    """Rates that tie, and what sets their bounds. The page and `plot` have the same front."""

    HEADER = ["name", "run.source", "allocation.left_lut", "allocation.left_image", "area.slices",
              "area.slices_percent", "lost_pixels", "frames_per_second.core",
              "frames_per_second.steady",
              "frames_per_second.steady_uncertainty", "bound.core_limited_by", "bound.system_limited_by",
              "bound.system"]

    def open(self, *points):
        """A database of points (slices, banks, steady rate, its uncertainty, % of the slices, lost
        pixels)."""
        rows = []
        whole = [(*point, point[0] / 300, 0)[:6] for point in points]
        for slices, banks, rate, uncertainty, percent, pixels in whole:
            pictures = "[" + ", ".join(f"bank{i}" for i in range(1, banks)) + "]"
            limits = ("bank bank0", "camera" if rate > 29 else "bank bank0")
            rows.append(("made", "camera", "bank0", pictures, slices, percent, pixels, 99, rate, uncertainty,
                         *limits,
                         31))
        self.store = make_database(self.folder / "made.db", self.HEADER, rows)
        self.succeeds(run("report", self.store, "--out", self.folder / "made.html"))
        self.browser.open(self.folder / "made.html")

    def fronts(self, *axes):
        """That of the page and that of `plot`, each from left to right."""
        for name, axis in zip("xyz", axes):
            column, sense = axis.split(":")
            self.browser.choose(f"scatter-{name}", column)
            self.browser.choose(f"best-{name}", sense)
        shown = list(csv.DictReader(io.StringIO(self.browser.csv("scatter"))))
        _, drawn, _ = draw("pareto", self.store, pareto=",".join(axes))
        return [sorted((float(row["area.slices"]), float(row["frames_per_second.steady"])) for row in rows)
                for rows in (shown, [row for row in drawn if row["front"] == "1"])]

    def test_within_the_uncertainty_tie_and_the_cheapest_is_named(self):
        slow, best, worse = (5000, 3, 20, 0.1), (22500, 8, 30.003, 0.002), (14000, 4, 29.99, 0.0001)
        same, twin, cheap = (14000, 8, 30, 0.002), (14000, 8, 30.0012, 0), (14100, 7, 30.0012, 0)
        self.open(slow, best, worse, same, twin, cheap, (14200, 7, 30.0025, 0.002))
        self.assertEqual(self.browser.text("h1"), "7 points: at most 30.00 frames/s, steady")
        fastest = self.answer("Which is the fastest?")
        self.assertTrue(fastest.startswith("30.00 frames/s, steady: "), fastest)
        self.assertIn("left_image [bank1, bank2, bank3, bank4, bank5, bank6].", fastest)
        self.assertIn("5 points tie within the uncertainty of their rates. "
                      "This is the cheapest: 7 banks, 14,100 slices.", fastest)
        front = sorted((slices, rate) for slices, _, rate, _ in (slow, same, twin))
        for axes in (("area.slices:min", "frames_per_second.steady:max"),
                     ("frames_per_second.steady:max", "area.slices:min")):
            self.assertEqual(self.fronts(*axes), [front, front])
            self.assertIn("What lies within the uncertainty ties.", self.browser.text("#front-text"))
        page, plot = self.fronts(*axes, "area.slices_percent:max")
        self.assertEqual(page, plot)
        self.assertGreater(len(page), len(front))

    def test_of_boards_that_do_not_fit_or_lose_pixels_are_not_the_fastest(self):
        self.open((14000, 8, 20, 0.5), (14000, 8, 30, 0, 101), (14000, 8, 30, 0, 99, 4))
        self.assertTrue(self.answer("Which is the fastest?").startswith("20.00 ± 0.50 frames/s, steady."))

    def test_that_lose_pixels_say_so_wherever_they_stand(self):
        self.open((14000, 8, 30, 0, 50, 4444), (14100, 7, 31, 0, 50, 5555))
        loss = ", while captures lose 4444 pixels"
        marks = self.browser.run("return [...document.querySelectorAll('#scatter .on-front')]"
                                 ".map(each => each.getAttribute('aria-label')).join()")
        self.assertIn(f"frames_per_second.steady 30{loss}", marks)
        self.assertIn("lost in 2 of the points (×), 2 of the front.", self.browser.text("#front-text"))
        self.browser.run("document.querySelectorAll('#points button[data-row]')[1].click()")
        self.assertIn(f"frames_per_second.steady30{loss}", self.browser.text("#board"))
        self.assertEqual(self.browser.text("h1"), "2 points: at most 31.00 frames/s, steady, while captures "
                         "lose 5555 pixels; pixels are lost in 2 of them")

    def test_of_computers_have_the_bound_of_the_computer_if_they_reach_it(self):
        lossy = (14000, 8, 31, 0, 50, 7)
        self.open((14000, 8, 30.9, 0), (5000, 8, 20, 0.5), (5001, 8, 30.8, 0.5), (5002, 8, 19, 0.5), lossy)
        self.assertEqual(self.answer("What limits?"), "Below all bounds in 3 points, at the bound of the "
                         "cameras in 1, pixels are lost in 1.")

    def test_on_the_front_are_joined_by_steps(self):
        self.open((14000, 8, 30, 0), (9000, 8, 25, 0), (5000, 8, 20, 0))
        places = lambda script: [tuple(float(each) for each in pair) for pair in self.browser.run(script)]
        line = places("return document.querySelector('#scatter .front').getAttribute('points').split(' ')"
                      ".map(pair => pair.split(','))")
        spots = places("return [...document.querySelectorAll('#scatter .on-front')]"
                       ".map(spot => [spot.getAttribute('cx'), spot.getAttribute('cy')])")
        corners = [(after[0], before[1]) for before, after in zip(spots, spots[1:])]
        self.assertEqual(len(corners), 2)
        self.assertLessEqual({*spots, *corners}, set(line))
        for before, after in zip(line, line[1:]):
            self.assertTrue(before[0] == after[0] or before[1] == after[1], line)

    def test_of_one_point_or_none_are_shown(self):
        self.open((14000, 8, 30, 0))
        self.assertEqual(self.browser.text("h1"), "1 point: at most 30.00 frames/s, steady")
        self.assertEqual(self.answer("What limits?"), "Below all bounds in 1 point.")
        plan = self.file("plan.yaml", "board: fpl2003\nset: {matcher.fetch: line_buffer}\n"
                         "vary: {matcher.rows: [2, 3]}\n")
        self.succeeds(run("sweep", plan, "--out", self.folder / "none.db"))
        self.succeeds(run("report", self.folder / "none.db", "--out", self.folder / "none.html"))
        self.browser.open(self.folder / "none.html")
        self.assertEqual(self.browser.text("h1"), "2 points: none has a rate")


class Tools(PageTest):
    """Zoom, sliders and search."""

    def picture(self):
        return self.browser.all("#picture .picture")[0].screenshot_as_base64

    def test_rows_are_zoomed_by_brush_and_buttons(self):
        self.browser.open(page_of(core()))
        shown = lambda: self.browser.text("#rows .controls .note")
        self.assertEqual(shown(), "rows 0 to 23")
        self.browser.drag("#rows .brush-y", (0.5, 0.26), (0.5, 0.74))
        self.assertEqual(shown(), "rows 6 to 17")
        self.browser.button("rows", "Zoom in")
        self.assertEqual(shown(), "rows 9 to 14")
        self.browser.button("rows", "All rows")
        self.assertEqual(shown(), "rows 0 to 23")
        self.browser.button("rows", "Zoom in")
        for rows in ("rows 3 to 14", "rows 0 to 11", "rows 0 to 11"):
            self.browser.button("rows", "Up")
            self.assertEqual(shown(), rows)

    def test_the_longest_wait_in_the_rows_shown_is_traced_by_the_command(self):
        self.browser.open(page_of(core()))
        command = lambda: shlex.split(self.browser.text("#rows .command code"))
        self.assertRegex(command()[-1], r"^frame=\d+,rows=0\.\.23,longest-wait$")
        self.browser.drag("#rows .brush-y", (0.5, 0.26), (0.5, 0.74))
        words = command()
        self.assertRegex(words[-1], r"^frame=\d+,rows=6\.\.17,longest-wait$")
        self.succeeds(run(*words[1:], cwd=self.folder))
        text = (self.folder / "waits.vcd").read_text()
        self.assertIn("swaits ", text)
        times = [int(line[1:]) for line in text.splitlines() if line.startswith("#")]
        self.assertIn((times[-1] - times[0]) / 25000, range(61, 100))
        self.browser.open(page_of(shared_run("alone", *PRELOADED)))
        self.assertEqual(self.browser.all("#rows .command"), [])

    def test_the_time_line_shows_where_the_page_has_no_events(self):
        def change(data):
            recording = data["run"]["recording"]
            end = max(row[5] for row in recording["events"]["rows"])
            recording["events"].update(periods_ps=[[0, end // 4], [end // 2, end]], all=9999)

        self.opened(page_of(computer()), change)
        self.browser.button("time", "All")
        self.assertIn("of 9999 events", self.browser.text("#time"))
        box = "return document.querySelector(arguments[0]).getBoundingClientRect().width"
        self.assertAlmostEqual(self.browser.run(box, "#time .left-out") * 4,
                               self.browser.run(box, "#time .brush-x"), delta=8)

    def test_a_part_of_a_run_has_the_work_and_the_waits_of_that_part(self):
        title = lambda: self.browser.text("#time h2")
        self.browser.open(page_of(computer()))
        whole = title()

        def change(data):
            stats = data["run"]["stats"]
            stats.update(frames=100 * stats["frames"], cycles=100 * stats["cycles"])

        self.opened(page_of(computer()), change)
        self.assertEqual(title(), whole)
        self.assertIn("The first 6 of 600 frames are recorded.", self.browser.text("#time"))

    def test_sliders_move_the_picture_and_the_overlay(self):
        self.browser.open(page_of(computer()))
        self.browser.drawn()
        states = [self.picture()]
        for slider, value in (("split", 0), ("split", 100), ("overlay", 100), ("overlay", 0)):
            self.browser.choose(f"picture-{slider}", value)
            states.append(self.picture())
            if slider == "split":
                there = self.browser.run(
                    "const box = document.querySelector('#picture .picture').getBoundingClientRect();"
                    "return document.elementsFromPoint(box.x + box.width / 2, box.y + box.height / 2)"
                    ".filter(each => each.matches('.picture canvas:not(.overlay)')).length")
                self.assertEqual(there, 2 - value // 100)
        self.assertEqual(len(set(states)), 5)
        self.browser.run("document.querySelector('#picture .picture').focus()")
        self.browser.keys(Keys.ARROW_DOWN)
        self.assertIn("row 13", self.browser.text("#tooltip"))

    def test_waits_are_shown_without_pixels_too(self):
        def change(data):
            del data["run"]["pictures"]
            recording = data["run"]["recording"]
            recording["tiles"] = {"columns": 10, "rows": 10, "width": 4, "height": 3}
            for each in recording["stalls"]:
                each["tiles"] = [1] * 100

        self.opened(page_of(computer()), change)
        self.browser.drawn()
        wide = self.browser.run("return [...document.querySelectorAll('#picture canvas')]"
                                ".filter(each => !each.hidden).map(each => each.offsetWidth)")
        self.assertEqual([round(width / wide[0], 1) for width in wide], [1, round(40 / 32, 1)])
        states = [self.picture()]
        self.browser.choose("picture-overlay", 100)
        self.assertNotEqual(self.picture(), states[0])
        self.assertEqual(self.browser.all("#picture-split"), [])

    def test_the_memory_charts_of_two_runs_change_places(self):
        self.browser.open(page_of(shared_run("plain", *PRELOADED, "--frames", "4"), core()))
        links = lambda: self.browser.run(
            "return [...document.querySelectorAll('#memory svg:not([hidden]) .edge')].map(edge => edge.id)")
        self.assertIn("edge-left_lut-bank6", links())
        self.browser.choose("memory-run", 1)
        self.assertIn("edge-left_lut-bank0", links())
        rows = {row["link"]: row for row in self.browser.table("memory")}
        self.assertEqual(rows["left_lut – bank6"]["megabytes_per_second_b"], "0")
        self.assertEqual(rows["left_lut – bank0"]["megabytes_per_second_a"], "0")

    def test_keys_are_searched(self):
        self.browser.open(page_of(core()))
        self.browser.choose("search-keys", "left_lut")
        keys = self.browser.cells("#configuration .scroll tbody tr", 0)
        self.assertIn("allocation.left_lut", keys)
        self.assertLess(len(keys), 8)

    def test_charts_that_are_left_out_say_why(self):
        without = lambda data: [data["run"].pop(key) for key in ("recording", "knobs")]
        self.opened(page_of(computer()), without)
        for chart, option in (("rows", "--no-record"), ("time", "--no-record"), ("knobs", "--quick")):
            self.assertIn(option, self.browser.text(f"#{chart}"))
            self.assertEqual(self.browser.all(f"#{chart} svg"), [])


class Answers(PageTest):
    """What the head of the page says; the data are changed to what is asked."""

    def opened(self, folder, change):
        super().opened(page_of(folder), lambda data: change(data["run"]))

    def test_the_port_that_waits_most_in_all_is_the_first(self):
        def change(run):
            cause = lambda port, bank, by, share: {"port": port, "bank": bank, "by": by,
                                                   "cycles": share * run["stats"]["cycles"] / 100}
            run["stats"]["blame"] = [
                cause("right_lut", "bank2", "result", 3.2), cause("right_lut", "bank2", "host", 2.9),
                cause("left_pixel", "bank0", "host", 3.3), cause("result", "bank2", "host", 0.2),
                cause("result", "bank1", "host", 0.3), cause("right_lut", "bank2", "turnaround", 0.01)]
            del run["recording"]

        self.opened(core(), change)
        first = "right_lut waits in 6.1 % of all cycles: 3.2 % for result, 2.9 % for host and less, on bank2"
        self.assertEqual(self.answer("Who waits for whom?"),
                         f"{first}.Then left_pixel 3.3 %, for host on bank0; result 0.5 %, mostly for host "
                         f"on bank1.")
        self.assertEqual(self.browser.text("#blame h2"), first)

    def test_few_tiles_with_half_of_the_waits_are_named(self):
        def change(run):
            recording = run["recording"]
            recording["tiles"] = {"columns": 10, "rows": 10, "width": 4, "height": 3}
            recording["stalls"] = recording["stalls"][:1]
            recording["stalls"][0]["tiles"] = few * [100 - few] + (100 - few) * [few]

        for few, text in ((34, "Over all columns; half of all waits are in 34 % of the picture."),
                          (35, "Over all columns.")):
            self.opened(core(), change)
            self.assertIn(text, self.answer("Where in the picture?"))

    def test_a_rate_above_its_bound_is_at_it_within_its_uncertainty(self):
        def change(run):
            run["stats"]["frames_per_second"].update(steady=60.22, steady_uncertainty=0.222)
            run["stats"]["bound"].update(system=60, system_limited_by="camera")
            run.pop("knobs")

        self.opened(computer(), change)
        text = ("60.22 ± 0.22 frames/s, steady: at the bound of 60.00 frames/s, which the cameras set, "
                "within its uncertainty")
        self.assertEqual(self.browser.text("h1"), text)
        self.assertIn(f"with --quick: only how far the lowest bound is.{text}.", self.answer("What limits?"))

    def steps(self, *changed):
        """Changes the steps of a run to these: (key, from, to, gain in %, what else differs from the
        board)."""

        def change(run):
            board = run["knobs"]
            board["changes"] = [
                {**board, "key": key, "from": before, "to": to, "changes_disparities": False,
                 "frames_per_second": board["frames_per_second"] * (1 + gain / 100),
                 "uncertainty_frames_per_second": 0,
                 "gained_frames_per_second": 1, "gained_percent": gain, "idle_banks": [],
                 "new_banks": 0, "sets": [f"{key}={to}"], **more,
                 "area": {**board["area"], **more.get("area", {})}}
                for key, before, to, gain, more in changed
            ]

        return change

    def test_the_first_change_needs_nothing_new(self):
        slices = lambda more, percent: {"area": {
            "slices": self.area["slices"] + more, "slices_percent": self.area["slices_percent"] + percent}}
        self.area = data_of(page_of(core()))["run"]["knobs"]["area"]
        large = ("matcher.rows", "1", "2", 40, slices(6016, 17.8))
        largest = ("matcher.fetch", "column", "line_buffer", 40, slices(9830, 29.1))
        kind = ("ssram.banks.*.kind", "zbt_pipelined", "qdr", 6, {})
        bank = ("a bank more", "right_lut in bank2", "in one of its own", 4.6, {"idle_banks": ["bank4"]})
        joint = ("fpga.tables", "separate", "joint in bank3", 4.6, slices(22, 0.1))
        self.opened(core(), self.steps(largest, large, kind, joint, bank))
        self.assertRegex(self.answer("What to change first?"),
                         r"^right_lut: bank2 → bank4 gives .* frames/s, core only \(\+4\.6 %\)\.Now: .*"
                         r"\.To try it: .*\."
                         r"Named are only changes that keep .* and more than the uncertainty\."
                         r"The largest gain: matcher\.rows: 1 → 2 gives .* "
                         r"\(\+40\.0 %\)\. It needs \+6016 slices \(\+17\.8 % of the FPGA\)\.$")
        self.assertTrue(self.answer("What does it cost?").startswith(
            "The first change takes nothing new: it uses bank4, which holds nothing."))
        self.opened(core(), self.steps(kind, ("a bank more", "right_lut in bank2", "", 4.6, {"new_banks": 1}),
                                       ("fpga.clock_mhz", "40", "41", 2, {"clock_mhz": 41}),
                                       ("matcher.window", "7", "5", 2, {"changes_disparities": True})))
        self.assertTrue(self.answer("What to change first?").startswith(
            "ssram.banks.*.kind: zbt_pipelined → qdr gives"))
        self.assertIn("takes other memory chips.", self.answer("What does it cost?"))
        self.assertEqual(self.browser.text("#knobs h2"),
                         "First: ssram.banks.*.kind: zbt_pipelined → qdr, +6.0 %")
        open_rate = 0.03 * data_of(page_of(core()))["run"]["knobs"]["frames_per_second"]
        for gain, more in ((0.9, {}), (2.9, {"uncertainty_frames_per_second": open_rate}),
                           (5, {"key": "a bank less"}), (5, {"loses_pixels": True})):
            self.opened(core(), self.steps(("fpga.arbitration", "age", "round_robin", gain, more)))
            self.assertTrue(self.answer("What to change first?").startswith("Nothing.Now: "), more)

    def test_a_bank_less_does_not_mend_the_loss_of_pixels(self):
        def change(run):
            run["knobs"]["loses_pixels"] = True
            whole = {"loses_pixels": False}
            self.steps(("a bank less", "bank3", "bank2", 0.2, whole), ("fpga.clock_mhz", "8", "9", 5, {}),
                       *[("capture.fifo_words", "64", "128", -1, whole)][:cures])(run)

        for cures, text in ((0, r"None of the changes ends the loss of pixels\.Now: "),
                            (1, r"capture.fifo_words: 64 → 128 gives .* \(−1.0 %\), and loses no "
                                r"pixels\.Now: .* while captures lose pixels\.")):
            self.opened(computer(), change)
            self.assertRegex(self.answer("What to change first?"), f"^{text}")

    def test_a_bank_is_told_from_a_part_of_its_name(self):
        names = sets("ssram.banks={matcher: {}, camera: {}, pci: {}}",
                     "allocation={left_image: matcher, right_image: camera, disparity: [pci, pci], "
                     "left_lut: matcher, right_lut: camera}")
        self.browser.open(page_of(shared_run("names", *PRELOADED, *names, "--frames", "2")))
        self.assertIn("bank matcher", self.answer("What limits?"))
        self.assertIn("for left_pixel on bank matcher", self.answer("Who waits for whom?"))
        for chart in ("bounds", "banks", "blame", "roofline", "memory"):
            self.assertIn("bank matcher", self.browser.text(f"#{chart}"), chart)
        self.assertRegex(self.browser.text("#bounds"), r"bank camera[\d.]+\s*matcher[\d.]+\s*left_lut")

    def test_small_changes_are_folded(self):
        self.opened(core(), self.steps(*(("matcher.rows", "1", str(i), gain, {}) for i, gain in
                                         enumerate((5, 0.11, 0.09, 0.049, 0, -0.049, -0.09, -0.11)))))
        self.assertEqual(len(self.browser.all("#knobs .mark")), 3)
        self.assertEqual(self.browser.text("#fold-changes"), "▸ 5 changes that gain or lose less than 0.1 %")
        self.browser.click("#fold-changes")
        gains = self.browser.run("return [...document.querySelectorAll('#knobs .mark')]"
                                 ".map(each => each.getAttribute('aria-label').match(/\\((.*?)\\)/)[1])")
        self.assertEqual(gains, ["+5.0 %", "+0.1 %", "+0.1 %", "≈ 0", "≈ 0", "≈ 0", "−0.1 %", "−0.1 %"])

    def test_the_core_says_when_it_waits(self):
        recorded = list(csv.DictReader(io.StringIO((computer() / "timeline.csv").read_text())))
        first = min(int(row["start_ps"]) for row in recorded if row["kind"] == "frame")
        waits = [row for row in recorded if (row["kind"], row["class"]) == ("wait", "core")]
        early = sum(int(row["end_ps"]) - int(row["start_ps"]) for row in waits if int(row["end_ps"]) <= first)

        def change(run):
            run["recording"]["waits"] = [{"class": "core", "why": "capture", "ps": early + 3 * 10**9}]

        self.opened(computer(), change)
        self.assertIn(" % because the capture of the next pair runs", self.browser.text("#time h2"))
        ms = f"{early / 1e9:.{1 if early >= 1e8 else 2}f}"
        self.assertIn(f"The core waits {ms} ms before its first frame, and 3.0 ms later.",
                      self.browser.text("#time .note"))


class TwoRuns(PageTest):
    def test_lead_with_the_change_and_have_the_words_of_one_run(self):
        a, b = two_computers()
        data = data_of(page_of(a, b))
        data["difference"]["settings"].insert(0, {"path": "name", "a": "fpl2003", "b": "another name"})
        data["difference"]["verdict"] = "in B left_lut waits 123456 cycles a frame more"
        self.browser.open(with_data(page_of(a, b), data, self.folder / "page.html"))
        (rate_a, rate_b) = (self.stats(folder)["frames_per_second"]["steady"] for folder in (a, b))
        self.assertRegex(self.browser.text("h1"), rf"^{rate_b:.1f}( ± .*)? frames/s, steady, instead of "
                         rf"{rate_a:.1f}( ± .*)? \(−.*\), with 7 banks instead of 8, .* pins instead of ")
        self.assertEqual(self.answer("What was changed?"),
                         "allocation.left_lut: bank6 → bank0name: fpl2003 → another name")
        self.assertIn("in B left_lut waits 123,456 cycles a frame more",
                      self.answer("Which is faster, and why?"))
        self.assertIn("% for host capture", self.answer("Who waits for whom?"))
        self.assertIn("host capture", {row["by"] for row in self.browser.table("blame")})
        frame = data["difference"]["camera_frame"]
        self.assertIn(f"Camera frame {frame} in both.", self.browser.text("#picture .note"))

    def test_within_the_uncertainty_have_no_gain(self):
        def change(data):
            for run_data, rate in zip(data["runs"], (20, 20.5)):
                run_data["stats"]["frames_per_second"].update(steady=rate, steady_uncertainty=0.25)

        self.opened(page_of(*two_computers()), change)
        self.assertTrue(self.browser.text("h1").startswith(
            "The same 20.50 ± 0.25 frames/s, steady, within the uncertainty, with 7 banks instead of 8, "))

        data = data_of(page_of(*two_computers()))
        data["runs"][1]["stats"]["cameras"][0]["dropped_pixels"] = 12345
        self.browser.open(with_data(page_of(*two_computers()), data, self.folder / "page.html"))
        self.assertIn("steady, while captures lose 12,345 pixels, instead of", self.browser.text("h1"))

    def test_name_banks_of_one_run_in_one_line(self):
        few = sets("ssram.banks={bank0: {}, bank1: {}, bank2: {}}", "allocation={left_lut: bank2, right_lut: "
                   "bank2, left_image: bank0, right_image: bank1, disparity: bank2}")
        a, b = shared_run("core1", *PRELOADED), shared_run("few", *PRELOADED, *few)
        self.browser.open(page_of(a, b))
        self.assertRegex(self.browser.text("h1"), r"3 banks instead of 8, \d+ pins instead of \d+")
        banks = "bank3, bank4, bank5, bank6, bank7"
        self.assertIn(f"banks only in A{banks}", self.browser.text("#settings"))
        self.assertIn(f"\n  banks only in A: {banks}\n", self.succeeds(run("diff", a, b)))


class WithoutScripts(PageTest):
    def test_a_page_shows_what_the_commands_print(self):
        text = lambda *inputs: html.unescape(
            re.search("<noscript><pre>(.*?)</pre>", page_of(*inputs).read_text(), re.DOTALL)[1])
        told = text(computer())
        explained = json.loads(self.succeeds(run("explain", computer() / "config.yaml", "--json")))
        self.assertIn(f"limited by {explained['limited_by']}", " ".join(told.split()))
        self.browser.open(page_of(computer()))
        self.assertTrue(self.answer("What limits?").startswith(f"Limited by {explained['limited_by']}."))
        for change in explained["changes"]:
            star = " *" if change["changes_disparities"] else ""
            self.assertIn(f"{change['key']}{star}: {change['from']} -> {change['to']}\n", told)
        self.assertRegex(told, r"\nsteady .* over 4 frames\n")
        self.assertIn(self.succeeds(run("diff", *two_computers())).split("\n\n")[-1], text(*two_computers()))


class Names(PageTest):
    """Names of boards and paths are shown as text, and never run."""

    def is_harmless(self, *texts):
        self.assertIsNone(self.browser.run("return window.hacked ?? null"))
        self.assertEqual(len(self.browser.all("script")), 2)
        self.assertEqual(self.browser.all("img"), [])
        for text in texts:
            self.assertIn(text, self.browser.text("main"))

    def test_of_a_run(self):
        out = self.folder / NASTY_FOLDER
        text = "name=" + json.dumps(NASTY)
        self.succeeds(run("run", "fpl2003", *SCENE, *PRELOADED, "--set", text, "--out", out))
        page = self.folder / f"{NASTY_FOLDER}.html"
        self.succeeds(run("report", out, "--out", page))
        self.browser.open(page)
        self.is_harmless(NASTY, NASTY_FOLDER)
        self.assertIn(NASTY[:8], self.browser.text("#memory svg"))
        self.succeeds(run("report", out, out, "--out", page))
        self.browser.open(page)
        self.is_harmless(NASTY_FOLDER)

    def test_of_a_database(self):
        plan = self.file("plan.yaml", "board: fpl2003\nset: {image.width: 32, image.height: 24, name: %s}\n"
                         "vary: {matcher.window: [3, 5]}\n" % json.dumps(NASTY))
        out = self.folder / f"{NASTY_FOLDER}.db"
        self.succeeds(run("sweep", plan, "--out", out))
        page = self.folder / "page.html"
        self.succeeds(run("report", out, "--out", page))
        self.browser.open(page)
        self.browser.run("document.querySelector('#points button[data-row]').click()")
        self.is_harmless(NASTY, NASTY_FOLDER)


if __name__ == "__main__":
    program.main()
