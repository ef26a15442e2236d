"""calibrate --import and --export: calibrations of other programs."""

import hashlib
import struct
import zlib

import numpy

import program
from pictures import noise, pgm, read_pfm, read_png_16
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


def pfm(disparities):
    return b"Pf\n%d %d\n-1\n" % disparities.shape[::-1] + disparities[::-1].astype("<f4").tobytes()


def png_16(levels):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width = levels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in levels)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


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

    def test_truth_of_middlebury_and_kitti_gives_quality_and_depths(self):
        width, height, offset = 160, 48, 4
        texture = numpy.frombuffer(noise(width + 20, height, 1), numpy.uint8).reshape(height, width + 20)
        x = numpy.arange(width)
        disparity = numpy.where(x < 80, 9, 14)
        pair = []
        for side, columns in (("left", x + 20 - disparity), ("right", x + 20)):
            picture = pgm(width, height, texture[:, columns].tobytes())
            pair += [f"--{side}", self.file(f"{side}.pgm", picture)]
        truth = disparity + numpy.zeros((height, 1))
        truth[:10] += 1.5  # wrong
        truth[:, :30] = numpy.inf
        size = f"width={width}\nheight={height}\n"
        middlebury = MIDDLEBURY.replace("width=64\nheight=32\n", size)
        kitti = "P0: 64 0 80 0 0 64 24 0 0 0 1 0\nP1: 64 0 80 -6.4 0 64 24 0 0 0 1 0\n"  # 0.1 m
        levels = numpy.where(numpy.isfinite(truth), truth * 256, 0).astype(">u2")
        for calib, words, of_run, doffs in (
            (middlebury, [], ["--truth", self.file("t.pfm", pfm(truth))], 3),
            (kitti, ["--size", f"{width}x{height}", "--cameras", "P0,P1"],
             ["--truth", self.file("t.png", png_16(levels)), "--truth-scale", 256], 0),
        ):
            self.succeeds(self.imported(self.file("calib.txt", calib), *words, "--disparity-offset", offset))
            board = program.sets(f"image={{width: {width}, height: {height}}}", "matcher.disparities=16")
            self.succeeds(run("run", "fpl2003", *PRELOADED, *board, *pair, *of_run, "--out", self.out,
                              "--calibration", self.folder / "mine.yaml"))
            found = numpy.array(read_pfm(self.out / "disparity.pfm")[2])
            # The quality, as numpy has it.
            known = numpy.full(truth.shape, numpy.inf)
            known[:, :-offset] = truth[:, offset:] - offset
            rows, columns = numpy.nonzero(x - known >= 0)
            seen = numpy.floor(x - known + 0.5)[rows, columns].astype(int)
            nearest = numpy.full(truth.shape, -numpy.inf)
            numpy.maximum.at(nearest, (rows, seen), known[rows, columns])
            visible = nearest[rows, seen] - known[rows, columns] <= 1
            errors = abs(found[rows, columns] - known[rows, columns])[visible]
            answered = numpy.isfinite(errors)
            accuracy = self.stats()["accuracy"]
            for key, share in (("answered_percent", answered.mean()),
                               ("bad_1_percent", (errors[answered] > 1).mean()),
                               ("bad_2_percent", (errors[answered] > 2).mean())):
                self.assertAlmostEqual(accuracy[key], 100 * share, 2)
            self.assertGreater(accuracy["bad_1_percent"], 10)
            depths = numpy.array(read_png_16(self.out / "depth.png"))
            expected = numpy.where(numpy.isfinite(found), 6400 / (found + offset + doffs), 0)
            self.assertLess(abs(depths - expected).max(), 0.51)
            right = (found + offset == numpy.roll(disparity, -offset)) & (depths > 0)
            self.assertGreater(right.sum(), 0.6 * width * height)

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
        for cameras in ("P2", "P2,", ",P3"):
            one = run("calibrate", "--import", "calib.txt", "--cameras", cameras, "--out", "f.yaml")
            self.refused(one, "must be two names with a comma")


if __name__ == "__main__":
    program.main()
