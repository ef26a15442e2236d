"""Pictures, boards and output folders that a run cannot use.

The reasons themselves are tested by load_test.cpp and result_folder*_test.cpp.
"""

import os
import resource
import shutil

import program
from pictures import noise, pgm, ppm
from program import HEIGHT, PRELOADED, WIDTH, ProgramTest, of_plain_user, run, sets


class Pictures(ProgramTest):
    def picture(self, width, height):
        return self.file(f"{width}x{height}.pgm", pgm(width, height, bytes(width * height)))

    def test_are_refused_with_their_option_path_and_reason(self):
        comment = b"P5\n# \r30000 30000 255\n1 1 255\nx"  # which a decoder may take for the size
        size = f"pixels: must be as large as the board's images, {WIDTH}x{HEIGHT}"
        sizes = ((WIDTH + 1, HEIGHT), (WIDTH - 1, HEIGHT), (WIDTH, HEIGHT + 1), (WIDTH, HEIGHT - 1))
        for path, reason in (
            (self.folder / "none.png", "no such file"),
            ("", "no such file"),
            (self.folder, "a directory"),
            (self.file("empty.png"), "an empty file"),
            (self.file("cut.pgm", self.left.read_bytes()[:-1]), "truncated"),
            (self.file("text.png", "This is a text.\n" * 10), "not a picture"),
            (self.file("comment.pgm", comment), "30000x30000 pixels: a board's images are 2048x2048 at most"),
            *((self.picture(*wrong), f"{wrong[0]}x{wrong[1]} {size}") for wrong in sizes),
        ):
            with self.subTest(reason=reason):
                options = ["--left", path, "--right", path, "--truth", path]
                lines = self.refused(self.run_with(*options, "--out", self.out))
                for option, line in zip(options[::2], lines, strict=True):
                    self.assertTrue(line.startswith(f"stereotlm: error: {option} '{path}': {reason}"), line)
                self.assertFalse(self.out.exists())

    def test_of_two_wrong_sizes_are_named_both(self):
        wide, high = self.picture(40, 24), self.picture(32, 30)
        process = self.run_small(left=wide, right=high)
        self.assertEqual(len(self.refused(process, f"--left '{wide}': 40x24", f"--right '{high}': 32x30")), 2)

    def test_of_ground_truth_may_not_be_in_colour(self):
        colour = self.file("colour.ppm", ppm(WIDTH, HEIGHT, noise(3 * WIDTH, HEIGHT, 1)))
        self.refused_in_one_line(self.run_small("--truth", colour), f"--truth '{colour}': 8-bit colour")

    def test_that_may_not_be_read_are_refused(self):
        self.left.chmod(0)
        process = run(*self.run_arguments(), preexec_fn=of_plain_user)
        self.refused_in_one_line(process, f"--left '{self.left}': Permission denied")

    def test_with_paths_that_run_json_cannot_hold_are_refused(self):
        strange = os.fsdecode(b"\xff")
        for side in ("left", "right"):
            shutil.copy(self.left, self.folder / f"{side}_{strange}.png")
        path = self.folder / f"left_{strange}.png"
        pair, folder = ["--left", path, "--right", self.right], ["--sequence", self.folder]
        for options, name in (pair, path), (folder, path.name):
            process = run("run", "fpl2003", *program.SMALL, *PRELOADED, *options, errors="surrogateescape")
            self.refused_in_one_line(process, f"error: {options[0]} '{name}': a path that is not UTF-8")


class Environment(ProgramTest):
    def test_sets_nothing_of_opencv(self):
        expected = self.succeeds(self.run_small())
        values = {"WIDTH": "1", "HEIGHT": "-1", "PIXELS": "many", "PARAMS": ""}
        variables = {f"OPENCV_IO_MAX_IMAGE_{name}": value for name, value in values.items()}
        process = run(*self.run_arguments(), env={**os.environ, **variables, "OPENCV_LOG_LEVEL": "VERBOSE"})
        self.assertEqual((process.stdout, process.stderr), (expected, ""))


class Boards(ProgramTest):
    def test_are_refused_at_once_with_the_pictures_and_the_folder(self):
        none = self.folder / "none"
        board = sets("matcher.window=4")
        lines = self.refused(self.run_small(*board, "--out", self.left, left=none))
        for line, start in zip(lines, (
            "--set matcher.window: matcher.window = 4: 3..31",
            f"stereotlm: error: --left '{none}': no such file",
            f"stereotlm: error: result folder '{self.left}': not a folder",
        ), strict=True):
            self.assertTrue(line.startswith(start), line)
        lines = self.refused(self.run_with("--sequence", none, *board), "--set matcher.window", "--sequence")
        self.assertEqual(len(lines), 2)

    def test_are_refused_where_they_are_no_preset_or_a_bank_is_too_small(self):
        words = WIDTH * HEIGHT // 4
        bank = "ssram.banks.bank4.words"
        self.succeeds(self.run_small(*sets(f"{bank}={words}")))
        process = self.run_small(*sets(f"{bank}={words - 1}"))
        self.refused_in_one_line(process, f"{bank} = {words - 1}: 1 words missing")
        self.refused_in_one_line(self.run_small(board="fpl"), "fpl: not a preset")


class Paths(ProgramTest):
    @program.slow
    def test_that_lead_nowhere_are_refused_with_their_option(self):
        self.succeeds(self.run_small("--out", self.out))
        plan = self.file("plan.yaml", "board: fpl2003\nvary: {matcher.window: [5, 7]}\n")
        sweep = ["sweep", plan, "--out"]
        grid = ["9x6", "--square-mm", "25"]
        calibrate = ["calibrate", "--grid", *grid]
        pictures = [*calibrate, "--out", self.folder / "rig.yaml"]
        for arguments, option, ending in (
            (["run", "fpl2003", "--right", self.right, "--left"], "--left", ""),
            (self.run_arguments("--truth"), "--truth", ""),
            (["run", "fpl2003", "--sequence"], "--sequence", ""),
            (["run", "fpl2003", "--video-layout", "side_by_side", "--video"], "--video", ""),
            (["check", "fpl2003", "--calibration"], "--calibration", ".yaml"),
            (self.run_arguments("--out"), "result folder", ""),
            ([*pictures, "--right", self.right, "--left"], "--left", ""),
            ([*pictures, "--left", self.left, "--right"], "--right", ""),
            ([*calibrate, "--synthetic", "1", "--out"], "--out", ".yaml"),
            (["calibrate", "--print-grid", *grid, "--out"], "--out", ".pdf"),
            (["diff", self.out], "A and B", ""),
            (["diff", self.out, self.out, "--csv"], "--csv", ".csv"),
            (sweep, "--out", ""),
            ([*sweep, self.folder / "a.db", "--known"], "--known", ""),
            ([*sweep, self.folder / "a.db", "--progress"], "--progress", ""),
            (["paper", "--out"], "--out", ""),
        ):
            loop = self.folder / f"loop{ending}"
            if not loop.is_symlink():
                loop.symlink_to(loop.name)
            too_long = self.folder / f"{'long' * 64}{ending}"
            for path in (loop, loop / f"x{ending}", too_long, self.left / f"x{ending}"):
                process = run(*arguments, path)
                self.assertNotIn("filesystem error", process.stderr)
                self.refused(process, option)
            self.assertTrue(loop.is_symlink())


class OutputFolders(ProgramTest):
    def test_with_files_of_others_are_refused(self):
        self.file("out/thesis.tex", "years of work")
        refusal = "stereotlm: error: result folder"
        with self.unchanged(self.folder):
            self.refused_in_one_line(self.run_small("--out", self.out), refusal, "holds 'thesis.tex'")

    def refused_inside(self, out, path, *names):
        """The pictures of these options lie in this folder, in which nothing changes."""
        options = [word for name in ("left", "right", "truth") for word in (
            [f"--{name}", path] if name in names else [] if name == "truth" else [f"--{name}", self.left])]
        rule = "which is replaced whole: an input must lie outside the folder of --out"
        with self.subTest(out=out, path=path), self.unchanged(self.out):
            command = ["run", "fpl2003", *program.SMALL, *PRELOADED, *options, "--out", out]
            lines = self.refused(run(*command, cwd=self.folder))
            refusals = [f"--{name} '{path}': inside the result folder '{out}', {rule}" for name in names]
            self.assertEqual(lines, [f"stereotlm: error: {refusal}" for refusal in refusals])

    def test_with_pictures_of_the_run_are_refused(self):
        self.succeeds(self.run_small("--out", self.out))
        for names in (["left"], ["right"], ["truth"], ["left", "right", "truth"]):
            self.refused_inside(self.out, self.out / "disparity.png", *names)
        (self.folder / "link.png").symlink_to(self.out / "disparity.png")
        (self.folder / "link").symlink_to(self.out)
        for out, path in (
            ("out", "out/disparity.png"),
            ("out/", "./out//disparity.png"),
            ("link", "out/../out/disparity.png"),
            (f"{self.out}/../out/.", "link.png"),
        ):
            self.refused_inside(out, path, "left")
        for below in ("frames", ".partial/earlier"):
            picture = self.file(f"out/{below}/000000.png", self.left.read_bytes())
            self.refused_inside(self.out, picture, "left")

    def test_may_lie_beside_a_picture_of_the_run(self):
        self.out.mkdir()
        shutil.copy(self.left, self.folder / "out.pgm")  # its name begins like the folder's
        for left in (self.folder / "out.pgm", self.out / ".." / "left.pgm"):
            self.succeeds(self.run_small("--out", self.out, left=left))

    def test_of_a_refused_run_stay_as_they_were(self):
        none = self.folder / "none.pgm"
        self.refused(self.run_small("--out", self.out / "a" / "b", left=none))
        self.assertFalse(self.out.exists())
        self.succeeds(self.run_small("--out", self.out))
        with self.unchanged(self.out):
            self.refused(self.run_small("--out", self.out, left=none))

    def test_on_a_full_disk_stay_as_they_were(self):
        def run_with_file_limit(limit, *more):
            set_limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            return run(*self.run_arguments("--out", self.out, *more), preexec_fn=set_limit)

        self.fails(run_with_file_limit(100), "'disparity.png' cannot be written: File too large")
        self.assertFalse(self.out.exists())
        self.succeeds(self.run_small("--out", self.out))
        largest = max(len(data) for data in self.result().values())
        with self.unchanged(self.out):
            self.fails(run_with_file_limit(largest - 1, "--frames", "2"))
        self.succeeds(run_with_file_limit(2 * largest, "--frames", "2"))
        self.assertEqual(self.stats()["frames"], 2)


if __name__ == "__main__":
    program.main()
