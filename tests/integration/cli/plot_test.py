"""plot: the figures of a sweep and their data."""

import csv
import os
import pathlib
import random
import re
import shutil
import sqlite3
import subprocess
import sys

import program
from program import HEIGHT, PYTHON, WIDTH, ProgramTest, run

SCRIPTS = pathlib.Path(__file__).resolve().parents[3] / "sw" / "report" / "plots"
FIGURES = ["window", "disparities", "banks", "states", "stalls", "use", "pareto"]
ENDINGS = [".png", ".svg", ".csv"]
LAYOUT = 2

sys.dont_write_bytecode = True
sys.path.insert(0, str(SCRIPTS))
import points as reader  # noqa: E402: the module under test that needs no matplotlib

SMALL_BOARD = f"""
board: fpl2003
run: {{source: preloaded}}
set: {{image.width: {WIDTH}, image.height: {HEIGHT}, matcher.filter: none}}
"""
WINDOWS = [3, 5, 7]
DISPARITIES = [4, 8]
PLAN = SMALL_BOARD + f"""
vary:
  matcher.window: {WINDOWS}
  matcher.disparities: {DISPARITIES}
  matcher.fetch: [column, line_buffer]
  allocation.right_image: [[bank2, bank3], bank3]
"""
FAMILIES = 4  # of window: disparities and fetch; allocation.right_image leaves one possibility
ALLOCATIONS = SMALL_BOARD + """
vary:
  allocation.left_lut: [bank6, bank0, bank4]
  allocation.right_lut: [bank7, bank2]
  allocation.disparity: [[bank4, bank5], [bank0, bank0]]
  ssram.default.kind: [zbt_pipelined, zbt_flow_through]
"""


# Beginnings of the columns of made databases that are no keys.
FIGURES_OF_RUNS = ("frames", "bound.", "area.", "latency_ms.", "pci.clocks", "cameras.left.", "cameras.right.", "ports.")


def make_database(path, header, rows):
    """One as sweep makes it, with these columns."""
    connection = sqlite3.connect(path)
    connection.execute(f"PRAGMA application_id = {0x53544C4D}")
    connection.execute(f"PRAGMA user_version = {LAYOUT}")
    columns = ["hash", "status", "reason", "version", "config", *header]
    connection.execute(f"CREATE TABLE points({', '.join(map(reader.quoted, columns))})")
    connection.execute("CREATE TABLE blame(hash, port, bank, by, cycles)")
    connection.execute("CREATE TABLE keys(name)")
    connection.executemany("INSERT INTO keys VALUES(?)",
                           [(column,) for column in header if not column.startswith(FIGURES_OF_RUNS)])
    marks = ", ".join("?" * len(columns))
    for number, row in enumerate(rows):
        connection.execute(f"INSERT INTO points VALUES({marks})", (f"{number:064}", "ok", "", "0.1.0", "", *row))
    connection.commit()
    connection.close()


class PlotTest(ProgramTest):
    def sweep(self, plan, name="points.db"):
        store = self.folder / name
        self.succeeds(run("sweep", self.file(name + ".yaml", plan.encode()), "--out", store))
        return store

    def script(self, name, *arguments, **variables):
        """A figure's own script, with these variables in its environment."""
        command = [PYTHON, "-B", SCRIPTS / name, *arguments]
        return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300, check=False,
                              env={**os.environ, **variables})

    def table(self, name, folder=None):
        with open((folder or self.out) / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))

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

    def is_a_picture(self, path):
        width, height, white, colors = program.drawn(path)
        self.assertEqual(width, 1440)  # 7.2 inches
        self.assertTrue(300 <= height <= 3000, height)
        self.assertTrue(0.3 < white < 0.99, white)
        self.assertGreater(colors, 20)

    def texts(self, path):
        return [text for text in re.findall(r"<text[^>]*>([^<]*)</text>", path.read_text())]

    def curves(self, path, width="1.4"):
        """The data's lines of that width in a drawing: (x, y) each."""
        found = re.findall(r'<path d="([^"]*)" clip-path="[^"]*" style="fill: none; [^"]*stroke-width: ([\d.]+)',
                           path.read_text())
        return [[tuple(map(float, pair)) for pair in re.findall(r"[ML] (\S+) (\S+)", line)]
                for line, found_width in found if found_width == width]


class Figures(PlotTest):
    def test_of_a_sweep(self):
        store = self.sweep(PLAN)
        said = self.succeeds(run("plot", store, "--out", self.out)).splitlines()
        self.assertEqual(said[0], f"{store}: 12 of 24 points; left out: 12 impossible")
        self.assertRegex(said[1], r"^  12 impossible: allocation.right_image = \[bank3\]: must be as long as left_image")
        self.assertEqual(said[2:], [
            "window       12 points, 4 lines",
            "disparities  12 points, 6 lines",
            "banks        not drawn: all points use 8 banks",
            "states       12 points, 5 ports",
            "stalls       not drawn: no port stalls in any point",
            "use          12 points, 8 banks",
            "pareto       12 points, " + said[-2].split(", ")[1],
            f"{self.out}: 15 files: a picture, a drawing and the data of each figure that is drawn",
        ])
        drawn = ["window", "disparities", "states", "use", "pareto"]
        self.assertEqual(sorted(os.listdir(self.out)), sorted(name + ending for name in drawn for ending in ENDINGS))
        for name in drawn:
            with self.subTest(name):
                self.is_a_picture(self.out / f"{name}.png")
                self.is_from(store, self.table(name), "port", "grants", "passed_cycles", "stall_cycles", "blocked_cycles",
                             "starved_cycles", "idle_cycles", "front")
                self.assertEqual(len({row["hash"] for row in self.table(name)}), 12)
                self.assertIn("fpl2003, source preloaded: 12 of 24 points of points.db; not shown: 12 impossible.",
                              self.texts(self.out / f"{name}.svg"))
        self.check_lines()
        self.check_states(store)
        self.check_again(store)

    def check_lines(self):
        """One for each combination of the other keys, through the points of that combination alone."""
        texts = self.texts(self.out / "window.svg")
        for text in ("window n, pixels (of n x n)", "bound", "matcher.fetch = column", "matcher.fetch = line_buffer",
                     *map(str, WINDOWS)):
            self.assertIn(text, texts)
        self.assertTrue(any(text.startswith("core, frames/s") for text in texts), texts)
        for width in ("1.4", "5.5"):  # simulated, bound
            curves = self.curves(self.out / "window.svg", width)
            self.assertEqual(len(curves), FAMILIES)
            for curve in curves:
                self.assertEqual(len(curve), len(WINDOWS))
                self.assertEqual(sorted({x for x, _ in curve}), [x for x, _ in curve])
        texts = self.texts(self.out / "disparities.svg")
        self.assertIn("disparities D", texts)
        self.assertTrue(any(text.startswith("area, % of the slices") for text in texts), texts)
        self.assertEqual(len(self.curves(self.out / "disparities.svg")), 2 * 6)  # in two panels

    def check_states(self, store):
        rows, _ = self.database(store)
        for row in self.table("states"):
            for count in ("grants", "passed_cycles", "stall_cycles", "blocked_cycles", "starved_cycles", "idle_cycles"):
                self.assertEqual(int(row[count]), rows[row["hash"]][f"ports.{row['port']}.{count}"])

    def check_again(self, store):
        """The same bytes, also where there are figures already; those that do not apply any more go."""
        before = self.result()
        (self.out / "banks.png").write_bytes(b"")
        self.succeeds(run("plot", store, "--out", self.out))
        self.assertEqual(self.result(), before)

    def test_of_allocations(self):
        store = self.sweep(ALLOCATIONS)
        said = self.succeeds(run("plot", store, "--out", self.out))
        rows, blame = self.database(store)
        self.assertIn("banks        24 points, 2 lines\n", said)
        self.assertIn("window       not drawn: all points have matcher.window = 7\n", said)
        banks = self.table("banks")
        self.is_from(store, banks, "banks_used")
        for row in banks:
            allocation = [value for key, value in rows[row["hash"]].items() if key.startswith("allocation.")]
            self.assertEqual(int(row["banks_used"]), len(set(re.findall(r"bank\d", " ".join(allocation)))))

        stalls = self.table("stalls")
        drawn = {row["hash"] for row in stalls}
        self.assertEqual(len(drawn), 16)
        texts = self.texts(self.out / "stalls.svg")
        self.assertIn("The 16 points with most stall cycles a frame.", texts)
        self.assertIn("fpl2003, source preloaded: 16 of 24 points of points.db; not shown: 8 with fewer stalls.", texts)
        self.assertIn("thousand stall cycles of the port a frame", texts)
        self.assertIn("lost to left_pixel", texts)
        self.assertIn("disparity=[bank0,\N{NO-BREAK SPACE}bank0],", " ".join(texts))
        self.assertEqual(sorted((row["hash"], row["port"], row["bank"], row["by"], int(row["cycles"])) for row in stalls),
                         sorted(row for row in blame if row[0] in drawn))
        least = min(sum(row[4] for row in blame if row[0] == key) / rows[key]["frames"] for key in drawn)
        for key in set(rows) - drawn:
            self.assertLessEqual(sum(row[4] for row in blame if row[0] == key) / rows[key]["frames"], least)

    def test_go_through_the_best_allocation(self):
        header = ["name", "run.source", "allocation.left_lut", "allocation.left_image", "fpga.clock_mhz",
                  "frames_per_second.core", "bound.core"]
        rows = [("made", "preloaded", lut, image, clock, rate * clock, 13 * clock) for clock in (1, 2)
                for lut, image, rate in (("bank0", "[bank0, bank0]", 8), ("none", "[bank1]", 12), ("bank2", "[bank1]", 10))]
        store = self.folder / "best.db"
        make_database(store, header, rows)
        self.succeeds(self.script("plot_banks.py", store, "--out", self.out))
        self.assertEqual(sorted(int(row["banks_used"]) for row in self.table("banks")), [1, 1, 1, 1, 2, 2])
        slow, fast = self.curves(self.out / "banks.svg")
        zero = 2 * slow[0][1] - fast[0][1]  # y of no frame at all: from zero, and one board twice as fast
        for curve in (slow, fast):
            self.assertEqual(len(curve), 2)
            self.assertLess(curve[0][0], curve[1][0])
            self.assertAlmostEqual((zero - curve[0][1]) / (zero - curve[1][1]), 12 / 10, places=4)
        texts = self.texts(self.out / "banks.svg")
        for text in ("banks used by the allocation", "best allocation", "every allocation", "bound",
                     "fpga.clock_mhz = 1"):
            self.assertIn(text, texts)

    def test_of_the_whole_computer(self):
        plan = SMALL_BOARD.replace("preloaded", "camera, frames: 3") + "vary: {matcher.window: [3, 5]}\n"
        store = self.sweep(plan)
        self.succeeds(self.script("plot_window.py", store, "--out", self.out))
        self.assertEqual(sorted(os.listdir(self.out)), sorted("window" + ending for ending in ENDINGS))
        self.is_from(store, self.table("window"))
        for column in ("frames_per_second.core", "bound.core", "frames_per_second.steady", "frames_per_second.system",
                       "bound.system"):
            self.assertIn(column, self.table("window")[0])
        texts = self.texts(self.out / "window.svg")
        self.assertIn("whole computer, steady frames/s", texts)
        self.assertIn("from power-up, tables included", texts)
        self.assertEqual(len(self.curves(self.out / "window.svg")), 2)
        self.assertEqual(len(self.curves(self.out / "window.svg", "5.5")), 2)

    def test_mark_points_that_lose_pixels(self):
        """Where the host comes last and its captures share banks with the core, most words of a picture come too late."""
        plan = """
board: fpl2003
run: {source: camera, frames: 7}
set: {allocation.left_image: [bank0, bank0], allocation.right_image: [bank1, bank1]}
vary:
  fpga.priority: [[host, result, left_pixel, right_pixel, left_lut, right_lut],
                  [result, left_pixel, right_pixel, left_lut, right_lut, host]]
  matcher.window: [7, 9]
"""
        store = self.sweep(plan)
        rows, _ = self.database(store)
        losing = {key for key, row in rows.items() if row["cameras.left.dropped_pixels"]}
        self.assertEqual(len(losing), 2)
        self.succeeds(run("plot", store, "--out", self.out))
        for name in ("window", "states", "stalls", "use", "pareto"):
            self.assertIn("2 of the points lose pixels: the pictures that they match are not whole.",
                          self.texts(self.out / f"{name}.svg"), name)
        for name in ("window", "pareto"):
            self.assertIn("loses pixels", self.texts(self.out / f"{name}.svg"))
            table = self.table(name)
            self.is_from(store, table, "front")
            self.assertEqual({row["hash"] for row in table if int(row["cameras.left.dropped_pixels"])}, losing)
        self.succeeds(run("plot", store, "--out", self.out, "--only", "fpga.priority=[host, "
                          "result, left_pixel, right_pixel, left_lut, right_lut]"))
        self.assertNotIn("loses pixels", self.texts(self.out / "window.svg"))

    def test_take_no_allocation_that_loses_pixels_for_the_best(self):
        header = ["name", "run.source", "allocation.left_lut", "allocation.left_image", "frames_per_second.core", "bound.core",
                  "cameras.left.dropped_pixels", "cameras.right.dropped_pixels"]
        rows = [("made", "camera", lut, "[bank1]", rate, 13, *lost)
                for lut, rate, lost in (("bank1", 8, (0, 0)), ("bank0", 12, (0, 5)), ("bank2", 10, (0, 0)))]
        store = self.folder / "losing.db"
        make_database(store, header, rows)
        self.succeeds(self.script("plot_banks.py", store, "--out", self.out))
        (curve,) = self.curves(self.out / "banks.svg")
        (_, one), (_, two) = curve
        make_database(self.folder / "whole.db", header, [row for row in rows if row[2] != "bank0"])
        self.succeeds(self.script("plot_banks.py", self.folder / "whole.db", "--out", self.out))
        (curve,) = self.curves(self.out / "banks.svg")
        self.assertAlmostEqual(one - two, curve[0][1] - curve[1][1], places=3)

    def test_with_more_combinations_than_lines(self):
        header = ["name", "run.source", "matcher.window", "fpga.clock_mhz", "fpga.arbitration", "frames_per_second.core",
                  "bound.core"]
        rows = [("made", "preloaded", window, clock, kind, clock / window / (1 + weight), clock / window)
                for window in (3, 5) for clock in range(20, 40) for weight, kind in enumerate(("$a$", "$c$"))]
        store = self.folder / "many.db"
        make_database(store, header, rows)
        self.assertIn("80 points, without lines", self.succeeds(self.script("plot_window.py", store, "--out", self.out)))
        self.assertEqual(self.curves(self.out / "window.svg"), [])
        self.assertIn("Points without lines: 40 combinations of fpga.clock_mhz, fpga.arbitration are more than can be told "
                      "apart; --only KEY=VALUE draws", self.texts(self.out / "window.svg"))
        said = self.succeeds(self.script("plot_window.py", store, "--out", self.out, "--only", "fpga.clock_mhz=20"))
        self.assertIn("4 of 80 points; left out: 76 other than --only fpga.clock_mhz=20", said)
        self.assertIn("4 points, 2 lines", said)
        self.assertIn("fpga.arbitration = $a$", self.texts(self.out / "window.svg"))

    def test_tell_by_how_much_keys_that_look_the_same_differ(self):
        header = ["name", "run.source", "matcher.window", "fpga.lane_fifo_slots", "frames_per_second.core", "bound.core"]
        rows = [("made", "preloaded", window, slots, rate * 100 / window, rate * 100 / window)
                for window in (3, 5) for slots, rate in ((8, 0.996), (16, 1), (32, 1))]
        store = self.folder / "same.db"
        make_database(store, header, rows)
        self.succeeds(self.script("plot_window.py", store, "--out", self.out))
        self.assertEqual(len(self.curves(self.out / "window.svg")), 3)
        self.assertIn("Lines that differ only in fpga.lane_fifo_slots (8, .., 32) look the same: what is drawn changes by "
                      "0.4 % at most.", self.texts(self.out / "window.svg"))
        connection = sqlite3.connect(store)
        connection.execute('UPDATE points SET "frames_per_second.core" = 18 WHERE "fpga.lane_fifo_slots" = 8 AND '
                           '"matcher.window" = 5')
        connection.commit()
        connection.close()
        self.succeeds(self.script("plot_window.py", store, "--out", self.out))
        texts = self.texts(self.out / "window.svg")
        for slots in (8, 16, 32):
            self.assertIn(f"fpga.lane_fifo_slots = {slots}", texts)


class ParetoFront(PlotTest):
    COLUMNS = ("area.luts", "latency_ms.capture_to_host.p50")
    HEADER = ("name", "run.source", "fpga.clock_mhz", *COLUMNS)

    def is_better(self, one, other, senses):
        """In one at least, and in none worse."""
        signs = [1 if sense == "min" else -1 for sense in senses]
        one, other = ([sign * value for sign, value in zip(signs, pair)] for pair in (one, other))
        return all(a <= b for a, b in zip(one, other)) and one != other

    def test_is_that_of_a_comparison_of_all_with_all(self):
        generator = random.Random(1)
        pairs = [(generator.randrange(12), generator.randrange(12) / 4) for _ in range(60)]  # with equal ones
        store = self.folder / "random.db"
        make_database(store, self.HEADER,
                      [("made", "preloaded", number, *pair) for number, pair in enumerate([*pairs, (3, None)])])
        for senses in (("min", "max"), ("max", "min"), ("min", "min"), ("max", "max")):
            with self.subTest(senses):
                asked = ",".join(f"{column}:{sense}" for column, sense in zip(self.COLUMNS, senses))
                said = self.succeeds(self.script("plot_pareto.py", store, "--out", self.out, "--pareto", asked))
                expected = [pair for pair in pairs if not any(self.is_better(other, pair, senses) for other in pairs)]
                table = self.table("pareto")
                self.assertEqual(len(table), len(pairs))
                front = [tuple(float(row[column]) for column in self.COLUMNS) for row in table if row["front"] == "1"]
                self.assertEqual(sorted(front), sorted(expected))
                self.assertIn(f"60 points, {len(expected)} of them on the front", said)
        self.assertIn("made, source preloaded: 60 of 61 points of random.db; not shown: 1 without these figures.",
                      self.texts(self.out / "pareto.svg"))
        self.is_from(store, table, "front")

    def test_names_its_points_by_what_varies(self):
        store = self.folder / "named.db"
        make_database(store, self.HEADER, [("made", "preloaded", 40, 5, 9), ("made", "preloaded", 50, 7, 12),
                                           ("made", "preloaded", 60, 7, 12), ("made", "preloaded", 70, 8, 11)])
        self.succeeds(self.script("plot_pareto.py", store, "--out", self.out, "--pareto",
                                  "area.luts:min,latency_ms.capture_to_host.p50:max"))
        texts = self.texts(self.out / "pareto.svg")
        for text in ("1  clock_mhz=40", "2  2 points with other clock_mhz", "area, LUTs (less is better)",
                     "capture_to_host.p50, ms (more is better)"):
            self.assertIn(text, texts)

    def test_takes_the_number_of_banks_for_a_column(self):
        store = self.sweep(ALLOCATIONS)
        self.succeeds(run("plot", store, "--out", self.out, "--pareto", "banks_used:min,frames_per_second.core:max"))
        table = self.table("pareto")
        self.is_from(store, table, "banks_used", "front")
        best = max(float(row["frames_per_second.core"]) for row in table)
        self.assertTrue(any(row["front"] == "1" and float(row["frames_per_second.core"]) == best for row in table))
        self.assertIn("bound of a point of the front", self.texts(self.out / "pareto.svg"))


class Columns(PlotTest):
    def test_are_keys_or_figures(self):
        load = "pci.load: [{burst_words: 16, interval_us: 50, access_us: 1}]"
        store = self.sweep(SMALL_BOARD.replace("preloaded", "camera, frames: 2") + f"vary: {{matcher.window: [3], {load}}}\n")
        (row,) = self.database(store)[0].values()
        board = self.file("board.yaml", row["config"].encode())
        self.succeeds(run("run", board, "--timing-only", "--frames", 2, "--out", self.out))
        figures = {figure for figure in self.paths("", self.stats()) if figure != "schema" and not figure.startswith("blame")}
        self.assertEqual(self.stats()["frames"], row["frames"])
        both = "bridge.posted_words"  # what the bridge can hold, and what it has taken
        self.assertEqual(self.stats()["bridge"]["posted_words"], row[both + ".counted"])
        self.assertNotEqual(row[both], row[both + ".counted"])
        self.assertEqual(set(reader.Points(store).keys), set(row) - reader.ADMINISTRATION - (figures - {both})
                         - {both + ".counted"})

    def test_of_keys_are_those_of_boards_and_runs(self):
        store = self.sweep(SMALL_BOARD + "vary: {matcher.window: [3]}\n")
        keys = set(reader.Points(store).keys)
        said = self.succeeds(run("keys")).splitlines()[1:]
        known = {line.split()[0] for line in said if line[0] != " " and not line.startswith("extends ")}
        self.assertGreater(len(known), 40)
        known = {key for key in known if not key.startswith(("pci.load", "ssram.", "matcher.filter."))}
        self.assertEqual({key for key in keys if not key.startswith("ssram.banks.bank")}, known | {"run.source", "run.frames"})

    def test_of_figures_make_no_lines(self):
        store = self.sweep("board: fpl2003\nrun: {source: camera, frames: 5}\nvary: {matcher.window: [5, 7, 9]}\n")
        taken = [row["bridge.posted_words.counted"] for row in self.database(store)[0].values()]
        self.assertGreater(len(set(taken)), 1)
        self.assertIn("3 points, 1 line\n", self.succeeds(self.script("plot_window.py", store, "--out", self.out)))

    def paths(self, path, value):
        if isinstance(value, dict):
            return [found for key, each in value.items() if key != "name"
                    for found in self.paths(f"{path}.{key}" if path else key, each)]
        if isinstance(value, list) and value and isinstance(value[0], dict):
            if "name" not in value[0]:
                return []
            return [found for each in value for found in self.paths(f"{path}.{each['name']}", each)]
        return [path]


class WhatCannotBeDrawn(PlotTest):
    """Of a database that somebody has changed: what is wrong is named by point, value and rule."""

    def setUp(self):
        super().setUp()
        self.store = self.sweep(ALLOCATIONS + "  matcher.disparities: [4, 8]\n")
        self.hash = sorted(self.database(self.store)[0])[1]

    def change(self, sql, *values):
        connection = sqlite3.connect(self.store)
        connection.execute(sql, values)
        connection.commit()
        connection.close()

    def test_is_refused(self):
        whole = self.store.read_bytes()
        for figure, column, value, found in (
                ("disparities", "matcher.disparities", "'x'", "x"), ("disparities", "frames_per_second.core", "NULL", "absent"),
                ("disparities", "bound.core", "9e999", "inf"), ("disparities", "area.slices_percent", "'x'", "x"),
                ("banks", "frames_per_second.core", "'x'", "x"), ("banks", "area.block_rams_percent", "-9e999", "-inf"),
                ("states", "frames_per_second.core", "NULL", "absent"), ("states", "ports.result.idle_cycles", "NULL", "absent"),
                ("states", "ports.host.grants", "'x'", "x"), ("states", "frames", "9e999", "inf"),
                ("stalls", "ports.left_lut.stall_cycles", "NULL", "absent"), ("stalls", "frames", "''", ""),
                ("use", "banks.bank3.utilization", "'x'", "x"), ("use", "frames_per_second.core", "9e999", "inf"),
                ("pareto", "frames_per_second.core", "-9e999", "-inf"),
                ("pareto", "frames_per_second.core", "1.7e308", "1.7e+308"), ("pareto", "area.slices", "'x'", "x"),
                ("pareto", "area.multipliers_percent", "'x'", "x")):
            with self.subTest(figure=figure, column=column, value=value):
                self.change(f"UPDATE points SET {reader.quoted(column)} = {value} WHERE hash = ?", self.hash)
                process = self.script(f"plot_{figure}.py", self.store, "--out", self.out)
                self.refused_in_one_line(process, f"plot_{figure}.py: error: {figure} not drawn: point {self.hash}: "
                                                  f"{column} = {found}: {reader.NUMBER}\n")
                self.store.write_bytes(whole)

    def test_is_refused_as_an_axis(self):
        self.change('UPDATE points SET "area.luts" = 9e999 WHERE hash = ?', self.hash)
        process = run("plot", self.store, "--out", self.out, "--pareto", "area.luts:min,bound.core:max")
        self.refused_in_one_line(process, f"--pareto = area.luts:min,bound.core:max: point {self.hash}: area.luts = inf: "
                                          f"{reader.NUMBER}\n")

    def test_of_no_frames(self):
        self.change("UPDATE points SET frames = 0 WHERE hash = ?", self.hash)
        self.refused_in_one_line(self.script("plot_states.py", self.store, "--out", self.out),
                                 f"states not drawn: point {self.hash}: frames = 0: must be 1 or more\n")

    def test_of_blame(self):
        self.change("UPDATE blame SET cycles = 'x'")
        process = self.script("plot_stalls.py", self.store, "--out", self.out)
        self.refused_in_one_line(process)
        self.assertRegex(process.stderr, r"stalls not drawn: blame of point [0-9a-f]{64}: \w+, bank\d, \w+: cycles = x: must be a "
                                         r"number from -1e\+100 to 1e\+100\n$")

    def test_of_text_that_is_none(self):
        self.change("UPDATE points SET \"fpga.device\" = CAST(x'ff' AS TEXT) WHERE hash = ?", self.hash)
        process = run("plot", self.store, "--out", self.out, "--only", "fpga.device=xc2v6000")
        self.refused_in_one_line(process, f"{self.store}: Could not decode to UTF-8")

    def test_is_left_out_where_a_point_need_not_have_it(self):
        self.change('UPDATE points SET "frames_per_second.core" = NULL WHERE hash = ?', self.hash)
        said = self.succeeds(run("plot", self.store, "--out", self.out))
        self.assertIn("\npareto       47 points", said)
        self.assertIn(f"\nbanks        not drawn: point {self.hash}: frames_per_second.core = absent: {reader.NUMBER}\n", said)
        self.assertIn("fpl2003, source preloaded: 47 of 48 points of points.db; not shown: 1 without these figures.",
                      self.texts(self.out / "pareto.svg"))


class Names(PlotTest):
    def test_of_digits_that_are_no_decimals(self):
        store = self.sweep(SMALL_BOARD + 'vary: {matcher.window: [3, 5], name: ["\N{SUPERSCRIPT TWO}", "b", '
                           '"\N{ARABIC-INDIC DIGIT TWO}"]}\n')
        process = run("plot", store, "--out", self.out)
        self.assertIn("window       6 points, 3 lines\n", self.succeeds(process))
        self.assertEqual(process.stderr, "")

    def test_that_the_font_lacks_are_told_once(self):
        store = self.sweep(SMALL_BOARD + 'vary: {matcher.window: [3, 5], name: ["\u65e5\u672c board", "b"]}\n')
        process = run("plot", store, "--out", self.out)
        self.assertIn("window       4 points, 2 lines\n", self.succeeds(process))
        self.assertEqual(process.stderr, "stereotlm: note: the font of the figures lacks '\u65e5\u672c': boxes in PNG; SVG and "
                                         "CSV have the text\n")
        self.assertIn("(b, \u65e5\u672c board)", " ".join(self.texts(self.out / "window.svg")))


class Studies(PlotTest):
    def test_of_fetch_takes_for_fitting_what_plot_does(self):
        """Neither too many slices, block RAMs nor multipliers."""
        results = pathlib.Path(__file__).resolve().parents[3] / "results"
        (self.folder / "results" / "fetch").mkdir(parents=True)
        (self.folder / "sw").symlink_to(results.parent / "sw")
        for script in ("study.py", "fetch/report.py"):
            shutil.copy(results / script, self.folder / "results" / script)
        core = self.folder / "core.db"
        header = ["name", "run.source", "matcher.window", "matcher.disparities", "matcher.fetch", "frames_per_second.core",
                  "area.slices_percent", "area.block_rams", "area.block_rams_percent", "area.multipliers_percent"]
        make_database(core, header, [
            ("made", "preloaded", 7, disparities, fetch, 18, *area) for fetch in ("column", "line_buffer")
            for disparities, area in ((80, (50, 9, 10, 0)), (120, (70, 9, 100, 100)), (160, (80, 9, 101, 0)),
                                      (200, (90, 9, 50, 101)), (240, (101, 9, 50, 0)))])
        computer = self.sweep("board: fpl2003\nrun: {source: camera, frames: 3}\nvary: {matcher.fetch: [column, line_buffer]}\n")
        report = [PYTHON, "-B", str(self.folder / "results" / "fetch" / "report.py"), str(core), str(computer)]
        self.succeeds(subprocess.run(report, capture_output=True, text=True, timeout=120, check=False))
        self.assertIn("| 7x7 | 18.00 | 18.00 | 1.0 | 50.0 | 50.0 | 9 | 9 | 120 | 120 |\n",
                      (self.folder / "results" / "fetch" / "README.md").read_text())


if __name__ == "__main__":
    program.main()
