"""diff: two runs, run again and compared frame by frame and row by row."""

import functools
import json
import shutil
import signal

import program
from pictures import avi, noise, pgm, read_png
from program import CAMERA_RATES, HEIGHT, PRELOADED, SMALL, WIDTH
from program import ProgramTest, Terminal, run, sets, sha256, shared_folder

SHARED = sets("allocation.left_lut=bank0")  # with every second left picture
SCENE = [*SMALL, "--synthetic", "1"]
TIMING = ["--timing-only", *sets("matcher.filter=none")]
ONE_FRAME = "disparities: the same, pixel for pixel, in 1 frame"


@functools.cache
def shared_run(*arguments):
    """The folder of a run of the board alone that cases only read."""
    out = shared_folder() / str(len(list(shared_folder().iterdir())))
    process = run("run", "fpl2003", *PRELOADED, *arguments, "--out", out)
    assert process.returncode == 0, process.stderr
    return out


def stats_of(folder):
    return json.loads((folder / "stats.json").read_text())


class DiffTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.a = self.folder / "a"
        self.b = self.folder / "b"

    def lines(self, a, b, *more, **options):
        """What it prints before the verdict, with one space between two words."""
        text, _ = self.parts(a, b, *more, **options)
        return [" ".join(line.split()) for line in text.splitlines()]

    def verdict(self, a, b):
        """The last sentence."""
        return " ".join(self.parts(a, b)[1].split())

    def parts(self, a, b, *more, **options):
        process = run("diff", a, b, *more, **options)
        text, _, verdict = self.succeeds(process).rpartition("\n\n")
        self.assertEqual(process.stderr, "")
        for line in verdict.splitlines():
            self.assertLessEqual(len(line), 100, line)
        return text, verdict

    def change(self, path, old, new):
        text = path.read_text()
        self.assertIn(old, text)
        path.write_text(text.replace(old, new, 1))


class Differences(DiffTest):
    def test_a_run_and_its_repetition_do_not_differ(self):
        a = shared_run(*SCENE, "--frames", "3")
        self.succeeds(self.run_with("--synthetic", "1", "--frames", "3", "--out", self.b))
        with self.unchanged(self.folder):
            lines = self.lines(a, self.b)
        same = "disparities: the same, pixel for pixel, in 3 frames"
        self.assertEqual(lines, [f"A: {a}", f"B: {self.b}", "", "no difference", "", same])
        self.assertIn("no difference", self.lines(a, a))

    def test_the_verdict_names_what_limits_if_no_wait_differs_and_the_clock_if_it_does(self):
        a = shared_run(*SCENE, "--frames", "2")
        lines = shared_run(*SCENE, *sets("matcher.fetch=line_buffer"), "--frames", "2")
        cycles = [sum(stats_of(folder)["frame_cycles"]) // 2 for folder in (a, lines)]
        self.assertRegex(self.verdict(a, lines),
                         rf"^B is faster .*: a frame takes {cycles[0]} cycles in A, limited by matcher, "
                         rf"and {cycles[1]} in B, limited by \w+.*; the disparities are the same\.$")
        fast = shared_run(*SCENE, *sets("fpga.clock_mhz=50"), "--frames", "2")
        self.assertIn("(25.00 %), core only: the core runs at 40 MHz in A and at 50 MHz in B;",
                      self.verdict(a, fast))
        slow = shared_run(*SCENE, *sets("fpga.clock_mhz=39", "matcher.fetch=line_buffer"), "--frames", "2")
        self.assertRegex(self.verdict(a, slow), "^B is faster .*: a frame takes ")  # not for its clock
        cache = shared_run(*SCENE, *sets("fpga.clock_mhz=40.000001"), "--frames", "2")
        self.assertEqual(self.lines(a, cache)[4:7],  # the rates differ in the eighth digit, and the energies
                         ["fpga.clock_mhz 40.0 40.000001", "", "banks A B difference"])
        self.assertIn("A and B are equally fast to 0.001 frames/s, core only: the core runs at 40 MHz in A "
                      "and at",
                      self.verdict(a, cache).replace("\n", " "))
        timing = shared_run(*SMALL, "--timing-only", "--frames", "2")
        self.assertIn("; the disparities are not compared.", self.verdict(a, timing))
        other = shared_run(*SMALL, "--synthetic", "2", "--frames", "2")
        self.assertIn("; the disparities differ.", self.verdict(a, other))

    def test_the_verdict_names_a_wait_that_is_at_least_half_of_the_difference(self):
        """A pixel takes 3 cycles in A and 1 in B. Where A shares a bank, it waits for 3 more."""
        board = [*SMALL, *TIMING, *sets("matcher.window=3", "matcher.disparities=16")]
        # A shares a bank in every second frame, so the wait is 3 of 5 cycles, then 3 of 7. The drain adds
        # some.
        for frames, least, most, said in ((1, 0.5, 0.6, ": in A left_lut waits "),
                                          (2, 0.4, 0.5, ": a frame takes ")):
            folders = [shared_run(*board, *more, "--frames", frames)
                       for more in (SHARED, sets("matcher.fetch=line_buffer"))]
            of_a, of_b = map(stats_of, folders)
            (wait,) = of_a["blame"]
            self.assertEqual(of_b["blame"], [])
            share = wait["cycles"] / (of_a["cycles"] - of_b["cycles"])
            self.assertTrue(least < share < most, share)
            self.assertIn(said, self.verdict(*folders))


class Frames(DiffTest):
    def test_rows_of_frames_of_another_size_are_refused(self):
        narrow = shared_run(*sets("image.width=16", f"image.height={HEIGHT}"), "--timing-only")
        rule = f"--csv: rows cannot be compared: images of {WIDTH}x{HEIGHT} in A, of 16x{HEIGHT} in B"
        with self.unchanged(self.folder):
            process = run("diff", shared_run(*SCENE), narrow, "--csv", self.folder / "rows.csv")
            self.refused_in_one_line(process, rule)


class Disparities(DiffTest):
    def test_pixels_that_differ_are_counted(self):
        other = self.file("other.pgm", pgm(WIDTH, HEIGHT, noise(WIDTH, HEIGHT, 3)))
        self.succeeds(self.run_small("--out", self.a))
        self.succeeds(self.run_small("--out", self.b, right=other))
        lines = self.lines(self.a, self.b)
        for path in (self.right, other):
            self.assertIn(str(path), " ".join(lines))
            self.assertIn(sha256(path), " ".join(lines))
        self.assertIn("no figure and no row differs", lines)
        ours, theirs = (read_png(folder / "disparity.png")[3] for folder in (self.a, self.b))
        pixels = [(x, y) for y in range(HEIGHT) for x in range(WIDTH) if ours[y][x] != theirs[y][x]]
        x, y = pixels[0]
        first = f"in frame 0 at ({x}, {y}): {ours[y][x]} in A, {theirs[y][x]} in B"
        differ = f"{len(pixels)} pixels differ, in 1 of 1 frame; the first {first}"
        self.assertEqual(lines[-1], f"disparities: {differ}")


class Computer(DiffTest):
    def test_no_wait_of_the_core_is_named_if_the_faster_computer_has_the_slower_core(self):
        one_buffer = sets("allocation.left_image=bank0", "allocation.right_image=bank2")
        for folder, allocation in ((self.a, one_buffer), (self.b, sets("allocation.disparity=bank0"))):
            options = [*SMALL, *CAMERA_RATES, "--timing-only", "--frames", "13", *allocation, "--out", folder]
            self.succeeds(run("run", "fpl2003", *options))
        rates = [stats_of(folder)["frames_per_second"] for folder in (self.a, self.b)]
        self.assertGreater(rates[1]["steady"], rates[0]["steady"])
        self.assertLess(rates[1]["core"], rates[0]["core"])
        for runs, name in (((self.a, self.b), "B"), ((self.b, self.a), "A")):
            self.assertRegex(self.verdict(*runs), rf"^{name} is faster by .*, steady: the core is not faster "
                                                  rf"in {name}, "
                                                  "and the difference arises around it; ")


class Sources(DiffTest):
    def test_every_source_is_found_again(self):
        """The runs name their files by relative paths, diff is run in another folder."""
        wide = [noise(2 * WIDTH, HEIGHT, seed) for seed in range(3)]
        self.file("v.avi", avi(2 * WIDTH, HEIGHT, wide))
        sides = [[noise(WIDTH, HEIGHT, side + frame) for frame in (0, 10)] for side in (1, 2)]
        for side, frames in enumerate(sides):
            self.file(f"{side}.avi", avi(WIDTH, HEIGHT, frames))
        self.sequence(3)
        for options in (
            "--left left.pgm --right right.pgm --truth left.pgm --truth-scale 0.5",
            "--sequence sequence --save-frames --frames 5",
            "--video v.avi --video-layout side_by_side --truth left.pgm",
            "--video 0.avi 1.avi --video-layout two",
            "--synthetic 18446744073709551615 --frames 2",
            "--synthetic 0 --verify",
        ):
            with self.subTest(options=options):
                command = ["run", "fpl2003", *SMALL, *PRELOADED, *options.split(), "--out", "a"]
                self.succeeds(run(*command, cwd=self.folder))
                self.assertIn("no difference", self.lines(self.a, self.a))
        self.assertIn("no difference", self.lines("a", "./a/", cwd=self.folder))

    @program.slow
    def test_a_calibration_is_found_again(self):
        pictures = program.made_rig()[0].parent / "rig_pictures"
        pair = ["--left", pictures / "scene_left.png", "--right", pictures / "scene_right.png"]
        command = ["run", "fpl2003", *PRELOADED, "--calibration", self.copy_of_rig(), *pair]
        self.succeeds(run(*command, "--out", self.a))
        self.succeeds(run(*command, *SHARED, "--out", self.b))
        self.assertIn(ONE_FRAME, self.lines(self.a, self.b))
        table = self.folder / "rig_left.lut"
        recorded = sha256(table)
        table.write_bytes(bytes(4) + table.read_bytes()[4:])
        rule = f"SHA-256 {sha256(table)}: must be that of the file of the run, {recorded}"
        for line in self.refused(run("diff", self.a, self.b)):
            self.assertIn(f"--calibration '{table}': {rule}", line)

    def refused_in_both(self, *texts):
        """Of the run in self.a: a line for each text, once as A and once as B."""
        lines = self.refused(run("diff", self.a, self.a))
        for (name, text), line in zip([(name, text) for name in "AB" for text in texts], lines, strict=True):
            self.assertIn(f"error: {name} '{self.a}': {text}", line)

    def test_changed_files_are_refused_with_both_sums(self):
        self.succeeds(self.run_small("--out", self.a))
        recorded = sha256(self.left)
        self.left.write_bytes(pgm(WIDTH, HEIGHT, noise(WIDTH, HEIGHT, 9)))
        rule = f"SHA-256 {sha256(self.left)}: must be that of the file of the run, {recorded}"
        self.refused_in_both(f"--left '{self.left}': {rule}")

    def test_missing_and_additional_files_are_refused(self):
        self.succeeds(self.run_small("--truth", self.right, "--out", self.a))
        self.right.unlink()
        missing = f"'{self.right}': cannot be read: No such file or directory"
        self.refused_in_both(f"--right {missing}", f"--truth {missing}")
        pairs = self.sequence(2)
        self.succeeds(self.run_with("--sequence", pairs, "--out", self.a))
        for side in ("left", "right"):
            shutil.copy(pairs / f"{side}_000.png", pairs / f"{side}_100.png")
        self.refused_in_both(f"--sequence '{pairs}': 3 pairs: must be those of the run, 2")

    def test_files_that_no_longer_fit_the_board_are_refused(self):
        self.succeeds(self.run_small("--out", self.a))
        self.change(self.a / "config.yaml", f"width: {WIDTH}", "width: 64")
        size = f"{WIDTH}x{HEIGHT} pixels: must be as large as the board's images, 64x{HEIGHT}"
        self.refused_in_both(f"--left '{self.left}': {size}")


class Folders(DiffTest):
    """A run, and a copy of it that is changed."""

    def setUp(self):
        super().setUp()
        self.a = shared_run(*SCENE)
        shutil.copytree(self.a, self.b)

    def diff(self, name, old, new):
        self.change(self.b / name, old, new)
        return run("diff", self.a, self.b)

    def test_folders_without_a_run_are_refused(self):
        rule = "B must be a folder that run --out has written"
        none = self.folder / "none"
        rows = [(none, f"error: {rule}: '{none}': no such folder"),
                (self.left, f"error: {rule}: '{self.left}': not a folder")]
        for name in ("run.json", "config.yaml", "stats.json"):
            copy = shutil.copytree(self.b, self.folder / f"without_{name}")
            (copy / name).unlink()
            rows.append((copy, f"{rule}: '{copy}/{name}': no such file"))
        self.all_refused((["diff", self.a, folder], text) for folder, text in rows)

    def test_other_figures_fail(self):
        other = f"B '{self.b}': repeated, it has other figures: "
        none, one = '"contended_cycles": 0', '"contended_cycles": 1'
        self.fails(self.diff("stats.json", none, one),
                   f"{other}/banks/0/contended_cycles: recorded 1, again 0\n")
        self.fails(self.diff("stats.json", none, one), other, ", and 1 more\n")
        process = self.diff("config.yaml", "window: 7", "window: 5")
        self.refused_in_one_line(process, f"{self.b}/stats.json:",
                                 "which follows from other figures and the board")

    def test_both_versions_are_named(self):
        version = json.loads((self.b / "run.json").read_text())["version"]
        said = self.succeeds(self.diff("run.json", f'"version": "{version}"', '"version": "0.0.9"'))
        self.assertIn("no figure and no row differs", said)
        process = self.diff("stats.json", '"contended_cycles": 0', '"contended_cycles": 1')
        versions = f"it was written by version 0.0.9, this is {version}\n"
        self.fails(process, f"again 0; {versions}")
        self.refused(self.diff("stats.json", '"frames": 1', '"frames": 2'), f"note: {versions}")


class Usage(DiffTest):
    def test_everything_missing_is_named_at_once(self):
        lines = self.refused(run("diff"))
        rule = "missing: a folder that run --out has written"
        self.assertEqual(lines, [f"stereotlm: error: {name}: {rule}" for name in ("A", "B")])

    def test_wrong_values_are_refused(self):
        a = shared_run(*SCENE)
        none, folder = self.folder / "none" / "rows.csv", self.folder / "folder.csv"
        folder.mkdir()
        self.all_refused([
            (["diff", a], "B: missing"),
            (["diff", a, ""], "B: missing"),
            (["diff", a, a, "third"], "third"),
            (["diff", a, a, "--csv", "rows.txt"], "--csv 'rows.txt': must end in .csv"),
            (["diff", a, a, "--csv", none], f"--csv '{none}': there is no such folder"),
            (["diff", a, a, "--csv", folder], f"--csv '{folder}': is no file"),
        ])

    def test_an_interrupt_compares_nothing(self):
        a = shared_run("--timing-only", "--frames", "60000", *sets("image.height=1"))
        with self.unchanged(self.folder):
            terminal = Terminal(["diff", a, a, "--csv", self.folder / "rows.csv"])
            status, out = terminal.interrupt(r"\d+/60000 frames compared", signal.SIGINT)
            self.assertEqual((status, out), (130, ""))
            self.assertEqual(terminal.shown(), ["stereotlm: note: interrupted: nothing is compared", ""])


if __name__ == "__main__":
    program.main()
