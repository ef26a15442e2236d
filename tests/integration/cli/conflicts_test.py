"""run --record and conflicts: where in the picture, and when in a frame, ports wait for banks."""

import csv

import program
from program import CAMERA_RATES, CYCLE, HEIGHT, PRELOADED, SMALL, ProgramTest, run, sets

TABLES = ("rows.csv", "conflicts.csv")
SHARED = sets("allocation.left_lut=bank0")  # with every second left picture
# Captures into the bank of both left pictures, which the core reads.
CAPTURES = [*CAMERA_RATES,
            *sets("allocation.left_image=[bank0, bank0]", "allocation.disparity=[bank0, bank0]")]


class ConflictsTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = ["fpl2003", *SMALL, "--synthetic", "1", "--frames", "3"]

    def table(self, name, folder=None):
        with open((folder or self.out) / name, encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))


class Recorded(ConflictsTest):
    def record(self, *more, out=None):
        self.succeeds(run("run", *self.scene, "--record", *more, "--out", out or self.out))

    def test_it_is_the_same_at_each_fidelity(self):
        cycle, timing = self.folder / "cycle", self.folder / "timing"
        for options in ([*PRELOADED, *SHARED], CAPTURES):
            self.record(*options)
            self.assertNotIn("failed", self.stats())
            self.record(*options, *CYCLE, out=cycle)
            self.record(*options, "--timing-only", out=timing)
            other = self.folder / "other"
            self.succeeds(run("run", *self.scene, "--conflicts", *options, "--out", other))
            for name in TABLES:
                self.assertEqual((self.out / name).read_bytes(), (other / name).read_bytes())
                self.assertEqual((self.out / name).read_bytes(), (cycle / name).read_bytes())
                self.assertEqual((self.out / name).read_bytes(), (timing / name).read_bytes())

    def test_a_frame_has_its_fill_and_all_its_rows(self):
        self.record(*PRELOADED, *sets("matcher.rows=5"))
        rows = [row for row in self.table("rows.csv") if row["frame"] == "1"]
        self.assertEqual((rows[0]["first_row"], rows[0]["last_row"]), ("", ""))
        self.assertEqual([int(row["first_row"]) for row in rows[1:]], list(range(0, HEIGHT, 5)))
        self.assertEqual(int(rows[-1]["last_row"]), HEIGHT - 1)


class Command(ConflictsTest):
    def test_it_writes_the_tables_of_a_recorded_run(self):
        self.succeeds(run("conflicts", *self.scene, *CAPTURES, "--out", self.out))
        self.is_in(self.out, *TABLES)
        recorded = self.folder / "recorded"
        self.succeeds(run("run", *self.scene, *CAPTURES, "--record", "--out", recorded))
        for name in TABLES:
            self.assertEqual((self.out / name).read_bytes(), (recorded / name).read_bytes())
        with self.unchanged(self.out):  # the same bytes again
            self.succeeds(run("conflicts", *self.scene, *CAPTURES, "--out", self.out))
        other = self.file("other/rows.csv", "mine").parent
        self.refused_in_one_line(run("conflicts", *self.scene, *CAPTURES, "--out", other), "holds 'rows.csv'")

    def test_a_run_is_repeated(self):
        recorded = self.folder / "recorded"
        self.succeeds(run("run", *self.scene, *PRELOADED, *SHARED, *CYCLE, "--out", recorded))
        text = self.succeeds(run("conflicts", recorded, "--out", self.out))
        self.assertEqual(text, self.succeeds(run("conflicts", *self.scene, *PRELOADED, *SHARED)))
        self.assertIn("left_lut,bank0,left_pixel", (self.out / "conflicts.csv").read_text())
        stats = (recorded / "stats.json").read_text()
        (recorded / "stats.json").write_text(stats.replace('"contended_cycles": 0', '"contended_cycles": 1'))
        self.fails(run("conflicts", recorded), "repeated, it has other figures")

    def test_its_example_is_a_command_of_its_own(self):
        example = self.refused(run("conflicts", "fpl2003"))[-1]
        begin = "stereotlm: note: a complete command: stereotlm conflicts fpl2003 "
        self.assertTrue(example.startswith(begin), example)

    def test_what_does_not_fit_is_refused(self):
        recorded = self.folder / "recorded"
        self.succeeds(run("run", *self.scene, *PRELOADED, "--out", recorded))
        self.refused(run("conflicts"), "BOARD: missing")
        self.all_refused([
            ([recorded, "--frames", "2"], "a run is repeated as it was: no option of run goes with it"),
            ([recorded, *SHARED], "a run is repeated as it was"),
            ([recorded, "--out", recorded], "of run holds nothing else: must lie elsewhere"),
        ], lambda *arguments: run("conflicts", *arguments))
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    program.main()
