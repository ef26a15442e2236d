"""sweep and merge: plans, their databases, what is continued and what is refused."""

import os
import re
import shlex
import signal
import sqlite3

import program
from program import HEIGHT, WIDTH, ProgramTest, Terminal, run, wait_until
from tracked_files import tracked

PLAN = f"""
board: fpl2003
run: {{source: preloaded}}
set: {{image.width: {WIDTH}, image.height: {HEIGHT}, matcher.filter: none}}
vary:
  matcher.window: [3, 5, 7]
  allocation.left_image: [[bank0, bank1], bank6]
  allocation.right_image: [[bank2, bank3], bank3]
"""
POINTS = 12
IMPOSSIBLE = 6  # the two image lists of different lengths
OK = POINTS - IMPOSSIBLE
MORE = PLAN.replace("[3, 5, 7]", "[7, 9]")  # 4 points that PLAN has, and 4 others

STUDIES = [plan for plan in tracked("results/*/*.yaml") if "\nplacements:" not in plan.read_text()]


class SweepTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.plan = self.file("plan.yaml", PLAN)
        self.store = self.folder / "points.db"

    def sweep(self, *more, plan=None, store=None):
        return run("sweep", plan or self.plan, "--out", store or self.store, *more)

    def query(self, sql, store=None):
        connection = sqlite3.connect(f"file:{store or self.store}?mode=ro", uri=True)
        try:
            return connection.execute(sql).fetchall()
        finally:
            connection.close()

    def points(self, store=None):
        """How many there are; 0 where there is no database yet."""
        try:
            return self.query("SELECT count(*) FROM points", store)[0][0]
        except sqlite3.OperationalError:
            return 0

    def run_point(self, config, *more):
        """stats.json of a run of this board."""
        board = self.file("board.yaml", config)
        self.succeeds(run("run", board, "--timing-only", *more, "--out", self.out))
        return self.stats()


class Sweep(SweepTest):
    def test_reasons_that_are_not_printed_are_counted(self):
        for count, shown in ((4, 4), (6, 3)):
            values = list(range(5, 5 + count))  # above 4 disparities: each is impossible for its own reason
            keys = f"set: {{matcher.disparities: 4}}\nvary: {{matcher.units: {values}}}\n"
            store = self.folder / f"{count} points.db"
            said = self.succeeds(run("sweep", self.file("plan.yaml", f"board: fpl2003\n{keys}"), "--out",
                                     store))
            self.assertEqual(said.count("  1 impossible: matcher.units = "), shown)
            further = re.search(r"  (\d) impossible: \1 further reasons\nAll reasons:\n  (sqlite3 .*)\n$",
                                said)
            if shown == count:
                self.assertIsNone(further)
                continue
            self.assertEqual(int(further[1]), count - shown)
            _, path, statement = shlex.split(further[2])
            self.assertEqual(len(self.query(statement, path)), count)

    def test_each_point_keeps_what_its_run_says(self):
        said = self.succeeds(self.sweep())
        self.assertIn(f"{POINTS} points: {OK} ok, {IMPOSSIBLE} impossible, 0 failed", said)
        self.assertIn(f"points.db: {POINTS} points\n", said)
        reasons = said[said.index("points.db: "):]  # of all that the database holds
        reason = "allocation.right_image = [bank3]: must be as long as"
        self.assertIn(f"  {IMPOSSIBLE // 2} impossible: {reason}", reasons)
        columns = 'cycles, "banks.bank6.reads", "frames_per_second.core", "bound.core_limited_by"'
        rows = self.query(f'SELECT config, hash, "run.frames", {columns} FROM points WHERE status = "ok"')
        self.assertEqual(len(rows), OK)
        for config, key, frames, *figures in rows:
            stats = self.run_point(config, "--source", "preloaded", "--frames", frames)
            (reads,) = (bank["reads"] for bank in stats["banks"] if bank["name"] == "bank6")
            bound = stats["bound"]["core_limited_by"]
            self.assertEqual(figures, [stats["cycles"], reads, stats["frames_per_second"]["core"], bound])
            blame = self.query(f"SELECT port, bank, by, cycles FROM blame WHERE hash = '{key}'")
            self.assertEqual(sorted(blame), sorted(tuple(row.values()) for row in stats["blame"]))
            self.assertEqual((self.out / "config.yaml").read_text(), config)
        self.assertGreater(self.query("SELECT count(*) FROM blame")[0][0], 0)
        columns = 'config, reason, "allocation.right_image"'
        rows = self.query(f"SELECT {columns} FROM points WHERE status = 'impossible'")
        self.assertEqual(len(rows), IMPOSSIBLE)
        for config, reason, banks in rows:
            board = self.file("board.yaml", config)
            asked = banks.replace("[bank3]", "bank3")
            self.assertIn(f"right_image: {asked}\n", config)
            lines = self.refused(run("run", board, "--timing-only"))
            self.assertEqual([line.split(": ", 1)[1] for line in lines], [reason])

    def test_known_points_are_left_out(self):
        more = self.file("more.yaml", MORE)
        other = self.folder / "other.db"
        progress = self.folder / "progress"  # which is replaced
        counts = "total {}\nexcluded 0\nknown {}\nok {}\nimpossible {}\nfailed 0\ngiven_up 0\n"
        self.succeeds(self.sweep("--progress", progress))
        self.assertEqual(progress.read_text(), counts.format(POINTS, 0, OK, IMPOSSIBLE))
        with self.unchanged(self.store):
            said = self.succeeds(self.sweep("--progress", progress))
            self.assertIn(f"0 ok, 0 impossible, 0 failed, {POINTS} there already", said)
            self.assertEqual(progress.read_text(), counts.format(POINTS, POINTS, 0, 0))
            said = self.succeeds(self.sweep("--known", self.store, plan=more, store=other))
            self.assertIn("2 ok, 2 impossible, 0 failed, 4 there already", said)
        self.assertEqual(self.query('SELECT DISTINCT "matcher.window" FROM points', other), [(9,)])
        self.assertEqual(list(self.folder.glob("*.db-*")), [])
        said = self.succeeds(self.sweep(plan=more))
        self.assertIn("2 ok, 2 impossible, 0 failed, 4 there already", said)
        self.assertIn(f"points.db: {POINTS + 4} points", said)

    def test_an_option_replaces_the_board_of_the_plan(self):
        board = self.file("board.yaml", "extends: fpl2003\nfpga: {clock_mhz: 50}\n")
        self.succeeds(self.sweep("--board", board))
        self.assertEqual(self.query('SELECT DISTINCT "fpga.clock_mhz" FROM points'), [(50,)])

    def test_names_that_sqlite_would_take_for_no_file_are_files(self):
        sweep, here = ["sweep", self.plan, "--out"], {"cwd": self.folder}
        merged = self.folder / "file:merged.db"
        for name in (":memory:", "file:x.db", "file::memory:?cache=shared"):
            said = self.succeeds(run(*sweep, name, **here))
            self.assertIn(f"\n{name}: {POINTS} points\n", said)
            said = self.succeeds(run(*sweep, "known.db", "--known", name, **here))
            self.assertIn(f"{POINTS} there already", said)
            self.succeeds(run("merge", merged.name, name, **here))
            self.assertTrue(merged.read_bytes() == (self.folder / name).read_bytes())


class Studies(SweepTest):
    """The plans in results/, which are examples too."""

    @program.slow
    def test_the_first_point_of_each_plan_runs(self):
        names = {plan.parent.name for plan in STUDIES}
        expected = {"arbitration", "bank_kinds", "banks", "buffers", "costs", "fetch", "folds", "rows",
                    "two_banks"}
        self.assertLessEqual(expected, names)
        for plan in STUDIES:
            with self.subTest(plan=plan):
                store = self.folder / f"{plan.parent.name}_{plan.stem}.db"
                said = self.succeeds(self.sweep("--shard", "0/1000000", plan=plan, store=store))
                self.assertIn("1 ok, 0 impossible, 0 failed", said)


@program.slow
class Calibration(SweepTest):
    """Six points with the tables of a rig, of which two lack one: they are impossible."""

    TEXT = """
board: fpl2003
run: {source: preloaded, calibration: RIG}
set: {matcher.filter: none}
vary:
  matcher.window: [5, 7]
  allocation.left_lut: [bank6, bank0, none]
"""

    def setUp(self):
        super().setUp()
        self.rig = self.copy_of_rig()
        self.plan = self.plan_of(self.rig)

    def plan_of(self, rig, name="plan.yaml", text=TEXT):
        return self.file(name, text.replace("RIG", str(rig)))

    def test_each_point_keeps_what_its_run_with_tables_says(self):
        said = self.succeeds(self.sweep())
        reason = "run.calibration: needs a board with both tables, but allocation.left_lut = none"
        self.assertIn("6 points: 4 ok, 2 impossible, 0 failed", said)
        self.assertIn(f"  2 impossible: {reason}\n", said)
        columns = 'config, "run.frames", cycles, "banks.bank0.reads", "ports.left_pixel.grants"'
        for config, frames, *figures in self.query(f"SELECT {columns} FROM points WHERE status = 'ok'"):
            options = ["--source", "preloaded", "--calibration", self.rig, "--frames", frames]
            stats = self.run_point(config, *options)
            (grants,) = (port["grants"] for port in stats["ports"] if port["name"] == "left_pixel")
            self.assertEqual(figures, [stats["cycles"], stats["banks"][0]["reads"], grants])

    def test_the_calibration_is_found_from_the_working_directory_and_replaced_by_the_option(self):
        self.succeeds(self.sweep())
        relative = self.plan_of("rig.yaml", "relative.yaml")
        none = self.plan_of("none.yaml", "none.yaml")
        without = self.plan_of("", "without.yaml", self.TEXT.replace(", calibration: RIG", ""))
        option = ["--calibration", self.rig]
        for plan, *option in ((relative,), (none, *option), (without, *option)):
            store = self.folder / f"{plan.stem}.db"
            self.succeeds(run("sweep", plan, "--out", store, *option, cwd=self.folder))
            self.assertEqual(store.read_bytes(), self.store.read_bytes())
        process = self.sweep(plan=relative)
        self.refused_in_one_line(process, f"{relative}:3:39: run.calibration 'rig.yaml': no such file")


class Refusals(SweepTest):
    """tests/unit/sw/explore has every way in which a plan or a condition is wrong."""

    def test_plans_are_refused_with_place_value_and_rule(self):
        for text, where, rule in (
            (PLAN.replace("[3, 5, 7]", "[3, 4, 7]"), "6:23", "matcher.window = 4: "),
            (f"{PLAN}where:\n  - random() > 0\n", "10:5",
             "where = random() > 0: not an SQL expression over keys: random() depends on more than"),
        ):
            plan = self.file("wrong.yaml", text)
            lines = self.refused(self.sweep(plan=plan), f"{plan}:{where}: {rule}")
            self.assertEqual(lines[-1], f"{plan}: the plan would have {POINTS} points")
        self.assertFalse(self.store.exists())

    def test_a_condition_that_fails_at_one_point_is_to_be_corrected(self):
        condition = "iif(matcher.window = 5, json('{' || image.width), 1)"
        plan = self.file("wrong.yaml", f"{PLAN}where:\n  - {condition}\n")
        problem = f"where = {condition}: malformed JSON; finished points are kept: correct the plan\n"
        self.fails(self.sweep(plan=plan), f"stereotlm: error: {plan}:10:5: {problem}")
        self.assertEqual(list(self.folder.glob(f"{self.store.name}-*")), [])  # it is in its final form

    def test_wrong_options_and_databases_are_refused(self):
        sweep = ["sweep", self.plan, "--out", self.store]
        none = self.folder / "none" / "file"
        shards = ("3/3", "1", "x/2", "-1/2", "1/0")
        with self.unchanged(self.folder):
            self.all_refused([([*sweep, *options], *texts) for options, *texts in (
                (["--jobs", 0], "--jobs = 0: must be 1..1024"),
                *((["--shard", shard], f"--shard = {shard}: must be I/N") for shard in shards),
                (["--launcher", "pbs"], "--launcher = pbs: must be local or slurm"),
                (["--known", self.left], f"--known {self.left}: not a database"),
                (["--known", none], "--known ", "No such file or directory"),
                (["--progress", none], f"--progress '{none}': there is no such folder"),
            )])
            self.all_refused([
                (["sweep", self.plan, "--out", self.left], f"--out {self.left}: not a database"),
                (["sweep", self.plan, "--out", none], "No such file or directory"),
                (["merge", self.store, self.left], f"{self.left}: not a database"),
            ])
            self.refused(self.sweep("--board", "fpl2004"), "fpl2004: not a preset")
            options = ("--known", "--progress", "--board")
            empty = self.sweep(*(word for option in options for word in (option, "")))
            self.refused(empty, *(f"{option}: a value is missing" for option in options))
            self.refused(run("sweep"), "PLAN: missing", "--out: missing")
            self.refused(run("merge"), "OUT: missing", "DB: missing")


class Meanwhile(SweepTest):
    """What happens to a sweep that has begun."""

    def setUp(self):
        super().setUp()
        keys = "matcher.window: [3, 5, 7, 9]\n  matcher.disparities: {from: 1, to: 254, step: 1}"
        self.many = self.file("many.yaml", PLAN.replace("matcher.window: [3, 5, 7]", keys))

    def begin(self):
        """A process with some points done."""
        process = self.start("sweep", self.many, "--out", self.store, start_new_session=True)
        wait_until(lambda: self.points() >= 3)
        return process

    @program.slow
    def test_an_interrupt_by_the_keyboard_says_how_to_go_on(self):
        process = self.begin()
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does it: all processes get it
        out, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertRegex(out, r"4064 points: \d+ ok, \d+ impossible, 0 failed, \d+ not begun\n")
        note = "interrupted: run the same command to resume"
        self.assertTrue(errors.endswith(f"stereotlm: note: {note}\n"), errors)
        self.succeeds(self.sweep(plan=self.many))
        whole = self.folder / "whole.db"
        self.succeeds(self.sweep(plan=self.many, store=whole))
        self.assertTrue(self.store.read_bytes() == whole.read_bytes())

    def test_a_lost_database_is_not_said_to_be_kept(self):
        process = self.begin()
        self.store.unlink()
        gone = f"{self.store}: was removed or replaced while in use: its points are lost"
        self.ends(process, 1, errors=f"stereotlm: error: {gone}\n")

    @program.slow
    def test_a_terminal_shows_its_progress(self):
        terminal = Terminal(["sweep", self.many, "--out", self.store])
        terminal.read_until(r"\d+/4064 points, \S+ left")
        status, out = terminal.finish()
        self.assertEqual(status, 0)
        self.assertIn("4064 points: 2032 ok, 2032 impossible", out)


if __name__ == "__main__":
    program.main()
