"""The rig that took the 13 chessboard pairs of opencv-doc: calibrated, and measured through the simulated board.

usage: real_rig_test.py FOLDER_OF_PROGRAMS PICTURES
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
DISPARITIES = 112


def say(program, *arguments):
    command = [str(PROGRAMS / program)] + [str(argument) for argument in arguments]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def calibrate(folder, *more):
    return say("stereotlm", "calibrate", "--left", PICTURES / "left[01][0-9].jpg", "--right",
               PICTURES / "right[01][0-9].jpg", "--grid", "9x6", "--square-mm", "25", *more, "--out", folder / "rig.yaml")


def run_all_pairs(folder, tolerance):
    """What stereotlm-grid-check says of all pairs together, without filter."""
    out = folder / f"tolerance_{tolerance}"
    say("stereotlm", "run", "fpl2003", "--source", "preloaded", "--fidelity", "cycle", "--sequence", folder / "pairs",
        "--calibration", folder / "rig.yaml", "--save-frames", "--out", out, "--set", "matcher.filter=none",
        "--set", f"matcher.disparities={DISPARITIES}", "--set", f"matcher.lr_tolerance={tolerance}")
    return json.loads(say("stereotlm-grid-check", folder / "rig.yaml", out))["all"]


class RealRig(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        calibrate(cls.folder, "--disparities", DISPARITIES)
        say("stereotlm-demo-pictures", "sequence", PICTURES, cls.folder / "pairs")
        text = (cls.folder / "rig.yaml").read_text()
        cls.quality = text[text.index("\nquality:") :]

    def figure(self, pattern):
        return float(re.search(pattern + r"\s*([-+.e\d]+)", self.quality).group(1))

    def test_calibrates_as_well_as_opencv_does_carefully(self):
        self.assertLessEqual(self.figure(r" reprojection_rms_px:"), 0.216)
        self.assertLessEqual(self.figure(r" row_error:\s+mean_px:"), 0.128)
        self.assertLessEqual(self.figure(r" row_error:\s+mean_px:.*\s+max_px:"), 0.72)
        self.assertLessEqual(self.figure(r" row_error_found_again:\s+mean_px:"), 0.385)
        self.assertEqual(self.figure(r" row_error:\s+mean_px:.*\s+max_px:.*\s+corners:"), 702)

    def test_is_not_fitted_to_single_pairs(self):
        self.assertLessEqual(self.figure(r" held_out_reprojection_rms_px:"), 1.1 * self.figure(r" reprojection_rms_px:"))
        self.assertLessEqual(self.figure(r" held_out_row_error:\s+mean_px:"), 1.1 * self.figure(r" row_error:\s+mean_px:"))

    def test_gives_the_board_the_right_disparities(self):
        found = run_all_pairs(self.folder, "off")
        self.assertEqual(found["corners"], 702)
        self.assertGreaterEqual(found["right"], 0.994 * 702)

    def test_gives_the_board_true_lengths(self):
        found = run_all_pairs(self.folder, 0)
        self.assertLessEqual(found["wrong"], 2)
        self.assertLess(found["unanswered"], 0.15 * 702)
        self.assertLessEqual(abs(found["lengths"]["mean_percent"]), 0.5)
        self.assertLessEqual(found["lengths"]["mean_absolute_percent"], 1.6)
        self.assertGreater(found["lengths"]["mean_absolute_percent"], found["lengths_floor"]["mean_absolute_percent"])
        self.assertLess(found["plane_percent"], 0.4)

    def test_is_shown_with_its_depths(self):
        say("stereotlm", "run", "fpl2003", "--source", "preloaded", "--fidelity", "cycle", "--calibration",
            self.folder / "rig.yaml", "--set", f"matcher.disparities={DISPARITIES}", "--set", "matcher.window=3",
            "--left", PICTURES / "left09.jpg", "--right", PICTURES / "right09.jpg", "--out", self.folder / "run")
        page = self.folder / "page.png"
        say("stereotlm-demo-pictures", "depth-montage", page, PICTURES / "left09.jpg", self.folder / "rig.yaml",
            self.folder / "run")
        self.assertGreater(page.stat().st_size, 200_000)


if __name__ == "__main__":
    unittest.main()
