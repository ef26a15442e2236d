"""calibrate, and --calibration, on a rig that is made up."""

import hashlib
import itertools
import re
import shutil
import signal
import struct
import time

import program
from pictures import avi, noise, pgm, read_pfm, read_png, read_png_16
from program import PRELOADED, RESULT_FILES, ProgramTest, Terminal, made_rig, run, sets, wait_until

GRID = ["--grid", "7x5", "--square-mm", "30"]
SIDES = ("left", "right")


def fields(text):
    """What calibrate prints, by the first word or words of its lines."""
    return {line[:16].strip(): line[17:] for line in text.splitlines() if line[:16].strip()}


class CalibrateTest(ProgramTest):
    """With a calibration that all cases share, self.rig, and its pictures, self.pictures."""

    def setUp(self):
        super().setUp()
        self.rig, self.made = made_rig()
        self.home = self.rig.parent
        self.pictures = self.home / "rig_pictures"
        self.new = self.folder / "new.yaml"

    def calibrate(self, *more, left="left_0[0-2].png", right="right_0[0-2].png"):
        """A calibration from pictures of the rig: patterns, or lists of paths."""
        options = []
        for option, given in (("--left", left), ("--right", right)):
            options += [option, *([self.pictures / given] if isinstance(given, str) else given)]
        for option, value in (("--disparities", 120), ("--out", self.new)):
            options += [] if option in more else [option, value]
        return run("calibrate", *options, *GRID, *more)

    def scene(self, *more, rig=None, left="scene_left.png", right="scene_right.png"):
        """A run of the scene with the tables of the rig."""
        pair = ["--left", self.pictures / left, "--right", self.pictures / right]
        board = ["fpl2003", *PRELOADED, *sets("matcher.disparities=80"), "--calibration", rig or self.rig]
        return ["run", *board, *pair, *more]


class Made(CalibrateTest):
    def test_says_what_it_found_and_writes_tables_and_drawings(self):
        found = fields(self.succeeds(self.made))
        self.assertIn("9 of 9 with the grid", found["pairs"])
        self.assertRegex(found["reprojection"], r"^RMS 0\.[01]\d\d px")
        self.assertRegex(found["row error"], r"^mean 0\.0\d\d px")
        baseline = float(found["baseline"].split()[0])
        known = float(re.search(r"baseline ([\d.]+) mm", found["known to be"]).group(1))
        self.assertLess(abs(baseline / known - 1), 0.01)
        for name in ("rig.yaml", "rig_left.lut", "rig_right.lut", "rig_drawings/"):
            self.assertIn(str(self.home / name), found["written"])
        for side in SIDES:
            self.assertEqual((self.home / f"rig_{side}.lut").stat().st_size, 4 * 640 * 480)
        drawings = [f"{name}_{number:02}.png" for name in ("corners", "rectified") for number in range(9)]
        self.is_in(self.home / "rig_drawings", *drawings, "displacement.png")
        self.assertEqual(len(set(self.result(self.home / "rig_drawings").values())), len(drawings) + 1)

    def test_the_pictures_it_wrote_give_the_same_tables(self):
        process = self.calibrate("--disparity-offset", "0", left="left_*.png", right="right_*.png")
        found, expected = fields(self.succeeds(process)), fields(self.made.stdout)
        self.assertEqual(found["reprojection"], expected["reprojection"])
        for side in SIDES:
            table = (self.folder / f"new_{side}.lut").read_bytes()
            self.assertEqual(table, (self.home / f"rig_{side}.lut").read_bytes())
        self.assertFalse((self.folder / "new_pictures").exists())

    def test_takes_pairs_side_by_side(self):
        (self.folder / "both").mkdir()
        frames = []
        for number in range(4):
            left, right = (read_png(self.pictures / f"{side}_0{number}.png")[3] for side in SIDES)
            if number == 3:
                right = [bytes(640)] * 480
            rows = b"".join(bytes(a) + bytes(b) for a, b in zip(left, right))
            self.file(f"both/{number}.pgm", pgm(1280, 480, rows))
            frames.append(rows)
        out = ["--disparities", 120, "--out", self.folder / "both.yaml"]
        beside = ["calibrate", *GRID, *out, "--side-by-side"]
        process = run(*beside, self.folder / "both" / "*.pgm")
        self.succeeds(process)
        self.assertIn("3.pgm' (right half): no grid of 7x5 inner corners found: the pair", process.stderr)
        self.succeeds(self.calibrate())
        for side in SIDES:
            table = (self.folder / f"new_{side}.lut").read_bytes()
            self.assertEqual((self.folder / f"both_{side}.lut").read_bytes(), table)
        video = ["--video", self.file("both.avi", avi(1280, 480, frames)), "--video-layout", "side_by_side"]
        of_video = ["calibrate", *GRID, "--disparities", 120, "--out", self.folder / "video.yaml", *video]
        process = run(*of_video)
        self.succeeds(process)
        self.assertIn("both.avi frame 3 right': no grid of 7x5", process.stderr)
        for side in SIDES:
            table = (self.folder / f"video_{side}.lut").read_bytes()
            self.assertEqual((self.folder / f"both_{side}.lut").read_bytes(), table)
        self.refused(run(*of_video, "--left", self.left), "--video: has both pictures of a pair")
        odd = self.file("odd.pgm", pgm(1281, 2, bytes(1281 * 2)))
        self.refused(run(*beside, odd), f"--side-by-side '{odd}': 1281 pixels wide: must be even")
        same = self.file("same.pgm", pgm(8, 2, bytes(16)))
        self.refused(run(*beside, same), "(right half): the same picture as --side-by-side", "(left half)")
        rule = "--side-by-side: has both pictures of a pair"
        self.refused(run(*beside, same, "--left", self.left), rule)
        inside = [self.folder / "both_drawings" / "corners_0*.png"]
        self.refused(run(*beside, *inside), "--side-by-side", "lies in it and would be replaced")

    def test_takes_grids_of_circles(self):
        for pattern, grid in (("circles", "7x5"), ("asymmetric_circles", "4x7")):
            shown = ["--pattern", pattern, "--grid", grid, "--square-mm", 30]
            found = fields(self.succeeds(run("calibrate", "--synthetic", 3, *shown, "--out", self.new)))
            self.assertIn("9 of 9 with the grid", found["pairs"])
            known = [float(word) for word in re.findall(r"[\d.]+(?= px| mm)", found["known to be"])]
            self.assertLess(abs(float(found["left camera"].split()[2].strip(",")) / known[0] - 1), 0.005)
            self.assertLess(abs(float(found["baseline"].split()[0]) / known[1] - 1), 0.005)
            self.assertIn(f"pattern: {pattern}\n", self.new.read_text())

    def test_answers_dark_pictures(self):
        """A search with adaptive thresholds would take minutes."""
        dark = [value % 23 for value in noise(1280, 960, 5)]
        for side in SIDES:
            for number in range(3):
                rows = read_png(self.pictures / f"{side}_0{number}.png")[3]
                large = b"".join(bytes(v for v in row for _ in "12") * 2 for row in rows)
                self.file(f"{side}_{number}.pgm", pgm(1280, 960, large))
            self.file(f"{side}_3.pgm", pgm(1280, 960, dark[::-1] if side == "left" else dark))
        sides = [word for side in SIDES for word in (f"--{side}", self.folder / f"{side}_*.pgm")]
        process = run("calibrate", *sides, *GRID, "--disparities", 254, "--out", self.new, timeout=100)
        self.succeeds(process)
        self.assertIn("left_3.pgm': no grid of 7x5 inner corners found", process.stderr)

    def test_shows_each_picture_on_a_terminal(self):
        for number, side in itertools.product(range(6), SIDES):
            self.file(f"{side}_{number}.pgm", pgm(1280, 960, noise(1280, 960, f"{side}{number}")))
        sides = [word for side in SIDES for word in (f"--{side}", self.folder / f"{side}_*.pgm")]
        terminal = Terminal(["calibrate", *sides, *GRID, "--out", self.new], columns=300)
        terminal.read_until(r"\d+/12 pictures searched.*; '.*right_\d.pgm': no grid of 7x5 inner corners")
        self.assertEqual(terminal.finish()[0], 2)

    @program.slow
    def test_replaces_an_earlier_calibration(self):
        self.succeeds(self.calibrate("--disparity-offset", "70"))
        self.assertEqual(len(list((self.folder / "new_drawings").iterdir())), 7)
        first = self.new.read_bytes()
        found = fields(self.succeeds(self.calibrate()))["disparities"]
        self.assertRegex(found, r"of the grid; offset \d+: 0 \.\. 119 of the board are")
        self.assertNotIn("do not fit", found)
        self.assertNotEqual(self.new.read_bytes(), first)
        names = [path.name for path in self.folder.glob("new*")]
        self.assertEqual(sorted(names), ["new.yaml", "new_drawings", "new_left.lut", "new_right.lut"])

    def test_takes_pictures_whose_names_look_like_patterns(self):
        folder = self.folder / "br[1]"
        folder.mkdir()
        pairs = {side: [folder / f"{side}_0{number}.png" for number in range(4)] for side in SIDES}
        for path in [*pairs["left"], *pairs["right"]]:
            shutil.copy(self.pictures / path.name, path)
        self.succeeds(self.calibrate(**pairs))

    @program.slow
    def test_doubts_pictures_whose_names_do_not_go_together(self):
        process = self.calibrate(left="left_0[01].png", right="right_0[02].png")
        pair = f"'{self.pictures / 'left_01.png'}' with '{self.pictures / 'right_02.png'}'"
        self.assertIn(f"{pair}: do they belong together?", process.stderr)

    @program.slow
    def test_writes_nothing_where_it_is_interrupted(self):
        command = ["calibrate", "--synthetic", 3, *GRID, "--out", self.folder / "rig.yaml"]
        for number, has_earlier, delay in (
            (signal.SIGINT, False, 0), (signal.SIGTERM, True, 0), (signal.SIGINT, True, 0.1),
        ):
            if has_earlier:
                self.copy_of_rig()
            with self.unchanged(self.folder):
                process = self.start(*command)
                wait_until((self.folder / "rig.partial" / "new").exists)
                time.sleep(delay)
                process.send_signal(number)
                self.ends(process, 130, errors="stereotlm: note: interrupted: nothing was written\n")
            self.assertFalse((self.folder / "rig.partial").exists())


class Run(CalibrateTest):
    def test_finds_the_disparities_and_depths_of_the_scene(self):
        scale = re.search(r"--truth-scale (\d+)", self.made.stdout).group(1)
        truth = ["--truth", self.pictures / "scene_truth.png", "--truth-scale", scale]
        process = run(*self.scene(*truth, "--out", self.out))
        self.succeeds(process)
        rows = r"note: .* \d+ are found in the right one; their rows differ by 0\.\d\d pixels on average\n"
        self.assertRegex(process.stderr, rows)
        accuracy = self.stats()["accuracy"]
        self.assertLess(accuracy["bad_1_percent"], 3)
        self.assertGreater(accuracy["answered_percent"], 60)
        self.is_in(self.out, *RESULT_FILES, "depth.ply", "depth.png", "depth_color.png")
        self.check_depths(self.rig, 0)
        options = self.run_json()["calibration"]
        self.assertEqual(options["path"], str(self.rig))
        self.assertEqual(options["right_lut"]["path"], str(self.home / "rig_right.lut"))
        with self.unchanged(self.out):
            self.succeeds(run(*self.scene(*truth, "--out", self.out)))

    def test_adds_the_offset_to_disparities_before_it_computes_depths(self):
        self.succeeds(self.calibrate("--disparity-offset", "11"))
        self.succeeds(run(*self.scene("--out", self.out, rig=self.new)))
        self.check_depths(self.new, 11)

    def check_depths(self, rig, offset):
        """Depth by the text of the calibration, and one point for each answer."""
        width, height, rows = read_pfm(self.out / "disparity.pfm")
        matrix = re.search(r"Q:.*?data: \[(.*?)\]", rig.read_text(), re.S).group(1)
        q = [float(word) for word in matrix.split(",")]
        depths = read_png_16(self.out / "depth.png")
        no_depth = (float("inf"), -offset)
        for y in range(0, height, 7):
            for x in range(width):
                expected = 0
                if rows[y][x] not in no_depth:
                    expected = int(q[11] / (q[14] * (rows[y][x] + offset) + q[15]) + 0.5)
                self.assertEqual(depths[y][x], expected, (x, y))
        width, height, channels, colors = read_png(self.out / "depth_color.png")
        self.assertEqual((width, height, channels), (max(len(rows[0]), 300), len(rows) + 28, 3))
        for row, shown in zip(depths, colors):
            unknown = [shown[3 * x : 3 * x + 3] == b"\xd9\xd9\xd9" for x in range(len(row))]
            self.assertEqual(unknown, [depth == 0 for depth in row])
        points = sum(1 for row in rows for disparity in row if disparity not in no_depth)
        self.assertIn(b"element vertex %d\n" % points, (self.out / "depth.ply").read_bytes())

    def test_tells_check_and_bounds_which_entries_have_no_source(self):
        self.succeeds(self.calibrate("--disparity-offset", "100"))
        self.succeeds(run("check", "fpl2003", "--calibration", self.new))
        plain = self.succeeds(run("bounds", "fpl2003")).splitlines()
        with_tables = self.succeeds(run("bounds", "fpl2003", "--calibration", self.new)).splitlines()
        # Such entries are not read.
        changed = [line.split()[:2] for line, other in zip(with_tables, plain) if line != other]
        names = [each[0] for each in changed]
        self.assertLessEqual(set(names), {"bank0,", "bank2,", "bank0", "bank1", "bank2", "bank3"})
        self.assertIn("bank0,", names)
        self.assertIn("bank0", names)

    def test_says_whether_the_pictures_are_of_the_rig(self):
        _, _, _, rows = read_png(self.pictures / "scene_right.png")
        lower = self.file("lower.pgm", pgm(640, 480, b"".join(rows[4:] + rows[:4])))
        flat = self.file("flat.pgm", pgm(640, 480, bytes(640 * 480)))
        few = r"note: --calibration: of 0 conspicuous points .* too few to see whether it is of this rig"
        for left, right, text in (
            ("scene_left.png", lower, r"warning: .* differ by \d\.\d\d pixels on average: is it of this rig"),
            ("scene_right.png", "scene_left.png", r"warning: --cal.* are left and right exchanged\?"),
            (flat, flat, few),
        ):
            process = run(*self.scene(left=left, right=right))
            self.succeeds(process)
            self.assertRegex(process.stderr, text)

    def test_says_that_the_board_has_fewer_disparities(self):
        board = sets("matcher.disparities=16", "matcher.window=3")
        need = "was made for 80 disparities: the nearest objects exceed the 16 of this board"
        for pictures in (["--synthetic", "1"], ["--timing-only"]):
            process = run("run", "fpl2003", *PRELOADED, *pictures, *board, "--calibration", self.rig)
            self.assertNotIn("accuracy", self.succeeds(process))  # the scene is not one of this rig
            self.assertIn(need, process.stderr)


class RefusedCalibrations(CalibrateTest):
    """tests/unit/calib/calibration_test.cpp has every way in which its text is wrong."""

    def refused_with(self, rig, *texts, board=()):
        process = run("check", "fpl2003", *board, "--calibration", rig)
        self.refused(process, "stereotlm: error: --calibration", *texts)

    def test_a_damaged_one_is_refused_by_each_command(self):
        rig = self.copy_of_rig()
        text = rig.read_text()
        rig.write_text(text[: text.index("P2:")])
        problem = f"error: --calibration '{rig}': P2: missing: a calibration has this key"
        self.refused(run(*self.scene("--out", self.out, rig=rig)), problem)
        for command in ("check", "bounds", "explain"):
            self.refused(run(command, "fpl2003", "--calibration", rig), problem)
        self.assertFalse(self.out.exists())

    @program.slow
    def test_tables_that_cannot_be_joined_are_refused_by_joint_boards_and_are_no_step_of_others(self):
        rig = self.copy_of_rig()
        table = self.folder / "rig_left.lut"
        entries = bytearray(table.read_bytes())
        entries[:4] = struct.pack("<I", 1 << 31 | 639)  # the first pixel has its source in the last column
        table.write_bytes(entries)
        digest = hashlib.sha256(entries).hexdigest()
        rig.write_text(re.sub(r"(left_lut_sha256:) .*", rf'\1 "{digest}"', rig.read_text()))
        problem = r"left table: its displacements in x are .*, a range of \d+: joint tables have 256"
        process = run("check", "two-banks", "--calibration", rig)
        self.refused(process, f"error: --calibration '{rig}': left table: ")
        self.assertRegex(process.stderr, problem)
        text = self.succeeds(run("explain", "fpl2003", *PRELOADED, "--calibration", rig))
        text = re.sub(r"\n  (?=\w)", " ", text)
        step = "not possible here: fpga.tables: separate -> joint in bank6, because"
        self.assertRegex(text, rf"(?m)^{step} {problem}$")
        self.assertNotIn("failed", text)

    def test_missing_long_and_foreign_tables_are_refused(self):
        rig = self.copy_of_rig()
        for side in SIDES:
            table = self.folder / f"rig_{side}.lut"
            whole = table.read_bytes()
            table.write_bytes(whole[:1000] + bytes([whole[1000] ^ 1]) + whole[1001:])
            written = "must be the table that the calibration was written with"
            self.refused_with(rig, f"'{table}': SHA-256", written)
            table.write_bytes(whole)
        shutil.copy(self.folder / "rig_right.lut", self.folder / "rig_left.lut")
        self.refused_with(rig, "rig_left.lut': SHA-256")

    def test_those_for_another_board_are_refused(self):
        size = "image size = 640x480: must be that of the board's images, 320x480"
        self.refused_with(self.rig, f"'{self.rig}': {size}", board=sets("image.width=320"))
        for side in SIDES:
            both = f"needs a board with both tables, but allocation.{side}_lut = none"
            self.refused_with(self.rig, both, board=sets(f"allocation.{side}_lut=none"))


class RefusedPictures(CalibrateTest):
    def test_each_reason_is_named_and_nothing_is_written(self):
        large = self.file("large.pgm", b"P5\n2052 2052\n255\n" + bytes(2052 * 2052))
        text = self.file("text.png", "no picture")
        lefts = [self.pictures / f"left_0{number}.png" for number in range(4)]
        sizes = [shutil.copy(lefts[0], self.folder), self.file("left_99.png", self.left.read_bytes())]
        none = self.folder / "none*.png"
        for left, right, *texts in (
            ([none], "right_00.png", f"--left '{none}': no such file"),
            ("left_*.png", "right_0[0-4].png", "9 left pictures", "5 right ones", "must be as many"),
            (sizes, "right_0[01].png", f"of several sizes: 1 of 32x24, such as --left '{sizes[1]}'; ",
             "3 of 640x480, such as ", "set to one size, or scale those that show the whole view"),
            ([self.file("turned.pgm", pgm(480, 640, bytes(480 * 640)))], "right_00.png",
             "must all have one size: turn those that lie on their side, or take the others again"),
            ([large], "right_00.png",
             f"--left '{large}': 2052x2052 pixels: a board's images with a look-up table are 4..2048"),
            ([text], "right_00.png", f"--left '{text}'", "not a picture"),
            ("right_0[0-2].png", "left_0[0-2].png", "the cameras are swapped"),
        ):
            with self.subTest(texts[0]), self.unchanged(self.folder):
                self.refused(self.calibrate(left=left, right=right), *texts)

    def test_those_among_its_own_drawings_are_refused(self):
        self.succeeds(self.calibrate())
        drawings = self.folder / "new_drawings"
        left, right = ([drawings / f"{name}_0[0-2].png"] for name in ("corners", "rectified"))
        process = self.calibrate(left=left, right=right)
        self.refused(process, f"--left '{drawings}/corners_00.png' lies in it and would be replaced: an "
                              f"input must")


class RefusedPlaces(CalibrateTest):
    def refused_beside(self, name, text, data="precious"):
        """A file of the user's is there, and stays."""
        path = self.file(name, data)
        with self.subTest(name), self.unchanged(self.folder):
            self.refused(self.calibrate(), f"holds '{name}'", text, "must be moved away")
        path.unlink()

    def test_files_that_calibrate_has_not_made_stay(self):
        self.refused_beside("new.yaml", "no new.yaml that is a calibration", "precious: 1\n")
        self.refused_beside("new_left.lut", "no new.yaml that is a calibration")
        self.copy_of_rig().rename(self.new)
        self.refused_beside("new_drawings/notes.txt", "with their calibration")
        (self.folder / "new_left.lut").mkdir()
        self.refused(self.calibrate(), "holds 'new_left.lut'")
        self.new.unlink()
        aside = self.file("new.partial", "precious")
        with self.unchanged(self.folder):
            self.refused(self.calibrate(), "holds 'new.partial', which is no folder")
        aside.unlink()
        self.file("new.partial/thesis.txt", "precious")
        self.new.symlink_to("new.yaml")
        with self.unchanged(self.folder / "new.partial"):
            self.refused(self.calibrate(), "holds 'new.partial/thesis.txt', which no killed run has left")

    def test_pictures_that_a_made_up_rig_would_replace_stay(self):
        self.file("new_pictures/left_00.png", "mine")
        command = ["calibrate", "--synthetic", 1, *GRID, "--out", self.new]
        with self.unchanged(self.folder):
            self.refused(run(*command), "holds 'new_pictures' but no new.yaml")

    def test_missing_folders_are_refused(self):
        for folder in (self.folder / "none", self.left):
            process = self.calibrate("--out", folder / "new.yaml")
            self.refused(process, f"--out '{folder}': no such folder")


class Usage(ProgramTest):
    def test_everything_missing_is_named_at_once(self):
        missing = [f"{option}: missing" for option in ("--grid", "--square-mm", "--left", "--right", "--out")]
        lines = self.refused(run("calibrate"), *missing, "a complete command: stereotlm calibrate --left")
        self.assertEqual(len(lines), 6)

    def test_wrong_values_are_refused(self):
        good = {"--left": "l", "--right": "r", "--grid": "9x6", "--square-mm": "25", "--out": "rig.yaml"}
        for option, value, problem in (
            ("--grid", "9", "must be columns x rows"),
            ("--grid", "9x", "must be columns x rows"),
            ("--grid", "2x6", "columns = 2: must be 3..100"),
            ("--grid", "9x101", "rows = 101: must be 3..100"),
            ("--square-mm", "wide", "--square-mm = wide: must be a number"),
            ("--square-mm", "0.5", "square_mm = 0.5: must be 1..1000"),
            ("--square-mm", "1000.5", "square_mm = 1000.5: must be 1..1000"),
            ("--square-mm", "nan", "square_mm = nan: must be"),
            ("--disparities", "255", "--disparities = 255: must be an integer, 1..254"),
            ("--disparity-offset", "1.5", "--disparity-offset = 1.5: must be auto or an integer"),
            ("--synthetic", "1", "does not go with --left, --right and --side-by-side"),
            ("--pattern", "dots", "--pattern = dots: must be chessboard, circles or asymmetric_circles"),
            ("--pattern", "asymmetric_circles", "rows = 6: must be odd with asymmetric circles"),
            ("--out", "rig.yml", "--out 'rig.yml': must end in .yaml"),
        ):
            arguments = [word for pair in {**good, option: value}.items() for word in pair]
            self.refused(run("calibrate", *arguments), problem)
        seed = ["calibrate", "--synthetic", "-1", *GRID, "--out", "rig.yaml"]
        self.refused(run(*seed), "--synthetic = -1: must be")


class PrintGrid(ProgramTest):
    def print_grid(self, name, *more, grid="9x6", size=("--square-mm", "25")):
        return run("calibrate", "--print-grid", grid, *size, "--out", self.folder / name, *more)

    def test_makes_a_sheet_and_replaces_it(self):
        sheet = self.folder / "grid.svg"
        said = f"{sheet}: 10x7 squares of 25 mm, 9x6 inner corners; print it at 100 %\n"
        self.assertEqual(self.succeeds(self.print_grid("grid.svg")), said)
        with self.unchanged(self.folder):
            self.succeeds(self.print_grid("grid.svg"))

    def test_wrong_sheets_are_refused(self):
        self.file("grid.svg", "precious")
        with self.unchanged(self.folder):
            self.refused(self.print_grid("grid.svg"),
                         "is not known as a sheet of the same grid, which alone is replaced")
            self.refused(self.print_grid("grid.pdf"), "must end in .svg")
            process = self.print_grid("new.svg", "--left", "x", "--disparities", "3")
            rule = "does not go with --print-grid"
            self.refused(process, f"--left: {rule}", f"--disparities: {rule}")
            self.refused(self.print_grid("none/grid.svg"), "there is no such folder")
            self.refused(self.print_grid("new.svg", size=()), "--square-mm: missing")
            self.refused(self.print_grid("new.svg", "--pattern", "circles"), "draws a chessboard only")


if __name__ == "__main__":
    program.main()
