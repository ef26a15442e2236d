"""Drives the program stereotlm from the outside; what the tests of this folder share.

The path of the program is the first argument of each test script.
"""

import functools
import json
import os
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

PROGRAM = None  # set by main()
PYTHON = "/usr/bin/python3"  # Debian's, which has matplotlib

WIDTH = 32
HEIGHT = 24
SMALL = ["--set", f"image.width={WIDTH}", "--set", f"image.height={HEIGHT}"]
PRELOADED = ["--source", "preloaded"]
# Of the whole computer: a frame of the small core takes 1.6 of the cameras', as on the paper's board at 7x7.
CAMERA_RATES = ["--set", "cameras.frame_rate_hz=1000", "--set", f"fpga.clock_mhz={5992 / 1600}"]
CYCLE = ["--fidelity", "cycle"]  # also for runs that have to take a while
RESULT_FILES = ["config.yaml", "disparity.pfm", "disparity.png", "disparity_color.png", "run.json", "stats.json"]


def run(*arguments, **options):
    """The finished process, with text output."""
    command = [PROGRAM] + [str(argument) for argument in arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, **options)


def has_address_sanitizer():
    return b"__asan_init" in pathlib.Path(PROGRAM).read_bytes()


def slow(test):
    """A test that is left out under the sanitizers: it takes seconds there, and others run the same code."""
    @functools.wraps(test)
    def wrapper(self):
        if has_address_sanitizer():
            self.skipTest("slow under the sanitizers")
        test(self)
    return wrapper


def pgm(width, height, pixels):
    return b"P5\n%d %d\n255\n" % (width, height) + bytes(pixels)


def noise(width, height, seed):
    generator = random.Random(seed)
    return bytes(generator.randrange(256) for _ in range(width * height))


def png_chunks(data):
    at = 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += 12 + length


def read_png(path, bits=8):
    """(width, height, channels, rows of bytes) of a PNG, not interlaced."""
    chunks = list(png_chunks(pathlib.Path(path).read_bytes()))
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", chunks[0][1])
    assert depth == bits and interlaced == 0 and kind in (0, 2, 6)
    channels = {0: 1, 2: 3, 6: 4}[kind]
    raw = zlib.decompress(b"".join(data for name, data in chunks if name == b"IDAT"))
    bytes_per_pixel = channels * bits // 8
    stride = width * bytes_per_pixel
    rows = []
    above = bytes(stride)
    for y in range(height):
        start = y * (stride + 1)
        row = bytearray(raw[start + 1 : start + 1 + stride])
        unfilter(raw[start], row, above, bytes_per_pixel)
        above = bytes(row)
        rows.append(above)
    return width, height, channels, rows


def drawn(path):
    """(width, height, part of it that is white, number of colours) of a figure."""
    script = """
import sys
import numpy
from matplotlib import image
pixels = (image.imread(sys.argv[1])[:, :, :3] * 255).round().astype(int) @ [65536, 256, 1]
print(pixels.shape[1], pixels.shape[0], numpy.mean(pixels == 0xFFFFFF), len(numpy.unique(pixels)))
"""
    process = subprocess.run([PYTHON, "-c", script, str(path)], capture_output=True, text=True, timeout=300, check=True)
    width, height, white, colors = process.stdout.split()
    return int(width), int(height), float(white), int(colors)


def read_png_16(path):
    """The rows of a 16-bit grey PNG."""
    width, _, channels, rows = read_png(path, 16)
    assert channels == 1
    return [struct.unpack(f">{width}H", row) for row in rows]


def unfilter(method, row, above, bytes_per_pixel):
    for i, value in enumerate(row):
        left = row[i - bytes_per_pixel] if i >= bytes_per_pixel else 0
        up = above[i]
        corner = above[i - bytes_per_pixel] if i >= bytes_per_pixel else 0
        estimate = left + up - corner
        nearest = min((left, up, corner), key=lambda candidate: abs(estimate - candidate))
        row[i] = (value + (0, left, up, (left + up) // 2, nearest)[method]) & 0xFF


def read_pfm(path):
    """(width, height, rows of floats from the top)."""
    kind, size, scale, data = pathlib.Path(path).read_bytes().split(b"\n", 3)
    assert kind == b"Pf" and float(scale) == -1.0
    width, height = map(int, size.split())
    values = struct.unpack(f"<{width * height}f", data)
    rows = [list(values[y * width : (y + 1) * width]) for y in range(height)]
    return width, height, rows[::-1]


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own, and a small pair in it: self.left, self.right."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.left = self.file("left.pgm", pgm(WIDTH, HEIGHT, noise(WIDTH, HEIGHT, 1)))
        self.right = self.file("right.pgm", pgm(WIDTH, HEIGHT, noise(WIDTH, HEIGHT, 2)))
        self.out = self.folder / "out"

    def file(self, name, data):
        path = self.folder / name
        path.write_bytes(data)
        return path

    def side(self, number, side):
        """The pixels of one side of a pair of a sequence."""
        return noise(WIDTH, HEIGHT, 10 * number + (0 if side == "left" else 1))

    def sequence(self, length, name="sequence"):
        """A folder of pairs that all differ."""
        folder = self.folder / name
        folder.mkdir()
        for number in range(length):
            for side in ("left", "right"):
                (folder / f"{side}_{number:03}.png").write_bytes(pgm(WIDTH, HEIGHT, self.side(number, side)))
        return folder

    def run_arguments(self, *more, board="fpl2003", left=None, right=None):
        pair = ["--left", self.left if left is None else left, "--right", self.right if right is None else right]
        return ["run", board, *SMALL, *PRELOADED, *pair, *more]

    def run_with(self, *source, board="fpl2003"):
        """A small run with these options instead of a pair."""
        return run("run", board, *SMALL, *PRELOADED, *source)

    def run_small(self, *more, **pair):
        return run(*self.run_arguments(*more, **pair))

    def succeeds(self, process):
        self.assertEqual(process.returncode, 0, process.stderr)
        return process.stdout

    def refused(self, process, *texts):
        """Refused before the first cycle: the lines on standard error, with nothing on standard output."""
        self.assertEqual(process.returncode, 2, process.stderr)
        self.assertEqual(process.stdout, "")
        for text in texts:
            self.assertIn(str(text), process.stderr)
        return process.stderr.splitlines()

    def refused_in_one_line(self, process, *texts):
        self.assertEqual(len(self.refused(process, *texts)), 1, process.stderr)

    def result(self, folder=None):
        """The bytes of all files of a result folder, by name."""
        folder = folder or self.out
        return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    def stats(self):
        return json.loads((self.out / "stats.json").read_text())


def main():
    sys.modules["program"].PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
