"""Every preset at full size, run at both fidelities and compared in every figure, time and pixel.

usage: presets_test.py FOLDER_OF_PROGRAMS PICTURES
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAMS = pathlib.Path(sys.argv.pop(1)).resolve()
PICTURES = pathlib.Path(sys.argv.pop(1)).resolve()
SOURCES = ("preloaded", "camera")

# What shares banks, at full size.
SHARED = {
    "a table beside an image": ["allocation.left_lut=bank0"],
    "disparities beside an image": ["allocation.disparity=[bank0, bank0]", "fpga.arbitration=round_robin"],
    "everything in one bank with turnaround": [
        "ssram.default.kind=sync_burst",
        "ssram.default.turnaround_cycles=2",
        "ssram.default.words=4194304",
        "allocation.left_image=[bank0, bank0]",
        "allocation.right_image=[bank0, bank0]",
        "allocation.disparity=[bank0, bank0]",
        "allocation.left_lut=bank0",
        "allocation.right_lut=bank0",
        "matcher.fetch=line_buffer",
    ],
}


def say(program, *arguments):
    command = [str(PROGRAMS / program)] + [str(argument) for argument in arguments]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def presets():
    return [line.split()[0] for line in say("stereotlm", "boards").splitlines() if line and not line.startswith(" ")]


class Verified(unittest.TestCase):
    def verify(self, board, *options):
        """Both sources."""
        for source in SOURCES:
            with self.subTest(board=board, source=source):
                command = [PROGRAMS / "stereotlm", "run", board, "--source", source, "--verify", *options]
                process = subprocess.run(command, capture_output=True, text=True, check=False)
                self.assertEqual(process.returncode, 0, process.stderr)
                self.assertIn("note: verified: fast and cycle agree in every figure", process.stderr)

    def test_every_preset(self):
        self.assertGreaterEqual(len(presets()), 6)
        for board in presets():
            self.verify(board, "--synthetic", "1", "--frames", "4")

    def test_shared_banks(self):
        for name, keys in SHARED.items():
            with self.subTest(name):
                self.verify("fpl2003", "--synthetic", "2", "--frames", "3", *(w for key in keys for w in ("--set", key)))

    def test_the_tables_of_a_real_rig(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            say("stereotlm", "calibrate", "--left", PICTURES / "left[01][0-9].jpg", "--right",
                PICTURES / "right[01][0-9].jpg", "--grid", "9x6", "--square-mm", "25", "--disparities", "112",
                "--out", folder / "rig.yaml")
            say("stereotlm-demo-pictures", "sequence", PICTURES, folder / "pairs")
            self.verify("fpl2003", "--calibration", folder / "rig.yaml", "--sequence", folder / "pairs",
                        "--set", "matcher.disparities=112")


if __name__ == "__main__":
    unittest.main()
