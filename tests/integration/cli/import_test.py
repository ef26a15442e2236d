"""calibrate --import and --export: calibrations of other programs."""

import hashlib
import struct

import program
from program import PRELOADED, ProgramTest, made_rig, run

DEPTHS = ["--near-mm", "500", "--far-mm", "3000"]
MIDDLEBURY = """cam0=[64 0 31.5; 0 64 15.5; 0 0 1]
cam1=[64 0 34.5; 0 64 15.5; 0 0 1]
doffs=3
baseline=100
width=64
height=32
ndisp=20
"""


class ImportTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.rig, _ = made_rig()

    def imported(self, *arguments, out="mine.yaml"):
        return run("calibrate", "--import", *arguments, "--out", self.folder / out)

    def tables(self, stem):
        return [(self.folder / f"{stem}_{side}.lut").read_bytes() for side in ("left", "right")]

    def test_gives_the_same_tables_through_each_format(self):
        self.succeeds(self.imported(self.rig, *DEPTHS))
        first = self.tables("mine")
        offset = ["--disparity-offset", "7"]
        for form, files in (("opencv", ["f.yaml"]), ("ros", ["f_left.yaml", "f_right.yaml"])):
            out = self.succeeds(self.imported(self.rig, "--export", form, out="f.yaml"))
            paths = [self.folder / name for name in files]
            self.assertEqual(out.split(maxsplit=1)[1].strip(), ", ".join(map(str, paths)))
            self.assertIn("imported", self.succeeds(self.imported(*paths, *DEPTHS, out=f"{form}.yaml")))
            for table, expected in zip(self.tables(form), first):
                different = sum(a != b for a, b in zip(table, expected))
                self.assertLess(different, 4, "entries at a rounding border")
            self.succeeds(self.imported(*paths, *offset, out=f"{form}.yaml"))  # replaces its own
        # Not a file of its own kind.
        self.refused(self.imported(self.rig, *offset, out="f_left.yaml"), "f_left.yaml")
        self.refused(self.imported(self.rig, "--export", "opencv", out="mine.yaml"), "mine.yaml")

    def test_leads_from_a_file_to_depths(self):
        calib = self.file("calib.txt", MIDDLEBURY)
        size = program.sets("image={width: 64, height: 32}", "matcher.disparities=16")
        scene = ["run", "fpl2003", *PRELOADED, *size, "--synthetic", "1"]
        self.refused(run(*scene, "--calibration", calib),
                     "this file of Middlebury calib.txt becomes one by stereotlm calibrate --import")
        found = self.succeeds(self.imported(calib, *DEPTHS, "--disparities", "16"))
        self.assertRegex(found, r"disparities +offset -1: 0 .. 15 of the board are -1 .. 14, 376 mm")
        result = self.folder / "result"
        self.succeeds(run(*scene, "--calibration", self.folder / "mine.yaml", "--out", result))
        self.assertTrue((result / "depth.png").exists())

    def test_a_run_warns_of_tables_that_are_mostly_empty(self):
        self.succeeds(self.imported(self.file("calib.txt", MIDDLEBURY), "--disparity-offset", "20"))
        rig, lut = self.folder / "mine.yaml", self.folder / "mine_left.lut"
        empty = b"".join(struct.pack("<I", 2**31 + (y << 16) + x + 40 if x + 40 < 64 else 0)
                         for y in range(32) for x in range(64))
        text = rig.read_text().replace(program.sha256(lut), hashlib.sha256(empty).hexdigest())
        lut.write_bytes(empty)
        rig.write_text(text.replace("disparity_offset: 20", "disparity_offset: 40"))
        size = program.sets("image={width: 64, height: 32}", "matcher.disparities=16")
        process = run("run", "fpl2003", *PRELOADED, *size, "--synthetic", "1", "--calibration", rig)
        self.succeeds(process)
        self.assertIn("warning: --calibration: 1280 of 2048 entries of the left table are", process.stderr)

    def test_refuses_what_it_cannot_do(self):
        calib = self.file("calib.txt", MIDDLEBURY)
        self.all_refused((
            ([calib], "--import: needs the depths to see, --near-mm and --far-mm, or instead"),
            ([calib, "--near-mm", "5", "--far-mm", "3"], "--near-mm = 5: must be less than --far-mm, 3"),
            ([calib, *DEPTHS, "--grid", "9x6"], "--grid: does not go with --import"),
            ([calib, "--disparities", "9", "--export", "ros"], "--disparities: does not go with --export"),
            ([calib, "--near-mm", "20", "--far-mm", "3000"], "are 320 disparities", "and the board has 80"),
            ([calib, "--disparity-offset", "40"], "the left table would be empty in"),
            (["none", *DEPTHS], "--import 'none': no such file"),
        ), self.imported)
        self.refused(run("calibrate", "--unit", "m", "--out", "f.yaml"), "--unit: goes with --import")


if __name__ == "__main__":
    program.main()
