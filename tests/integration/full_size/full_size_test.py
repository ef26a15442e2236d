"""Boards at full size: every preset at both fidelities, and a real rig measured through the simulated board.

usage: full_size_test.py FOLDER_OF_PROGRAMS PICTURES [CLASS]
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

PROGRAMS = pathlib.Path(sys.argv.pop(1)).resolve()
PICTURES = pathlib.Path(sys.argv.pop(1)).resolve()
DISPARITIES = "matcher.disparities=112"
CORNERS = 702  # of 13 pairs

# Boards whose buffers share banks.
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


def finished(program, *arguments):
    command = [PROGRAMS / program, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def said(program, *arguments):
    """What it prints."""
    process = finished(program, *arguments)
    assert process.returncode == 0, process.stderr
    return process.stdout


def sets(*assignments):
    return [word for assignment in assignments for word in ("--set", assignment)]


class RigTest(unittest.TestCase):
    """With a calibration, cls.rig, of the 13 chessboard pairs of opencv-doc, and the pairs, cls.pairs."""

    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        cls.rig, cls.pairs = cls.folder / "rig.yaml", cls.folder / "pairs"
        left, right = PICTURES / "left[01][0-9].jpg", PICTURES / "right[01][0-9].jpg"
        grid = ["--grid", "9x6", "--square-mm", "25", "--disparities", "112"]
        said("stereotlm", "calibrate", "--left", left, "--right", right, *grid, "--out", cls.rig)
        cls.pairs.mkdir()
        for side in ("left", "right"):
            for path in PICTURES.glob(f"{side}[01][0-9].jpg"):
                (cls.pairs / f"{side}_{path.stem[-2:]}.png").symlink_to(path)


class Fidelities(RigTest):
    def verify(self, board, source, *options):
        """Both fidelities agree in every figure, time and pixel."""
        with self.subTest(board=board, source=source):
            process = finished("stereotlm", "run", board, "--source", source, "--verify", *options)
            self.assertEqual(process.returncode, 0, process.stderr)
            self.assertIn("note: verified: fast and cycle agree in every figure", process.stderr)

    def test_agree_for_every_preset(self):
        lines = said("stereotlm", "boards").splitlines()
        presets = [line.split()[0] for line in lines if line and not line.startswith(" ")]
        self.assertGreaterEqual(len(presets), 6)
        for board in presets:
            for source in ("preloaded", "camera"):
                self.verify(board, source, "--synthetic", "1", "--frames", "2")

    def test_agree_for_shared_banks(self):
        for name, assignments in SHARED.items():
            with self.subTest(name):
                for source in ("preloaded", "camera"):
                    self.verify("fpl2003", source, "--synthetic", "2", "--frames", "3", *sets(*assignments))

    def test_agree_for_the_tables_of_a_real_rig(self):
        rig = ["--calibration", self.rig, "--sequence", self.pairs, "--frames", "3"]
        for source in ("preloaded", "camera"):
            self.verify("fpl2003", source, *rig, *sets(DISPARITIES))


class RealRig(RigTest):
    """From the pictures to the metric truth."""

    def figure(self, pattern):
        """A number of the section quality in the calibration."""
        text = self.rig.read_text()
        return float(re.search(pattern + r"\s*([-+.e\d]+)", text[text.index("\nquality:") :]).group(1))

    def run_board(self, name, *options):
        """The folder of a run with the tables of the rig."""
        out = self.folder / name
        board = ["fpl2003", "--source", "preloaded", "--calibration", self.rig, *sets(DISPARITIES)]
        said("stereotlm", "run", *board, *options, "--out", out)
        return out

    def check_grid(self, tolerance):
        """What stereotlm-grid-check says of all pairs together, without filter."""
        board = sets("matcher.filter=none", f"matcher.lr_tolerance={tolerance}")
        out = self.run_board(f"tolerance_{tolerance}", "--sequence", self.pairs, "--save-frames", *board)
        return json.loads(said("stereotlm-grid-check", self.rig, out))["all"]

    def test_is_calibrated_as_well_as_opencv_does_carefully(self):
        self.assertLessEqual(self.figure(r" reprojection_rms_px:"), 0.216)
        self.assertLessEqual(self.figure(r" row_error:\s+mean_px:"), 0.128)
        self.assertLessEqual(self.figure(r" row_error:\s+mean_px:.*\s+max_px:"), 0.72)
        self.assertLessEqual(self.figure(r" row_error_found_again:\s+mean_px:"), 0.385)
        self.assertEqual(self.figure(r" row_error:\s+mean_px:.*\s+max_px:.*\s+corners:"), CORNERS)

    def test_is_not_fitted_to_single_pairs(self):
        for error in (r"reprojection_rms_px:", r"row_error:\s+mean_px:"):
            self.assertLessEqual(self.figure(f" held_out_{error}"), 1.1 * self.figure(f" {error}"))

    def test_gives_the_board_the_right_disparities(self):
        found = self.check_grid("off")
        self.assertEqual(found["corners"], CORNERS)
        self.assertGreaterEqual(found["right"], 0.994 * CORNERS)

    def test_gives_the_board_true_lengths(self):
        found = self.check_grid(0)
        self.assertLessEqual(found["wrong"], 2)
        self.assertLess(found["unanswered"], 0.15 * CORNERS)
        lengths, floor = found["lengths"], found["lengths_floor"]
        self.assertLessEqual(abs(lengths["mean_percent"]), 0.5)
        self.assertLessEqual(lengths["mean_absolute_percent"], 1.6)
        self.assertGreater(lengths["mean_absolute_percent"], floor["mean_absolute_percent"])
        self.assertLess(found["plane_percent"], 0.4)

    def test_is_shown_with_its_depths(self):
        left, right = PICTURES / "left09.jpg", PICTURES / "right09.jpg"
        out = self.run_board("one", "--left", left, "--right", right, *sets("matcher.window=3"))
        page = self.folder / "page.png"
        said("stereotlm-demo-pictures", "depth-montage", page, left, self.rig, out)
        self.assertGreater(page.stat().st_size, 200_000)


if __name__ == "__main__":
    unittest.main()
