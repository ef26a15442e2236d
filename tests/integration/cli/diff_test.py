"""diff: two runs, run again and compared frame by frame and row by row."""

import csv
import hashlib
import json
import re

import program
from program import CAMERA_RATES, CYCLE, HEIGHT, PRELOADED, SMALL, WIDTH, ProgramTest, noise, pgm, read_png, run

SHARED = ["--set", "allocation.left_lut=bank0"]  # with every second left picture


class DiffTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.a = self.folder / "a"
        self.b = self.folder / "b"

    def write(self, folder, *options):
        """A small run into that folder."""
        self.succeeds(self.run_small(*options, "--out", folder))

    def write_timing(self, folder, *options):
        """A run of the whole board without pixels."""
        self.succeeds(run("run", "fpl2003", *PRELOADED, "--timing-only", *options, "--out", folder))

    def diff(self, *more, a=None, b=None):
        return run("diff", a or self.a, b or self.b, *more)

    def lines(self, *more, **runs):
        """What it prints, with one space between two words."""
        process = self.diff(*more, **runs)
        text = self.succeeds(process)
        self.assertEqual(process.stderr, "")
        return [" ".join(line.split()) for line in text.splitlines()]

    def failed(self, process, *texts):
        """What went wrong once the runs had begun, in one line."""
        self.assertEqual(process.returncode, 1, process.stderr)
        self.assertEqual(process.stdout, "")
        self.assertEqual(len(process.stderr.splitlines()), 1, process.stderr)
        for text in texts:
            self.assertIn(str(text), process.stderr)

    def change(self, path, old, new):
        text = path.read_text()
        self.assertIn(old, text)
        path.write_text(text.replace(old, new, 1))


class Nothing(DiffTest):
    def test_differs_of_a_run_and_its_repetition(self):
        for folder in (self.a, self.b):
            self.write(folder, "--frames", "3")
        self.assertEqual(
            self.lines(),
            [f"A: {self.a}", f"B: {self.b}", "", "no difference", "", "disparities: the same, pixel for pixel, in 3 frames"],
        )

    def test_differs_of_a_run_and_itself(self):
        self.write(self.a)
        self.assertIn("no difference", self.lines(b=self.a))

    def test_differs_where_a_key_has_no_effect(self):
        self.write(self.a)
        self.write(self.b, "--set", "cameras.frame_rate_hz=25")
        lines = self.lines()
        self.assertEqual(lines[3:5], ["board A B", "cameras.frame_rate_hz 29.97 25"])
        self.assertEqual(lines[6:], ["no figure and no row differs", "", "disparities: the same, pixel for pixel, in 1 frame"])

    def test_is_written_or_changed(self):
        for folder in (self.a, self.b):
            self.write(folder)
        before = self.result(self.folder)
        self.lines()
        self.assertEqual(self.result(self.folder), before)

    def test_differs_but_the_fidelity(self):
        self.write(self.a, "--frames", "2")
        self.write(self.b, "--frames", "2", *CYCLE)
        lines = self.lines()
        self.assertEqual(lines[3:5], ["run options A B", "fidelity fast cycle"])
        self.assertIn("no figure and no row differs", lines)


class WorkedValues(DiffTest):
    """Contract section 2."""

    def setUp(self):
        super().setUp()
        for folder, options in ((self.a, []), (self.b, SHARED)):
            self.write_timing(folder, "--set", "matcher.filter=none", *options)

    def test_say_what_a_shared_bank_costs_and_who_is_to_blame(self):
        lines = self.lines()
        for line in (
            "allocation.left_lut bank6 bank0",
            "cycles 2150979 4288581 +2137602",
            "frames_per_second.core 18.596 9.32706 -9.26899",
            "bound.core_limited_by matcher bank bank0",
            "frame 0 2150995 4288597 +2137602",
            "left_lut on bank0 to left_pixel 0 2137602 +2137602",
            "left_lut stall_cycles 0 2137602 +2137602",
            "bank0 contended_cycles 0 2137602 +2137602",
            "bank6 busy_cycles 2142720 0 -2142720",
            "disparities: not compared: there are none in both",
        ):
            self.assertIn(line, lines)

    def test_say_in_which_rows(self):
        # 4 cycles of latency, 7 a column, 82 columns behind the first one, and the write.
        lines = self.lines()
        (parting,) = (line for line in lines if line.startswith("they part"))
        self.assertRegex(parting, r"^they part in frame 0, row 0: whole after 5059 cycles in A, \d+ in B$")
        rows = [re.fullmatch(r"(\d+)(?:\.\.(\d+))? (\S+) (\S+) (\S+) 0 0 0 0", line) for line in lines]
        rows = [row.groups() for row in rows if row]
        self.assertEqual(sum(int(row[2]) for row in rows), 2_137_602)
        self.assertEqual(sum(int(row[4]) for row in rows), 2_137_602)
        # 640 columns of 7 slots take twice as long.
        (longest,) = (row for row in rows if int(row[1] or row[0]) - int(row[0]) > 400)
        self.assertEqual(longest[3], "+4480")
        self.assertEqual(int(rows[-1][1] or rows[-1][0]), 479)

    def test_keep_rows_that_take_as_long_and_stall_at_another_port(self):
        # Either table beside every left picture.
        c = self.folder / "c"
        self.write_timing(c, "--set", "matcher.filter=none", "--set", "allocation.right_lut=bank0")
        rows = [re.fullmatch(r"(\d+)(?:\.\.(\d+))? (\S+) \S+ (\S+) (\S+) 0 0 0", line) for line in self.lines(a=self.b, b=c)]
        rows = [row.groups() for row in rows if row]
        (longest,) = (row for row in rows if int(row[1] or row[0]) - int(row[0]) > 400)
        self.assertEqual(longest[2], "0")
        b, c = (json.loads((folder / "stats.json").read_text()) for folder in (self.b, c))
        self.assertEqual(sum(int(row[2]) for row in rows), c["cycles"] - b["cycles"])
        for port in (0, 1):
            stalls = c["ports"][port]["stall_cycles"] - b["ports"][port]["stall_cycles"]
            self.assertEqual(sum(int(row[3 + port]) for row in rows), stalls)
            self.assertGreater(abs(stalls), 2_000_000)

    def test_are_in_the_table_for_other_programs(self):
        path = self.folder / "rows.csv"
        self.lines("--csv", path)
        with open(path) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["frame"], row["row"]) for row in rows], [("0", str(row)) for row in range(480)])
        self.assertEqual(rows[0]["a_cycles"], "5059")
        self.assertEqual({row["a_cycles"] for row in rows[1:]}, {"4480"})
        self.assertEqual(sum(int(row["a_cycles"]) for row in rows), 2_150_995 - 16)
        self.assertEqual(sum(int(row["b_cycles"]) for row in rows), 4_288_597 - 16)
        self.assertEqual(sum(int(row["b_left_lut_stall_cycles"]) for row in rows), 2_137_602)
        self.assertEqual({row["a_left_lut_stall_cycles"] for row in rows}, {"0"})

    def test_have_their_signs_turned_the_other_way_round(self):
        lines = self.lines(a=self.b, b=self.a)
        self.assertIn("frame 0 4288597 2150995 -2137602", lines)
        self.assertIn("left_lut on bank0 to left_pixel 2137602 0 -2137602", lines)

    def test_fit_into_a_hundred_columns(self):
        for line in self.succeeds(self.diff()).splitlines():
            self.assertLessEqual(len(line), max(100, len(str(self.a)) + 3), line)


class Frames(DiffTest):
    def test_with_the_same_cycles_are_put_together(self):
        for folder, options in ((self.a, []), (self.b, SHARED)):
            self.write_timing(folder, "--set", "matcher.filter=none", "--frames", "5", *options)
        lines = self.lines()
        self.assertIn("each of 3 frames, the first is 0 2150995 4288597 +2137602", lines)
        self.assertIn("each of 2 frames, the first is 1 2150995 2150995 0", lines)

    def test_part_where_the_first_one_is_contended(self):
        self.write(self.a, "--frames", "4")
        self.write(self.b, "--frames", "4", "--set", "allocation.disparity=[bank4, bank0]",
                   "--set", "allocation.left_image=[bank1, bank0]")
        lines = self.lines()
        (parting,) = (line for line in lines if line.startswith("they part"))
        self.assertTrue(parting.startswith("they part in frame 1, row "), parting)

    def test_of_different_numbers_are_compared_as_far_as_both_go(self):
        self.write(self.a, "--frames", "2")
        self.write(self.b, "--frames", "4")
        lines = self.lines()
        self.assertIn("frames 2 4", lines)
        self.assertIn("frames 2 4 +2", lines)
        self.assertIn("figures are of all 2 frames of A and all 4 of B, cycles and rows of the first 2", lines)
        self.assertIn("disparities: the same, pixel for pixel, in 2 frames", lines)
        self.assertFalse([line for line in lines if line.startswith("they part")])

    def test_of_another_fetch_have_the_same_rows(self):
        self.write(self.a)
        self.write(self.b, "--set", "matcher.fetch=line_buffer")
        lines = self.lines()
        ours = self.result(self.a)
        self.assertEqual(ours["disparity.png"], self.result(self.b)["disparity.png"])
        self.assertIn("disparities: the same, pixel for pixel, in 1 frame", lines)
        self.assertTrue([line for line in lines if line.startswith("they part in frame 0, row 0: ")])

    def test_of_another_size_are_compared_as_a_whole(self):
        self.write(self.a)
        small = ["--set", "image.width=16", "--timing-only"]
        self.succeeds(run("run", "fpl2003", *PRELOADED, "--set", f"image.height={HEIGHT}", *small, "--out", self.b))
        lines = self.lines()
        sizes = f"images of {WIDTH}x{HEIGHT} in A, of 16x{HEIGHT} in B"
        self.assertIn(f"rows: not compared: {sizes}", lines)
        self.assertIn(f"disparities: not compared: {sizes}", lines)
        self.assertIn("image.width 32 16", lines)
        self.assertTrue([line for line in lines if line.startswith("frame 0 ")])
        self.assertFalse([line for line in lines if line.startswith("they part")])
        path = self.folder / "rows.csv"
        self.refused_in_one_line(self.diff("--csv", path), f"--csv: rows cannot be compared: {sizes}")
        self.assertEqual({p.name for p in self.folder.iterdir()}, {"a", "b", "left.pgm", "right.pgm"})


class Disparities(DiffTest):
    def test_that_differ_are_counted(self):
        self.write(self.a, "--set", "matcher.disparities=8")
        self.write(self.b, "--set", "matcher.disparities=8", "--set", "matcher.lr_tolerance=off")
        (line,) = (line for line in self.lines() if line.startswith("disparities"))
        ours, theirs = (read_png(folder / "disparity.png")[3] for folder in (self.a, self.b))
        other = [(x, y) for y in range(HEIGHT) for x in range(WIDTH) if ours[y][x] != theirs[y][x]]
        self.assertGreater(len(other), 1)
        x, y = other[0]
        self.assertEqual(
            line,
            f"disparities: {len(other)} pixels differ, in 1 of 1 frame; the first in frame 0 at ({x}, {y}): "
            f"{ours[y][x]} in A, {theirs[y][x]} in B",
        )

    def test_are_not_compared_where_one_run_has_none(self):
        self.write(self.a)
        self.write(self.b, "--timing-only")
        self.assertIn("disparities: not compared: there are none in B", self.lines())
        self.assertIn("disparities: not compared: there are none in A", self.lines(a=self.b, b=self.a))

    def test_of_other_pictures_differ(self):
        self.write(self.a)
        other = self.file("other.pgm", pgm(WIDTH, HEIGHT, noise(WIDTH, HEIGHT, 3)))
        self.succeeds(self.run_small("--out", self.b, right=other))
        lines = self.lines()
        for path in (self.right, other):
            self.assertIn(str(path), " ".join(lines))
            self.assertIn(hashlib.sha256(path.read_bytes()).hexdigest(), " ".join(lines))
        self.assertIn("no figure and no row differs", lines)
        self.assertRegex(lines[-1], r"^disparities: \d+ pixels? differs?, in 1 of 1 frame; the first in frame 0 at ")


class Camera(DiffTest):
    def camera(self, folder, *options):
        self.succeeds(run("run", "fpl2003", *SMALL, *CAMERA_RATES, "--sequence", self.pairs, *options, "--out", folder))

    def setUp(self):
        super().setUp()
        self.pairs = self.sequence(5)

    def test_has_the_figures_of_the_computer(self):
        self.camera(self.a, "--frames", "8")
        self.camera(self.b, "--frames", "8", "--set", "allocation.left_image=bank0", "--set", "allocation.right_image=bank2")
        lines = self.lines()
        for head in ("pci A B difference", "bridge A B difference", "cameras A B difference", "latency_ms A B difference"):
            self.assertIn(head, lines)
        dropped = [json.loads((folder / "stats.json").read_text())["cameras"][0]["dropped_frames"] for folder in (self.a, self.b)]
        self.assertGreater(dropped[1], dropped[0])
        self.assertIn(f"left dropped_frames {dropped[0]} {dropped[1]} +{dropped[1] - dropped[0]}", lines)
        for start in ("frames_per_second.system ", "frames_per_second.steady "):
            self.assertTrue([line for line in lines if line.startswith(start)])

    def test_compares_disparities_of_the_same_camera_frame(self):
        # With one input buffer the cameras' frames are others.
        self.camera(self.a, "--frames", "8", "--save-frames")
        self.camera(self.b, "--frames", "8", "--save-frames", "--set", "allocation.left_image=bank0",
                    "--set", "allocation.right_image=bank2")
        ours, theirs = ({path.name for path in (folder / "frames").iterdir()} for folder in (self.a, self.b))
        self.assertNotEqual(ours, theirs)
        both = len(ours & theirs)
        self.assertGreater(both, 1)
        self.assertEqual(self.lines()[-1], f"disparities: the same, pixel for pixel, in {both} frames")

    def test_blames_the_host_row_by_row(self):
        self.camera(self.a, "--frames", "4")
        self.camera(self.b, "--frames", "4", "--set", "allocation.left_image=[bank0, bank0]")
        path = self.folder / "rows.csv"
        self.lines("--csv", path)
        with open(path) as file:
            stalls = sum(int(row["b_left_pixel_stall_cycles"]) for row in csv.DictReader(file))
        stats = json.loads((self.b / "stats.json").read_text())
        (row,) = stats["blame"]
        self.assertEqual((row["port"], row["by"]), ("left_pixel", "host"))
        self.assertEqual(stalls, row["cycles"])

    def test_is_compared_with_the_board_alone(self):
        self.camera(self.a, "--frames", "3")
        self.write_small_sequence(self.b)
        for a, b, name in ((self.a, self.b, "A"), (self.b, self.a, "B")):
            lines = self.lines(a=a, b=b)
            self.assertIn(f"pci, bridge, cameras and latency: only in {name}", lines)
            self.assertIn("source camera preloaded" if name == "A" else "source preloaded camera", lines)

    def test_says_that_no_frame_is_in_both(self):
        self.camera(self.a, "--frames", "1")
        self.write_small_sequence(self.b, "--frames", "1")
        self.assertEqual(self.lines()[-1], "disparities: not compared: no camera frame is in both")

    def write_small_sequence(self, folder, *options):
        self.succeeds(run("run", "fpl2003", *SMALL, *CAMERA_RATES, *PRELOADED, "--sequence", self.pairs, *options, "--out", folder))


if __name__ == "__main__":
    program.main()
