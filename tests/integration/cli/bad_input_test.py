"""Pictures, boards and output folders that cannot be used."""

import os
import resource
import shutil
import struct
import subprocess
import unittest
import zlib

import program
from program import HEIGHT, PRELOADED, WIDTH, ProgramTest, noise, pgm, run


def png(width, height, depth, kind, rows):
    """A PNG with these rows of bytes, unfiltered."""

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


class Pictures(ProgramTest):
    def refused_picture(self, path, text):
        """On either side and as the truth, whatever the folder for results."""
        for option, arguments in (
            ("--left", self.run_arguments("--out", self.out, left=path)),
            ("--right", self.run_arguments("--out", self.out, right=path)),
            ("--truth", self.run_arguments("--out", self.out, "--truth", path)),
        ):
            self.refused_in_one_line(run(*arguments), f"stereotlm: error: {option} '{path}': ", text)
            self.assertFalse(self.out.exists())

    def test_missing(self):
        self.refused_picture(self.folder / "none.png", "no such file")
        self.refused_picture("", "no such file")

    def test_a_folder(self):
        self.refused_picture(self.folder, "a directory")

    @unittest.skipIf(os.geteuid() == 0, "permissions do not bind root")
    def test_unreadable(self):
        self.left.chmod(0)
        self.refused_in_one_line(self.run_small(), f"--left '{self.left}': Permission denied")

    def test_empty(self):
        self.refused_picture(self.file("empty.png", b""), "an empty file")

    def test_truncated(self):
        rows = [noise(WIDTH, 1, y) for y in range(HEIGHT)]
        whole = png(WIDTH, HEIGHT, 8, 0, rows)
        self.succeeds(self.run_small(left=self.file("whole.png", whole)))
        self.refused_picture(self.file("cut.png", whole[: len(whole) // 2]), "truncated")
        self.refused_picture(self.file("cut.pgm", self.left.read_bytes()[:-1]), "truncated")

    def test_larger_than_a_boards_by_its_header(self):
        self.refused_picture(self.file("large.png", png(65000, 64000, 8, 0, [])),
                             "65000x64000 pixels: a board's images are 2048x2048 at most")
        comment = b"P5\n# \r30000 30000 255\n1 1 255\n"  # a decoder may take it for the size
        self.refused_picture(self.file("comment.pgm", comment + b"x"), "30000x30000 pixels")

    def test_no_picture(self):
        self.refused_picture(self.file("text.png", b"This is a text.\n" * 10), "not a picture")

    def test_sixteen_bit(self):
        rows = [noise(2 * WIDTH, 1, y) for y in range(HEIGHT)]
        self.refused_picture(self.file("deep.png", png(WIDTH, HEIGHT, 16, 0, rows)), "16-bit")

    def test_alpha(self):
        rows = [noise(4 * WIDTH, 1, y) for y in range(HEIGHT)]
        self.refused_picture(self.file("alpha.png", png(WIDTH, HEIGHT, 8, 6, rows)), "alpha")

    def test_wrong_size_names_both_sizes(self):
        for width, height in ((WIDTH + 1, HEIGHT), (WIDTH - 1, HEIGHT), (WIDTH, HEIGHT + 1), (WIDTH, HEIGHT - 1)):
            path = self.file("size.pgm", pgm(width, height, bytes(width * height)))
            text = f"{width}x{height} pixels: must be as large as the board's images, {WIDTH}x{HEIGHT}"
            self.refused_picture(path, text)

    def test_two_of_different_size_which_are_both_wrong(self):
        wide = self.file("wide.pgm", pgm(40, 24, bytes(40 * 24)))
        high = self.file("high.pgm", pgm(32, 30, bytes(32 * 30)))
        lines = self.refused(self.run_small(left=wide, right=high))
        self.assertEqual(len(lines), 2)
        self.assertTrue(lines[0].startswith(f"stereotlm: error: --left '{wide}': 40x24 pixels"), lines[0])
        self.assertTrue(lines[1].startswith(f"stereotlm: error: --right '{high}': 32x30 pixels"), lines[1])

    def test_a_truth_in_colour(self):
        colour = self.file("colour.ppm", b"P6\n%d %d\n255\n" % (WIDTH, HEIGHT) + noise(3 * WIDTH, HEIGHT, 1))
        self.refused_in_one_line(self.run_small("--truth", colour), f"--truth '{colour}': 8-bit colour")

    def test_a_path_that_run_json_cannot_name(self):
        strange = os.fsencode(self.folder) + b"/\xff.pgm"
        shutil.copy(self.left, strange)
        process = subprocess.run(
            [program.PROGRAM, "run", "fpl2003", *program.SMALL, *PRELOADED, "--left", strange, "--right", self.right],
            capture_output=True, timeout=60, check=False,
        )
        self.assertEqual((process.returncode, process.stdout), (2, b""))
        self.assertRegex(process.stderr, rb"\Astereotlm: error: --left '.*': a path that is not UTF-8")


class Environment(ProgramTest):
    def test_sets_nothing_of_opencv(self):
        expected = self.succeeds(self.run_small())
        for name, value in (("WIDTH", "1"), ("HEIGHT", "-1"), ("PIXELS", "many"), ("PARAMS", "")):
            environment = {**os.environ, f"OPENCV_IO_MAX_IMAGE_{name}": value, "OPENCV_LOG_LEVEL": "VERBOSE"}
            process = run(*self.run_arguments(), env=environment)
            self.assertEqual((process.stdout, process.stderr), (expected, ""), (name, value))


class Boards(ProgramTest):
    def test_are_refused_with_the_pictures_at_once(self):
        none = self.folder / "none.pgm"
        lines = self.refused(self.run_small("--set", "matcher.window=4", "--out", self.left, left=none))
        self.assertEqual(len(lines), 3)
        self.assertTrue(lines[0].startswith("--set matcher.window: matcher.window = 4: 3..31"), lines[0])
        self.assertTrue(lines[1].startswith(f"stereotlm: error: --left '{none}': no such file"), lines[1])
        self.assertTrue(lines[2].startswith(f"stereotlm: error: result folder '{self.left}': not a folder"), lines[2])

    def test_that_cannot_be_found(self):
        self.refused_in_one_line(self.run_small(board="fpl"), "fpl: not a preset")

    def test_with_a_bank_too_small(self):
        words = WIDTH * HEIGHT // 4
        bank = "ssram.banks.bank4.words"
        self.succeeds(self.run_small("--set", f"{bank}={words}"))
        self.refused_in_one_line(self.run_small("--set", f"{bank}={words - 1}"), f"{bank} = {words - 1}: 1 words missing")


class Paths(ProgramTest):
    @program.slow
    def test_that_lead_nowhere_are_refused_with_their_option(self):
        self.succeeds(self.run_small("--out", self.out))
        plan = self.file("plan.yaml", b"board: fpl2003\nvary: {matcher.window: [5, 7]}\n")
        grid = ["--grid", "9x6", "--square-mm", "25"]
        sweep = ["sweep", plan, "--out"]
        for option, arguments in (
            ("--left", ["run", "fpl2003", "--right", self.right, "--left"]),
            ("--truth", self.run_arguments("--truth")),
            ("--sequence", ["run", "fpl2003", "--sequence"]),
            ("--video", ["run", "fpl2003", "--video-layout", "side_by_side", "--video"]),
            ("--calibration", ["check", "fpl2003", "--calibration"]),
            ("result folder", self.run_arguments("--out")),
            ("--left", ["calibrate", *grid, "--right", self.right, "--out", self.folder / "rig.yaml", "--left"]),
            ("--right", ["calibrate", *grid, "--left", self.left, "--out", self.folder / "rig.yaml", "--right"]),
            ("--out", ["calibrate", *grid, "--synthetic", "1", "--out"]),
            ("--out", ["calibrate", "--print-grid", "9x6", "--square-mm", "25", "--out"]),
            ("A and B", ["diff", self.out]),
            ("--csv", ["diff", self.out, self.out, "--csv"]),
            ("--out", sweep),
            ("--known", [*sweep, self.folder / "a.db", "--known"]),
            ("--progress", [*sweep, self.folder / "a.db", "--progress"]),
            ("--out", ["paper", "--out"]),
        ):
            ending = {"--csv": ".csv", "--calibration": ".yaml"}.get(option, "")
            if arguments[0] == "calibrate" and option == "--out":
                ending = ".pdf" if "--print-grid" in arguments else ".yaml"
            loop = self.folder / f"loop{ending}"
            if not loop.is_symlink():
                loop.symlink_to(loop.name)
            for path in (loop, loop / f"x{ending}", self.folder / f"{'long' * 64}{ending}", self.left / f"x{ending}"):
                process = run(*arguments, path)
                self.assertNotIn("filesystem error", process.stderr)
                self.refused(process, option)
        self.assertTrue(loop.is_symlink())


class OutputFolders(ProgramTest):
    def refused_folder(self, folder, text):
        self.refused_in_one_line(self.run_small("--out", folder), "stereotlm: error: result folder", text)

    def test_with_files_of_others(self):
        self.out.mkdir()
        (self.out / "thesis.tex").write_text("years of work")
        self.refused_folder(self.out, "holds 'thesis.tex'")
        self.assertEqual(os.listdir(self.out), ["thesis.tex"])

    def test_with_results_without_run_json(self):
        self.out.mkdir()
        (self.out / "stats.json").write_text("{}")
        self.refused_folder(self.out, "no run.json")

    def test_that_cannot_be_made(self):
        self.refused_folder("", "must be named")
        self.refused_folder(self.left, "not a folder")
        self.refused_folder(self.left / "out", "cannot be written to")
        self.refused_folder("/proc/stereotlm", "cannot be written to")

    @unittest.skipIf(os.geteuid() == 0, "permissions do not bind root")
    def test_without_permission(self):
        self.out.mkdir(mode=0o555)
        self.refused_folder(self.out, "cannot be written to: Permission denied")
        self.refused_folder(self.out / "deeper", "cannot be written to: Permission denied")

    def refused_inside(self, out, path, *names):
        """The pictures of these options lie in this folder, in which nothing changes."""
        before = {file: file.read_bytes() for file in self.out.rglob("*") if file.is_file()}
        pair = {name: path for name in names if name != "truth"}
        truth = ["--truth", path] if "truth" in names else []
        lines = self.refused(run(*self.run_arguments("--out", out, *truth, **pair), cwd=self.folder))
        rule = f"inside the result folder '{out}', which is replaced whole: an input must lie outside the folder of --out"
        self.assertEqual(lines, [f"stereotlm: error: --{name} '{path}': {rule}" for name in names])
        self.assertEqual({file: file.read_bytes() for file in self.out.rglob("*") if file.is_file()}, before)

    def test_with_a_picture_of_the_run(self):
        self.succeeds(self.run_small("--out", self.out))
        for names in (["left"], ["right"], ["truth"], ["left", "right", "truth"]):
            self.refused_inside(self.out, self.out / "disparity.png", *names)

    def test_with_a_picture_below(self):
        self.succeeds(self.run_small("--out", self.out))
        for place in ("frames", ".partial/earlier"):
            (self.out / place).mkdir(parents=True)
            shutil.copy(self.left, self.out / place / "000000.png")
            self.refused_inside(self.out, self.out / place / "000000.png", "left")

    def test_with_a_picture_however_the_paths_are_written(self):
        self.succeeds(self.run_small("--out", self.out))
        (self.folder / "link.png").symlink_to(self.out / "disparity.png")
        (self.folder / "link").symlink_to(self.out)
        for path in ("out/disparity.png", "./out//disparity.png", "out/../out/disparity.png", "link.png"):
            for out in ("out", "out/", "link", self.out, f"{self.out}/../out/."):
                self.refused_inside(out, path, "left")

    def test_beside_a_picture_of_the_run(self):
        self.out.mkdir()
        shutil.copy(self.left, self.folder / "out.pgm")  # its name begins like the folder's
        for left in (self.folder / "out.pgm", self.out / ".." / "left.pgm"):
            self.succeeds(self.run_small("--out", self.out, left=left))

    def test_a_refused_run_leaves_no_folder(self):
        self.refused(self.run_small("--out", self.out / "a" / "b", left=self.folder / "none.pgm"))
        self.assertFalse(self.out.exists())

    def test_of_a_refused_run_keep_the_earlier_result(self):
        self.succeeds(self.run_small("--out", self.out))
        earlier = self.result()
        self.refused(self.run_small("--out", self.out, left=self.folder / "none.pgm"))
        self.assertEqual(self.result(), earlier)


class FullDisk(ProgramTest):
    def run_with_file_limit(self, limit, *more):
        return run(
            *self.run_arguments("--out", self.out, *more),
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
        )

    def test_known_before_the_first_cycle(self):
        self.refused_in_one_line(self.run_with_file_limit(0), "cannot be written to: File too large")
        self.assertFalse(self.out.exists())

    def test_found_when_writing_leaves_no_file(self):
        process = self.run_with_file_limit(100)
        self.assertEqual((process.returncode, process.stdout), (1, ""))
        self.assertEqual(len(process.stderr.splitlines()), 1)
        self.assertIn("'disparity.png' cannot be written: File too large", process.stderr)
        self.assertFalse(self.out.exists())

    def test_found_when_writing_keeps_the_earlier_result(self):
        self.succeeds(self.run_small("--out", self.out))
        earlier = self.result()
        largest = max(len(data) for data in earlier.values())
        process = self.run_with_file_limit(largest - 1, "--frames", "2")
        self.assertEqual(process.returncode, 1, process.stderr)
        self.assertEqual(self.result(), earlier)
        self.succeeds(self.run_with_file_limit(2 * largest, "--frames", "2"))
        self.assertNotEqual(self.result(), earlier)

    def test_a_small_file_system(self):
        disk = self.folder / "disk"
        disk.mkdir()
        mount = f'mount -t tmpfs -o size=16k none "{disk}" && '
        unshare = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c"]
        if subprocess.run(unshare + [mount + "true"], capture_output=True, check=False).returncode != 0:
            self.skipTest("no small disk can be mounted here")
        command = [program.PROGRAM] + [str(a) for a in self.run_arguments("--out", disk)]
        process = subprocess.run(
            unshare + [mount + '"$@"; status=$?; ls -A "$0"; exit $status', disk, *command],
            capture_output=True, text=True, timeout=60, check=False,
        )
        self.assertEqual((process.returncode, process.stdout), (1, ""), process.stderr)
        self.assertEqual(len(process.stderr.splitlines()), 1)
        self.assertIn("cannot be written: No space left on device", process.stderr)


if __name__ == "__main__":
    program.main()
