"""sweep on a machine that fails it: a full disk, a locked or read-only database, processes that are killed."""

import ctypes
import os
import pathlib
import random
import re
import resource
import signal
import sqlite3
import subprocess
import sys
import time

import program
from program import HEIGHT, WIDTH, run
from sweep_test import SweepTest

FULL_DISK = os.path.abspath(sys.argv.pop(2))  # a library, see tests/support/full_disk.cpp

PLAN = f"""
board: fpl2003
run: {{source: preloaded}}
set: {{image.width: {WIDTH}, image.height: {HEIGHT}, matcher.filter: none}}
vary:
  matcher.disparities: {{from: 1, to: 40, step: 1}}
"""
POINTS = 40
# Each takes a second or so: there is time to end it.
SLOW = """
board: fpl2003
run: {source: camera, frames: 60}
vary: {matcher.disparities: [10, 20, 30, 40]}
"""
SLOW_POINTS = 4
MERGING = r"\.merging-[0-9a-f]{16}"  # behind the name of the file that a merge writes


def of_plain_user():
    """In a process to be: root obeys the permissions of its own files."""
    drop_from_bounding_set, override, search = 24, 1, 2
    if os.geteuid() == 0:
        for capability in (override, search):
            if ctypes.CDLL(None, use_errno=True).prctl(drop_from_bounding_set, capability, 0, 0, 0) != 0:
                raise OSError(ctypes.get_errno(), "prctl")


class RobustnessTest(SweepTest):
    def setUp(self):
        super().setUp()
        self.plan = self.file("plan.yaml", PLAN.encode())
        self.disk = self.folder / "disk"
        self.disk.mkdir()
        self.store = self.disk / "points.db"
        self.whole = self.folder / "whole.db"

    def expected(self, plan=None):
        """The bytes of the database of a sweep that nothing has disturbed."""
        self.succeeds(self.sweep(plan=plan, store=self.whole))
        return self.whole.read_bytes()

    def finished(self, bytes_expected, plan=None):
        """The same command once more ends well."""
        said = self.succeeds(self.sweep(plan=plan))
        self.assertTrue(self.store.read_bytes() == bytes_expected, "the databases differ")
        self.assertEqual([path.name for path in self.disk.iterdir()], ["points.db"])
        return said

    def points(self):
        try:
            return self.query("SELECT count(*) FROM points")[0][0]
        except sqlite3.OperationalError:
            return 0

    def fails(self, process, *texts):
        """In one line, after it has begun."""
        self.assertEqual(process.returncode, 1, process.stderr)
        for text in texts:
            self.assertIn(text, process.stderr)
        self.assertEqual(len(process.stderr.splitlines()), 1, process.stderr)


class FullDisk(RobustnessTest):
    def on_disk_of(self, size, *arguments):
        environment = dict(os.environ, LD_PRELOAD=FULL_DISK, FULL_DISK_FOLDER=str(self.disk.resolve()), FULL_DISK_BYTES=str(size))
        return run(*arguments, env=environment)

    def sweep_on(self, size, *more):
        return self.on_disk_of(size, "sweep", self.plan, "--out", self.store, *more)

    def test_at_any_time_is_said_and_loses_nothing(self):
        """From the first byte of the database to the last one of the merge."""
        expected = self.expected()
        full_at_begin = full_later = 0
        size = 0
        while True:
            process = self.sweep_on(size, "--jobs", 2)
            if process.returncode == 0:
                break
            self.assertRegex(process.stderr, rf"points\.db({MERGING})?: the disk is full")
            self.assertNotIn(".merging", " ".join(path.name for path in self.disk.iterdir()))
            if process.returncode == 2:
                full_at_begin += 1
            else:
                self.fails(process, "; finished points are kept: run the same command to resume")
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

    def test_in_the_merge_leaves_the_database_as_it_was(self):
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        process = self.on_disk_of(len(before) * 3 // 2, "merge", self.store, self.store)
        self.refused_in_one_line(process)
        self.assertRegex(process.stderr, rf"points\.db{MERGING}: the disk is full")
        self.assertTrue(self.store.read_bytes() == before)
        self.assertEqual([path.name for path in self.disk.iterdir()], ["points.db"])

    def test_in_the_merge_at_the_end_keeps_all_points(self):
        expected = self.expected()
        self.succeeds(self.sweep())
        more = self.file("more.yaml", PLAN.replace("to: 40", "to: 41").encode())
        room = len(expected) * 9 // 5
        process = self.on_disk_of(room, "sweep", more, "--out", self.store)
        self.fails(process)
        self.assertRegex(process.stderr, rf"points\.db{MERGING}: the disk is full; finished points are kept")
        self.assertEqual(self.points(), POINTS + 1)
        self.finished(self.expected(more), more)

    def test_of_the_file_with_the_progress(self):
        progress = self.disk / "progress"
        process = self.on_disk_of(0, "sweep", self.plan, "--out", self.folder / "a.db", "--progress", progress)
        self.refused_in_one_line(process, f"--progress {progress}: No space left on device")

    def test_a_limit_on_files_is_said_too(self):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

        expected = self.expected()
        process = run("sweep", self.plan, "--out", self.store, preexec_fn=limit, restore_signals=False)
        self.fails(process, "points.db: disk I/O error; finished points are kept")
        self.finished(expected)


class OpenFiles(RobustnessTest):
    def test_that_are_too_few_are_refused_with_how_many_jobs_they_are_enough_for(self):
        def sweep_with(files, jobs):
            return run("sweep", self.plan, "--known", self.whole, "--out", self.store, "--jobs", jobs,
                       preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (files, files)))

        self.succeeds(self.sweep(plan=self.file("one.yaml", PLAN.replace("to: 40", "to: 1").encode()), store=self.whole))
        rule = "--jobs = 8: too many for the limit on open files (ulimit -n): "
        enough = None
        for files in range(12, 60):
            process = sweep_with(files, 8)
            if process.returncode == 0:
                break
            self.refused_in_one_line(process, rule)
            self.assertEqual(list(self.disk.iterdir()), [])
            enough = re.search(r"lower --jobs to (\d+), or raise the limit\n", process.stderr)
            if enough:
                self.succeeds(sweep_with(files, enough[1]))
                self.store.unlink()
            else:
                self.assertTrue(process.stderr.endswith(f"{rule}raise it\n"), process.stderr)
        self.assertEqual(enough[1], "7", "the limit before the first that is enough for 8")


class UnfinishedChange(RobustnessTest):
    """What a process leaves that is killed while it changes a finished database."""

    def test_in_a_database_that_is_only_read_is_said_with_the_cure(self):
        expected = self.expected()
        self.succeeds(self.sweep())
        change = ("import os, sqlite3, sys\n"
                  "connection = sqlite3.connect(sys.argv[1], isolation_level=None)\n"
                  "connection.execute('PRAGMA cache_size = 1')\n"
                  "connection.execute('BEGIN')\n"
                  "connection.execute('DELETE FROM points')\n"
                  "connection.execute('UPDATE keys SET name = name || \\'x\\'')\n"
                  "os._exit(0)\n")
        subprocess.run([sys.executable, "-c", change, str(self.store)], check=True)
        self.assertTrue((self.disk / "points.db-journal").exists())
        rule = (f"{self.store}: {self.store}-journal was left by an unfinished change, and this command only "
                f"reads: `stereotlm merge {self.store} {self.store}` rolls the change back")
        more = self.folder / "more.db"
        self.refused_in_one_line(self.sweep("--known", self.store, store=more), f"--known {rule}")
        self.refused_in_one_line(run("merge", more, self.store), rule)
        self.assertFalse(more.exists())
        self.succeeds(run("merge", self.store, self.store))
        self.assertTrue(self.store.read_bytes() == expected)
        self.assertEqual([path.name for path in self.disk.iterdir()], ["points.db"])


class LockedDatabase(RobustnessTest):
    def lock(self, begin):
        connection = sqlite3.connect(self.store, isolation_level=None)
        self.addCleanup(connection.close)
        connection.execute(begin)
        return connection

    def test_for_a_moment_is_waited_for(self):
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        for begin in ("BEGIN IMMEDIATE", "BEGIN EXCLUSIVE"):
            connection = self.lock(begin)
            process = subprocess.Popen([program.PROGRAM, "sweep", str(self.plan), "--out", str(self.store)],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            with self.assertRaises(subprocess.TimeoutExpired):
                process.communicate(timeout=1)
            connection.execute("ROLLBACK")
            connection.close()
            _, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 0, errors)
            self.assertTrue(self.store.read_bytes() == before)

    def test_for_longer_than_a_minute_is_said(self):
        """sweep_test.cpp has what else there is to it, with less patience."""
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        connection = self.lock("BEGIN IMMEDIATE")
        begin = time.monotonic()
        self.refused_in_one_line(self.sweep(), f"--out {self.store}: another process keeps it locked")
        self.assertGreater(time.monotonic() - begin, 59)
        connection.execute("ROLLBACK")
        connection.close()
        self.finished(before)

    def test_by_a_merge_into_it_is_said_at_once(self):
        """Also where the merge is the first to write to it. It waits for the database that it reads."""
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        connection = self.lock("BEGIN EXCLUSIVE")
        merged = self.folder / "merged.db"
        process = subprocess.Popen([program.PROGRAM, "merge", str(merged), str(self.store)],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        end = time.monotonic() + 30
        while not merged.exists() and time.monotonic() < end:
            time.sleep(0.01)
        rule = f"{merged}: another process is at work on it: wait for its end, or give another file"
        self.refused_in_one_line(run("merge", merged, self.left), rule)
        self.refused_in_one_line(self.sweep(store=merged), f"--out {rule}")
        connection.execute("ROLLBACK")
        connection.close()
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, errors)
        self.assertTrue(merged.read_bytes() == before)

    def test_by_another_sweep_is_said_at_once(self):
        slow = self.file("slow.yaml", SLOW.replace("60", "60000").encode())
        process = subprocess.Popen([program.PROGRAM, "sweep", str(slow), "--out", str(self.store)],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        while not self.store.exists() or self.store.stat().st_size == 0:
            time.sleep(0.01)
        begin = time.monotonic()
        rule = f"{self.store}: another process is at work on it: wait for its end, or give another file"
        self.refused_in_one_line(self.sweep(), f"--out {rule}")
        self.refused_in_one_line(run("merge", self.store, self.store), rule)
        self.assertLess(time.monotonic() - begin, 30)
        self.assertIsNone(process.poll(), "it was to be at work meanwhile")


class ReadOnly(RobustnessTest):
    def sweep_as_user(self):
        return run("sweep", self.plan, "--out", self.store, preexec_fn=of_plain_user)

    def protect(self, path, mode):
        path.chmod(mode)
        self.addCleanup(path.chmod, 0o755)

    def test_database_is_refused(self):
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        self.protect(self.store, 0o444)
        self.refused_in_one_line(self.sweep_as_user(), f"--out {self.store}: cannot be opened to write: Permission denied")
        self.assertTrue(self.store.read_bytes() == before)

    def test_folder_is_refused(self):
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        self.protect(self.disk, 0o555)
        self.refused_in_one_line(self.sweep_as_user(), f"--out {self.store}: ")
        self.assertTrue(self.store.read_bytes() == before)
        self.store = self.disk / "none.db"
        self.refused_in_one_line(self.sweep_as_user(), f"--out {self.store}: cannot be opened to write: Permission denied")

    def test_folder_of_a_merge_is_refused(self):
        self.succeeds(self.sweep())
        self.protect(self.disk, 0o555)
        process = run("merge", self.store, self.store, preexec_fn=of_plain_user)
        self.refused_in_one_line(process, str(self.store))


def descendants(pid):
    found = []
    for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            for child in map(int, task.read_text().split()):
                found += [child, *descendants(child)]
        except OSError:
            pass  # it has ended
    return found


class Killed(RobustnessTest):
    def start(self, plan, *more):
        process = subprocess.Popen([program.PROGRAM, "sweep", str(plan), "--out", str(self.store), *more],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        return process

    def test_at_any_time_it_goes_on_to_the_same_bytes(self):
        """Twenty times, each at another moment between its begin and its end."""
        expected = self.expected()
        begin = time.monotonic()
        self.succeeds(self.sweep())
        duration = time.monotonic() - begin
        self.store.unlink()
        moments = random.Random(1)
        killed = 0
        for _ in range(20):
            for attempt in range(3):  # killed, killed again, and to its end
                process = self.start(self.plan, "--jobs", "2")
                if attempt < 2:
                    time.sleep(moments.uniform(0, duration))
                    process.kill()
                    killed += 1
                out, errors = process.communicate(timeout=60)
                if attempt == 2:
                    self.assertEqual(process.returncode, 0, errors)
                    self.assertIn(f"points.db: {POINTS} points", out)
            self.assertTrue(self.store.read_bytes() == expected, "the databases differ")
            self.assertEqual([path.name for path in self.disk.iterdir()], ["points.db"])
            self.store.unlink()

    def test_workers_again_and_again_make_rows_of_their_points(self):
        slow = self.file("slow.yaml", SLOW.encode())
        process = self.start(slow, "--jobs", "1")
        end = time.monotonic() + 300
        kills = 0
        while process.poll() is None and time.monotonic() < end:
            time.sleep(0.1)
            for pid in descendants(process.pid)[-1:]:  # what simulates, or else its worker
                os.kill(pid, signal.SIGKILL)
                kills += 1
        out, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, errors)
        self.assertGreaterEqual(kills, 3 * SLOW_POINTS)
        self.assertIn(f"{SLOW_POINTS} points: 0 ok, 0 impossible, {SLOW_POINTS} failed\n", out)
        reason = ("its process has ended with signal 9 (Killed), 3 times: to try again, delete this row and give the "
                  "same command")
        self.assertIn(f"  {SLOW_POINTS} failed: {reason}\n", out)
        rows = self.query('SELECT reason, config, "matcher.disparities" FROM points WHERE status = \'failed\' ORDER BY 3')
        self.assertEqual([row[2] for row in rows], [10, 20, 30, 40])
        for row in rows:
            self.assertEqual(row[0], reason)
            self.assertIn(f"disparities: {row[2]}\n", row[1])
        connection = sqlite3.connect(self.store)
        connection.execute("DELETE FROM points WHERE status = 'failed'")  # as --help says
        connection.commit()
        connection.close()
        self.finished(self.expected(slow), slow)

    def test_a_worker_once_costs_nothing(self):
        slow = self.file("slow.yaml", SLOW.encode())
        process = self.start(slow, "--jobs", "2")
        while not descendants(process.pid):
            time.sleep(0.01)
        os.kill(descendants(process.pid)[0], signal.SIGKILL)
        out, errors = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 0, errors)
        self.assertIn(f"{SLOW_POINTS} points: {SLOW_POINTS} ok, 0 impossible, 0 failed\n", out)
        self.finished(self.expected(slow), slow)


if __name__ == "__main__":
    program.main()
