"""sweep and merge: plans, their databases, what is continued."""

import os
import re
import signal
import sqlite3
import subprocess
import time

import program
from interrupt_test import Terminal
from program import HEIGHT, WIDTH, ProgramTest, run

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


class SweepTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.plan = self.file("plan.yaml", PLAN.encode())
        self.store = self.folder / "points.db"

    def sweep(self, *more, plan=None, store=None):
        return run("sweep", plan or self.plan, "--out", store or self.store, *more)

    def query(self, sql, store=None):
        connection = sqlite3.connect(f"file:{store or self.store}?mode=ro", uri=True)
        try:
            return connection.execute(sql).fetchall()
        finally:
            connection.close()


class Sweep(SweepTest):
    def test_keeps_what_each_run_says(self):
        said = self.succeeds(self.sweep())
        self.assertIn(f"{POINTS} points: {POINTS - IMPOSSIBLE} ok, {IMPOSSIBLE} impossible, 0 failed", said)
        self.assertIn(f"points.db: {POINTS} points\n", said)
        reasons = said[said.index("points.db: "):]  # of all that the database holds
        self.assertIn(f"  {IMPOSSIBLE // 2} impossible: allocation.right_image = [bank3]: must be as long as", reasons)
        rows = self.query("SELECT config, cycles, \"banks.bank6.reads\", \"frames_per_second.core\", \"run.frames\", "
                          "\"bound.core_limited_by\", hash FROM points WHERE status = 'ok'")
        self.assertEqual(len(rows), POINTS - IMPOSSIBLE)
        for config, cycles, reads, rate, frames, limited_by, key in rows:
            board = self.file("board.yaml", config.encode())
            self.succeeds(run("run", board, "--source", "preloaded", "--timing-only", "--frames", frames, "--out", self.out))
            stats = self.stats()
            self.assertEqual(cycles, stats["cycles"])
            self.assertEqual(reads, [bank["reads"] for bank in stats["banks"] if bank["name"] == "bank6"][0])
            self.assertEqual(rate, stats["frames_per_second"]["core"])
            self.assertEqual(limited_by, stats["bound"]["core_limited_by"])
            blame = self.query(f"SELECT port, bank, by, cycles FROM blame WHERE hash = '{key}'")
            self.assertEqual(sorted(blame), sorted(tuple(row.values()) for row in stats["blame"]))
            self.assertEqual((self.out / "config.yaml").read_text(), config)
        self.assertGreater(self.query("SELECT count(*) FROM blame")[0][0], 0)

    def test_keeps_what_was_asked_for_where_it_is_impossible(self):
        self.succeeds(self.sweep())
        rows = self.query("SELECT config, reason, \"allocation.right_image\" FROM points WHERE status = 'impossible'")
        self.assertEqual(len(rows), IMPOSSIBLE)
        for config, reason, banks in rows:
            board = self.file("board.yaml", config.encode())
            self.assertIn(f"right_image: {banks}\n", config.replace("right_image: bank3", "right_image: [bank3]"))
            process = run("run", board, "--source", "preloaded", "--timing-only")
            self.assertEqual([line.split(": ", 1)[1] for line in self.refused(process)], [reason])

    def test_gives_the_same_bytes_for_jobs_and_shards(self):
        self.succeeds(self.sweep("--jobs", 1))
        expected = self.store.read_bytes()
        two = self.folder / "two.db"
        self.succeeds(self.sweep("--jobs", 2, store=two))
        self.assertEqual(two.read_bytes(), expected)
        shards = [self.folder / f"shard{number}.db" for number in range(3)]
        for number, store in enumerate(shards):
            said = self.succeeds(self.sweep("--shard", f"{number}/3", store=store))
            self.assertIn(f"4 points in shard {number}/3: ", said)
        merged = self.folder / "merged.db"
        said = self.succeeds(run("merge", merged, *reversed(shards)))
        self.assertEqual(said, f"{merged}: {POINTS} points of 3 databases\n")
        self.assertEqual(merged.read_bytes(), expected)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir() if "wal" in path.name), [])

    def test_continues_its_database(self):
        self.succeeds(self.sweep())
        expected = self.store.read_bytes()
        self.assertIn(f"0 ok, 0 impossible, 0 failed, {POINTS} there already", self.succeeds(self.sweep()))
        self.assertEqual(self.store.read_bytes(), expected)
        more = self.file("more.yaml", PLAN.replace("[3, 5, 7]", "[7, 9]").encode())
        said = self.succeeds(self.sweep(plan=more))
        self.assertIn("2 ok, 2 impossible, 0 failed, 4 there already", said)
        self.assertIn(f"points.db: {POINTS + 4} points", said)

    def test_leaves_out_what_another_database_has(self):
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        plan = self.file("more.yaml", PLAN.replace("[3, 5, 7]", "[7, 9]").encode())
        more = self.folder / "more.db"
        self.assertIn("2 ok, 2 impossible, 0 failed, 4 there already",
                      self.succeeds(self.sweep("--known", self.store, plan=plan, store=more)))
        self.assertEqual(self.query("SELECT DISTINCT \"matcher.window\" FROM points", more), [(9,)])
        self.assertEqual(self.store.read_bytes(), before)
        self.assertEqual(list(self.folder.glob("*.db-*")), [])

    def test_keeps_a_file_with_its_progress(self):
        progress = self.folder / "progress"
        for known in (0, POINTS):  # the second time it replaces its file
            self.succeeds(self.sweep("--progress", progress))
            new = POINTS - IMPOSSIBLE, IMPOSSIBLE
            ok, impossible = new if known == 0 else (0, 0)
            self.assertEqual(progress.read_text(), f"total {POINTS}\nexcluded 0\nknown {known}\nok {ok}\n"
                                                   f"impossible {impossible}\nfailed 0\ngiven_up 0\n")

    def test_of_another_board_than_the_plan_names(self):
        board = self.file("board.yaml", b"extends: fpl2003\nfpga: {clock_mhz: 50}\n")
        self.succeeds(self.sweep("--board", board))
        self.assertEqual(self.query("SELECT DISTINCT \"fpga.clock_mhz\" FROM points"), [(50,)])

    def test_of_the_whole_computer(self):
        plan = self.file("computer.yaml", (PLAN.replace("preloaded", "camera, frames: 3").replace("[3, 5, 7]", "[3]")
                                           + f"where: allocation.left_image = '[bank0, bank1]'\n").encode())
        self.succeeds(self.sweep(plan=plan))
        (row,) = self.query("SELECT config, \"frames_per_second.steady\", \"pci.busy_clocks\", \"cameras.left.frames\" "
                            "FROM points WHERE status = 'ok'")
        board = self.file("board.yaml", row[0].encode())
        self.succeeds(run("run", board, "--timing-only", "--frames", 3, "--out", self.out))
        stats = self.stats()
        self.assertEqual(row[1:], (stats["frames_per_second"]["steady"], stats["pci"]["busy_clocks"],
                                   stats["cameras"][0]["frames"]))


class Links(SweepTest):
    """A link to a file is the name of that file, for whatever writes one."""

    def setUp(self):
        super().setUp()
        (self.folder / "real").mkdir()
        self.store.symlink_to("real/points.db")
        self.real = self.folder / "real" / "points.db"

    def of_link(self, count, process):
        self.succeeds(process)
        self.assertTrue(self.store.is_symlink())
        self.assertEqual(self.query("SELECT count(*) FROM points", self.real), [(count,)])
        self.assertEqual([path.name for path in self.real.parent.iterdir()], ["points.db"])

    def test_to_databases_and_their_modes_stay(self):
        self.of_link(POINTS, self.sweep())
        self.real.chmod(0o640)
        more = self.file("more.yaml", PLAN.replace("[3, 5, 7]", "[7, 9]").encode())
        self.of_link(POINTS + 4, self.sweep(plan=more))
        other = self.folder / "other.db"
        self.succeeds(self.sweep(plan=self.file("last.yaml", PLAN.replace("[3, 5, 7]", "[11]").encode()), store=other))
        self.of_link(POINTS + 8, run("merge", self.store, other, self.store))
        self.succeeds(run("allocate", "fpl2003", "--source", "preloaded", "--banks", 4, "--out", self.store,
                          *program.SMALL))
        self.assertTrue(self.store.is_symlink())
        self.assertEqual([path.name for path in self.real.parent.iterdir()], ["points.db"])
        self.assertEqual(self.real.stat().st_mode & 0o7777, 0o640)

    def test_to_files_of_progress_stay(self):
        progress = self.folder / "progress"
        target = self.file("counts", b"")
        target.chmod(0o640)
        progress.symlink_to(target)
        self.succeeds(self.sweep("--progress", progress))
        self.assertTrue(progress.is_symlink())
        self.assertIn(f"total {POINTS}\n", target.read_text())
        self.assertEqual(target.stat().st_mode & 0o7777, 0o640)


class Names(SweepTest):
    def test_that_sqlite_would_take_for_no_file_are_files(self):
        for name in (":memory:", "file:x.db", "file::memory:?cache=shared"):
            process = run("sweep", self.plan, "--out", name, cwd=self.folder)
            self.assertIn(f"\n{name}: {POINTS} points\n", self.succeeds(process))
            self.assertEqual(self.query_file(name), POINTS)
            self.assertIn(f"{POINTS} there already", self.succeeds(
                run("sweep", self.plan, "--out", "known.db", "--known", name, cwd=self.folder)))
            self.succeeds(run("merge", "file:merged.db", name, cwd=self.folder))
            self.assertEqual(self.query_file("file:merged.db"), POINTS)

    def query_file(self, name):
        connection = sqlite3.connect(self.folder / name)
        self.addCleanup(connection.close)
        return connection.execute("SELECT count(*) FROM points").fetchone()[0]


class Refusals(SweepTest):
    def test_of_plans_name_place_value_and_rule(self):
        plan = self.file("wrong.yaml", PLAN.replace("[3, 5, 7]", "[3, 4, 7]").encode())
        lines = self.refused(self.sweep(plan=plan), f"{plan}:6:23: matcher.window = 4: ")
        self.assertEqual(lines[-1], f"{plan}: the plan would have {POINTS} points")
        self.assertFalse(self.store.exists())

    def test_of_conditions_name_their_place_and_leave_out_nothing_in_silence(self):
        for condition, reason in (
            ("abs(-9223372036854775808) > 0", "integer overflow"),
            ("name MATCH 'fpl*'", "not an SQL expression over keys: match() depends on more than its arguments"),
            ("random() > 0", "not an SQL expression over keys: random() depends on more than its arguments"),
            ("image.width > ?1", "not an SQL expression over keys: parameters such as ? and :x have no value"),
            ("1)) /*", 'not an SQL expression over keys: near ")": syntax error'),
            ("board.name = 'fpl", "not an SQL expression over keys: unrecognized token: \"'fpl\""),
        ):
            plan = self.file("wrong.yaml", f"{PLAN}where:\n  - {condition}\n".encode())
            lines = self.refused(self.sweep(plan=plan))
            self.assertEqual(lines, [f"{plan}:10:5: where = {condition}: {reason}",
                                     f"{plan}: the plan would have {POINTS} points"])
        self.assertFalse(self.store.exists())

    def test_of_a_condition_that_one_point_shows_to_be_wrong_do_not_advise_to_repeat_it(self):
        condition = "iif(matcher.window = 5, json('{' || image.width), 1)"
        plan = self.file("wrong.yaml", f"{PLAN}where:\n  - {condition}\n".encode())
        process = self.sweep(plan=plan)
        self.assertEqual(process.returncode, 1, process.stderr)
        self.assertEqual(process.stderr, f"stereotlm: error: {plan}:10:5: where = {condition}: malformed JSON; finished "
                                         "points are kept: correct the plan\n")

    def test_of_options(self):
        self.refused_in_one_line(self.sweep("--jobs", 0), "--jobs = 0: must be 1..1024")
        for shard in ("3/3", "1", "x/2", "-1/2", "1/0"):
            self.refused_in_one_line(self.sweep("--shard", shard), f"--shard = {shard}: must be I/N")
        self.refused_in_one_line(self.sweep("--launcher", "pbs"), "--launcher = pbs: must be local or slurm")
        self.refused_in_one_line(self.sweep("--known", self.left), f"--known {self.left}: not a database")
        self.refused_in_one_line(self.sweep("--known", self.folder / "none.db"), "--known ", "No such file or directory")
        self.assertFalse(self.store.exists(), "nothing was to be made")
        none = self.folder / "none" / "progress"
        self.refused_in_one_line(self.sweep("--progress", none), f"--progress {none}: No such file or directory")
        self.assertFalse(self.store.exists(), "nothing was to be made")
        self.refused(self.sweep("--board", "fpl2004"), "fpl2004: not a preset")
        self.refused(self.sweep("--known", "", "--progress", "", "--board", ""), "--known: empty", "--progress: empty",
                     "--board: empty")
        self.refused(run("sweep"), "PLAN: missing", "--out: missing")
        self.refused(run("merge"), "OUT: missing", "DB: missing")

    def test_of_banks_whose_names_differ_only_in_case(self):
        def board(one, other):
            return self.file(f"{one}{other}.yaml", (
                f"extends: fpl2003\nimage: {{width: {WIDTH}, height: {HEIGHT}}}\nmatcher: {{filter: none}}\n"
                f"ssram: {{banks: {{{one}: {{}}, {other}: {{}}}}}}\n"
                f"allocation: {{left_image: {one}, right_image: {other}, disparity: {one}, left_lut: {other}, "
                f"right_lut: {one}}}\n").encode())

        rule = "ssram.banks = A, a: the names differ only in case"
        twins = board("A", "a")
        self.succeeds(run("check", twins))
        plan = self.file("twins.yaml", f"board: {twins}\nrun: {{source: preloaded}}\n".encode())
        self.refused(self.sweep(plan=plan), f"{plan}:1:8: {rule}")
        self.refused_in_one_line(run("allocate", twins, "--source", "preloaded", "--banks", 2, "--out", self.store),
                                 f"{twins}: {rule}")
        self.refused_in_one_line(run("explain", twins, "--source", "preloaded"), f"{twins}: {rule}")
        self.assertFalse(self.store.exists())
        self.succeeds(self.sweep("--board", board("a", "b"), plan=plan))
        rule = f"--out {self.store}: its column ssram.banks.a.words differs from ssram.banks.A.words only in case"
        self.refused_in_one_line(self.sweep("--board", board("A", "b"), plan=plan), rule)
        self.refused_in_one_line(run("allocate", board("A", "b"), "--source", "preloaded", "--banks", 2, "--out", self.store),
                                 rule)
        self.assertEqual(self.query("SELECT count(*) FROM points"), [(1,)])

    def test_of_files_that_the_progress_would_replace(self):
        link = self.folder / "link"
        link.symlink_to(self.plan)
        (self.folder / "sub").mkdir()
        around = self.folder / "sub" / ".." / "points.db"
        for path, name in ((self.store, "--out"), (around, "--out"), (self.plan, "PLAN"), (link, "PLAN")):
            self.refused_in_one_line(self.sweep("--progress", path), f"--progress = {path}: is the file of {name}")
        self.assertFalse(self.store.exists())
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        more = self.folder / "more.db"
        self.refused_in_one_line(self.sweep("--known", self.store, "--progress", self.store, store=more),
                                 f"--progress = {self.store}: is the file of --known")
        notes = self.file("notes", b"ok 3\nand more\n")
        for path in (notes, self.left, self.store, self.folder, "/dev/null"):
            self.refused_in_one_line(self.sweep("--progress", path, store=more),
                                     f"--progress = {path}: exists, and was not written by --progress: ")
        self.assertFalse(more.exists())
        self.assertEqual(notes.read_bytes(), b"ok 3\nand more\n")
        self.assertEqual(self.plan.read_text(), PLAN)
        self.assertEqual(self.store.read_bytes(), before)

    def test_of_databases(self):
        self.refused_in_one_line(self.sweep(store=self.left), f"--out {self.left}: not a database")
        self.refused_in_one_line(self.sweep(store=self.folder / "none" / "a.db"), "No such file or directory")
        self.refused_in_one_line(run("merge", self.store, self.left), f"{self.left}: not a database")
        self.assertFalse(self.store.exists())
        self.assertEqual(self.left.read_bytes()[:2], b"P5")


class Interrupted(SweepTest):
    def setUp(self):
        super().setUp()
        self.many = self.file("many.yaml", PLAN.replace(
            "matcher.window: [3, 5, 7]", "matcher.disparities: {from: 1, to: 254, step: 1}").encode())

    def start(self, *more):
        command = [program.PROGRAM, "sweep", str(self.many), "--out", str(self.store), *more]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                start_new_session=True)

    def wait_for_points(self, count):
        end = time.monotonic() + 30
        while time.monotonic() < end:
            try:
                if self.query("SELECT count(*) FROM points")[0][0] >= count:
                    return
            except sqlite3.OperationalError:
                pass  # not there yet
            time.sleep(0.01)
        self.fail("no points")

    def expected(self):
        store = self.folder / "whole.db"
        self.succeeds(self.sweep(plan=self.many, store=store))
        return store.read_bytes()

    @program.slow
    def test_by_the_keyboard_it_says_how_to_go_on(self):
        process = self.start()
        self.wait_for_points(3)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does it: all processes get it
        out, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertRegex(out, r"1016 points: \d+ ok, \d+ impossible, 0 failed, \d+ not begun\n")
        self.assertEqual(errors, "stereotlm: note: interrupted: run the same command to resume\n")
        self.succeeds(self.sweep(plan=self.many))
        self.assertEqual(self.store.read_bytes(), self.expected())

    def test_by_the_loss_of_its_database_it_does_not_say_that_anything_is_kept(self):
        for another in (None, b"", b"another file"):
            process = self.start()
            self.wait_for_points(3)
            self.store.unlink()
            if another is not None:
                self.store.write_bytes(another)
            out, errors = process.communicate(timeout=60)
            self.assertEqual((process.returncode, out), (1, ""), errors)
            self.assertEqual(errors, f"stereotlm: error: {self.store}: was removed or replaced while in use: its "
                                     "points are lost\n")
            for left in self.folder.glob("points.db*"):
                left.unlink()

    def test_by_damage_to_its_database_it_does_not_say_that_anything_is_kept(self):
        process = self.start()
        self.wait_for_points(3)
        with open(self.store, "r+b") as damaged:
            damaged.write(b"damage" * 1000)
        (self.folder / "points.db-wal").write_bytes(b"")
        out, errors = process.communicate(timeout=60)
        self.assertEqual((process.returncode, out), (1, ""), errors)
        self.assertIn("points.db", errors)
        self.assertNotIn("kept", errors)

    def test_when_killed_it_keeps_what_was_done(self):
        process = self.start("--jobs", "2")
        self.wait_for_points(20)
        process.kill()
        process.communicate(timeout=60)
        kept = self.query("SELECT count(*) FROM points")[0][0]
        self.assertGreaterEqual(kept, 20)
        time.sleep(0.2)
        self.assertLessEqual(self.query("SELECT count(*) FROM points")[0][0], kept + 2)  # workers end with it
        said = self.succeeds(self.sweep(plan=self.many))
        self.assertRegex(said, r", \d+ there already")
        self.assertEqual(self.store.read_bytes(), self.expected())

    def test_shows_its_progress(self):
        terminal = Terminal(["sweep", self.many, "--out", self.store])
        terminal.read_until(re.compile(r"\d+/1016 points   \d+\.\d %   \d+\.\d points/s   \S+ left"))
        status, out = terminal.finish()
        self.assertEqual(status, 0)
        self.assertIn("1016 points: 508 ok, 508 impossible", out)


if __name__ == "__main__":
    program.main()
