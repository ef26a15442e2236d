"""What commands leave behind when they or their clients are ended: no process and no file.

A process belongs to a case if it has the case's variable in its environment, as all that it starts has. The
computations would take minutes: if one goes on, its case fails.
"""

import contextlib
import itertools
import os
import pathlib
import resource
import signal
import sqlite3
import subprocess

import program
from program import CYCLE, PRELOADED, PROGRAM, SMALL, ProgramTest, run, wait_until

SOURCES = pathlib.Path(__file__).resolve().parents[3]
FRAMES = ["--frames", 100000, "--quiet"]
LONG = ["run", "fpl2003", *CYCLE, "--synthetic", 1, *FRAMES]
SECONDS = 30  # within which all is gone; 2 where the machine is not busy
NUMBERS = itertools.count()


class EndedTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.mark = f"STEREOTLM_MARK={os.getpid()}_{next(NUMBERS)}".encode()
        self.work, self.temporary = (self.folder / name for name in ("work", "temporary"))
        for folder in (self.work, self.temporary):
            folder.mkdir()
        self.environment = {**os.environ, "STEREOTLM_MARK": self.mark.decode().partition("=")[2],
                            "TMPDIR": str(self.temporary), "STEREOTLM_PROGRAM": PROGRAM,
                            "PYTHONPATH": str(SOURCES / "sw" / "python")}
        self.addCleanup(lambda: [os.kill(number, signal.SIGKILL) for number in self.processes()])

    def processes(self):
        """The command lines of the case's processes that have not ended, by their numbers."""
        found = {}
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if self.mark in (folder / "environ").read_bytes().split(b"\0"):
                    found[int(folder.name)] = (folder / "cmdline").read_text()
        return found

    def begin(self, words, others, **options):
        """The process of these words, once it has started so many others, or one of this text."""
        def calm():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # SIGQUIT would write a file
            for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT):  # a background job may ignore them
                signal.signal(number, signal.SIG_DFL)

        process = subprocess.Popen(list(map(str, words)), env=self.environment, cwd=self.work,
                                   **{"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL,
                                      "preexec_fn": calm, **options})
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        is_ready = lambda lines: len(lines) > others if isinstance(others, int) else others in str(lines)
        wait_until(lambda: is_ready(self.processes().values()) or process.poll() is not None)
        self.assertIsNone(process.poll(), words)
        return process

    def becomes_clean(self, files=(), numbers=()):
        """Only these files, and processes of these numbers, are left."""
        there = lambda: {name for folder in (self.work, self.temporary)
                         for _, *names in os.walk(folder) for name in sum(names, [])}
        left = lambda: (there() - set(files), self.processes().keys() - set(numbers))
        is_clean = lambda: left() == (set(), set())
        with contextlib.suppress(AssertionError):
            # Twice, because a list may lack a process that a killed one has just begun.
            wait_until(lambda: is_clean() and is_clean(), SECONDS)
        self.assertEqual((left(), there()), ((set(), set()), set(files)), self.processes())


class Commands(EndedTest):
    def ended(self, words, others, *signals):
        for number in (signal.SIGKILL, signal.SIGHUP, *signals):
            with self.subTest(words=words[0], signal=number):
                process = self.begin([PROGRAM, *words], others)
                process.send_signal(number)
                if number == signal.SIGTERM:
                    self.assertEqual(process.wait(SECONDS), 130)
                self.becomes_clean()
                self.assertIn(process.wait(), (-number, 130))

    def test_leave_nothing(self):
        rig = ["--synthetic", 3, "--grid", "7x5", "--square-mm", 30]
        self.succeeds(run(*self.run_arguments("--frames", 20000, "--timing-only", "--out", self.out)))
        plan = self.file("small.yaml", "board: fpl2003\nvary: {matcher.window: [3, 5]}\n")
        self.succeeds(run("sweep", plan, "--out", self.folder / "points.db"))
        self.ended([*LONG, "--out", "new/out", "--trace", "perfetto:t.pftrace"], 2, signal.SIGQUIT)
        self.ended([*LONG, *PRELOADED, "--verify"], 1)
        self.ended(["conflicts", "fpl2003", "--synthetic", 1, *FRAMES, "--out", "c"], 1)
        self.ended(["calibrate", *rig, "--out", "rig.yaml"], 1)
        self.ended(["explain", "fpl2003", *FRAMES], 2, signal.SIGTERM)
        self.ended(["diff", self.out, self.out], 2, signal.SIGTERM)
        self.ended(["report", self.out, "--out", "page.html"], 1)  # SIGTERM: it writes what it has
        self.ended(["plot", self.folder / "points.db", "--out", "figures"], "figures.py", signal.SIGQUIT)
        with contextlib.closing(sqlite3.connect(self.folder / "points.db", isolation_level=None)) as reader:
            reader.execute("BEGIN EXCLUSIVE")  # merge waits for its end
            self.ended(["merge", "new.db", self.folder / "points.db"], 1)

    def test_searches_leave_their_database_with_which_they_continue(self):
        plan = self.file("plan.yaml", "board: fpl2003\nrun: {source: camera, frames: 100000}\n"
                                      "vary: {matcher.window: [3, 5, 7, 9, 11, 13]}\n")
        whole = ["x.db", "x.db-shm", "x.db-wal"]
        for words, database, others in ((["allocate", "fpl2003", *FRAMES, "--banks", 8], whole[:1], 2),
                                        (["sweep", plan], whole, 1)):
            for number in (signal.SIGKILL, signal.SIGHUP, signal.SIGTERM):
                process = self.begin([PROGRAM, *words, "--out", "x.db"], others)
                wait_until(lambda: all((self.work / name).exists() for name in database))
                process.send_signal(number)
                if number == signal.SIGTERM:  # it puts the database into its final form
                    self.assertEqual(process.wait(SECONDS), 130)
                self.becomes_clean(database[:1] if number == signal.SIGTERM else database)
                for path in self.work.iterdir():
                    path.unlink()

    def test_a_second_ctrl_c(self):
        process = self.begin([PROGRAM, *LONG, "--out", "out"], 1)
        status = pathlib.Path(f"/proc/{process.pid}/status")
        process.send_signal(signal.SIGINT)
        wait_until(lambda: not int(status.read_text().split("SigCgt:")[1].split()[0], 16) & 2)  # SIGINT
        process.send_signal(signal.SIGINT)
        if process.wait(60) != 130:  # it has not finished its frame before
            self.assertEqual(process.returncode, -signal.SIGINT)
            self.becomes_clean()

    def test_nohup(self):
        ignored = lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = self.begin([PROGRAM, *LONG, *PRELOADED, *SMALL, "--out", "out"], 1, preexec_fn=ignored)
        process.send_signal(signal.SIGHUP)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(60), 130)  # of SIGTERM

    def test_the_same_command_can_follow_at_once(self):
        for _ in range(5):
            self.begin([PROGRAM, *LONG, "--out", "out", "--trace", "perfetto:t.pftrace"], 2).kill()
            self.succeeds(run(*self.run_arguments("--out", "out", "--trace", "perfetto:t.pftrace"),
                              cwd=self.work))
            self.becomes_clean(["out", "t.pftrace", *program.RESULT_FILES])


class Clients(EndedTest):
    CALLS = ["run(frames=100000, fidelity='cycle', synthetic=1, out='out', quiet=True)",
             "run(frames=100000, verify=True, synthetic=1, quiet=True)",
             "explain(frames=100000, quiet=True)",
             "allocate(8, frames=100000, quiet=True)",
             "sweep({'matcher.window': [3, 5, 7, 9]}, source='camera', frames=100000, quiet=True)"]

    def begin_python(self, text, others=3, **options):
        """The worker, its process for commands, and what that starts."""
        script = 'import os, time, stereotlm\nboard = stereotlm.Board("fpl2003")\n' + text
        return self.begin(["/usr/bin/python3", "-B", self.file("client.py", script)], others, **options)

    def test_a_killed_one(self):
        for call in self.CALLS:
            with self.subTest(call):
                self.begin_python("board." + call).kill()
                self.becomes_clean()

    def test_one_that_is_killed_while_a_forked_process_goes_on(self):
        process = self.begin_python("other = stereotlm.Worker()\nother.execute('boards')\nchild = os.fork()\n"
                                    "if child == 0: time.sleep(600)\nprint(child, flush=True)\n"
                                    f"board.{self.CALLS[-1]}", 6, stdout=subprocess.PIPE)
        child = int(process.stdout.readline())
        process.stdout.close()
        process.kill()
        self.becomes_clean(numbers=[child])

    def test_an_interrupted_one(self):
        process = self.begin_python(f"try: board.{self.CALLS[2]}\nexcept KeyboardInterrupt: time.sleep(600)")
        process.send_signal(signal.SIGINT)
        self.becomes_clean(numbers=[process.pid])


if __name__ == "__main__":
    program.main()
