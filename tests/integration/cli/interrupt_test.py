"""The progress line, and runs that are interrupted."""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time

import program
from program import CYCLE, PRELOADED, RESULT_FILES, ProgramTest

MANY = ["--frames", "18446744073709551615"]
PROGRESS = re.compile(
    r"(\d+\.\d\d)/(\d+) frames   (\d+\.\d) %   (\d+\.\d\d) M cycles/s   (\d+\.\d\d) frames/s   (\S+) left"
)


class Terminal:
    """A process whose standard error is a terminal of its own."""

    def __init__(self, arguments, columns=100, **options):
        self.master, slave = pty.openpty()
        os.set_blocking(self.master, False)
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        command = [program.PROGRAM] + [str(argument) for argument in arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=slave, text=True, **options)
        os.close(slave)
        self.text = ""

    def read_until(self, pattern, seconds=30):
        """Reads until the pattern is there; its matches."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            found = pattern.findall(self.text)
            if found:
                return found
            if self.read(0.1) is None:
                raise AssertionError(f"ended without {pattern.pattern}: {self.text!r}")
        raise AssertionError(f"not within {seconds} s: {pattern.pattern} in {self.text!r}")

    def read(self, seconds):
        """Whether there was anything to read within this time; None where nothing will come any more."""
        if not select.select([self.master], [], [], seconds)[0]:
            return False
        try:
            self.text += os.read(self.master, 65536).decode()
        except OSError:
            return None
        return True

    def finish(self):
        """(exit status, standard output)."""
        out, _ = self.process.communicate(timeout=60)
        while self.read(0.1):
            pass
        os.close(self.master)
        return self.process.returncode, out


def shown(text):
    """What a terminal shows after this text, line by line."""
    lines = []
    for line in text.replace("\r\n", "\n").split("\n"):
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


class ProgressLine(ProgramTest):
    def test_shows_rate_and_remaining_time_and_is_erased(self):
        terminal = Terminal(self.run_arguments(*CYCLE, "--frames", "1000"))
        found = terminal.read_until(PROGRESS)
        status, out = terminal.finish()
        self.assertEqual(status, 0, terminal.text)
        self.assertIn("1000 frames", out)
        done, total, percent, _, rate, left = found[0]
        self.assertEqual(total, "1000")
        self.assertAlmostEqual(float(percent), float(done) / 10, delta=0.1)
        self.assertGreater(float(rate), 0)
        self.assertRegex(left, r"^\d+:\d\d$")
        self.assertEqual(shown(terminal.text), [""])

    def test_fits_into_a_narrow_terminal(self):
        terminal = Terminal(self.run_arguments(*CYCLE, "--frames", "1000"), columns=20)
        terminal.read_until(re.compile(r"/1000 fra"))
        terminal.finish()
        self.assertLess(max(len(part) for part in terminal.text.split("\r")), 20)

    def test_is_not_there_without_a_terminal(self):
        process = self.run_small("--frames", "1000")
        self.assertEqual((process.returncode, process.stderr), (0, ""))


class Interrupted(ProgramTest):
    def interrupt(self, *arguments, number=signal.SIGINT):
        terminal = Terminal(self.run_arguments(*MANY, *arguments))
        terminal.read_until(PROGRESS)
        terminal.process.send_signal(number)
        return terminal, *terminal.finish()

    def test_writes_what_was_finished(self):
        terminal, status, out = self.interrupt("--out", self.out)
        self.assertEqual(status, 130)
        self.assertEqual(sorted(os.listdir(self.out)), RESULT_FILES)
        stats = self.stats()
        frames = stats["frames"]
        self.assertGreater(frames, 0)
        self.assertEqual(len(stats["frame_cycles"]), frames)
        self.assertNotIn("failed", stats)
        self.assertIn(f"{frames} frame", out)
        self.assertIn(f"stereotlm: note: interrupted after {frames} of {MANY[1]} frames", shown(terminal.text)[0])

    def test_has_the_result_of_a_whole_run_of_these_frames(self):
        self.interrupt("--out", self.out)
        frames = self.stats()["frames"]
        whole = self.folder / "whole"
        self.succeeds(self.run_small("--out", whole, "--frames", frames))
        ours, theirs = self.result(), self.result(whole)
        for name in RESULT_FILES:
            self.assertEqual(ours[name], theirs[name], name)

    def test_without_out_prints_the_table(self):
        _, status, out = self.interrupt()
        self.assertEqual(status, 130)
        self.assertIn("worst stall", out)

    def test_by_a_termination_request(self):
        _, status, _ = self.interrupt("--out", self.out, number=signal.SIGTERM)
        self.assertEqual(status, 130)
        self.assertEqual(sorted(os.listdir(self.out)), RESULT_FILES)

    def test_not_where_the_caller_ignores_the_signal(self):
        ignore = lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)
        terminal = Terminal(self.run_arguments(*CYCLE, "--frames", "1000"), preexec_fn=ignore)
        terminal.read_until(PROGRESS)
        terminal.process.send_signal(signal.SIGINT)
        status, out = terminal.finish()
        self.assertEqual(status, 0)
        self.assertIn("1000 frames", out)

    def test_a_first_frame_that_is_not_finished_leaves_the_earlier_result(self):
        self.succeeds(self.run_small("--out", self.out))
        earlier = self.result()
        size = 2048
        big = self.file("big.pgm", program.pgm(size, size, bytes(size * size)))
        terminal = Terminal(
            ["run", "fpl2003", *PRELOADED, *CYCLE, "--left", big, "--right", big, "--out", self.out]
            + ["--set", f"image.width={size}", "--set", f"image.height={size}"]
            + ["--set", "matcher.window=31", "--set", "ssram.default.words=4194304"]
        )
        terminal.read_until(PROGRESS)
        terminal.process.send_signal(signal.SIGINT)
        status, out = terminal.finish()
        self.assertEqual((status, out), (130, ""))
        self.assertIn("interrupted after 0 of 1 frames: there is no result", terminal.text)
        self.assertEqual(self.result(), earlier)


if __name__ == "__main__":
    program.main()
