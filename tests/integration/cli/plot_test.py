"""plot: the figures of a sweep and their data."""

import math
import pathlib
import random
import re
import shutil
import sqlite3
import subprocess
import xml.etree.ElementTree

import program
from pictures import PYTHON, drawn
from plots import ALLOCATIONS, ENDINGS, LANES, SCRIPTS, SMALL_BOARD, WINDOWS
from plots import PlotTest, change, make_database, reader, script
from program import PRELOADED, SMALL, run

SIZES = [3, 5, 7]
PLAN = SMALL_BOARD + f"""
vary:
  matcher.window: {SIZES}
  matcher.disparities: [4, 8]
  matcher.fetch: [column, line_buffer]
  allocation.right_image: [[bank2, bank3], bank3]
"""
FAMILIES = 4  # of window: disparities and fetch; allocation.right_image leaves one possibility
STATES = ["grants", "passed_cycles", "stall_cycles", "blocked_cycles", "starved_cycles", "idle_cycles"]
# Small images of cameras that are too fast where the host comes last.
LOSING = """
board: fpl2003
run: {source: camera, frames: 7}
set:
  image.width: 64
  image.height: 32
  cameras.frame_rate_hz: 1000
  fpga.clock_mhz: 4
  allocation.left_image: [bank0, bank0]
  allocation.right_image: [bank1, bank1]
  capture.fifo_words: 16
  capture.fifo_trigger_words: 4
vary:
  fpga.priority: [[host, result, left_pixel, right_pixel, left_lut, right_lut],
                  [result, left_pixel, right_pixel, left_lut, right_lut, host]]
  matcher.window: [7, 9]
"""
HEADER = ["name", "run.source", "matcher.window"]
ALLOCATED = ["name", "run.source", "allocation.left_lut", "allocation.left_image"]
RATES = ["frames_per_second.core", "bound.core"]


class FigureTest(PlotTest):
    def database(self, store):
        """{hash: the row by column} and the blame."""
        connection = sqlite3.connect(store)
        connection.row_factory = sqlite3.Row
        rows = {row["hash"]: dict(row) for row in connection.execute("SELECT * FROM points")}
        blame = [tuple(row) for row in connection.execute("SELECT hash, port, bank, by, cycles FROM blame")]
        connection.close()
        return rows, blame

    def is_from(self, store, table, *more):
        """Every cell is the database's, but those of the columns `more`."""
        rows, _ = self.database(store)
        self.assertGreater(len(table), 0)
        for row in table:
            known = rows[row["hash"]]
            for column in set(row) - set(more):
                at = "ssram.banks.bank0." + column.rsplit(".", 1)[1] if "*" in column else column
                self.assertEqual(row[column], "" if known[at] is None else str(known[at]), column)

    def texts(self, name):
        """The words of a drawing."""
        return re.findall(r"<text[^>]*>([^<]*)</text>", (self.out / f"{name}.svg").read_text())

    def shows(self, name, *texts):
        self.assertLessEqual(set(texts), set(self.texts(name)))

    def curves(self, name, width="1.4"):
        """The data's lines of that width in a drawing: (x, y) each."""
        path = r'<path d="([^"]*)" clip-path="[^"]*" style="fill: none; [^"]*stroke-width: ([\d.]+)'
        found = re.findall(path, (self.out / f"{name}.svg").read_text())
        return [[tuple(map(float, pair)) for pair in re.findall(r"[ML] (\S+) (\S+)", line)]
                for line, found_width in found if found_width == width]

    def bounds(self, name):
        """The places of the marks of bounds in a drawing, without the legend: a list of (x, y) for each
        line."""
        groups = re.findall(r'<g id="bound">(.*?)</g>\n   </g>', (self.out / f"{name}.svg").read_text(),
                            re.DOTALL)
        return [[tuple(map(float, pair)) for pair in re.findall(r'<use [^>]*x="([^"]*)" y="([^"]*)"', group)]
                for group in groups if "clip-path" in group]

    def ranges(self, name):
        """The surfaces in a drawing, each as the set of its corners."""
        groups = re.findall(r'<g id="range">(.*?)</g>', (self.out / f"{name}.svg").read_text(), re.DOTALL)
        origins = [float(re.search(r'<use [^>]*x="0" y="([^"]*)"', group)[1]) for group in groups]
        return [{(float(x), float(y) + origin) for x, y in re.findall(r"[ML] (\S+) (\S+)", group)}
                for group, origin in zip(groups, origins)]


class Figures(FigureTest):
    def test_a_sweep_has_the_figures_that_apply_with_its_data(self):
        store = self.sweep(PLAN)
        said = self.succeeds(run("plot", store, "--out", self.out)).splitlines()
        self.assertEqual(said[0], f"{store}: 12 of 24 points; left out: 12 impossible")
        impossible = r"allocation.right_image = \[bank3\]: must be as long as left_image"
        self.assertRegex(said[1], rf"^  12 impossible: {impossible}")
        self.assertEqual(said[2:], [
            "window       12 points, 4 lines",
            "disparities  12 points, 6 lines",
            "rows         not drawn: all points have matcher.rows = 1",
            "units        not drawn: all points have matcher.units = all",
            "banks        not drawn: all points use 8 banks",
            "states       12 points, 5 ports",
            "stalls       not drawn: no port waits in any point",
            "use          12 points, 8 banks",
            "pareto       12 points, " + said[-2].split(", ")[1],
            f"{self.out}: 15 files: png, svg and csv of each figure that is drawn",
        ])
        names = ["window", "disparities", "states", "use", "pareto"]
        self.is_in(self.out, *(name + ending for name in names for ending in ENDINGS))
        note = "fpl2003, source preloaded: 12 of 24 points of points.db; not shown: 12 impossible."
        for width, height, white, colors in drawn(*(self.out / f"{name}.png" for name in names)):
            self.assertEqual(width, 1440)  # 7.2 inches
            self.assertTrue(300 <= height <= 3000, height)
            self.assertTrue(0.3 < white < 0.99, white)
            self.assertGreater(colors, 20)
        for name in names:
            with self.subTest(name):
                self.is_from(store, self.table(name), "port", *STATES, "front")
                self.assertEqual(len({row["hash"] for row in self.table(name)}), 12)
                self.shows(name, note)
        self.check_lines()
        rows, _ = self.database(store)
        for row in self.table("states"):
            for count in STATES:
                self.assertEqual(int(row[count]), rows[row["hash"]][f"ports.{row['port']}.{count}"])
        # The same bytes again; figures that do not apply any more go.
        with self.unchanged(self.out):
            (self.out / "banks.png").touch()
            self.succeeds(run("plot", store, "--out", self.out))
            self.assertFalse((self.out / "banks.png").exists())

    def check_lines(self):
        """One for each combination of the other keys, through the points of that combination alone."""
        fetches = ("matcher.fetch = column", "matcher.fetch = line_buffer")
        self.shows("window", "Frame rate against the size of the window", "window n, pixels (of n x n)",
                   "bound", *fetches, *map(str, SIZES))
        self.assertIn("core, frames/s", " ".join(self.texts("window")))
        for curves in (self.curves("window"), self.bounds("window")):
            self.assertEqual(len(curves), FAMILIES)
            for curve in curves:
                self.assertEqual(len(curve), len(SIZES))
                self.assertEqual(sorted({x for x, _ in curve}), [x for x, _ in curve])
        self.shows("disparities", "disparities D")
        self.assertIn("area, % of the slices", " ".join(self.texts("disparities")))
        self.assertEqual(len(self.curves("disparities")), 2 * 6)  # in two panels

    def test_the_lanes_of_a_port_are_one_with_their_mean(self):
        store = self.sweep(LANES)
        self.plot("all", store)
        rows, blame = self.database(store)
        states = self.table("states")
        self.assertEqual(len(states), 2 * 4)  # left_lut, both pixel ports, result
        for row in states:
            known = rows[row["hash"]]
            lanes = known["fpga.lanes"]
            names = [row["port"]]
            if lanes > 1 and row["port"] != "result":
                names = [f"{row['port']}.{lane}" for lane in range(lanes)]
            for count in ("grants", "passed_cycles", "stall_cycles", "starved_cycles"):
                mean = sum(known[f"ports.{name}.{count}"] for name in names) / len(names)
                self.assertAlmostEqual(float(row[count]), mean)
        means = {}
        for point, port, bank, by, cycles in blame:
            key = (point, port.split(".")[0], bank, by.split(".")[0])
            means[key] = means.get(key, 0) + cycles / (rows[point]["fpga.lanes"] if "." in port else 1)
        found = {(row["hash"], row["port"], row["bank"], row["by"]): float(row["cycles"])
                 for row in self.table("stalls")}
        self.assertEqual(set(found), set(means))
        for key, cycles in found.items():
            self.assertAlmostEqual(cycles, means[key])
        self.assertTrue(any("." in port for _, port, *_ in blame))

    def test_allocations_have_banks_stalls_and_a_front(self):
        store = self.sweep(ALLOCATIONS)
        said = self.plot("all", store)
        rows, blame = self.database(store)
        self.assertIn("banks        24 points, 2 lines\n", said)
        self.assertIn("window       not drawn: all points have matcher.window = 7\n", said)
        banks = self.table("banks")
        self.is_from(store, banks, "banks_used")
        for row in banks:
            allocation = [value for key, value in rows[row["hash"]].items() if key.startswith("allocation.")]
            self.assertEqual(int(row["banks_used"]), len(set(re.findall(r"bank\d", " ".join(allocation)))))

        stalls = self.table("stalls")
        shown = {row["hash"] for row in stalls}
        self.assertEqual(len(shown), 16)
        note = "fpl2003, source preloaded: 16 of 24 points of points.db; not shown: 8 with fewer waits."
        self.shows("stalls", note, "The 16 points whose ports wait most in a frame.",
                   "thousand cycles a frame in which the port waits", "for left_pixel")
        self.assertIn("disparity=[bank0,\N{NO-BREAK SPACE}bank0],", " ".join(self.texts("stalls")))
        found = [(row["hash"], row["port"], row["bank"], row["by"], int(row["cycles"])) for row in stalls]
        self.assertEqual(sorted(found), sorted(row for row in blame if row[0] in shown))
        stalls_of = {key: sum(row[4] for row in blame if row[0] == key) / rows[key]["frames"] for key in rows}
        least = min(stalls_of[key] for key in shown)
        self.assertLessEqual(max(stalls_of[key] for key in set(rows) - shown), least)

        self.plot("pareto", store, "--pareto", "banks_used:min,frames_per_second.core:max")
        table = self.table("pareto")
        self.is_from(store, table, "banks_used", "front")
        best = max(float(row["frames_per_second.core"]) for row in table)
        fastest = [row["front"] for row in table if float(row["frames_per_second.core"]) == best]
        self.assertIn("1", fastest)
        self.shows("pareto", "bound of a point of the front")

    def test_boards_of_one_frame_are_called_so(self):
        store = self.folder / "found.db"
        self.succeeds(run("allocate", "fpl2003", *SMALL, *PRELOADED, "--banks", 3, "--out", store))
        self.plot("banks", store)
        count = len(self.table("banks"))
        self.shows("banks", f"one frame of fpl2003, source preloaded: {count} of {count} points of found.db.")

    def test_an_allocation_that_loses_pixels_is_not_the_best(self):
        lost = ["cameras.left.dropped_pixels", "cameras.right.dropped_pixels"]
        header = [*ALLOCATED, *RATES, *lost]
        one, two, losing = (("made", "camera", lut, "[bank1]", rate, 13, 0, pixels)
                            for lut, rate, pixels in (("bank1", 8, 0), ("bank2", 10, 0), ("bank0", 12, 5)))
        heights = []
        for name, rows in (("losing", [one, two, losing]), ("whole", [one, two])):
            self.plot("banks", make_database(self.folder / f"{name}.db", header, rows))
            (((_, low), (_, high)),) = self.curves("banks")
            heights.append(low - high)
        self.assertAlmostEqual(*heights, places=3)

    def test_the_whole_computer_has_two_rates(self):
        store = self.sweep(WINDOWS.replace("preloaded", "camera, frames: 4"))
        self.plot("window", store)
        self.is_in(self.out, *("window" + ending for ending in ENDINGS))
        self.is_from(store, self.table("window"))
        rates = {"frames_per_second.steady", "frames_per_second.system", "bound.system", *RATES}
        self.assertLessEqual(rates, set(self.table("window")[0]))
        self.shows("window", "whole computer, steady frames/s", "from power-up, tables included")
        self.assertEqual((len(self.curves("window")), len(self.bounds("window"))), (2, 2))
        change(store, 'UPDATE points SET "bound.system" = 0.9 * "frames_per_second.steady" WHERE '
                      '"matcher.window" = 3')
        self.plot("window", store)
        self.shows("window", "Above the bound by no more than the uncertainty: 1 steady rate.")

    def test_points_that_lose_pixels_are_marked(self):
        store = self.sweep(LOSING)
        rows, _ = self.database(store)
        losing = {key for key, row in rows.items() if row["cameras.left.dropped_pixels"]}
        self.assertEqual(len(losing), 2)
        self.plot("all", store)
        for name in ("window", "states", "stalls", "use", "pareto"):
            self.shows(name, "2 of the points lose pixels: the pictures that they match are not whole.")
        for name in ("window", "pareto"):
            self.shows(name, "loses pixels")
            table = self.table(name)
            self.is_from(store, table, "front")
            marked = {row["hash"] for row in table if int(row["cameras.left.dropped_pixels"])}
            self.assertEqual(marked, losing)
        order = "[host, result, left_pixel, right_pixel, left_lut, right_lut]"
        self.plot("window", store, "--only", f"fpga.priority={order}")
        self.assertNotIn("loses pixels", self.texts("window"))

    def test_too_many_combinations_are_drawn_without_lines(self):
        header = [*HEADER, "fpga.clock_mhz", "fpga.arbitration", *RATES]
        rows = [("made", "preloaded", window, clock, kind, clock / window / (1 + weight), clock / window)
                for window in (3, 5) for clock in range(20, 40) for weight, kind in enumerate(("$a$", "$c$"))]
        store = make_database(self.folder / "many.db", header, rows)
        self.assertIn("80 points, without lines", self.plot("window", store))
        self.assertEqual(self.curves("window"), [])
        many = "40 combinations of fpga.clock_mhz, fpga.arbitration are more than can be told apart"
        self.shows("window", f"Points without lines: {many}; --only KEY=VALUE draws fewer.")
        said = self.plot("window", store, "--only", "fpga.clock_mhz=20")
        self.assertIn("4 of 80 points; left out: 76 other than --only fpga.clock_mhz=20", said)
        self.assertIn("4 points, 2 lines", said)
        self.shows("window", "fpga.arbitration = $a$")

    def test_many_points_without_lines_are_envelopes(self):
        """One for each value of the key that leaves the least range: its corners are the least and the
        greatest."""
        header = [*HEADER, "fpga.clock_mhz", "matcher.fetch", *RATES]
        rates = {"column": 1, "line_buffer": 10}
        rows = [("made", "preloaded", window, clock, fetch, clock * rate / window,
                 1.5 * clock * rate / window)
                for window in (3, 5, 7) for clock in range(20, 80) for fetch, rate in rates.items()]
        store = make_database(self.folder / "many.db", header, rows[::-1])
        self.assertIn("360 points, 2 envelopes", self.plot("window", store))
        self.assertEqual(len(self.table("window")), 360)
        many = "120 combinations of fpga.clock_mhz, matcher.fetch are more than can be told apart"
        self.shows("window", f"Envelopes: {many}; --only KEY=VALUE draws fewer.", "matcher.fetch = column",
                   "matcher.fetch = line_buffer", "all points, from the least to the greatest",
                   "greatest bound",
                   "median")
        medians, (all_column, middle_column, all_kept, _) = self.curves("window"), self.ranges("window")
        self.assertEqual([len(curve) for curve in medians], [3, 3])
        bounds = self.bounds("window")
        self.assertEqual([len(curve) for curve in bounds], [3, 3])
        # The scale is logarithmic: ratios are distances. The highest y is the least.
        decade = medians[0][0][1] - medians[1][0][1]
        for number in range(3):
            x, column = medians[0][number]
            self.assertAlmostEqual(column - medians[1][number][1], decade, places=3)
            edges = sorted(y for at, y in all_column if at == x)
            self.assertAlmostEqual(edges[-1] - edges[0], decade * math.log10(79 / 20), places=3)
            self.assertAlmostEqual(edges[0] - bounds[0][number][1], decade * math.log10(1.5), places=3)
            self.assertAlmostEqual(column - edges[0], decade * math.log10(79 / 50), places=3)
            middle = sorted(y for at, y in middle_column if at == x)
            self.assertAlmostEqual(middle[-1] - middle[0], decade * math.log10(64 / 35), places=3)
            self.assertAlmostEqual(edges[0] - min(y for at, y in all_kept if at == x), decade, places=3)
        self.assertLess((self.out / "window.svg").stat().st_size, 50_000)

    def test_many_allocations_are_a_range_below_the_best(self):
        header = [*ALLOCATED, *RATES]
        rows = [("made", "preloaded", f"bank{lut}", f"[bank0, bank{number}]", number / 10 + banks, 50)
                for banks, lut in ((0, 0), (1, 400)) for number in range(1, 161)]
        self.assertIn("320 points, 1 line\n",
                      self.plot("banks", make_database(self.folder / "many.db", header, rows)))
        ((best,), (surface,)) = self.curves("banks"), self.ranges("banks")
        self.assertEqual(len(best), 2)
        for x, y in best:
            edges = [each for at, each in surface if at == x]
            self.assertAlmostEqual(min(edges), y, places=3)
            self.assertGreater(max(edges), y + 50)

    def test_rows_and_units_have_figures(self):
        store = self.sweep(SMALL_BOARD + "vary: {matcher.rows: [1, 2, 4], matcher.units: [all, 40, 20]}\n")
        said = self.plot("all", store)
        self.assertIn("rows         9 points, 3 lines\n", said)
        self.assertIn("units        9 points, 3 lines\n", said)
        self.is_from(store, self.table("rows"))
        self.is_from(store, self.table("units"), "units_used")
        for row in self.table("units"):
            units = row["matcher.units"]
            self.assertEqual(row["units_used"], "80" if units == "all" else units)
        self.shows("rows", "rows of results at once", "matcher.units = all", "1", "2", "4")
        self.shows("units", "column and window modules", "matcher.rows = 4", "20", "40", "80")
        self.assertEqual(self.texts("units").count("80"), 1, "both panels have one axis")
        self.assertEqual([len(self.curves(name)) for name in ("rows", "units")], [6, 6])  # in two panels
        axes = "units_used:min,frames_per_second.core:max"
        self.assertIn("9 points, 3 of them on the front", self.plot("pareto", store, "--pareto", axes))

    def test_lines_that_look_the_same_are_noted_with_their_difference(self):
        header = [*HEADER, "fpga.lane_fifo_slots", *RATES]
        rows = [("made", "preloaded", window, slots, rate * 100 / window, rate * 100 / window)
                for window in (3, 5) for slots, rate in ((8, 0.996), (16, 1), (32, 1))]
        store = make_database(self.folder / "same.db", header, rows)
        self.plot("window", store)
        self.assertEqual(len(self.curves("window")), 3)
        same = "Lines that differ only in fpga.lane_fifo_slots (8, .., 32) look the same"
        self.shows("window", f"{same}: what is drawn changes by 0.4 % at most.")
        change(store, 'UPDATE points SET "frames_per_second.core" = 18 '
                      'WHERE "fpga.lane_fifo_slots" = 8 AND "matcher.window" = 5')
        self.plot("window", store)
        self.shows("window", *(f"fpga.lane_fifo_slots = {slots}" for slots in (8, 16, 32)))


class ParetoFront(FigureTest):
    COLUMNS = ("area.luts", "latency_ms.capture_to_host.p50")
    HEADER = ("name", "run.source", "fpga.clock_mhz", *COLUMNS)

    def front(self, store, *senses):
        """Draws it with the smallest or largest values, min or max, as the best ones."""
        asked = ",".join(f"{column}:{sense}" for column, sense in zip(self.COLUMNS, senses))
        return self.plot("pareto", store, "--pareto", asked)

    def is_better(self, one, other, senses):
        """In one column at least, and in none worse."""
        signs = [1 if sense == "min" else -1 for sense in senses]
        one, other = ([sign * value for sign, value in zip(signs, pair)] for pair in (one, other))
        return all(a <= b for a, b in zip(one, other)) and one != other

    def test_the_front_is_that_of_a_comparison_of_all_with_all(self):
        generator = random.Random(1)
        pairs = [(generator.randrange(12), generator.randrange(12) / 4) for _ in range(60)]  # with equal ones
        rows = [("made", "preloaded", number, *pair) for number, pair in enumerate([*pairs, (3, None)])]
        store = make_database(self.folder / "random.db", self.HEADER, rows)
        for senses in (("min", "max"), ("max", "min"), ("min", "min"), ("max", "max")):
            with self.subTest(senses):
                said = self.front(store, *senses)
                best = [pair for pair in pairs
                        if not any(self.is_better(other, pair, senses) for other in pairs)]
                table = self.table("pareto")
                self.assertEqual(len(table), len(pairs))
                on_front = [row for row in table if row["front"] == "1"]
                front = [tuple(float(row[column]) for column in self.COLUMNS) for row in on_front]
                self.assertEqual(sorted(front), sorted(best))
                self.assertIn(f"60 points, {len(best)} of them on the front", said)
        note = "made, source preloaded: 60 of 61 points of random.db; not shown: 1 without these figures."
        self.shows("pareto", note)
        self.is_from(store, table, "front")

    def test_points_are_named_by_what_varies(self):
        rows = [("made", "preloaded", *row) for row in ((40, 5, 9), (50, 7, 12), (60, 7, 12), (70, 8, 11))]
        self.front(make_database(self.folder / "named.db", self.HEADER, rows), "min", "max")
        axes = ("area, LUTs (less is better)", "capture_to_host.p50, ms (more is better)")
        self.shows("pareto", "1  clock_mhz=40", "2  2 points with other clock_mhz", *axes)


    def numbers(self, pairs, *senses):
        """The texts beside the front, and the labels of the x axis that are fractions."""
        rows = [("made", "preloaded", number, *pair) for number, pair in enumerate(pairs)]
        self.out = self.folder / f"out{len(list(self.folder.iterdir()))}"
        self.front(make_database(self.folder / f"{self.out.name}.db", self.HEADER, rows), *senses)
        return [text for text in self.texts("pareto") if re.fullmatch(r"\d+(\N{EN DASH}\d+)?", text)]

    def test_numbers_that_would_touch_are_merged(self):
        apart = [(100 * number, 10 * number) for number in range(1, 5)]
        self.assertLessEqual({"1", "2", "3", "4"}, set(self.numbers(apart, "min", "max")))
        close = [*apart, (401, 40.1), (402, 40.2)]
        found = self.numbers(close, "min", "max")
        self.assertLessEqual({"1", "2", "3", "4\N{EN DASH}6"}, set(found))
        self.assertNotIn("5", found)
        all_close = [(400 + number, 40 + number / 10) for number in range(20)]
        self.assertIn("1\N{EN DASH}16", self.numbers(all_close, "min", "max"))

    def test_counts_have_whole_ticks(self):
        header = ["name", "run.source", "allocation.left_lut", "allocation.left_image", *RATES]
        rows = [("made", "preloaded", lut, image, rate, 9) for lut, image, rate in
                (("bank0", "[bank0]", 4), ("bank1", "[bank0]", 5.5), ("bank2", "[bank0, bank1]", 7))]
        self.plot("pareto", make_database(self.folder / "counts.db", header, rows), "--pareto",
                  "banks_used:min,frames_per_second.core:max")
        texts = self.texts("pareto")
        ticks = texts[: texts.index("banks used by the allocation (less is better)")]
        self.assertEqual(ticks[-3:], ["1", "2", "3"])
        self.assertEqual([len(line) for line in self.bounds("pareto")], [3])


class Columns(FigureTest):
    def paths(self, path, value):
        """The names of the figures in a part of stats.json."""
        if isinstance(value, dict):
            return [found for key, each in value.items() if key != "name"
                    for found in self.paths(f"{path}.{key}" if path else key, each)]
        if isinstance(value, list) and value and isinstance(value[0], dict):
            if "name" not in value[0]:
                return []
            return [found for each in value for found in self.paths(f"{path}.{each['name']}", each)]
        return [path]

    def test_columns_are_keys_or_figures(self):
        load = "pci.load: [{burst_words: 16, interval_us: 50, access_us: 1}]"
        plan = SMALL_BOARD.replace("preloaded", "camera, frames: 2")
        store = self.sweep(plan + f"vary: {{matcher.window: [3], {load}}}\n")
        (row,) = self.database(store)[0].values()
        board = self.file("board.yaml", row["config"])
        self.succeeds(run("run", board, "--timing-only", "--frames", 2, "--out", self.out))
        figures = set(self.paths("", self.stats())) - {"schema", "blame"}
        self.assertEqual(self.stats()["frames"], row["frames"])
        both = "bridge.posted_words"  # what the bridge can hold, and what it has taken
        self.assertEqual(self.stats()["bridge"]["posted_words"], row[both + ".counted"])
        self.assertNotEqual(row[both], row[both + ".counted"])
        keys = set(row) - reader.ADMINISTRATION - (figures - {both}) - {both + ".counted"}
        self.assertEqual(set(reader.Points(store).keys), keys)
        # All keys of boards, but those of loads, filters, costs and banks.
        said = self.succeeds(run("keys")).splitlines()[1:]
        known = {line.split()[0] for line in said if line[0] != " " and not line.startswith("extends ")}
        self.assertGreater(len(known), 40)
        others = ("pci.load", "ssram.", "matcher.filter.", "matcher.cost.")
        known = {key for key in known if not key.startswith(others)} | {"run.source", "run.frames"}
        self.assertEqual({key for key in keys if not key.startswith(others)}, known)


class ChangedDatabases(FigureTest):
    """What cannot be drawn is named by point, value and rule."""

    def setUp(self):
        super().setUp()
        self.store = self.sweep(ALLOCATIONS + "  matcher.disparities: [4, 8]\n")
        self.hash = sorted(self.database(self.store)[0])[1]

    def test_values_that_are_no_numbers_are_refused(self):
        whole = self.store.read_bytes()
        columns = {
            "disparities": [*RATES, "matcher.disparities", "area.slices_percent"],
            "banks": ["frames_per_second.core", "area.block_rams_percent"],
            "states": ["frames_per_second.core", "frames", "ports.result.idle_cycles", "ports.host.grants"],
            "stalls": ["frames", "ports.left_lut.stall_cycles"],
            "use": ["frames_per_second.core", "banks.bank3.utilization"],
            "pareto": ["frames_per_second.core", "area.slices", "area.multipliers_percent"],
        }
        rows = [(figure, column, "'x'", "x") for figure in columns for column in columns[figure]]
        values = {"NULL": "absent", "9e999": "inf", "-9e999": "-inf", "1.7e308": "1.7e+308", "''": ""}
        rows += [("states", "frames_per_second.core", *value) for value in values.items()]
        for figure, column, value, found in rows:
            with self.subTest(figure=figure, column=column, value=value):
                assignment = f"{reader.quoted(column)} = {value}"
                change(self.store, f"UPDATE points SET {assignment} WHERE hash = ?", self.hash)
                problem = f"{figure} not drawn: point {self.hash}: {column} = {found}: {reader.NUMBER}"
                process = script(f"plot_{figure}.py", self.store, "--out", self.out)
                self.refused_in_one_line(process, f"plot_{figure}.py: error: {problem}\n")
                self.store.write_bytes(whole)

    def test_wrong_frames_blame_and_text_are_refused(self):
        whole = self.store.read_bytes()
        number = re.escape(reader.NUMBER)
        axes = "area.luts:min,bound.core:max"
        for sql, figure, options, problem in (
            ("points SET frames = 0", "states", [], "states not drawn: point .*: frames = 0: must be 1"),
            ("blame SET cycles = 'x'", "stalls", [],
             rf"stalls not drawn: blame of point \w{{64}}: \w+, bank\d, \w+: cycles = x: {number}"),
            ("points SET \"fpga.device\" = CAST(x'ff' AS TEXT)", "all", ["--only", "fpga.device=xc2v6000"],
             f"{self.store}: Could not decode to UTF-8"),
            ('points SET "area.luts" = 9e999', "all", ["--pareto", axes],
             rf"--pareto = {axes}: point .*: area.luts = inf: {number}"),
        ):
            change(self.store, f"UPDATE {sql}")
            process = script(f"plot_{figure}.py", self.store, "--out", self.out, *options)
            self.refused_in_one_line(process)
            self.assertRegex(process.stderr, problem)
            self.store.write_bytes(whole)

    def test_a_point_without_a_figure_that_it_need_not_have_is_left_out(self):
        change(self.store, 'UPDATE points SET "frames_per_second.core" = NULL WHERE hash = ?', self.hash)
        said = self.plot("all", self.store)
        self.assertIn("\npareto       47 points", said)
        problem = f"point {self.hash}: frames_per_second.core = absent: {reader.NUMBER}\n"
        self.assertIn(f"\nbanks        not drawn: {problem}", said)
        note = "fpl2003, source preloaded: 47 of 48 points of points.db; not shown: 1 without these figures."
        self.shows("pareto", note)


class Names(FigureTest):
    def test_characters_that_the_font_lacks_are_noted_once(self):
        names = '"\N{SUPERSCRIPT TWO}", "b", "\N{ARABIC-INDIC DIGIT TWO}", "\u65e5\u672c board"'
        store = self.sweep(SMALL_BOARD + f"vary: {{matcher.window: [3, 5], name: [{names}]}}\n")
        process = script("plot_window.py", store, "--out", self.out)
        self.assertIn("8 points, 4 lines\n", self.succeeds(process))
        lacks = ("the font of the figures lacks '\u65e5\u672c': boxes in PNG and PDF; SVG and CSV have the "
                 "text\n")
        self.assertEqual(process.stderr, f"plot_window.py: note: {lacks}")
        self.assertIn("\u65e5\u672c board", " ".join(self.texts("window")))


    def test_names_are_shown_as_they_are(self):
        """Neither as mathematics nor as parts of the drawing, wherever they are."""
        names = ["<script>alert('$x^2$')</script>", '_b $\\alpha$ 100 % "c" \\n', "$\\frac{1"]
        ports = [f"ports.{port}.{count}" for port in reader.PORTS for count in STATES]
        banks = [f"banks.{bank}.utilization" for bank in ("$a_0$", "<b>&")]
        header = [*HEADER, "allocation.disparity", *RATES, *banks, "frames", *ports]
        rows = [(name, "preloaded", window, "[bank0]", number * 9 / window, 99, 0.5, 0.7, 1,
                 *[5] * len(ports))
                for number, name in enumerate(names, 1) for window in (3, 5)]
        store = make_database(self.folder / "$x_2$ <i> 5%.db", header, rows)
        change(store, "INSERT INTO blame SELECT hash, 'left_lut', '$b$', 'result', 5 FROM points")
        self.assertIn("window       6 points, 3 lines", self.plot("all", store, "--format", "png,svg,pdf"))
        self.is_in(self.out, *(f"{name}.{kind}" for name in ("window", "states", "stalls", "use")
                               for kind in ("png", "svg", "pdf", "csv")))
        for figure in ("window", "states", "stalls", "use"):
            drawing = xml.etree.ElementTree.parse(self.out / f"{figure}.svg")
            self.assertEqual([each.tag for each in drawing.iter() if "script" in each.tag], [])
            texts = " ".join(text for each in drawing.iter() for text in each.itertext())
            texts = texts.replace("\N{NO-BREAK SPACE}", " ")
            for name in names:
                self.assertIn(name, texts)
            self.assertIn("6 of 6 points of $x_2$ <i> 5%.db.", texts)
        self.assertIn("$a_0$", texts)
        self.assertIn("<b>&", texts)


class Formats(FigureTest):
    HEADER = [*HEADER, "matcher.fetch", "allocation.disparity", *RATES]

    def store(self):
        rows = [("made", "preloaded", window, fetch, "[bank0]", 90 / window + more, 99) for window in (3, 5,
                                                                                                       7)
                for fetch, more in (("column", 0), ("line_buffer", 9))]
        return make_database(self.folder / "made.db", self.HEADER, rows)

    def test_files_are_of_the_formats_that_are_asked_for(self):
        store = self.store()
        for asked, endings in (("pdf", ["pdf"]), ("svg", ["svg"]), ("pdf,png", ["pdf", "png"])):
            said = self.succeeds(run("plot", store, "--out", self.out, "--format", asked))
            self.assertIn(f"{len(endings) + 1} files: {', '.join(endings)} and csv of each figure", said)
            # Those of the other formats have gone.
            self.is_in(self.out, "window.csv", *(f"window.{each}" for each in endings))
        pdf = (self.out / "window.pdf").read_bytes()
        self.assertTrue(pdf.startswith(b"%PDF-"))
        self.assertNotIn(b"CreationDate", pdf)
        with self.unchanged(self.out):
            self.succeeds(run("plot", store, "--out", self.out, "--format", asked))

    def test_figures_have_the_size_that_is_asked_for(self):
        store = self.store()
        usual = self.succeeds(run("plot", store, "--out", self.out)) and self.table("window")
        for size, width, height in (("5x4", 5, 4), ("3.5x3.25", 3.5, 3.25), ("12x9", 12, 9)):
            self.succeeds(run("plot", store, "--out", self.out, "--size", size, "--format", "png,svg,pdf"))
            ((pixels, lines, _, _),) = drawn(self.out / "window.png")
            self.assertEqual((pixels, lines), (200 * width, 200 * height))
            points = rf'width="{72 * width:g}pt" height="{72 * height:g}pt"'
            self.assertIn(points, (self.out / "window.svg").read_text())
            box = rf"/MediaBox \[ 0 0 {72 * width:g} {72 * height:g} \]"
            self.assertRegex((self.out / "window.pdf").read_bytes().decode("latin-1"), box)
            self.assertEqual(self.table("window"), usual)


class Layout(FigureTest):
    """Texts do not touch, whatever the numbers are."""

    def test_labels_of_neighboring_columns_are_apart(self):
        script_of = """
import sys
sys.path.insert(0, sys.argv[1])
import drawing, style
from matplotlib.backends.backend_agg import FigureCanvasAgg
for size in (None, (4.6, 6)):
    for count in (1, 2, 4, 6):
        for most in (0.37, 3, 20.4, 99.6, 1234, 1999, 104000.5):
            sheet = drawing.Sheet("title", size)
            panels = sheet.grid([2], count, 0.6, 0.2)
            drawing.ticks_of_columns(panels, most)
            sheet.figure.canvas.draw()
            labels = [label for axes in panels for label in axes.get_xticklabels() if label.get_text()]
            boxes = [label.get_window_extent() for label in labels]
            assert len(boxes) >= count, (count, most)
            for before, after in zip(boxes, boxes[1:]):
                assert before.x1 < after.x0, (size, count, most, before, after)
            assert all(axes.get_xlim()[1] >= most for axes in panels)
print("apart")
"""
        command = [PYTHON, "-B", "-c", script_of, str(SCRIPTS)]
        process = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(self.succeeds(process), "apart\n")

    def test_columns_that_have_no_room_are_not_drawn(self):
        store = self.sweep(ALLOCATIONS)
        (line,) = self.refused(script("plot_states.py", store, "--out", self.out, "--size", "2x20"))
        self.assertRegex(line, r"states not drawn: --size 2x20: this figure needs a width of \d\.\d inches$")
        self.succeeds(script("plot_states.py", store, "--out", self.out, "--size", "6x20"))

    def test_use_has_a_scale_of_its_colors(self):
        store = self.sweep(WINDOWS)
        self.plot("use", store)
        self.shows("use", "use of the bank, % of cycles", "0", "20", "40", "60", "80", "100")
        self.assertIn("<image", (self.out / "use.svg").read_text())


class Studies(FigureTest):
    def test_the_study_of_fetch_takes_for_fitting_what_plot_does(self):
        """Neither too many slices, block RAMs nor multipliers."""
        results = pathlib.Path(__file__).resolve().parents[3] / "results"
        (self.folder / "results" / "fetch").mkdir(parents=True)
        (self.folder / "sw").symlink_to(results.parent / "sw")
        for name in ("study.py", "fetch/report.py"):
            shutil.copy(results / name, self.folder / "results" / name)
        areas = ["slices_percent", "block_rams", "block_rams_percent", "multipliers_percent"]
        header = [*HEADER, "matcher.disparities", "matcher.fetch", "frames_per_second.core"]
        header += [f"area.{part}" for part in areas]
        rows = [("made", "preloaded", 7, disparities, fetch, 18, *area) for fetch in ("column", "line_buffer")
                for disparities, *area in ((80, 50, 9, 10, 0), (120, 70, 9, 100, 100), (160, 80, 9, 101, 0),
                                           (200, 90, 9, 50, 101), (240, 101, 9, 50, 0))]
        core = make_database(self.folder / "core.db", header, rows)
        run_it = "run: {source: camera, frames: 4}"
        plan = f"board: fpl2003\n{run_it}\nvary: {{matcher.fetch: [column, line_buffer]}}\n"
        report = self.folder / "results" / "fetch" / "report.py"
        command = [PYTHON, "-B", report, core, self.sweep(plan)]
        self.succeeds(subprocess.run(command, capture_output=True, text=True, timeout=120, check=False))
        row = "| 7x7 | 18.00 | 18.00 | 1.0 | 50.0 | 50.0 | 9 | 9 | 120 | 120 |\n"
        self.assertIn(row, report.with_name("README.md").read_text())


if __name__ == "__main__":
    program.main()
