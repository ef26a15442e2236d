"""What commands leave behind when they or their clients are ended: no process and no file.

A process belongs to a case if it has the case's variable in its environment, as all that it starts has. The
computations would take minutes: if one goes on, its case fails.
"""

import contextlib
import itertools
import os
import pathlib
import pty
import resource
import signal
import subprocess
import sys
import unittest

import program
from program import CYCLE, PRELOADED, PROGRAM, SMALL, ProgramTest, run, wait_until

SOURCES = pathlib.Path(__file__).resolve().parents[3]
LONG = ["run", "fpl2003", *CYCLE, "--synthetic", 1, "--frames", 100000, "--quiet"]
SECONDS = 30  # within which all is gone; 2 where the machine is not busy
NUMBERS = itertools.count()


class EndedTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.mark = f"{os.getpid()}_{next(NUMBERS)}"
        self.work = self.folder / "work"  # where the commands write
        self.temporary = self.folder / "temporary"
        for folder in (self.work, self.temporary):
            folder.mkdir()
        self.environment = {**os.environ, "STEREOTLM_MARK": self.mark, "TMPDIR": str(self.temporary),
                            "STEREOTLM_PROGRAM": PROGRAM, "PYTHONPATH": str(SOURCES / "sw" / "python")}

    def processes(self):
        """The command lines of the case's processes that have not ended, by their numbers."""
        found = {}
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                variables = (folder / "environ").read_bytes().split(b"\0")
                if f"STEREOTLM_MARK={self.mark}".encode() in variables:
                    found[int(folder.name)] = (folder / "cmdline").read_text().replace("\0", " ")
        return found

    def begin(self, words, is_ready, **options):
        """The process of these words, once `is_ready` holds for all command lines of the case."""
        calm = lambda: resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # SIGQUIT would write a file
        process = subprocess.Popen(list(map(str, words)), env=self.environment, cwd=self.work,
                                   **{"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL,
                                      "preexec_fn": calm, **options})
        self.addCleanup(process.wait)
        self.addCleanup(lambda: [os.kill(number, signal.SIGKILL) for number in self.processes()])
        wait_until(lambda: is_ready(list(self.processes().values())) or process.poll() is not None)
        self.assertIsNone(process.poll(), words)
        return process

    def is_clean(self, before=(), numbers=()):
        """Whether only these files, and processes of these numbers, are left."""
        files = {path.name for folder in (self.work, self.temporary) for path in folder.rglob("*")}
        return not self.processes().keys() - set(numbers) and files == set(before)

    def becomes_clean(self, before=(), numbers=()):
        with contextlib.suppress(AssertionError):
            wait_until(lambda: self.is_clean(before, numbers), SECONDS)
        files = [path for folder in (self.work, self.temporary) for path in folder.rglob("*")]
        self.assertTrue(self.is_clean(before, numbers), (files, self.processes()))


def more_than(number):
    """A command has started others: those that remove its files, and those that do a part of its work."""
    return lambda lines: len(lines) > number


class Commands(EndedTest):
    def plan(self):
        return self.file("plan.yaml", "board: fpl2003\nrun: {source: camera, frames: 100000}\n"
                                      "vary: {matcher.window: [3, 5, 7, 9, 11, 13]}\n")

    def ended(self, words, is_ready, *signals, before=()):
        for number in signals:
            with self.subTest(words=words[0], signal=number):
                process = self.begin([PROGRAM, *words], is_ready)
                process.send_signal(number)
                self.becomes_clean(before)
                self.assertEqual(process.wait(), -number)

    def test_runs(self):
        self.ended([*LONG, "--out", "new/out", "--trace", "perfetto:t.pftrace"], more_than(2), signal.SIGKILL,
                   signal.SIGHUP, signal.SIGQUIT)
        self.ended([*LONG, *PRELOADED, "--verify"], more_than(1), signal.SIGKILL,
                   signal.SIGHUP)
        self.ended(["conflicts", *LONG[1:2], "--synthetic", 1, "--frames", 100000, "--out", "c"],
                   more_than(1), signal.SIGKILL, signal.SIGHUP)

    def test_searches(self):
        board = ["fpl2003", "--frames", 100000, "--quiet"]
        self.ended(["explain", *board], more_than(2), signal.SIGKILL, signal.SIGHUP)
        self.ended(["paper", "--out", "paper", "--quiet"], more_than(2), signal.SIGKILL, signal.SIGHUP)
        # The database is a result, which the same command continues.
        is_begun = lambda lines: len(lines) > 1 and (self.work / "x.db-shm").exists()
        database = ["x.db", "x.db-shm", "x.db-wal"]
        for words in (["allocate", *board, "--banks", 8], ["sweep", self.plan()]):
            self.ended([*words, "--out", "x.db"], is_begun, signal.SIGKILL, signal.SIGHUP, before=database)
            for name in database:
                (self.work / name).unlink()

    def test_what_reads_results(self):
        self.succeeds(run(*self.run_arguments("--frames", 20000, "--timing-only", "--out", self.out)))
        self.ended(["diff", self.out, self.out], more_than(2), signal.SIGKILL, signal.SIGHUP)
        self.ended(["report", self.out, "--out", "page.html"], more_than(1), signal.SIGKILL,
                   signal.SIGHUP)

    def test_calibrate(self):
        words = ["calibrate", "--synthetic", 3, "--grid", "7x5", "--square-mm", 30, "--out", "rig.yaml"]
        self.ended(words, more_than(1), signal.SIGKILL, signal.SIGHUP)

    def test_drawings(self):
        plan = self.file("small.yaml", "board: fpl2003\nvary: {matcher.window: [3, 5]}\n")
        store = self.folder / "points.db"
        self.succeeds(run("sweep", plan, "--out", store))
        draws = lambda lines: any("plot_all.py" in line for line in lines)
        self.ended(["plot", store, "--out", "figures"], draws, signal.SIGKILL, signal.SIGHUP, signal.SIGQUIT)

    def test_a_second_ctrl_c(self):
        process = self.begin([PROGRAM, *LONG, "--out", "out"], more_than(1))
        process.send_signal(signal.SIGINT)
        status = pathlib.Path(f"/proc/{process.pid}/status")
        caught = lambda: int(status.read_text().split("SigCgt:")[1].split()[0], 16)
        wait_until(lambda: not caught() & 1 << signal.SIGINT - 1)
        process.send_signal(signal.SIGINT)
        if process.wait(60) != 130:  # it has not finished its frame before
            self.assertEqual(process.returncode, -signal.SIGINT)
            self.becomes_clean()

    def test_nohup(self):
        ignored = lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = self.begin([PROGRAM, *LONG, *PRELOADED, *SMALL, "--out", "out"], more_than(1),
                             preexec_fn=ignored)
        process.send_signal(signal.SIGHUP)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(60), 130)  # of SIGTERM

    def test_a_killed_shell_at_a_terminal(self):
        script = 'cd "$1"; shift; "$@"; exit 0'
        shell, terminal = pty.fork()
        if shell == 0:
            os.execve("/bin/sh", ["sh", "-c", script, "sh", str(self.work), PROGRAM, *map(str, LONG),
                                  "--out", "out"], self.environment)
        self.addCleanup(os.close, terminal)
        wait_until(lambda: len(self.processes()) > 2)
        os.kill(shell, signal.SIGKILL)
        os.waitpid(shell, 0)
        self.becomes_clean()


class Clients(EndedTest):
    """The process of Python, and what it has started."""

    CALLS = {
        "run": "board.run(frames=100000, fidelity='cycle', synthetic=1, out='out', quiet=True)",
        "verify": "board.run(frames=100000, verify=True, synthetic=1, quiet=True)",
        "explain": "board.explain(frames=100000, quiet=True)",
        "allocate": "board.allocate(8, frames=100000, quiet=True)",
        "sweep": "board.sweep({'matcher.window': range(3, 21, 2)}, source='camera', frames=100000, quiet=True)",
    }

    def begin_python(self, call, *lines, **options):
        script = "\n".join(["import os, time, stereotlm", 'board = stereotlm.Board("fpl2003")', *lines, call])
        # Python, the worker, its process for commands, and what that starts.
        return self.begin([sys.executable, "-B", self.file("client.py", script)],
                          more_than(3 + len(lines) // 3), **options)

    def test_a_killed_one(self):
        for name, call in self.CALLS.items():
            with self.subTest(name):
                self.begin_python(call).kill()
                self.becomes_clean()

    def test_one_that_is_killed_while_a_forked_process_goes_on(self):
        fork = "child = os.fork()\nif child == 0: time.sleep(600)\nprint(child, flush=True)"
        process = self.begin_python(self.CALLS["explain"], "other = stereotlm.Worker()",
                                    "other.execute('boards')", fork, stdout=subprocess.PIPE)
        child = int(process.stdout.readline())
        process.stdout.close()
        process.kill()
        self.becomes_clean(numbers=[child])

    def test_an_interrupted_one(self):
        call = f"try: {self.CALLS['explain']}\nexcept KeyboardInterrupt: time.sleep(600)"
        process = self.begin_python(call)
        process.send_signal(signal.SIGINT)
        self.becomes_clean(numbers=[process.pid])
        self.assertIsNone(process.poll())


if __name__ == "__main__":
    program.main(unittest.TestSuite)
