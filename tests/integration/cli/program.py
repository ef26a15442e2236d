"""Runs the program stereotlm as its users do: what the test scripts of this folder share.

The path of the program is the first argument of each script.
"""

import concurrent.futures
import contextlib
import ctypes
import fcntl
import functools
import hashlib
import json
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest

from pictures import noise, pgm

PROGRAM = os.path.abspath(sys.argv.pop(1))


def sets(*assignments):
    """The option --set with each of them."""
    return [word for assignment in assignments for word in ("--set", assignment)]


WIDTH = 32
HEIGHT = 24
SMALL = sets(f"image.width={WIDTH}", f"image.height={HEIGHT}")
PRELOADED = ["--source", "preloaded"]
# A frame of the small core takes 1.6 times as long as one of the cameras, as on the paper's board at 7x7.
CAMERA_RATES = sets("cameras.frame_rate_hz=1000", f"fpga.clock_mhz={5992 / 1600}")
CYCLE = ["--fidelity", "cycle"]  # also for runs that have to take a while
# Of a run with --source preloaded, and of one with cameras.
RESULT_FILES = ("config.yaml conflicts.csv disparity.pfm disparity.png disparity_color.png rows.csv run.json "
                "stats.json").split()
CAMERA_FILES = [*RESULT_FILES, "latency.csv", "timeline.csv"]

PROGRESS = re.compile(
    r"(\d+\.\d\d)/(\d+) frames   (\d+\.\d) %   (\d+\.\d\d) M cycles/s   (\d+\.\d\d) frames/s   (\S+) left"
)


def words(arguments):
    return [PROGRAM, *map(str, arguments)]


# How far long work has come: on a busy machine any command may say it.
PROGRESS_NOTE = re.compile(r"stereotlm: note: .*(\d/\d+ |\d left|so far).*\n")


def run(*arguments, **options):
    """The finished process, with text output, without notes on progress."""
    pipes = {"capture_output": True, "text": True, "timeout": 300, "check": False}
    process = subprocess.run(words(arguments), **{**pipes, **options})
    if isinstance(process.stderr, str):
        process.stderr = PROGRESS_NOTE.sub("", process.stderr)
    return process


def wait_until(is_so, seconds=60):
    """What `is_so` returns, as soon as that is true."""
    end = time.monotonic() + seconds
    while not (found := is_so()):
        if time.monotonic() > end:
            raise AssertionError(f"not within {seconds} s")
        time.sleep(0.01)
    return found


def of_process(pid, name):
    """The text of a file of /proc/PID; None of a process that has ended."""
    try:
        return pathlib.Path(f"/proc/{pid}/{name}").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return None


def stat(pid):
    """The fields of /proc/PID/stat behind the name; None of a process that has ended."""
    fields = (of_process(pid, "stat") or "Z").rpartition(")")[2].split()
    return None if fields[0] in "ZX" else fields


def descendants(pid):
    parents = {int(each): int(fields[1]) for each in os.listdir("/proc")
               if each.isdigit() and (fields := stat(each))}
    found = [pid]
    for each in found:
        found += [child for child, parent in parents.items() if parent == each]
    return found[1:]


def of_plain_user():
    """For preexec_fn: permissions of files bind the process, also where root runs the tests."""
    drop_from_bounding_set, override, search = 24, 1, 2
    if os.geteuid() == 0:
        for capability in (override, search):
            if ctypes.CDLL(None, use_errno=True).prctl(drop_from_bounding_set, capability, 0, 0, 0) != 0:
                raise OSError(ctypes.get_errno(), "prctl")


HAS_ADDRESS_SANITIZER = b"__asan_init" in pathlib.Path(PROGRAM).read_bytes()

# Marks a case, or a class of cases, that is left out under the sanitizers because it would take too long. The
# release build runs it; under the sanitizers other cases run the same code.
slow = unittest.skipIf(HAS_ADDRESS_SANITIZER, "too slow under the sanitizers")


def sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


@functools.cache
def shared_folder():
    """A folder that stays until the script ends, for what several cases only read."""
    scratch = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(scratch.cleanup)
    return pathlib.Path(scratch.name)


@functools.cache
def made_rig():
    """A calibration of a made-up rig, rig.yaml in shared_folder(), and the process that has made it."""
    rig = shared_folder() / "rig.yaml"
    return rig, run("calibrate", "--synthetic", 3, "--grid", "7x5", "--square-mm", 30, "--out", rig)


class ProgramTest(unittest.TestCase):
    """A case with a folder of its own, self.folder, with a small pair in it, self.left and self.right.

    self.out is a folder for results that is not there yet.
    """

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.left = self.file("left.pgm", pgm(WIDTH, HEIGHT, noise(WIDTH, HEIGHT, 1)))
        self.right = self.file("right.pgm", pgm(WIDTH, HEIGHT, noise(WIDTH, HEIGHT, 2)))
        self.pair = ["--left", self.left, "--right", self.right]
        self.out = self.folder / "out"

    # Files.

    def file(self, name, data=b""):
        """A file of these bytes, or of this text, in the folder."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data.encode() if isinstance(data, str) else data)
        return path

    def side(self, number, side):
        """The pixels of one side of a pair of a sequence."""
        return noise(WIDTH, HEIGHT, 10 * number + (0 if side == "left" else 1))

    def sequence(self, length, name="sequence"):
        """A folder of pairs that all differ."""
        (self.folder / name).mkdir()
        for number in range(length):
            for side in ("left", "right"):
                self.file(f"{name}/{side}_{number:03}.png", pgm(WIDTH, HEIGHT, self.side(number, side)))
        return self.folder / name

    def copy_of_rig(self):
        """The calibration of made_rig(), to be changed."""
        for name in ("rig.yaml", "rig_left.lut", "rig_right.lut"):
            shutil.copy(made_rig()[0].parent / name, self.folder)
        return self.folder / "rig.yaml"

    def result(self, folder=None):
        """The bytes of all files of a result folder, by name."""
        folder = folder or self.out
        files = (path for path in folder.rglob("*") if path.is_file())
        return {str(path.relative_to(folder)): path.read_bytes() for path in files}

    def stats(self, folder=None):
        return json.loads(((folder or self.out) / "stats.json").read_text())

    def run_json(self):
        return json.loads((self.out / "run.json").read_text())

    @contextlib.contextmanager
    def unchanged(self, path):
        """The file, or each file of the folder, stays as it is meanwhile, and none is added."""
        of = lambda: self.result(path) if path.is_dir() else path.read_bytes()
        before = of()
        yield
        self.assertTrue(of() == before, f"{path} has changed")

    def is_in(self, folder, *names):
        """These are all entries of the folder."""
        self.assertEqual(sorted(os.listdir(folder)), sorted(names))

    # Commands.

    def run_arguments(self, *more, board="fpl2003", left=None, right=None):
        left, right = self.left if left is None else left, self.right if right is None else right
        return ["run", board, *SMALL, *PRELOADED, "--left", left, "--right", right, *more]

    def run_small(self, *more, **pair):
        """A small run of a pair."""
        return run(*self.run_arguments(*more, **pair))

    def run_with(self, *source):
        """A small run with these options instead of a pair."""
        return run("run", "fpl2003", *SMALL, *PRELOADED, *source)

    def start(self, *arguments, **options):
        """A process under way, with text output; the case ends it."""
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        process = subprocess.Popen(words(arguments), **{**pipes, **options})
        self.addCleanup(self.close, process)
        return process

    @staticmethod
    def close(process):
        process.kill()
        process.communicate()

    # How a command has ended.

    def ends(self, process, status, out="", errors=""):
        """A process that was started ends so."""
        said, told = process.communicate(timeout=120)
        self.assertEqual((process.returncode, said, PROGRESS_NOTE.sub("", told)), (status, out, errors))

    def succeeds(self, process):
        """Its standard output."""
        self.assertEqual(process.returncode, 0, process.stderr)
        return process.stdout

    def ended(self, process, status, *texts):
        """With nothing on standard output; the lines on standard error, among which are these texts."""
        self.assertEqual(process.returncode, status, process.stderr)
        self.assertEqual(process.stdout, "")
        for text in texts:
            self.assertIn(str(text), process.stderr)
        return process.stderr.splitlines()

    def refused(self, process, *texts):
        """Before it began."""
        return self.ended(process, 2, *texts)

    def refused_in_one_line(self, process, *texts):
        self.assertEqual(len(self.refused(process, *texts)), 1, process.stderr)

    def all_refused(self, rows, command=run):
        """Rows of arguments of a command, and of what the one line says in which it refuses them."""
        for arguments, *texts in rows:
            with self.subTest(arguments=arguments):
                self.refused_in_one_line(command(*arguments), *texts)

    def fails(self, process, *texts):
        """In one line, once it had begun."""
        self.assertEqual(len(self.ended(process, 1, *texts)), 1, process.stderr)


class Terminal:
    """A process whose standard error is a terminal of its own; with stdout_too also its standard output.

    There are no colours unless env says so.
    """

    def __init__(self, arguments, columns=100, stdout_too=False, **options):
        self.master, slave = pty.openpty()
        os.set_blocking(self.master, False)
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        command = words(arguments)
        options.setdefault("env", {**os.environ, "NO_COLOR": "1"})
        stdout = slave if stdout_too else subprocess.PIPE
        self.process = subprocess.Popen(command, stdout=stdout, stderr=slave, text=True, **options)
        os.close(slave)
        self.text = ""

    def read_until(self, pattern, seconds=60):
        """Reads until the pattern is there; its matches."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            found = re.findall(pattern, self.text)
            if found:
                return found
            if self.read(0.1) is None:
                raise AssertionError(f"ended without {pattern}: {self.text!r}")
        raise AssertionError(f"not within {seconds} s: {pattern} in {self.text!r}")

    def read(self, seconds):
        """Whether there was anything to read within this time; None where nothing will come any more."""
        if not select.select([self.master], [], [], seconds)[0]:
            return False
        try:
            self.text += os.read(self.master, 65536).decode()
        except OSError:
            return None
        return True

    def interrupt(self, pattern, number):
        """Sends the signal once the pattern is shown; (exit status, standard output)."""
        self.read_until(pattern)
        self.process.send_signal(number)
        return self.finish()

    def finish(self):
        """(exit status, standard output)."""
        while self.process.stdout is None and self.process.poll() is None:
            self.read(0.1)
        out, _ = self.process.communicate(timeout=60)
        while self.read(0.1):
            pass
        os.close(self.master)
        return self.process.returncode, out

    def shown(self):
        """What the terminal shows, line by line."""
        lines = []
        for line in self.text.replace("\r\n", "\n").split("\n"):
            screen = []
            column = 0
            for character in line:
                if character == "\r":
                    column = 0
                    continue
                screen[column : column + 1] = [character]
                column += 1
            lines.append("".join(screen).rstrip())
        return lines


class AtOnce(unittest.TestSuite):
    """Runs its cases in threads, for scripts whose cases wait most of the time."""

    def run(self, result, debug=False):
        with concurrent.futures.ThreadPoolExecutor() as threads:
            list(threads.map(lambda case: case.run(result), self))
        return result


def main(suite=unittest.TestSuite):
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
    loader = unittest.TestLoader()
    loader.suiteClass = suite
    unittest.main(testLoader=loader)
