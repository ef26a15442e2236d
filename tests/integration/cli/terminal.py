"""A terminal for the program, and what it shows."""

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import termios
import time

import program

PROGRESS = re.compile(
    r"(\d+\.\d\d)/(\d+) frames   (\d+\.\d) %   (\d+\.\d\d) M cycles/s   (\d+\.\d\d) frames/s   (\S+) left"
)


class Terminal:
    """A process whose standard error is a terminal of its own."""

    def __init__(self, arguments, columns=100, **options):
        self.master, slave = pty.openpty()
        os.set_blocking(self.master, False)
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        command = program.words(arguments)
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=slave, text=True, **options)
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
