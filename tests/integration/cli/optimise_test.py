"""optimise: what it prints, keeps, refuses and resumes. That it finds the best is in random_searches_test."""

import json
import random
import shlex
import signal
import sqlite3
import subprocess
import time

import jsonschema

import program
from program import PRELOADED, ProgramTest, run, sets

PLAN = """
board: fpl2003
run: {source: preloaded}
set: {image.width: 32, image.height: 24}
vary:
  matcher.window: [5, 7]
  matcher.units: [all, 40]
  matcher.fetch: [column, line_buffer]
  matcher.rows: [1, 2]
placements: {banks: 3}
maximise: frames_per_second.core
minimise: [area.slices, banks_used]
"""
# With a small FIFO the captures lose pixels.
COMPUTER = """
board: fpl2003
set: {image.width: 64, image.height: 16, cameras.frame_rate_hz: 800, bridge.posted_words: 4,
      fpga.clock_mhz: 1}
vary:
  capture.fifo_words: [4, 16, 140]
  capture.fifo_trigger_words: [4]
  allocation.left_image: [bank0, [bank0, bank1]]
  allocation.right_image: [bank0, [bank2, bank3]]
"""
# Its search takes some seconds.
LONG = PLAN.replace("width: 32", "width: 160").replace("height: 24", "height: 120").replace(
    "placements", "  fpga.arbitration: [round_robin, age]\n  fpga.lane_fifo_slots: [3, 4, 8]\nplacements")


class Optimise(ProgramTest):
    def setUp(self):
        super().setUp()
        self.store = self.folder / "found.db"

    def plan(self, text=PLAN):
        return self.file("plan.yaml", text)

    def found(self, *words):
        document = json.loads(self.succeeds(run("optimise", *words, "--json")))
        schema = json.loads(self.succeeds(run("keys", "--schema", "optimise")))
        jsonschema.Draft202012Validator(schema).validate(document)
        return document

    def test_values_are_those_of_run(self):
        for point in self.found(self.plan())["front"]:
            board = self.file("board.yaml", point["config"])
            self.succeeds(run("run", board, "--timing-only", "--frames", 2, *PRELOADED, "--out", self.out))
            stats = self.stats()
            values = {value["figure"]: value["least"] for value in point["values"]}
            self.assertEqual(values["frames_per_second.core"], stats["frames_per_second"]["core"])
            self.assertEqual(values["area.slices"], stats["area"]["slices"])
            command = shlex.split(point["command"])
            self.assertEqual(command[:5], ["stereotlm", "explain", "fpl2003", "--source", "preloaded"])
            named, written = (json.loads(self.succeeds(run("check", *words, "--json")))["values"]
                              for words in (["fpl2003", *command[5:]], [board]))
            self.assertEqual(named, written)

    def test_accuracy_is_a_goal_and_a_requirement(self):
        """Compared with a sweep of the same plan."""
        plan = ("board: fpl2003\nrun: {source: preloaded, synthetic: [1, 2]}\n"
                "set: {image.width: 64, image.height: 48, matcher.disparities: 16}\n"
                "vary:\n  matcher.window: [3, 5, 7, 9, 11]\n  matcher.lr_tolerance: [0, 1, 2]\n"
                "  matcher.fetch: [column, line_buffer]\n")
        self.succeeds(run("sweep", self.plan(plan), "--out", self.store))
        with sqlite3.connect(self.store) as database:
            rows = database.execute("SELECT accuracy_bad_1_percent, -frames_per_second_core FROM plain "
                                    "WHERE accuracy_answered_percent >= 80").fetchall()
        self.assertGreater(30, len(rows))
        front = {a for a in rows if not any(b != a and b[0] <= a[0] and b[1] <= a[1] for b in rows)}
        self.store.unlink()
        wishes = ["--minimise", "accuracy.bad_1_percent", "--maximise", "frames_per_second.core", "--for",
                  "accuracy.answered_percent >= 80"]
        for _ in range(2):  # the second time it is read
            found = self.found(self.plan(plan), *wishes, "--out", self.store)
            values = [[value["least"] for value in point["values"]] for point in found["front"]]
            self.assertEqual({(bad, -rate) for rate, bad in values}, front)
        without = plan.replace(", synthetic: [1, 2]", "")
        self.refused_in_one_line(run("optimise", self.plan(without), *wishes),
                                 "accuracy.bad_1_percent: of pictures: give run.pairs or run.synthetic")

    def test_a_computer_that_loses_pixels_does_not_count(self):
        """Compared with a sweep of the same plan."""
        plan = COMPUTER + "run: {source: camera}\n"
        self.succeeds(run("sweep", self.plan(plan), "--out", self.store))
        with sqlite3.connect(self.store) as database:
            rows = database.execute("SELECT frames_per_second_steady, frames_per_second_steady_uncertainty, "
                                    "frames_per_second_exact_least, frames_per_second_exact_most, "
                                    "lost_pixels FROM plain WHERE status = 'ok'").fetchall()
        whole = [(max(rate - uncertainty, proven[0]), min(rate + uncertainty, proven[1]))
                 for rate, uncertainty, *proven, lost in rows if lost == 0]
        self.assertTrue(0 < len(whole) < len(rows), rows)
        least = max(least for least, _ in whole)
        for wish in ("--minimise", "--maximise"):  # nor where the rate is no goal
            with sqlite3.connect(self.store) as database:
                clocks = [value for value, in database.execute("SELECT pci_busy_clocks FROM plain WHERE "
                                                               "status = 'ok' AND lost_pixels = 0")]
            (best, _), = self.values(self.plan(plan), wish, "pci.busy_clocks")
            self.assertEqual(best, min(clocks) if wish == "--minimise" else max(clocks))
        found = self.found(self.plan(plan), "--maximise", "frames_per_second.steady")
        boards = sum(point["boards"] for point in found["front"])
        # The bound may cut the range of a rate, and so rule out more.
        self.assertTrue(1 <= boards <= sum(most >= least for _, most in whole))
        self.assertIn(least, [point["values"][0]["least"] for point in found["front"]])

    def test_a_goal_with_the_rate_of_a_computer_lies_between_those_of_both_ends(self):
        plan = self.plan("board: fpl2003\nset: {image.width: 48, image.height: 32}\nrun: {source: camera}\n"
                         "vary:\n  matcher.disparities: [8, 16]\nplacements: {banks: 2}\n")
        points = self.found(plan, "--maximise", "round(frames_per_second.steady)",
                            "--minimise", "area.slices", "--minimise", "banks_used")["front"]
        self.assertEqual([[(value["least"], value["most"]) for value in point["values"]] for point in points],
                         [[(30, 30), (points[0]["values"][1]["least"],) * 2, (1, 1)]])
        best = self.found(plan, "--maximise", "frames_per_second.steady / area.slices")["front"]
        for value in (point["values"][0] for point in best):
            self.assertTrue(0.97 < value["least"] * points[0]["values"][1]["least"] / 29.97 <= 1, value)
        self.fails(run("optimise", plan, "--maximise", "abs(frames_per_second.steady - 29.9699)",
                       "--quiet"),
                   "abs(frames_per_second.steady - 29.9699): the rate of a board lies between 29.9",
                   "frames/s: the goal must rise all the way between them, or fall")

    def test_bytes_depend_on_the_search_alone(self):
        """Killed at random and resumed, with any number of processes."""
        plan = self.plan(LONG)
        self.succeeds(run("optimise", plan, "--out", self.store, "--jobs", 1))
        expected = self.store.read_bytes()
        again = self.succeeds(run("optimise", plan, "--out", self.store))
        self.assertEqual(self.store.read_bytes(), expected)
        chance = random.Random(1)
        self.store.unlink()
        killed = 0
        for _ in range(30):
            process = self.start("optimise", plan, "--out", self.store, "--jobs", chance.randint(1, 3))
            time.sleep(chance.uniform(0, 0.7))
            process.kill()
            status = process.wait()
            killed += status == -signal.SIGKILL
            if status == 0:
                break
        self.assertGreater(killed, 0)
        self.assertEqual(self.succeeds(run("optimise", plan, "--out", self.store)), again)
        self.assertEqual(self.store.read_bytes(), expected)

    def test_an_interrupt_gives_the_best_so_far(self):
        plan = self.plan(LONG)
        process = run("optimise", plan, "--out", self.store, "--within", "0.3s")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertRegex(process.stdout, r"not proven: [\d.e+]+ boards: \d+ open, \d+ simulated")
        self.succeeds(run("optimise", plan, "--out", self.store))
        with sqlite3.connect(self.store) as database:
            parts = database.execute("SELECT first, last FROM parts ORDER BY first").fetchall()
            query = "SELECT value FROM search WHERE name = 'combinations'"
            combinations, = database.execute(query).fetchone()
        self.assertEqual([first for first, _ in parts], [0] + [last + 1 for _, last in parts[:-1]])
        self.assertEqual(parts[-1][1], combinations - 1)

    def test_a_database_that_appears_in_its_place_is_kept(self):
        """It is of another search that has not ended, which the command could continue."""
        other = self.folder / "other.db"
        plan = self.file("other.yaml", LONG.replace("[3, 4, 8]", "[3, 5]"))
        self.succeeds(run("optimise", plan, "--out", other, "--within", "0.5s"))
        content = other.read_bytes()
        command = program.words(["optimise", self.plan(LONG), "--out", self.store])
        pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        with subprocess.Popen(command, text=True, **pipes) as process:
            program.wait_until(lambda: self.store.exists() and self.store.stat().st_size > 0)
            self.store.rename(self.folder / "aside.db")
            other.rename(self.store)
            _, errors = process.communicate()
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("found.db", errors)
        self.assertEqual(self.store.read_bytes(), content)

    def test_says_why_a_board_is_not_the_best(self):
        ask = ["optimise", self.plan(), "--for", "area.slices < 12000"]
        text = self.succeeds(run(*ask, "--why", "matcher.window=9"))
        self.assertRegex(text, r"this board (has|can at best have) frames_per_second.core \d+.*the better")
        text = self.succeeds(run(*ask, "--why", "matcher.disparities=200"))
        self.assertIn("this board does not meet area.slices < 12000", text)
        text = self.succeeds(run(*ask, "--why", "matcher.rows=3", "--why", "matcher.fetch=line_buffer"))
        self.assertIn("this board is refused: matcher.rows = 3: must be 1", text)

    def test_a_key_that_a_kind_of_bank_misses_is_missing_in_any_placement(self):
        """With placements, the kind without its key was evaluated, and ended the search."""
        kinds = PLAN.replace("placements", "  ssram.default.kind: [zbt_pipelined, sync_burst]\nplacements")
        one_kind, both = [self.found(self.plan(text)) for text in (PLAN, kinds)]
        self.assertEqual(both["boards"], one_kind["boards"])
        self.assertEqual([point["values"] for point in both["front"]],
                         [point["values"] for point in one_kind["front"]])
        text = self.succeeds(run("optimise", self.plan(), "--why", "ssram.default.kind=sync_burst"))
        self.assertIn("this board is refused: ssram.default.turnaround_cycles: missing: 1..16", text)

    def test_shows_the_values_of_the_plan(self):
        axes = "  ssram.default: [{words: 4096, kind: qdr}]\n  run.frames: [2]\n"
        plan = PLAN.replace("placements", axes + "placements")
        text = self.succeeds(run("optimise", self.plan(plan)))
        self.assertIn("ssram.default: {words: 4096, kind: qdr}, run.frames: 2", " ".join(text.split()))

    def test_a_store_without_results_is_free(self):
        """Such as that of a search that ended with an error."""
        plan = PLAN.replace("minimise: [area.slices,", "minimise: [area.pins_percent,")
        process = run("optimise", self.plan(plan), "--out", self.store)
        self.assertEqual((process.returncode, process.stderr.splitlines()[-1]), (
            1, "stereotlm: error: area.pins_percent: a board of the plan does not have this figure"))
        self.succeeds(run("optimise", self.plan(), "--out", self.store))
        plan = plan.replace("vary:", "vary:\n  fpga.package: [ff1152, ff1517]")
        values = self.found(self.plan(plan))["front"][0]["values"]
        self.assertEqual([value["figure"] for value in values],
                         ["frames_per_second.core", "area.pins_percent", "banks_used"])

    def test_says_what_leaves_nothing(self):
        ask = ["optimise", "fpl2003", *sets("image.width=32", "image.height=24"), "--minimise", "area.slices"]
        text = self.succeeds(run(*ask, "--for", "frames_per_second.core >= 1000000"))
        self.assertRegex(text, r"no board meets frames_per_second.core >= 1000000: the nearest has \d+")
        text = self.succeeds(run(*ask, "--for", "frames_per_second.core >= 20000"))
        self.assertRegex(text, r"the first of them: stereotlm explain fpl2003 --set image.width=32")

    def test_names_the_figure_that_is_nearest_to_one_that_no_board_has(self):
        process = run("optimise", self.plan(), "--minimise", "ports.left_pixl.grants")
        self.assertEqual((process.returncode, process.stderr), (
            1, "stereotlm: error: ports.left_pixl.grants: a board of the plan does not have this figure; "
            "nearest: ports.left_pixel.grants\n"))

    def test_says_why_no_board_is_left(self):
        for where, and_steady, why in (
                ("window = 9", False, "where leaves out every board, or those that are left lose pixels\n"),
                ("capture.fifo_words = 4", False, "or those that are left lose pixels\n"),
                ("window = 9", True, "where leaves out every board, or those that are left lose pixels\n"),
                ("capture.fifo_words = 4", True, "or those that are left lose pixels\n")):
            plan = f"{COMPUTER}run: {{source: camera}}\nwhere: [\"{where}\"]\nminimise: area.slices\n"
            if and_steady:
                plan += "maximise: frames_per_second.steady\n"
            self.assertIn(why, self.succeeds(run("optimise", self.plan(plan))))
        core_alone = self.plan(PLAN + "where: [window = 11]\n")
        self.assertIn("where leaves out every board\n", self.succeeds(run("optimise", core_alone)))
        plan = COMPUTER.replace("[4, 16, 140]", "[4]") + "run: {source: camera}\n"
        text = self.succeeds(run("optimise", self.plan(plan + "maximise: frames_per_second.steady\n")))
        self.assertIn("every board loses pixels\n", text)
        plan = PLAN.replace("rows: [1, 2]", "rows: [2]\n  fpga.result_fifo_words: [1]")
        self.assertIn("no combination is a board; the first: fpga.result_fifo_words = 1: at least 2",
                      self.succeeds(run("optimise", self.plan(plan))))

    def values(self, *words):
        return [[value["least"] for value in point["values"]] + [point["boards"]]
                for point in self.found(*words)["front"]]

    def test_a_requirement_on_an_uncertain_rate_may_be_written_in_any_way(self):
        """All four boards have steady 29.97 with an uncertainty, and lose no pixels."""
        plan = self.plan("board: sdram\nrun: {source: camera, frames: 20}\n"
                         "vary: {matcher.lr_tolerance: [0, 1], pci.latency_timer_clocks: [32, 64]}\n"
                         "set: {image.width: 160, image.height: 120}\nmaximise: matcher.lr_tolerance\n")
        rate = "frames_per_second.steady"
        for condition in (f"{rate} >= 20", f"20 <= {rate}", f"{rate} * 2 >= 40", f"{rate} > 2e1",
                          f"{rate} BETWEEN 20 AND 40", f"{rate} >= 20 AND pins > 0"):
            self.assertEqual(self.values(plan, "--for", condition), [[1, 2]], condition)
        # One that lies within the range is open, and the answer says so.
        self.found(plan, "--for", f"{rate} >= 29")
        text = self.succeeds(run("optimise", plan, "--for", f"{rate} >= 29.97"))
        self.assertRegex(text, rf"no board surely meets {rate} >= 29.97: the nearest has [\d.]+ ± [\d.]+, "
                         "which leaves it open")
        text = self.succeeds(run("optimise", plan, "--for", f"{rate} >= 29.97", "--why",
                                 "matcher.lr_tolerance=1"))
        self.assertIn(f"this board does not meet {rate} >= 29.97 for sure: its rate is 2", text)
        for condition in (f"{rate} >= 31", f"31 <= {rate}", f"{rate} BETWEEN 31 AND 40"):
            self.assertEqual(self.found(plan, "--for", condition)["front"], [], condition)

    def test_a_goal_that_does_not_rise_all_the_way_has_no_bound(self):
        plan = self.plan("board: fpl2003\nrun: {source: preloaded}\nplacements: {banks: 4}\n"
                         "set: {image.width: 64, image.height: 48, matcher.window: 5, "
                         "matcher.disparities: 16}\n"
                         "vary: {matcher.units: [all, 8]}\n")
        rates = [row[0] for row in self.values(plan, "--maximise", "frames_per_second.core", "--minimise",
                                               "frames_per_second.core")]
        self.assertGreater(len(rates), 10)
        for aim in sorted(rates)[1:-1:7]:
            goal = f"abs(frames_per_second.core - {aim + 0.01})"
            (distance, boards), = self.values(plan, "--minimise", goal)
            self.assertAlmostEqual(distance, min(abs(rate - aim - 0.01) for rate in rates), 9)
            self.assertGreater(boards, 0)
        # With the number of decimals the value rises and falls, so a bound would rule out the best.
        decimals = "round(3.14159265, frames_per_second.core / 600)"
        places = sorted({float(f"{3.14159265:.{int(rate / 600)}f}") for rate in rates})
        self.assertGreater(len(places), 2)
        self.assertEqual(self.values(plan, "--maximise", decimals)[0][0], places[-1])
        self.assertEqual(self.values(plan, "--minimise", decimals)[0][0], places[0])

    def test_names_of_three_parts_stand_in_expressions(self):
        loads = ", ".join(f"{{burst_words: {words}, interval_us: 10}}" for words in (8, 9))
        plan = self.plan("board: fpl2003-qvga\nrun: {source: preloaded}\nvary:\n  matcher.rows: [1, 2]\n"
                         f"  pci.load: [{loads}]\nwhere: pci.load.burst_words * 2 > 16\n")
        grants = "ports.left_pixel.grants"
        alone = self.values(plan, "--minimise", grants)
        self.assertEqual(alone[0][1], 1)  # `where` leaves half of the boards
        self.assertEqual(self.values(plan, "--minimise", f"{grants} + pci.load.burst_words * 0.5"),
                         [[alone[0][0] + 4.5, 1]])
        self.assertEqual(self.found(plan, "--minimise", "pins")["boards"], 2)  # those that `where` leaves

    def test_all_boards_that_the_cameras_hold_at_60_tie(self):
        """The time of a frame at 60 Hz is no whole number of ps."""
        plan = self.plan("""
board: fpl2003
run: {source: camera, frames: 20}
set: {image.width: 48, image.height: 32, cameras.frame_rate_hz: 60,
      allocation.left_image: bank0, allocation.right_image: bank2, matcher.fetch: line_buffer}
vary: {bridge.posted_words: [1, 8, 64], bridge.dma_burst_words: [1, 32]}
maximise: frames_per_second.steady
""")
        points = self.found(plan)["front"]
        self.assertEqual(sum(point["boards"] for point in points), 6)
        self.assertEqual({point["values"][0]["most"] for point in points}, {60})
        # Ranges that are less than a thousandth wide are printed with more decimals.
        text = self.succeeds(run("optimise", plan))
        self.assertIn("59.99", text)
        self.assertNotIn("± 0.000 ", text)
        self.assertEqual(self.found(plan, "--for", "frames_per_second.steady < 60")["front"], [])

    def test_a_knob_of_the_command_keeps_its_value(self):
        words = ["fpl2003", *sets("image.width=32", "image.height=24", "matcher.units=64"), "--banks", 2,
                 "--maximise", "frames_per_second.core"]
        text = self.succeeds(run("optimise", *words))
        self.assertNotIn("matcher.units", text.split("proven")[0].split("stereotlm")[0])
        command = shlex.split(text.split("the first of them: stereotlm explain ")[1].split("\n")[0])
        self.assertIn("matcher.units=64", command)
        self.succeeds(run("check", *(word for word in command if word not in ("--source", "preloaded"))))
        varied = self.succeeds(run("optimise", *words[:5], *words[7:]))
        self.assertIn("matcher.units: all, 40, 27, 20;", varied)
        names = self.plan("board: fpl2003\nrun: {source: preloaded}\nvary: {name: ['1', '[a']}\n"
                          "maximise: pins\n")
        command = shlex.split(self.found(names)["front"][0]["command"])
        self.succeeds(run("check", command[2], *sets(command[-1])))

    def test_a_board_of_pictures_of_another_size_is_impossible(self):
        left, right, truth = (self.file(name, "P5 64 48 255\n" + "ab" * 32 * 48)
                              for name in ("left.pgm", "right.pgm", "truth.pgm"))
        plan = self.plan(f"board: fpl2003\nrun: {{pairs: [{{left: {left}, right: {right}, truth: {truth}, "
                         "scale: 4}]}\nset: {matcher.disparities: 16, matcher.window: 5}\n"
                         "vary: {image.width: [64, 32], image.height: [48, 24]}\n"
                         "maximise: frames_per_second.core\nminimise: image.width\n")
        text = self.succeeds(run("optimise", plan))
        self.assertIn("1 board in 4 combinations of values", text)
        self.assertIn("3 combinations are no board; the first: run.pairs: ", text)

    def test_says_of_the_best_that_it_is(self):
        """Other placements of these values do not meet the requirement."""
        words = ["fpl2003", "--set", "image.width=64", "--set", "image.height=48", "--banks", 3, "--minimise",
                 "area.slices", "--set", "matcher.rows=1", "--set", "fpga.lanes=1"]
        best = self.values(*words, "--maximise", "frames_per_second.core")[0][0]
        asked = [*words, "--for", f"frames_per_second.core >= {best}", "--why", "matcher.fetch=line_buffer",
                 "--why", "fpga.lane_fifo_slots=8", "--why", "fpga.tables=joint",
                 "--why", "fpga.pixel_cache=word"]
        self.assertIn("this board is one of the best", self.succeeds(run("optimise", *asked)))
        other = self.succeeds(run("optimise", *words, "--why", "matcher.units=10"))
        self.assertIn("this board is no board of the plan, and none of those beats it", other)

    def test_refusals(self):
        two_banks = "allocation.left_lut: [bank6, bank0]"
        self.all_refused([
            (["optimise", "fpl2003"], "fpl2003: no goal: give maximise or minimise, such as maximise: "
             "frames_per_second.core"),
            (["optimise", "fpl2003", "--minimise", "area.slice"],
             "--minimise: area.slice: no such column: area.slice; nearest: area.slices"),
            (["optimise", "fpl2003", "--minimise", "fps"],
             "--minimise: fps: no such column: fps; stereotlm keys, and keys --figures, list the names"),
            (["optimise", "fpl2003", "--minimise", '"area.slices" + 1'], "; write it without quotes"),
            (["optimise", self.file("core.yaml", PLAN), "--maximise", "frames_per_second.steady"],
             "frames_per_second.steady: of a whole computer: give run.source: camera"),
            (["optimise", "fpl2003", "--maximise", "frames_per_second.exact"],
             "--maximise: frames_per_second.exact: not every board has a proven rate: give "
             "frames_per_second.steady, which is the proven rate where there is one"),
            (["optimise", "fpl2003", "--minimise", "frames_per_second.exact_camera_frames"],
             "not every board has a proven rate"),
            (["optimise", "fpl2003", "--minimise", "pins", "--within", "5"],
             "--within = 5: must be a time such as 90s, 5min or 2h"),
            (["optimise", self.plan(), "--set", "fpga.lanes=2"],
             "--set: of a board; a plan has the section set"),
            (["optimise", self.plan(), "--for", "allocation.left_lut = 'bank0'"],
             "--for: allocation.left_lut = 'bank0': allocation.left_lut: names banks, and placements do not "
             "tell banks apart that are alike"),
            (["optimise", self.plan(), "--for", "Allocation .left_lut = 'bank0'"], "names banks"),
            (["optimise", self.file("where.yaml", PLAN + "where: allocation.left_lut <> 'bank0'\n")],
             "names banks, and placements put buffers in all of them"),
            (["optimise", self.file("vary.yaml", PLAN.replace("vary:", "vary:\n  " + two_banks))],
             "allocation.left_lut: its values differ in banks alone, and placements put buffers in all of "
             "them"),
            (["optimise", "fpl2003", "--banks", 8, "--stripes", 4, "--minimise", "pins"],
             "placements: more than 5000000 different placements: give fewer banks, stripes or buffers"),
            (["optimise", "fpl2003", "--banks", 9, "--minimise", "pins"],
             "--banks = 9: must be 1..8, the banks of the board; --set 'ssram.banks.NEW={}' gives it one "
             "more"),
            (["optimise", "fpl2003", "--stripes", 4, "--minimise", "pins"],
             "placements: more than 5000000 different placements"),
            (["optimise", self.file("own.yaml", PLAN.replace("placements: {banks: 3}\n", "")),
              "--stripes", 4],
             "--stripes: goes with --banks N, or with placements in the plan"),
            (["optimise", "fpl2003", "--minimise", "smallest_device"],
             "--minimise: smallest_device: smallest_device is a text: goals and conditions take numbers"),
            (["optimise", "fpl2003", "--minimise", "pins", "--for", "area.slices"],
             "--for: area.slices: no condition: compare it with a number"),
            (["optimise", "fpl2003", "--minimise", "pins", "--for", " (area.slices)"],
             "--for:  (area.slices): no condition"),
            (["optimise", "fpl2003", "--minimise", "pins", "--for", "ssram.default.kind = 'qdr'"],
             "no such column: ssram.default.kind; a key of banks: of these a condition knows only their "
             "number"),
            (["optimise", "fpl2003", "--minimise", "pins", "--for", "pci.load = 'none'"],
             "no such column: pci.load; no single value: name a key below it, or the one of which it is a "
             "part"),
            (["optimise", self.plan(), "--why", "matcher.unitz=3"],
             "--why: matcher.unitz = 3: unknown key; nearest known key: matcher.units"),
            (["optimise", self.file("camera.yaml", COMPUTER + "run: {source: camera}\n"), "--minimise",
              "energy.memory_mj_per_frame"],
             "all boards must run equally long: give run.frames, such as 120"),
        ])
        process = run("sweep", self.plan(), "--out", self.store)
        self.assertEqual(process.returncode, 2)
        self.assertIn("of a search: stereotlm optimise takes this plan", process.stderr)
        self.succeeds(run("optimise", self.plan(), "--out", self.store))
        process = run("optimise", self.plan(), "--out", self.store, "--for", "pins < 500")
        self.assertEqual(process.returncode, 2)
        self.assertIn("holds another search, which differs in its goals, "
                      "requirements or placements: give another file", process.stderr)


if __name__ == "__main__":
    program.main()
