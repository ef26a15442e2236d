"""calibrate and --calibration: what is refused; the grid to print."""

import os
import signal
import subprocess
import time

import program
from calibrate_test import DISPARITIES, GRID, CalibrateTest
from program import ProgramTest, pgm, run


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
            (text[: text.index("P2:") + 60], "line 77: P2.data: no list: must be a list"),
            (text.replace("disparity_offset: 0", "disparity_offset: 1"),
             "matrices and disparity_offset: must be those that its tables were made with"),
            (text.replace("image_height: 480", "image_height: tall"), "line 4: image_height: no integer"),
            ("", "line 1: no OpenCV FileStorage: must begin with %YAML:1.0"),
            (text.replace("Q: !!opencv-matrix", "Q: [1, 2"),
             "line 81: end of sequence flow not found: must be OpenCV FileStorage YAML"),
            ("%YAML:1.0\n---\nM1:\n   a: 1\n   : : x\n", "image_width: missing"),
            ("%YAML:1.0\n---\na: " + "[" * 50000, "line 3: nested too deeply"),
            ("%YAML:1.0\n---\na: " + "1" * 2**20, "1048593 bytes: must be 1000000 at most"),
        ):
            rig.write_text(damaged)
            self.refused_with(rig, f"--calibration '{rig}': {problem}")

    def test_whose_table_is_too_long(self):
        rig = self.copy_of_rig()
        os.truncate(self.folder / "rig_left.lut", 2**40)
        self.refused_with(rig, f"--calibration '{self.folder}/rig_left.lut': {2**40} bytes: must be 1228800 at most")

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

    def test_that_are_larger_than_a_boards_by_their_headers(self):
        large = self.file("left_99.pgm", b"P5\n2052 2052\n255\n")
        self.refused_pictures(self.calibrate("--left", large, "--right", self.pictures / "right_00.png"),
                              f"--left '{large}': 2052x2052 pixels: a board's images are 2048x2048 at most")

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
        self.refused(self.calibrate(*self.sources()), "holds 'new.partial', which is no folder")
        self.assertEqual(aside.read_bytes(), b"precious")
        aside.unlink()
        aside.mkdir()
        thesis = self.file("new.partial/thesis.txt", b"precious")
        (self.folder / "new.yaml").symlink_to("new.yaml")
        self.refused(self.calibrate(*self.sources()), "holds 'new.partial/thesis.txt': no killed run has left that")
        self.assertEqual(thesis.read_bytes(), b"precious")

    def test_after_a_run_that_was_killed(self):
        few = self.sources("left_0[0-2].png", "right_0[0-2].png")
        self.succeeds(self.calibrate(*few))
        aside = self.folder / "new.partial"
        (aside / "earlier").mkdir(parents=True)
        (aside / "new").mkdir()
        (aside / "new" / "new.yaml").write_bytes(b"half")
        (aside / "names").write_bytes(b"new.yaml\n")
        (self.folder / "new.yaml").rename(aside / "earlier" / "new.yaml")
        self.succeeds(self.calibrate(*few))
        self.assertFalse(aside.exists())

    def test_into_a_folder_that_cannot_be(self):
        for folder in (self.folder / "none", self.left):
            self.refused(run("calibrate", *self.sources(), *GRID, "--out", folder / "new.yaml"),
                         f"--out '{folder}': no such folder")


class Interrupted(CalibrateTest):
    def test_writes_nothing(self):
        for number, has_earlier, delay in ((signal.SIGINT, False, 0), (signal.SIGTERM, True, 0), (signal.SIGINT, True, 0.2)):
            if has_earlier:
                self.copy_of_rig()
            earlier = self.result(self.folder)
            process = subprocess.Popen(
                [program.PROGRAM, "calibrate", *map(str, self.sources()), *GRID, "--disparities", str(DISPARITIES), "--out",
                 self.folder / "rig.yaml"],
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            end = time.monotonic() + 60
            while not (self.folder / "rig.partial" / "new").exists() and time.monotonic() < end:
                time.sleep(0.005)
            time.sleep(delay)
            process.send_signal(number)
            out, errors = process.communicate(timeout=60)
            self.assertEqual((process.returncode, out, errors), (130, "", "stereotlm: note: interrupted: nothing was written\n"))
            self.assertEqual(self.result(self.folder), earlier)
            self.assertFalse((self.folder / "rig.partial").exists())


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
