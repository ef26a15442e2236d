"""diff: the folders and pictures that it takes, its usage, interrupts."""

import hashlib
import json
import re
import shutil
import signal

import program
from avi import avi
from diff_test import SHARED, DiffTest
from interrupt_test import Terminal, shown
from program import HEIGHT, PRELOADED, WIDTH, noise, pgm, run


class Sources(DiffTest):
    """Every source of pictures is found again."""

    def same(self, *options):
        for folder in (self.a, self.b):
            self.succeeds(self.run_with(*options, "--out", folder))
        self.assertIn("no difference", self.lines())

    def test_a_sequence(self):
        self.same("--sequence", self.sequence(3), "--save-frames")

    def test_a_video(self):
        frames = [noise(2 * WIDTH, HEIGHT, seed) for seed in range(3)]
        self.same("--video", self.file("v.avi", avi(2 * WIDTH, HEIGHT, frames)), "--video-layout", "side_by_side")

    def test_two_videos(self):
        videos = [self.file(f"{side}.avi", avi(WIDTH, HEIGHT, [noise(WIDTH, HEIGHT, side + f) for f in (0, 10)])) for side in (1, 2)]
        self.same("--video", *videos, "--video-layout", "two")

    def test_a_made_scene(self):
        self.same("--synthetic", "18446744073709551615", "--frames", "2")

    def test_with_a_truth(self):
        self.same("--left", self.left, "--right", self.right, "--truth", self.left, "--truth-scale", "0.5")

    def test_of_a_run_that_was_verified(self):
        self.same("--synthetic", "1", "--verify")

    def test_from_another_folder(self):
        for folder in ("a", "b"):
            self.write(self.folder / folder)
        process = run("diff", "a", "./b/", cwd=self.folder)
        self.assertIn("no difference", self.succeeds(process))

    @program.slow
    def test_a_calibration(self):
        rig = self.folder / "rig.yaml"
        self.succeeds(run("calibrate", "--synthetic", "3", "--grid", "9x6", "--square-mm", "25", "--out", rig))
        pictures = self.folder / "rig_pictures"
        arguments = ["run", "fpl2003", *PRELOADED, "--calibration", rig, "--left", pictures / "scene_left.png",
                     "--right", pictures / "scene_right.png"]
        self.succeeds(run(*arguments, "--out", self.a))
        self.succeeds(run(*arguments, *SHARED, "--out", self.b))
        lines = self.lines()
        self.assertIn("disparities: the same, pixel for pixel, in 1 frame", lines)
        table = self.folder / "rig_left.lut"
        recorded = hashlib.sha256(table.read_bytes()).hexdigest()
        table.write_bytes(bytes(4) + table.read_bytes()[4:])
        found = hashlib.sha256(table.read_bytes()).hexdigest()
        for line in self.refused(self.diff()):
            self.assertIn(f"--calibration '{table}': SHA-256 {found}: must be that of the file of the run, {recorded}", line)


class Inputs(DiffTest):
    def test_that_have_changed_are_refused_with_both_sums(self):
        self.write(self.a)
        other = self.file("other.pgm", self.left.read_bytes())
        self.succeeds(self.run_small("--out", self.b, left=other))
        recorded = hashlib.sha256(other.read_bytes()).hexdigest()
        other.write_bytes(pgm(WIDTH, HEIGHT, noise(WIDTH, HEIGHT, 9)))
        found = hashlib.sha256(other.read_bytes()).hexdigest()
        self.refused_in_one_line(
            self.diff(),
            f"error: B '{self.b}': --left '{other}': SHA-256 {found}: must be that of the file of the run, {recorded}",
        )

    def test_that_are_missing_are_refused(self):
        self.write(self.a, "--truth", self.right)
        self.right.unlink()
        lines = self.refused(self.diff(b=self.a))
        self.assertEqual(len(lines), 4)  # both, in both
        for name, (right, truth) in (("A", lines[:2]), ("B", lines[2:])):
            self.assertIn(f"error: {name} '{self.a}': --right '{self.right}': cannot be read: No such file or directory", right)
            self.assertIn(f"error: {name} '{self.a}': --truth '{self.right}': cannot be read: No such file or directory", truth)

    def test_that_are_more_than_the_run_had_are_refused(self):
        pairs = self.sequence(2)
        self.succeeds(self.run_with("--sequence", pairs, "--out", self.a))
        for side in ("left", "right"):
            shutil.copy(pairs / f"{side}_000.png", pairs / f"{side}_100.png")
        for name, line in zip("AB", self.refused(self.diff(b=self.a)), strict=True):
            self.assertIn(f"error: {name} '{self.a}': --sequence '{pairs}': 3 pairs: must be those of the run, 2", line)

    def test_that_do_not_fit_to_the_board_any_more_are_refused(self):
        self.write(self.a)
        self.change(self.a / "config.yaml", f"width: {WIDTH}", "width: 64")
        for name, line in zip("AB", self.refused(self.diff(b=self.a)), strict=True):
            self.assertIn(f"error: {name} '{self.a}': --", line)
            self.assertIn(f"{WIDTH}x{HEIGHT} pixels: must be as large as the board's images, 64x{HEIGHT}", line)


class Folders(DiffTest):
    def setUp(self):
        super().setUp()
        for folder in (self.a, self.b):
            self.write(folder)

    def test_that_are_none_are_refused(self):
        rule = "A and B must be folders that run --out has written"
        none = self.folder / "none"
        self.refused_in_one_line(self.diff(b=none), f"error: {rule}: '{none}': no such folder")
        self.refused_in_one_line(self.diff(b=self.left), f"error: {rule}: '{self.left}': not a folder")
        for name in ("run.json", "config.yaml", "stats.json"):
            copy = self.folder / "copy"
            shutil.copytree(self.b, copy)
            (copy / name).unlink()
            self.refused_in_one_line(self.diff(b=copy), f"{rule}: '{copy}/{name}': no such file")
            shutil.rmtree(copy)

    def test_with_other_figures_fail(self):
        self.change(self.b / "stats.json", '"frames": 1', '"frames": 2')
        self.failed(self.diff(), f"B '{self.b}': run again it has other figures: /frames: recorded 2, again 1\n")
        self.change(self.b / "stats.json", '"cycles": ', '"cycles": 1')
        self.failed(self.diff(), "other figures: /cycles: recorded 1", ", and 1 more\n")

    def test_with_figures_that_run_has_not_written_so_fail(self):
        self.change(self.b / "stats.json", '"schema": 1', '"schema":  1')
        self.failed(self.diff(), f"B '{self.b}': its stats.json is not as run has written it\n")

    def test_with_another_board_fail(self):
        self.change(self.b / "config.yaml", "window: 7", "window: 5")
        self.failed(self.diff(), f"B '{self.b}': run again it has other figures: ")

    def test_of_another_version_name_both(self):
        version = json.loads((self.b / "run.json").read_text())["version"]
        self.change(self.b / "run.json", f'"version": "{version}"', '"version": "0.0.9"')
        self.assertIn("no figure and no row differs", self.lines())
        self.change(self.b / "stats.json", '"frames": 1', '"frames": 2')
        self.failed(self.diff(), f"again 1; it is of version 0.0.9, this is {version}\n")

    def test_of_a_run_that_failed_are_refused(self):
        self.change(self.b / "stats.json", '"schema": 1,', '"schema": 1, "failed": ["1 = 2"],')
        self.refused_in_one_line(
            self.diff(), f"'{self.b}/stats.json': failed = [\"1 = 2\"]: must be a run in which nothing failed"
        )

    def test_with_damaged_files_are_refused(self):
        for text in ("{", "[]", '"x"', ""):
            (self.b / "stats.json").write_text(text)
            self.refused_in_one_line(self.diff(), f"'{self.b}/stats.json': must be as run writes it")
        (self.b / "run.json").write_text("{}")
        (self.b / "config.yaml").write_text("image: 3\nextra: 1\n")
        lines = self.refused(self.diff(), f"'{self.b}/run.json': must be as run writes it", "config.yaml:2:1: extra")
        self.assertGreater(len(lines), 3)

    def test_with_options_that_run_does_not_have_are_refused(self):
        self.change(self.b / "run.json", '"frames": 1,', '"frames": 1, "trace": "vcd",')
        self.refused_in_one_line(self.diff(), f"'{self.b}/run.json': line 7: must be as run writes it")

    def test_with_videos_that_do_not_go_with_their_layout_are_refused(self):
        frames = [noise(2 * WIDTH, HEIGHT, seed) for seed in range(2)]
        video = self.file("v.avi", avi(2 * WIDTH, HEIGHT, frames))
        self.succeeds(self.run_with("--video", video, "--video-layout", "side_by_side", "--out", self.b))
        for layout in ("two", "three"):
            text = (self.b / "run.json").read_text()
            self.change(self.b / "run.json", "side_by_side", layout)
            self.refused_in_one_line(self.diff(), f"'{self.b}/run.json': video_layout = {layout}: must be that of 1 file")
            (self.b / "run.json").write_text(text)


class Usage(DiffTest):
    def test_everything_missing_at_once(self):
        lines = self.refused(run("diff"))
        self.assertEqual([line.split(": ", 1)[1] for line in lines],
                         [f"error: {name}: missing: a folder that run --out has written" for name in ("A", "B")])
        self.refused_in_one_line(run("diff", self.a), "B: missing")
        self.refused_in_one_line(run("diff", self.a, ""), "B: missing")

    def test_a_third_run(self):
        self.refused_in_one_line(run("diff", self.a, self.b, "third"), "third")

    def test_the_name_of_the_table(self):
        for name in ("rows.txt", "stats.json", ""):
            self.refused_in_one_line(self.diff("--csv", name), f"--csv '{name}': must end in .csv")

    def test_a_table_leaves_other_files_alone(self):
        self.write(self.a)
        self.file("rows.csv.part", b"precious")
        self.lines("--csv", self.folder / "rows.csv", b=self.a)
        self.assertEqual((self.folder / "rows.csv.part").read_bytes(), b"precious")
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"a", "rows.csv", "rows.csv.part", "left.pgm", "right.pgm"})

    def test_a_table_behind_a_link_is_replaced_and_the_link_stays(self):
        self.write(self.a)
        target = self.file("table", b"old")
        target.chmod(0o640)
        link = self.folder / "rows.csv"
        link.symlink_to("table")
        self.lines("--csv", link, b=self.a)
        self.assertTrue(link.is_symlink())
        self.assertTrue(target.read_text().startswith("frame,row,"))
        self.assertEqual(target.stat().st_mode & 0o7777, 0o640)

    def test_a_table_that_cannot_be_written(self):
        self.write(self.a)
        path = self.folder / "none" / "rows.csv"
        self.refused_in_one_line(self.diff("--csv", path, b=self.a), f"--csv '{path}': cannot be written: No such file")
        folder = self.folder / "folder.csv"
        folder.mkdir()
        self.refused_in_one_line(self.diff("--csv", folder, b=self.a), f"--csv '{folder}': is a folder")


class Interrupted(DiffTest):
    def test_compares_nothing(self):
        self.write_timing(self.a, "--frames", "20000", "--set", "image.height=1")
        path = self.folder / "rows.csv"
        terminal = Terminal(["diff", self.a, self.a, "--csv", path])
        terminal.read_until(re.compile(r"\d+/20000 frames compared"))
        terminal.process.send_signal(signal.SIGINT)
        status, out = terminal.finish()
        self.assertEqual((status, out), (130, ""))
        self.assertEqual(shown(terminal.text), ["stereotlm: note: interrupted: nothing is compared", ""])
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"a", "left.pgm", "right.pgm"})

    def test_by_a_kill_leaves_nothing_for_long(self):
        self.write_timing(self.a, "--frames", "20000", "--set", "image.height=1")
        path = self.folder / "rows.csv"
        terminal = Terminal(["diff", self.a, self.a, "--csv", path])
        terminal.read_until(re.compile(r"\d+/20000 frames compared"))
        terminal.process.kill()
        terminal.finish()
        self.assertEqual(len(list(self.folder.glob(".rows.csv.*"))), 1)
        self.write_timing(self.a, "--frames", "2")
        self.lines("--csv", path, b=self.a)
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"a", "rows.csv", "left.pgm", "right.pgm"})


if __name__ == "__main__":
    program.main()
