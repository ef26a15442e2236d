"""plot: the figures of a sweep and their data."""

import random
import re
import sqlite3
import xml.etree.ElementTree

import program
from pictures import drawn
from plots import ALLOCATIONS, SMALL_BOARD, PlotTest, change, make_database
from program import PRELOADED, SMALL, run

SIZES = [3, 5, 7]
PLAN = SMALL_BOARD + f"""
vary:
  matcher.window: {SIZES}
  matcher.disparities: [4, 8]
  matcher.fetch: [column, line_buffer]
  allocation.right_image: [[bank2, bank3], bank3]
"""
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
            for column in set(row) - set(more):
                known = rows[row["hash"]][column]
                self.assertEqual(row[column], "" if known is None else str(known), column)

    def texts(self):
        return re.findall(r"<text[^>]*>([^<]*)</text>", self.svg)

    def shows(self, *texts):
        self.assertLessEqual(set(texts), set(self.texts()))

    def curves(self, width="1.4"):
        """The data's lines of that width: (x, y) each."""
        path = r'<path d="([^"]*)" clip-path="[^"]*" style="fill: none; [^"]*stroke-width: ([\d.]+)'
        return [[tuple(map(float, pair)) for pair in re.findall(r"[ML] (\S+) (\S+)", line)]
                for line, found in re.findall(path, self.svg) if found == width]


class Command(FigureTest):
    def test_draws_the_figures_that_apply_with_their_data(self):
        store = self.sweep(PLAN)
        said = self.succeeds(run("plot", store, "--out", self.out)).splitlines()
        self.assertEqual(said, [
            f"{store}: 12 of 24 points; left out: 12 impossible",
            "window       12 points, 2 lines",
            "disparities  12 points, 6 lines",
            "rows         not drawn: all points have matcher.rows = 1",
            "units        not drawn: all points have matcher.units = all",
            "banks        not drawn: all points have banks_used = 8",
            "stalls       not drawn: no port waits in any point",
            "pareto       12 points, " + said[7].split(", ")[1],
            f"{self.out}: 9 files",
        ])
        names = ["window", "disparities", "pareto"]
        self.is_in(self.out, *(name + ending for name in names for ending in (".png", ".svg", ".csv")))
        for width, height, white, colors in drawn(*(self.out / f"{name}.png" for name in names)):
            self.assertEqual(width, 1440)  # 7.2 inches
            self.assertTrue(300 <= height <= 3000, height)
            self.assertTrue(0.3 < white < 0.99, white)
            self.assertGreater(colors, 20)
        # The same bytes again; figures that do not apply any more go.
        with self.unchanged(self.out):
            (self.out / "banks.png").touch()
            self.succeeds(run("plot", store, "--out", self.out))
            self.assertFalse((self.out / "banks.png").exists())

    def test_files_have_the_formats_and_the_size_that_are_asked_for(self):
        store = self.sweep(SMALL_BOARD + "vary: {matcher.window: [3, 5]}\n")
        looks = ["--format", "pdf,png", "--size", "3.5x4.25"]
        said = self.succeeds(run("plot", store, "--out", self.out, *looks))
        self.assertIn(f"{self.out}: 6 files\n", said)
        self.is_in(self.out, *(name + ending for name in ("window", "pareto")
                               for ending in (".csv", ".pdf", ".png")))
        ((width, height, _, _),) = drawn(self.out / "window.png")
        self.assertEqual((width, height), (700, 850))
        pdf = (self.out / "window.pdf").read_bytes()
        self.assertIn(b"/MediaBox [ 0 0 252 306 ]", pdf)
        self.assertNotIn(b"CreationDate", pdf)
        self.succeeds(run("plot", store, "--out", self.out, "--format", "svg"))
        self.is_in(self.out, "window.csv", "window.svg", "pareto.csv", "pareto.svg")


class Lines(FigureTest):
    def test_there_is_one_for_each_combination_of_the_other_keys(self):
        store = self.sweep(PLAN)
        self.assertEqual(self.draw("window", store), "12 points, 2 lines")
        self.is_from(store, self.table)
        self.assertEqual(len(self.table), 12)
        self.shows("Frame rate against the size of the window", "core, frames/s (log scale)",
                   "window n, pixels (of n x n)", "bound", "matcher.fetch = column", *map(str, SIZES),
                   "fpl2003, source preloaded: 12 of 24 points of points.db; not shown: 12 impossible.")
        self.assertEqual([len(curve) for curve in self.curves()], [3, 3])
        self.draw("disparities", store)
        self.shows("disparities D", "area, % of the slices")
        self.assertEqual(len(self.curves()), 2 * 6)  # in two panels
        self.assertEqual(self.draw("window", store, only=["matcher.fetch=column"]), "6 points, 1 line")
        left_out = "not shown: 12 impossible, 6 other than --only matcher.fetch=column."
        self.shows(f"fpl2003, source preloaded: 6 of 24 points of points.db; {left_out}")

    def test_keys_that_change_little_share_a_line(self):
        header = [*HEADER, "fpga.lane_fifo_slots", *RATES]
        rows = [("made", "preloaded", window, slots, rate * 100 / window, rate * 100 / window)
                for window in (3, 5) for slots, rate in ((8, 0.992), (16, 1), (32, 1))]
        store = make_database(self.folder / "same.db", header, rows)
        self.assertEqual(self.draw("window", store), "6 points, 1 line")
        self.shows("A line stands for all values of fpga.lane_fifo_slots: what is drawn changes by at most "
                   "1 %.")
        change(store, 'UPDATE points SET "frames_per_second.core" = 18 '
                      'WHERE "fpga.lane_fifo_slots" = 8 AND "matcher.window" = 5')
        self.draw("window", store)
        self.shows(*(f"fpga.lane_fifo_slots = {slots}" for slots in (8, 16, 32)))

    def test_more_than_can_be_told_apart_are_an_envelope(self):
        header = [*HEADER, "fpga.clock_mhz", "fpga.arbitration", *RATES]
        rows = [("made", "preloaded", window, clock, kind, clock / window / (1 + weight), clock / window)
                for window in (3, 5) for clock in range(20, 40) for weight, kind in enumerate(("$a$", "$c$"))]
        store = make_database(self.folder / "many.db", header, rows)
        self.assertEqual(self.draw("window", store), "80 points, an envelope")
        self.assertEqual(len(self.curves()), 1)
        many = "40 combinations of fpga.clock_mhz, fpga.arbitration are more than can be told apart"
        self.shows(f"Envelopes: {many}; --only KEY=VALUE draws fewer.", "the middle half of them", "median")
        self.assertEqual(self.draw("window", store, only=["fpga.clock_mhz=20"]), "4 points, 2 lines")
        self.shows("fpga.arbitration = $a$")

    def test_rows_and_units(self):
        store = self.sweep(SMALL_BOARD + "vary: {matcher.rows: [1, 2, 4], matcher.units: [all, 40, 20]}\n")
        self.assertEqual(self.draw("rows", store), "9 points, 3 lines")
        self.is_from(store, self.table)
        self.shows("rows of results at once", "matcher.units = all", "1", "2", "4")
        self.assertEqual(self.draw("units", store), "9 points, 3 lines")
        self.is_from(store, self.table, "units_used")
        for row in self.table:
            units = row["matcher.units"]
            self.assertEqual(row["units_used"], "80" if units == "all" else units)
        self.assertEqual(self.texts().count("80"), 1, "both panels have one axis")
        axes = "units_used:min,frames_per_second.core:max"
        self.assertEqual(self.draw("pareto", store, pareto=axes), "9 points, 3 of them on the front")

    def test_of_banks_goes_through_the_best_allocation(self):
        store = self.sweep(ALLOCATIONS)
        self.draw("banks", store)
        self.shows("best allocation")
        self.is_from(store, self.table, "banks_used")
        rows, _ = self.database(store)
        for row in self.table:
            allocation = [value for key, value in rows[row["hash"]].items() if key.startswith("allocation.")]
            self.assertEqual(int(row["banks_used"]), len(set(re.findall(r"bank\d", " ".join(allocation)))))

    def test_a_stripe_uses_its_banks_alone(self):
        store = self.sweep("board: eight-banks-four-lanes\nset: {image.width: 64, image.height: 48}\n"
                           "vary: {matcher.window: [5, 7]}\n")
        axes = "banks_used:min,frames_per_second.core:max"
        self.assertIn("all points have banks_used = 8", self.succeeds(run("plot", store, "--out", self.out)))
        self.draw("pareto", store, pareto=axes)
        self.assertEqual({row["banks_used"] for row in self.table}, {"8"})

    def test_an_allocation_that_loses_pixels_is_not_the_best(self):
        header = ["name", "run.source", "allocation.left_lut", "allocation.left_image", *RATES, "lost_pixels"]
        one, two, losing = (("made", "camera", lut, "[bank1]", rate, 13, pixels)
                            for lut, rate, pixels in (("bank1", 8, 0), ("bank2", 10, 0), ("bank0", 12, 5)))
        self.draw("banks", make_database(self.folder / "losing.db", header, [one, two, losing]))
        (line,) = self.curves()
        panel = re.findall(r'<g clip-path="[^"]*">((?:\s*<use [^>]*>)+)', self.svg)
        heights = {float(y) for group in panel for y in re.findall(r' y="([^"]*)"', group)}
        of_8, of_10, _, _ = sorted(heights, reverse=True)  # then the rate of the losing one, and the bound
        self.assertEqual([y for _, y in line], [of_8, of_10])

    def test_the_whole_computer_has_two_rates_and_points_that_lose_pixels_have_crosses(self):
        store = self.sweep(LOSING)
        rows, _ = self.database(store)
        losing = {key for key, row in rows.items() if row["lost_pixels"]}
        self.assertEqual(len(losing), 2)
        for name in ("window", "stalls", "pareto"):
            self.draw(name, store)
            self.shows("2 of the points lose pixels: the pictures that they match are not whole.")
            if name != "stalls":
                self.shows("loses pixels")
                self.is_from(store, self.table, "front")
                marked = {row["hash"] for row in self.table if int(row["lost_pixels"])}
                self.assertEqual(marked, losing)
        change(store, 'UPDATE points SET "bound.system" = 0.9 * "frames_per_second.steady" '
                      'WHERE lost_pixels = 0 AND "matcher.window" = 9')
        order = "[host, result, left_pixel, right_pixel, left_lut, right_lut]"
        self.draw("window", store, only=[f"fpga.priority={order}"])
        self.shows("whole computer, steady frames/s", "from power-up, tables included",
                   "Above the bound by no more than the uncertainty: 1 steady rate.")
        self.assertNotIn("loses pixels", self.texts())
        self.assertEqual(len(self.curves()), 2)


class Stalls(FigureTest):
    def test_those_points_are_shown_that_wait_most(self):
        store = self.sweep(ALLOCATIONS)
        self.draw("stalls", store)
        rows, blame = self.database(store)
        shown = {row["hash"] for row in self.table}
        self.assertEqual(len(shown), 16)
        self.shows("The 16 points whose ports wait most in a frame.", "for left_pixel",
                   "fpl2003, source preloaded: 16 of 24 points of points.db; not shown: 8 with fewer waits.",
                   "thousand cycles a frame in which the port waits")
        found = sorted((row["hash"], row["port"], row["bank"], row["by"], float(row["cycles"]))
                       for row in self.table)
        self.assertEqual(found, sorted(row for row in blame if row[0] in shown))
        stalls_of = {key: sum(row[4] for row in blame if row[0] == key) / rows[key]["frames"] for key in rows}
        least = min(stalls_of[key] for key in shown)
        self.assertLessEqual(max(stalls_of[key] for key in set(rows) - shown), least)


class ParetoFront(FigureTest):
    COLUMNS = ("area.luts", "latency_ms.capture_to_host.p50", "pci.clocks")
    HEADER = ("name", "run.source", "fpga.clock_mhz", *COLUMNS)

    def front(self, store, *senses):
        """Draws it with the smallest or largest values, min or max, as the best ones."""
        return self.draw("pareto", store, pareto=",".join(f"{column}:{sense}" for column, sense
                                                          in zip(self.COLUMNS, senses)))

    def is_better(self, one, other, senses):
        """In one column at least, and in none worse."""
        signs = [1 if sense == "min" else -1 for sense in senses]
        one, other = ([sign * value for sign, value in zip(signs, pair)] for pair in (one, other))
        return all(a <= b for a, b in zip(one, other)) and one != other

    def test_is_that_of_a_comparison_of_all_with_all(self):
        generator = random.Random(1)
        made = [(generator.randrange(12), generator.randrange(12) / 4, generator.randrange(5))
                for _ in range(60)]  # with equal ones
        rows = [("made", "preloaded", number, *each) for number, each in enumerate([*made, (3, None, 1)])]
        store = make_database(self.folder / "random.db", self.HEADER, rows)
        for senses in (("min", "max"), ("max", "min"), ("min", "min"), ("max", "max"), ("min", "max", "min"),
                       ("max", "max", "max")):
            with self.subTest(senses):
                values = [each[:len(senses)] for each in made]
                best = [one for one in values
                        if not any(self.is_better(other, one, senses) for other in values)]
                self.assertEqual(self.front(store, *senses), f"60 points, {len(best)} of them on the front")
                self.assertEqual(len(self.table), len(made))
                front = [tuple(float(row[column]) for column in self.COLUMNS[:len(senses)])
                         for row in self.table if row["front"] == "1"]
                self.assertEqual("pci.clocks" in " ".join(self.texts()), len(senses) == 3)
                self.assertEqual(sorted(front), sorted(best))
        self.is_from(store, self.table, "front")

    def test_points_are_named_by_what_varies(self):
        rows = [("made", "preloaded", *row, 1)
                for row in ((40, 5, 9), (50, 7, 12), (60, 7, 12), (70, 8, 11))]
        self.front(make_database(self.folder / "named.db", self.HEADER, rows), "min", "max")
        self.shows("1  clock_mhz=40", "2  2 points", "area.luts, less is better")


class Names(FigureTest):
    def test_are_shown_as_they_are(self):
        """Neither as mathematics nor as parts of the drawing, wherever they are."""
        names = ["<script>alert('$x^2$')</script>", '_b $\\alpha$ 100 % "c" \\n', "$\\frac{1"]
        header = [*HEADER, "allocation.disparity", *RATES, "frames"]
        rows = [(name, "preloaded", window, "[bank0]", number * 9 / window, 99, 1)
                for number, name in enumerate(names, 1) for window in (3, 5)]
        store = make_database(self.folder / "$x_2$ <i> 5%.db", header, rows)
        change(store, "INSERT INTO blame SELECT hash, 'left_lut', '$b$', 'result', 5 FROM points")
        for figure in ("window", "stalls"):
            self.draw(figure, store)
            drawing = xml.etree.ElementTree.fromstring(self.svg)
            self.assertEqual([each.tag for each in drawing.iter() if "script" in each.tag], [])
            texts = " ".join(drawing.itertext())
            for name in names:
                self.assertIn(name, texts)
            self.assertIn("6 of 6 points of $x_2$ <i> 5%.db.", texts)


if __name__ == "__main__":
    program.main()
