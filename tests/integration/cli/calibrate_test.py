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


class RefusedCalibrations(CalibrateTest):
    def refused_with(self, rig, *texts):
        for command in ("check", "bounds"):
            self.refused(run(command, "fpl2003", "--calibration", rig), "stereotlm: error: --calibration", *texts)
        self.refused(run(*self.scene(rig, "--out", self.out)), *texts)
        self.assertFalse(self.out.exists())

    def test_that_are_not_there(self):
        self.refused_with(self.folder / "none.yaml", "none.yaml': no such file")
        self.refused_with(self.folder / "rig.yml", "must end in .yaml")
        self.refused_with(self.folder, "must end in .yaml")

    def test_without_a_table(self):
        rig = self.copy_of_rig()
        (self.folder / "rig_left.lut").unlink()
        self.refused_with(rig, "rig_left.lut': no such file")

    def test_that_are_damaged(self):
        rig = self.copy_of_rig()
        text = rig.read_text()
        for damaged, problem in (
            (text[: text.index("P2:")], "P2: missing: a calibration has this key"),
            (text[: text.index("P2:") + 60], "P2: no matrix"),
            (text.replace("disparity_offset: 0", "disparity_offset: 1"), "must be those that its tables were made with"),
            (text.replace("image_height: 480", "image_height: tall"), "image_height: no integer"),
            ("", "must be %YAML:1.0"),
            (text.replace("Q: !!opencv-matrix", "Q: [1, 2"), "must be OpenCV FileStorage YAML"),
        ):
            rig.write_text(damaged)
            self.refused_with(rig, problem)

    def test_whose_tables_are_others(self):
        rig = self.copy_of_rig()
        for name in ("rig_left.lut", "rig_right.lut"):
            table = bytearray((self.home / name).read_bytes())
            table[1000] ^= 1
            (self.folder / name).write_bytes(table)
            self.refused_with(rig, f"{name}': SHA-256", "must be the table that the calibration was written with")
            (self.folder / name).write_bytes((self.home / name).read_bytes())
        (self.folder / "rig_left.lut").write_bytes((self.home / "rig_right.lut").read_bytes())
        self.refused_with(rig, "rig_left.lut': SHA-256")

    def test_of_another_size(self):
        self.refused(run("check", "fpl2003", "--set", "image.width=320", "--calibration", self.rig),
                     f"--calibration '{self.rig}': image size = 640x480: must be that of the board's images, 320x480")

    def test_for_a_side_without_table(self):
        for side in ("left", "right"):
            self.refused(run("check", "fpl2003", "--set", f"allocation.{side}_lut=none", "--calibration", self.rig),
                         f"goes with a board that has both tables; allocation.{side}_lut = none")

    def test_inside_the_result_folder(self):
        self.out.mkdir()
        rig = self.copy_of_rig()
        for path in self.folder.glob("rig*"):
            path.rename(self.out / path.name)
        self.refused(run(*self.scene(self.out / rig.name, "--out", self.out)), "inside the result folder")
        self.assertTrue((self.out / "rig.yaml").exists())


class RefusedPictures(CalibrateTest):
    def calibrate(self, *sources, more=()):
        return run("calibrate", *sources, *GRID, "--disparities", DISPARITIES, "--out", self.folder / "new.yaml", *more)

    def refused_pictures(self, process, *texts):
        self.refused(process, *texts)
        self.assertEqual([path.name for path in self.folder.iterdir() if path.name.startswith("new")], [])

    def test_that_are_not_there(self):
        self.refused_pictures(self.calibrate("--left", self.folder / "l*.png", "--right", self.folder / "r*.png"),
                              f"--left '{self.folder}/l*.png': no such file", "--right")

    def test_of_different_numbers(self):
        self.refused_pictures(self.calibrate(*self.sources(right="right_0[0-4].png")),
                              "9 left pictures", "5 right ones", "must be as many")

    def test_of_different_sizes(self):
        self.file("left_99.png", self.left.read_bytes())
        left = [self.file("left_00.png", (self.pictures / "left_00.png").read_bytes()), self.folder / "left_99.png"]
        self.refused_pictures(self.calibrate("--left", *left, "--right", self.pictures / "right_0[01].png"),
                              f"'{self.folder}/left_99.png': 32x24 pixels: must be as large as", "640x480")

    def test_that_are_none(self):
        broken = self.file("left_99.png", b"no picture")
        self.refused_pictures(self.calibrate("--left", broken, "--right", self.pictures / "right_00.png"),
                              f"--left '{broken}'", "not a picture")

    def test_too_few(self):
        self.refused_pictures(self.calibrate(*self.sources("left_0[01].png", "right_0[01].png")),
                              "in both pictures = 2 of 2: must be 3 or more")

    def test_that_are_there_twice(self):
        again = self.file("left_99.png", (self.pictures / "left_02.png").read_bytes())
        left = [self.pictures / f"left_0{number}.png" for number in range(4)] + [again]
        self.refused_pictures(self.calibrate("--left", *left, "--right", self.pictures / "right_0[0-4].png"),
                              "left_02.png': the same picture as" if str(again) < str(self.pictures) else
                              "left_99.png': the same picture as")

    def test_that_are_tiny(self):
        names = [[self.file(f"{side}_{number}.pgm", pgm(4, 1, bytes([number, side_number, 0, 9])))
                  for number in range(3)] for side_number, side in enumerate(("left", "right"))]
        self.refused_pictures(self.calibrate("--left", *names[0], "--right", *names[1]), "= 0 of 3: must be 3 or more",
                              f"'{names[0][0]}': no grid of 7x5 inner corners found")

    def test_whose_names_look_like_patterns(self):
        folder = self.folder / "br[1]"
        folder.mkdir()
        for number in range(4):
            for side in ("left", "right"):
                name = f"{side}_0{number}.png"
                (folder / name).write_bytes((self.pictures / name).read_bytes())
        left, right = ([folder / f"{side}_0{number}.png" for number in range(4)] for side in ("left", "right"))
        self.succeeds(self.calibrate("--left", *left, "--right", *right))

    def test_of_swapped_cameras(self):
        self.refused_pictures(self.calibrate(*self.sources("right_0[0-2].png", "left_0[0-2].png")),
                              "the cameras are swapped")

    def test_whose_names_do_not_go_together(self):
        left = [self.pictures / f"left_{number}.png" for number in ("00", "01", "03", "04")]
        right = [self.pictures / f"right_{number}.png" for number in ("00", "02", "03", "04")]
        process = self.calibrate("--left", *left, "--right", *right)
        self.assertIn(f"'{left[1]}' with '{right[1]}': do they belong together?", process.stderr)

    def test_whose_disparities_do_not_fit(self):
        process = run("calibrate", *self.sources("left_0[0-2].png", "right_0[0-2].png"), *GRID, "--disparities", "3",
                      "--out", self.folder / "new.yaml")
        self.assertRegex(self.refused(process)[0], r"disparities = 3: must be \d+ or more for the grid's own")

    def test_into_a_file_that_is_no_calibration(self):
        new = self.file("new.yaml", b"precious: 1\n")
        self.refused(self.calibrate(*self.sources()), f"--out '{new}': exists and is no calibration")
        self.assertEqual(new.read_bytes(), b"precious: 1\n")

    def test_beside_files_that_are_not_its_own(self):
        table = self.file("new_left.lut", b"precious")
        self.refused(self.calibrate(*self.sources()), f"'{table}': exists, without its calibration")
        table.unlink()
        self.copy_of_rig().rename(self.folder / "new.yaml")
        (self.folder / "new_drawings").mkdir()
        notes = self.file("new_drawings/notes.txt", b"precious")
        self.refused(self.calibrate(*self.sources()), f"'{notes}'", "must be moved away")
        notes.unlink()
        table.mkdir()
        self.refused(self.calibrate(*self.sources()), f"'{table}': must be a file that calibrate has made")

    def test_beside_the_new_calibration_stay(self):
        mine = self.folder / "new_pictures"
        mine.mkdir()
        for number in range(4):
            for side in ("left", "right"):
                name = f"{side}_0{number}.png"
                (mine / name).write_bytes((self.pictures / name).read_bytes())
        for _ in range(2):
            self.succeeds(self.calibrate("--left", mine / "left_*.png", "--right", mine / "right_*.png"))
            self.assertEqual(len(list(mine.iterdir())), 8)
        self.refused(run("calibrate", "--synthetic", 1, *GRID, "--out", self.folder / "other.yaml", "--left", "x"))
        mine.rename(self.folder / "other_pictures")
        self.refused(run("calibrate", "--synthetic", 1, *GRID, "--out", self.folder / "other.yaml"),
                     "other_pictures': exists, without its calibration")
        self.assertEqual(len(list((self.folder / "other_pictures").iterdir())), 8)

    def test_in_the_folder_of_drawings(self):
        few = self.sources("left_0[0-2].png", "right_0[0-2].png")
        self.succeeds(self.calibrate(*few))
        drawings = self.folder / "new_drawings"
        self.refused(self.calibrate("--left", drawings / "corners_0[0-2].png", "--right", drawings / "rectified_0[0-2].png"),
                     "new_drawings', which is replaced whole: a picture must lie elsewhere")

    def test_with_something_of_the_users_under_the_name_of_the_folder_aside(self):
        aside = self.file("new.partial", b"precious")
        self.refused(self.calibrate(*self.sources()), f"'{aside}': the name of a folder that calibrate uses")
        self.assertEqual(aside.read_bytes(), b"precious")
        aside.unlink()
        aside.mkdir()
        thesis = self.file("new.partial/thesis.txt", b"precious")
        (self.folder / "new.yaml").symlink_to("new.yaml")
        self.refused(self.calibrate(*self.sources()), f"'{thesis}'")
        self.assertEqual(thesis.read_bytes(), b"precious")

    def test_after_a_run_that_was_killed(self):
        few = self.sources("left_0[0-2].png", "right_0[0-2].png")
        self.succeeds(self.calibrate(*few))
        aside = self.folder / "new.partial"
        aside.mkdir()
        (self.folder / "new.yaml").rename(aside / "new.yaml")
        self.succeeds(self.calibrate(*few))
        self.assertFalse(aside.exists())

    def test_into_a_folder_that_cannot_be(self):
        for folder in (self.folder / "none", self.left):
            self.refused(run("calibrate", *self.sources(), *GRID, "--out", folder / "new.yaml"),
                         f"--out '{folder}': no such folder")


class Usage(ProgramTest):
    def test_everything_missing_at_once(self):
        lines = self.refused(run("calibrate"), "--grid: missing", "--square-mm: missing", "--left: missing",
                             "--right: missing", "--out: missing", "a complete command: stereotlm calibrate --left")
        self.assertEqual(len(lines), 6)

    def test_wrong_values(self):
        good = {"--left": "l", "--right": "r", "--grid": "9x6", "--square-mm": "25", "--out": "rig.yaml"}
        for option, value, problem in (
            ("--grid", "9", "must be columns x rows"),
            ("--grid", "9x", "must be columns x rows"),
            ("--grid", "2x6", "columns = 2: must be 3..100"),
            ("--square-mm", "wide", "--square-mm = wide: must be a number"),
            ("--square-mm", "0", "square_mm = 0: must be"),
            ("--square-mm", "nan", "square_mm = nan: must be"),
            ("--disparities", "255", "--disparities = 255: must be an integer, 1..254"),
            ("--disparity-offset", "1.5", "--disparity-offset = 1.5: must be auto or an integer"),
            ("--synthetic", "1", "does not go with --left and --right"),
            ("--out", "rig.yml", "--out 'rig.yml': must end in .yaml"),
        ):
            arguments = [word for pair in {**good, option: value}.items() for word in pair]
            self.refused(run("calibrate", *arguments), problem)

    def test_a_wrong_seed(self):
        self.refused(run("calibrate", "--synthetic", "-1", *GRID, "--out", "rig.yaml"), "--synthetic = -1: must be")


class PrintGrid(ProgramTest):
    def test_makes_a_sheet_true_to_scale(self):
        for name, beginning in (("grid.pdf", b"%PDF-"), ("grid.svg", b"<?xml")):
            sheet = self.folder / name
            said = self.succeeds(run("calibrate", "--print-grid", "9x6", "--square-mm", "25", "--out", sheet))
            self.assertEqual(said, f"{sheet}: 10x7 squares of 25 mm, 9x6 inner corners; print it at 100 %\n")
            self.assertTrue(sheet.read_bytes().startswith(beginning))
            again = sheet.read_bytes()
            self.succeeds(run("calibrate", "--print-grid", "9x6", "--square-mm", "25", "--out", sheet))
            self.assertEqual(sheet.read_bytes(), again)
        text = (self.folder / "grid.svg").read_text()
        self.assertIn('width="297mm"', text)
        self.assertEqual(text.count('width="25" height="25"'), 35)

    def test_refusals(self):
        sheet = self.folder / "grid.pdf"
        arguments = ["calibrate", "--print-grid", "9x6", "--square-mm", "25", "--out"]
        self.refused(run(*arguments, self.folder / "grid.png"), "must end in .pdf or .svg")
        self.refused(run(*arguments, sheet, "--left", "x", "--disparities", "3"), "--left: does not go with --print-grid",
                     "--disparities: does not go with --print-grid")
        self.refused(run(*arguments, self.folder / "none" / "grid.pdf"), "cannot be written")
        self.refused(run("calibrate", "--print-grid", "9x6", "--out", sheet), "--square-mm: missing")
        self.refused(run("calibrate", "--print-grid", "100x100", "--square-mm", "1000", "--out", sheet), "5080")
        sheet.write_bytes(b"precious")
        self.refused(run(*arguments, sheet), "exists and is another file")
        self.assertEqual(sheet.read_bytes(), b"precious")


if __name__ == "__main__":
    program.main()
