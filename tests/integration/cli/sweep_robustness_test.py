"""sweep on a machine that fails it: full disks, locked or read-only databases, processes that are killed."""

import os
import re
import resource
import subprocess
import sys

import program
from program import HEIGHT, WIDTH, of_plain_user, run
from sweep_test import SweepTest

FULL_DISK = os.path.abspath(sys.argv.pop(1))  # a library, see tests/support/full_disk.cpp

POINTS = 40
PLAN = f"""
board: fpl2003
run: {{source: preloaded}}
set: {{image.width: {WIDTH}, image.height: {HEIGHT}, matcher.filter: none}}
vary:
  matcher.disparities: {{from: 1, to: {POINTS}, step: 1}}
"""
KEPT = "; finished points are kept"


class RobustnessTest(SweepTest):
    def setUp(self):
        super().setUp()
        self.plan = self.file("plan.yaml", PLAN)
        self.disk = self.folder / "disk"
        self.disk.mkdir()
        self.store = self.disk / "points.db"
        self.whole = self.folder / "whole.db"

    def expected(self, plan=None):
        """The bytes of the database of a sweep that nothing has disturbed."""
        self.succeeds(self.sweep(plan=plan, store=self.whole))
        return self.whole.read_bytes()

    def finished(self, expected, plan=None):
        """What the same command prints that, once more, ends well, with these bytes."""
        said = self.succeeds(self.sweep(plan=plan))
        self.assertTrue(self.store.read_bytes() == expected, "the databases differ")
        self.is_in(self.disk, "points.db")
        return said


class FullDisk(RobustnessTest):
    def on_disk_of(self, size, *arguments):
        disk = {"FULL_DISK_FOLDER": str(self.disk.resolve()), "FULL_DISK_BYTES": str(size)}
        return run(*arguments, env={**os.environ, "LD_PRELOAD": FULL_DISK, **disk})

    def test_a_disk_full_at_any_time_loses_nothing(self):
        """From the first byte of the database to the last one of the merge."""
        expected = self.expected()
        full_at_begin = full_later = 0
        size = 0
        while True:
            process = self.on_disk_of(size, "sweep", self.plan, "--out", self.store, "--jobs", 2)
            if process.returncode == 0:
                break
            self.assertRegex(process.stderr, r"points\.db: the disk is full")
            self.assertNotIn(".writing", " ".join(os.listdir(self.disk)))
            if process.returncode == 2:
                full_at_begin += 1
            else:
                self.fails(process, f"{KEPT}: run the same command to resume")
                full_later += 1
            kept = self.points()
            said = self.finished(expected)
            self.assertEqual("there already" in said, kept > 0)
            if kept:
                self.assertIn(f", {kept} there already", said)
            self.store.unlink()
            size += 30000
        self.assertTrue(self.store.read_bytes() == expected)
        self.assertGreater(full_at_begin, 1)
        self.assertGreater(full_later, 5)

    def test_a_disk_full_in_a_merge_keeps_all_points(self):
        expected = self.expected()
        self.succeeds(self.sweep())
        with self.unchanged(self.disk):
            process = self.on_disk_of(len(expected) * 3 // 2, "merge", self.store, self.store)
            self.refused_in_one_line(process)
            self.assertRegex(process.stderr, r"points\.db: the disk is full")
        more = self.file("more.yaml", PLAN.replace("to: 40", "to: 41"))
        process = self.on_disk_of(len(expected) * 9 // 5, "sweep", more, "--out", self.store)
        self.fails(process)
        self.assertRegex(process.stderr, rf"points\.db: the disk is full{KEPT}")
        self.assertEqual(self.points(), POINTS + 1)
        self.finished(self.expected(more), more)

    def test_a_disk_full_for_the_progress_is_refused(self):
        progress = self.disk / "progress"
        store = self.folder / "a.db"
        process = self.on_disk_of(0, "sweep", self.plan, "--out", store, "--progress", progress)
        self.refused_in_one_line(process,
                                 f"--progress '{progress}': cannot be written: No space left on device")


class OpenFiles(RobustnessTest):
    def test_too_few_open_files_are_refused_with_the_jobs_that_they_allow(self):
        def sweep_with(files, jobs):
            limit = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (files, files))
            command = ["sweep", self.plan, "--known", self.whole, "--out", self.store, "--jobs", jobs]
            return run(*command, preexec_fn=limit)

        one = self.file("one.yaml", PLAN.replace("to: 40", "to: 1"))
        self.succeeds(self.sweep(plan=one, store=self.whole))
        rule = "--jobs = 8: too many for the limit on open files (ulimit -n): "
        enough = None
        for files in range(12, 60):
            process = sweep_with(files, 8)
            if process.returncode == 0:
                break
            self.refused_in_one_line(process, rule)
            self.is_in(self.disk)
            enough = re.search(r"lower --jobs to (\d+), or raise the limit\n", process.stderr)
            if enough:
                self.succeeds(sweep_with(files, enough[1]))
                self.store.unlink()
            else:
                self.assertTrue(process.stderr.endswith(f"{rule}raise it\n"), process.stderr)
        self.assertEqual(enough[1], "7", "the limit before the first that is enough for 8")
        limit = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (20, 20))
        search = ["optimise", self.plan, "--minimise", "pins", "--jobs", 8]
        self.refused_in_one_line(run(*search, preexec_fn=limit), rule)


class ReadOnly(RobustnessTest):
    def test_read_only_files_and_folders_are_refused(self):
        self.succeeds(self.sweep())
        rule = "cannot be opened to write: Permission denied"
        new = self.disk / "new.db"
        sweep = ["sweep", self.plan, "--out"]
        self.addCleanup(self.disk.chmod, 0o755)
        with self.unchanged(self.disk):
            for path, mode, arguments, text in (
                (self.store, 0o444, [*sweep, self.store], f"--out {self.store}: {rule}"),
                (self.disk, 0o555, [*sweep, self.store], f"--out {self.store}: "),
                (self.disk, 0o555, [*sweep, new], f"--out {new}: {rule}"),
                (self.disk, 0o555, ["merge", self.store, self.store], self.store),
            ):
                path.chmod(mode)
                self.refused_in_one_line(run(*arguments, preexec_fn=of_plain_user), text)
                path.chmod(0o755)


class UnfinishedChange(RobustnessTest):
    """What a process leaves that is killed while it changes a finished database."""

    CHANGE = """
import os, sqlite3, sys
connection = sqlite3.connect(sys.argv[1], isolation_level=None)
connection.execute("PRAGMA cache_size = 1")
connection.execute("BEGIN")
connection.execute("DELETE FROM points")
connection.execute("UPDATE columns SET name = name || 'x'")
os._exit(0)
"""

    def test_an_unfinished_change_is_refused_with_the_cure(self):
        expected = self.expected()
        self.succeeds(self.sweep())
        subprocess.run([sys.executable, "-c", self.CHANGE, str(self.store)], check=True)
        self.assertTrue((self.disk / "points.db-journal").exists())
        store = self.store
        reason = f"{store}-journal was left by an unfinished change, and this command only reads"
        rule = f"{store}: {reason}: `stereotlm merge {store} {store}` rolls the change back"
        more = self.folder / "more.db"
        self.refused_in_one_line(self.sweep("--known", self.store, store=more), f"--known {rule}")
        self.refused_in_one_line(run("merge", more, self.store), rule)
        self.assertFalse(more.exists())
        self.succeeds(run("merge", self.store, self.store))
        self.finished(expected)


if __name__ == "__main__":
    program.main()
