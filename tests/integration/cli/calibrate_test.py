"""calibrate, and --calibration: on a rig that is made up."""

import functools
import json
import pathlib
import re
import struct
import tempfile

import program
from program import PRELOADED, RESULT_FILES, ProgramTest, pgm, read_png, run

GRID = ["--grid", "7x5", "--square-mm", "30"]
DISPARITIES = 120


def fields(text):
    """What calibrate prints, by the first word or words of its lines."""
    return {line[:16].strip(): line[17:] for line in text.splitlines() if line[:16].strip()}


HOME = tempfile.TemporaryDirectory()  # of the calibration that all tests share


@functools.lru_cache(maxsize=None)
def made():
    """The finished process that made it."""
    return run("calibrate", "--synthetic", 3, *GRID, "--out", pathlib.Path(HOME.name) / "rig.yaml")


class CalibrateTest(ProgramTest):
    """With a calibration: self.rig, and its pictures: self.pictures."""

    def setUp(self):
        super().setUp()
        self.home = pathlib.Path(HOME.name)
        self.rig = self.home / "rig.yaml"
        self.pictures = self.home / "rig_pictures"
        self.made = made()

    def copy_of_rig(self):
        for path in (self.rig, self.home / "rig_left.lut", self.home / "rig_right.lut"):
            (self.folder / path.name).write_bytes(path.read_bytes())
        return self.folder / "rig.yaml"

    def sources(self, left="left_*.png", right="right_*.png"):
        return ["--left", self.pictures / left, "--right", self.pictures / right]

    def scene(self, rig=None, *more):
        """A run of the scene with the tables of the rig."""
        return ["run", "fpl2003", *PRELOADED, "--set", "matcher.disparities=80", "--calibration", rig or self.rig,
                "--left", self.pictures / "scene_left.png", "--right", self.pictures / "scene_right.png", *more]


class Made(CalibrateTest):
    def test_says_what_it_found_and_wrote(self):
        found = fields(self.succeeds(self.made))
        self.assertIn("9 of 9 with the grid", found["pairs"])
        self.assertRegex(found["reprojection"], r"^RMS 0\.[01]\d\d px")
        self.assertRegex(found["row error"], r"^mean 0\.0\d\d px")
        baseline = float(found["baseline"].split()[0])
        known = float(re.search(r"baseline ([\d.]+) mm", found["known to be"]).group(1))
        self.assertLess(abs(baseline / known - 1), 0.01)
        for name in ("rig.yaml", "rig_left.lut", "rig_right.lut", "rig_drawings/"):
            self.assertIn(str(self.home / name), found["written"])

    def test_writes_tables_of_one_word_a_pixel(self):
        for side in ("left", "right"):
            table = (self.home / f"rig_{side}.lut").read_bytes()
            self.assertEqual(len(table), 4 * 640 * 480)
            for (entry,) in struct.iter_unpack("<I", table):
                if entry:
                    self.assertEqual(entry & 0x7800F800, 0)
                    self.assertTrue(entry >> 31 and (entry >> 16 & 0x7FF) < 480 and (entry & 0x7FF) < 640)

    def test_draws(self):
        names = sorted(path.name for path in (self.home / "rig_drawings").iterdir())
        numbers = [f"{number:02}" for number in range(9)]
        self.assertEqual(names, sorted([f"corners_{number}.png" for number in numbers]
                                       + [f"rectified_{number}.png" for number in numbers]
                                       + ["displacement.png", "source_lines.png"]))
        self.assertEqual(len({path.read_bytes() for path in (self.home / "rig_drawings").iterdir()}), len(names))

    def test_of_the_pictures_it_wrote_gives_the_same_tables(self):
        again = self.folder / "again.yaml"
        said = self.succeeds(run("calibrate", *self.sources(), *GRID, "--disparity-offset", "0", "--out", again))
        self.assertEqual(fields(said)["reprojection"], fields(self.made.stdout)["reprojection"])
        for side in ("left", "right"):
            self.assertEqual((self.folder / f"again_{side}.lut").read_bytes(),
                             (self.home / f"rig_{side}.lut").read_bytes())
        self.assertFalse((self.folder / "again_pictures").exists())

    def test_replaces_an_earlier_calibration(self):
        new = self.folder / "new.yaml"
        few = self.sources("left_0[0-2].png", "right_0[0-2].png")
        command = ["calibrate", *few, *GRID, "--disparities", DISPARITIES, "--out", new]
        self.succeeds(run(*command, "--disparity-offset", "70"))
        self.assertEqual(len(list((self.folder / "new_drawings").iterdir())), 8)
        first = new.read_bytes()
        said = self.succeeds(run(*command))
        self.assertRegex(fields(said)["disparities"], r"of the grid; offset \d+: 0 \.\. 119 of the board are")
        self.assertNotIn("do not fit", fields(said)["disparities"])
        self.assertNotEqual(new.read_bytes(), first)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir() if path.name.startswith("new")),
                         ["new.yaml", "new_drawings", "new_left.lut", "new_right.lut"])


class Run(CalibrateTest):
    def test_finds_the_disparities_of_the_scene(self):
        scale = re.search(r"--truth-scale (\d+)", self.made.stdout).group(1)
        truth = self.pictures / "scene_truth.png"
        process = run(*self.scene(None, "--truth", truth, "--truth-scale", scale, "--out", self.out))
        self.succeeds(process)
        self.assertRegex(process.stderr, r"note: .* \d+ are found in the right one; their rows differ by 0\.\d\d pixels on average\n")
        accuracy = self.stats()["accuracy"]
        self.assertLess(accuracy["bad_1_percent"], 3)
        self.assertGreater(accuracy["answered_percent"], 60)
        self.assertEqual(sorted(self.result()), sorted(RESULT_FILES + ["depth.ply", "depth.png"]))
        self.check_depths(self.rig, 0)

    def test_puts_the_offset_back_before_depths(self):
        rig = self.folder / "far.yaml"
        self.succeeds(run("calibrate", *self.sources("left_0[0-2].png", "right_0[0-2].png"), *GRID,
                          "--disparity-offset", "11", "--out", rig))
        self.succeeds(run(*self.scene(rig, "--out", self.out)))
        self.check_depths(rig, 11)

    def check_depths(self, rig, offset):
        """Depth by the text of the calibration, and one point for each answer."""
        width, height, _, rows = read_png(self.out / "disparity.png")
        q = [float(word) for word in re.search(r"Q:.*?data: \[(.*?)\]", rig.read_text(), re.S).group(1).split(",")]
        depths = program.read_png_16(self.out / "depth.png")
        for y in range(0, height, 7):
            for x in range(width):
                expected = 0
                if rows[y][x] not in (255, -offset):
                    expected = int(q[11] / (q[14] * (rows[y][x] + offset) + q[15]) + 0.5)
                self.assertEqual(depths[y][x], expected, (x, y))
        points = sum(1 for row in rows for disparity in row if disparity not in (255, -offset))
        self.assertIn(b"element vertex %d\n" % points, (self.out / "depth.ply").read_bytes())

    def test_is_reproduced_from_what_it_was_given(self):
        self.succeeds(run(*self.scene(None, "--out", self.out)))
        options = json.loads((self.out / "run.json").read_text())["calibration"]
        self.assertEqual(options["path"], str(self.rig))
        self.assertEqual(options["right_lut"]["path"], str(self.home / "rig_right.lut"))
        first = self.result()
        self.succeeds(run(*self.scene(None, "--out", self.out)))
        self.assertEqual(self.result(), first)

    def test_gives_the_same_disparities_through_the_whole_computer(self):
        small = ["--set", "matcher.fetch=line_buffer", "--set", "matcher.window=3"]
        self.succeeds(run(*self.scene(None, *small, "--out", self.out)))
        whole = self.folder / "whole"
        command = [word for word in self.scene(None, *small, "--out", whole) if word not in ("--source", "preloaded")]
        self.succeeds(run(*command))
        for name in ("disparity.png", "depth.png", "depth.ply"):
            self.assertEqual((whole / name).read_bytes(), (self.out / name).read_bytes())

    def test_goes_with_every_command_that_takes_a_board(self):
        rig = self.folder / "far.yaml"
        self.succeeds(run("calibrate", *self.sources("left_0[0-2].png", "right_0[0-2].png"), *GRID,
                          "--disparity-offset", "100", "--out", rig))
        self.succeeds(run("check", "fpl2003", "--calibration", rig))
        plain = self.succeeds(run("bounds", "fpl2003")).splitlines()
        with_tables = self.succeeds(run("bounds", "fpl2003", "--calibration", rig)).splitlines()
        # Entries without source are not read.
        changed = [line.split()[:3] for line, other in zip(with_tables, plain) if line != other]
        self.assertEqual(changed, [["bank", "bank0,", "bank1"], ["bank", "bank2,", "bank3"]][: len(changed)])
        self.assertIn(["bank", "bank0,", "bank1"], changed)

    def test_warns_where_the_pictures_are_of_another_rig(self):
        _, _, _, rows = read_png(self.pictures / "scene_right.png")
        lower = self.file("lower.pgm", pgm(640, 480, b"".join(rows[4:] + rows[:4])))
        command = self.scene()
        command[command.index("--right") + 1] = lower
        process = run(*command)
        self.succeeds(process)
        self.assertRegex(process.stderr, r"warning: .* differ by \d\.\d\d pixels on average: is it of this rig\?")

    def test_cannot_tell_where_the_pictures_show_nothing(self):
        flat = self.file("flat.pgm", pgm(640, 480, bytes(640 * 480)))
        process = run("run", "fpl2003", *PRELOADED, "--calibration", self.rig, "--left", flat, "--right", flat)
        self.succeeds(process)
        self.assertIn("note: --calibration: of 0 conspicuous points", process.stderr)
        self.assertIn("too few to see whether it is of this rig", process.stderr)

    def test_warns_where_left_and_right_are_exchanged(self):
        command = self.scene()
        left, right = command.index("--left") + 1, command.index("--right") + 1
        command[left], command[right] = command[right], command[left]
        process = run(*command)
        self.succeeds(process)
        self.assertRegex(process.stderr, r"warning: --calibration: .* is it of this rig")

    def test_says_that_the_board_has_fewer_disparities(self):
        process = run("run", "fpl2003", *PRELOADED, "--synthetic", "1", "--set", "matcher.disparities=16",
                      "--set", "matcher.window=3", "--calibration", self.rig)
        self.assertNotIn("accuracy", self.succeeds(process))  # the scene is not one of this rig
        self.assertIn("was made for 80 disparities: of this board's 16 the nearest things need more", process.stderr)


if __name__ == "__main__":
    program.main()
