"""The checker of searches (tests/support/check_search.py): it agrees with searches, and sees what is wrong.

STEREOTLM_SPACES: a folder of spaces that random_searches_test has written; they are checked too.
"""

import os
import pathlib
import re
import sqlite3
import subprocess
import sys

import program
from program import PROGRAM, ProgramTest, run

CHECKER = pathlib.Path(__file__).parents[2] / "support" / "check_search.py"
# Frames are independent: groups of placements. All verdicts but `unmet`, which needs no simulation.
GROUPS = """
board: fpl2003
run: {source: preloaded}
set: {image.width: 16, image.height: 8, matcher.disparities: 8}
vary:
  matcher.window: [3, 5]
  matcher.units: [all, 4]
  matcher.fetch: [column, line_buffer]
  matcher.rows: [1, 2]
  fpga.lanes: {from: 1, to: 2, step: 1}
  ssram.default.kind: [zbt_pipelined, sdram]
where: [matcher.window + fpga.lanes <> 7]
placements: {banks: 2}
maximise: frames_per_second.core
minimise: [area.slices, banks_used]
require: [matcher.window * banks_used > 4]
"""
# Frames depend on each other; banks differ, in one key or more.
SINGLE = """
board: board.yaml
run: {source: preloaded}
vary:
  fpga.arbitration: [fixed_priority, round_robin]
zip: [{fpga.lane_fifo_slots: [4, 16], fpga.result_fifo_words: [8, 2]}]
placements: {banks: 2, stripes: 2}
maximise: frames_per_second.core
minimise: [energy.memory_mj_per_frame]
"""
# Whole computers: some lose pixels, and a rate is a range.
COMPUTER = """
board: fpl2003
run: {source: camera}
set: {image: {width: 48, height: 32}, cameras.frame_rate_hz: 900, fpga.clock_mhz: 2,
      capture.fifo_trigger_words: 4, bridge.posted_words: 4}
vary:
  matcher.disparities: [8, 16]
  matcher.window: [3, 7]
  capture.fifo_words: [2, 8, 140]
placements: {banks: 2}
maximise: [frames_per_second.steady, matcher.disparities]
minimise: [area.slices, banks_used]
require: frames_per_second.steady >= 150
"""
BOARD = """
extends: fpl2003
name: small
image: {width: 12, height: 6}
ssram:
  default: {kind: sync_burst, words: 300, turnaround_cycles: 2}
  banks: {a: {}, b: {turnaround_cycles: 4}}
allocation: {left_image: a, right_image: a, disparity: a, left_lut: a, right_lut: b}
matcher: {window: 3, disparities: 4}
"""


class CheckSearch(ProgramTest):
    def setUp(self):
        super().setUp()
        self.store = self.folder / "found.db"

    def search(self, plan):
        self.file("plan.yaml", plan)
        self.file("board.yaml", BOARD)
        self.succeeds(run("optimise", "plan.yaml", "--out", self.store, cwd=self.folder))

    def check(self, folder=None, loops=40):
        words = [sys.executable, "-B", CHECKER, self.store, PROGRAM, "--loops", str(loops), "--boards", "800"]
        return subprocess.run(words, cwd=folder or self.folder, capture_output=True, text=True, check=False)

    def agrees(self, *what):
        process = self.check()
        self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
        loops = re.findall(r"(\d+) run in the loop", process.stdout)
        self.assertEqual(sum(map(int, loops)), 40)
        for one in what:
            self.assertRegex(process.stdout, rf"[1-9]\d* {one}, boards")

    def test_agrees_with_searches(self):
        self.search(GROUPS)
        self.agrees("impossible", "excluded", "bound", "dominated", "front", "unmet")
        self.store.unlink()
        self.search(SINGLE)
        self.agrees("dominated", "front")
        self.store.unlink()
        self.search(GROUPS + "sample: {points: 40, seed: 3}\n")
        self.agrees("impossible", "excluded", "dominated", "front", "unmet")
        self.sees([("UPDATE search SET value = replace(value, 'seed: 3', 'seed: 4') WHERE name = 'plan'",
                    "a board that is possible, or is not|where says otherwise")])

    def test_agrees_with_searches_of_computers(self):
        points = self.folder / "points.db"
        plan = self.file("sweep.yaml", COMPUTER[:COMPUTER.index("placements")])
        self.succeeds(run("sweep", plan, "--out", points))
        with sqlite3.connect(points) as database:
            lost = database.execute("SELECT lost_pixels > 0 FROM plain WHERE status = 'ok'").fetchall()
        self.assertEqual(sorted(lost), [(0,)] * 4 + [(1,)] * 4)
        self.search(COMPUTER)
        process = self.check()
        self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
        for one in ("impossible", "bound", "dominated", "front", "unmet"):
            self.assertRegex(process.stdout, rf"[1-9]\d* {one}, boards")
        self.sees([("UPDATE examined SET fate = 'bound' WHERE fate = 'front'", "nothing on the front beats"),
                   ("UPDATE examined SET results = results + 1 WHERE fate = 'dominated'", "other results"),
                   ("UPDATE front_values SET least = least + 9, most = most + 9 WHERE goal = 0",
                    "boards of the front with other values"),
                   ("UPDATE examined SET fate = 'front' WHERE fate = 'unmet'",
                    "the requirements say otherwise")])

    def test_sees_what_is_wrong(self):
        self.search(GROUPS)
        self.sees([
            ("DELETE FROM parts WHERE verdict = 'bound'", "the parts are no cover"),
            ("UPDATE parts SET verdict = 'impossible' WHERE verdict = 'excluded'",
             "a board that is possible, or is not"),
            ("UPDATE parts SET verdict = 'unmet' WHERE verdict = 'bound'", "the requirements say otherwise"),
            ("UPDATE parts SET verdict = 'bound' WHERE verdict = 'excluded'", "where says otherwise"),
            ("DELETE FROM examined WHERE fate = 'dominated'", "the fates do not cover the placements"),
            ("UPDATE spaces SET placements = '999' WHERE number = 1", "other placements"),
            ("UPDATE examined SET least_cycles = 2 * least_cycles WHERE fate = 'bound'",
             "a bound above the cycles"),
            ("UPDATE examined SET fate = 'bound' WHERE fate = 'front' AND rowid % 2",
             "nothing on the front beats"),
            ("UPDATE examined SET results = results + 1 WHERE fate = 'dominated'", "other results"),
            ("UPDATE front_values SET least = least + 1, most = most + 1 WHERE goal = 0",
             "boards of the front with other values"),
            ("UPDATE front SET boards = boards + 1", "another number of boards has a point"),
            ("DELETE FROM front_values WHERE point = 0", "nothing on the front beats|with other values"),
            ("UPDATE search SET value = value + 1 WHERE name = 'boards'", "another number of boards"),
        ])

    def sees(self, wrong):
        """A statement that spoils the database, and what the checker says then."""
        good = self.store.read_bytes()
        for statement, expected in wrong:
            with self.subTest(statement):
                self.store.write_bytes(good)
                with sqlite3.connect(self.store) as database:
                    self.assertGreater(database.execute(statement).rowcount, 0)
                process = self.check(loops=0)
                self.assertEqual(process.returncode, 1, process.stdout + process.stderr)
                self.assertRegex(process.stdout, expected)

    @program.unittest.skipUnless("STEREOTLM_SPACES" in os.environ, "no random spaces are given")
    def test_agrees_with_random_searches(self):
        for folder in sorted(pathlib.Path(os.environ["STEREOTLM_SPACES"]).iterdir()):
            self.store = self.folder / f"{folder.name}.db"
            self.succeeds(run("optimise", "plan.yaml", "--out", self.store, cwd=folder))
            process = self.check(folder)
            self.assertEqual(process.returncode, 0, f"{folder}\n{process.stdout}{process.stderr}")


if __name__ == "__main__":
    program.main()
