"""sweep with the tables of a calibration, of a rig that is made up."""

import pathlib
import shutil
import tempfile

import program
from program import run
from sweep_test import SweepTest

HOME = tempfile.TemporaryDirectory()  # of the calibration that all tests share
PLAN = """
board: fpl2003
run: {source: preloaded, calibration: CALIBRATION}
set: {matcher.filter: none}
vary:
  matcher.window: [5, 7]
  allocation.left_lut: [bank6, bank0, none]
"""
POINTS = 6
MISSING = 2  # without a left table


def setUpModule():
    process = run("calibrate", "--synthetic", 3, "--grid", "9x6", "--square-mm", 25, "--out", pathlib.Path(HOME.name) / "rig.yaml")
    assert process.returncode == 0, process.stderr


def tearDownModule():
    HOME.cleanup()


class Calibration(SweepTest):
    def setUp(self):
        super().setUp()
        for path in pathlib.Path(HOME.name).glob("rig*"):
            if path.is_file():
                shutil.copy(path, self.folder)
        self.rig = self.folder / "rig.yaml"
        self.plan = self.plan_of(self.rig)

    def plan_of(self, rig, name="plan.yaml", text=PLAN):
        return self.file(name, text.replace("CALIBRATION", str(rig)).encode())

    def test_gives_what_each_run_says(self):
        said = self.succeeds(self.sweep())
        self.assertIn(f"{POINTS} points: {POINTS - MISSING} ok, {MISSING} impossible, 0 failed", said)
        reason = "run.calibration: goes with a board that has both tables; allocation.left_lut = none"
        self.assertIn(f"  {MISSING} impossible: {reason}\n", said)
        rows = self.query("SELECT config, \"run.frames\", cycles, \"banks.bank0.reads\", \"ports.left_pixel.grants\" "
                          "FROM points WHERE status = 'ok'")
        for config, frames, *figures in rows:
            board = self.file("board.yaml", config.encode())
            self.succeeds(run("run", board, "--source", "preloaded", "--timing-only", "--calibration", self.rig,
                              "--frames", frames, "--out", self.out))
            stats = self.stats()
            self.assertEqual(figures, [stats["cycles"], stats["banks"][0]["reads"],
                                       [port["grants"] for port in stats["ports"] if port["name"] == "left_pixel"][0]])

    def test_is_part_of_a_point(self):
        self.succeeds(self.sweep())
        plain = self.plan_of("", "plain.yaml", PLAN.replace(", calibration: CALIBRATION", ""))
        self.assertIn(f"{POINTS} ok, 0 impossible, 0 failed\n", self.succeeds(self.sweep(plan=plain)))
        counts = self.query("SELECT count(*), count(DISTINCT \"run.calibration\"), count(\"run.calibration\") FROM points")
        self.assertEqual(counts, [(2 * POINTS, 1, POINTS)])
        again = self.succeeds(self.sweep())
        self.assertIn(f"0 ok, 0 impossible, 0 failed, {POINTS} there already", again)

    def test_is_found_from_the_working_directory_as_boards_are(self):
        self.succeeds(self.sweep())
        expected = self.store.read_bytes()
        relative = self.plan_of("rig.yaml", "relative.yaml")
        store = self.folder / "relative.db"
        self.succeeds(run("sweep", relative, "--out", store, cwd=self.folder))
        self.assertEqual(store.read_bytes(), expected)
        self.refused_in_one_line(self.sweep(plan=relative), f"{relative}:3:39: run.calibration 'rig.yaml': no such file")

    def test_is_replaced_by_the_option(self):
        self.succeeds(self.sweep())
        expected = self.store.read_bytes()
        for text in (PLAN.replace("CALIBRATION", "none.yaml"), PLAN.replace(", calibration: CALIBRATION", "")):
            plan = self.plan_of("", "other.yaml", text)
            store = self.folder / "option.db"
            self.succeeds(self.sweep("--calibration", self.rig, plan=plan, store=store))
            self.assertEqual(store.read_bytes(), expected)
            store.unlink()

    def test_of_a_whole_computer(self):
        plan = self.plan_of(self.rig, "camera.yaml", "board: fpl2003\nrun: {source: camera, frames: 2, calibration: CALIBRATION}\n")
        self.succeeds(self.sweep(plan=plan))
        self.succeeds(run("run", "fpl2003", "--timing-only", "--frames", 2, "--calibration", self.rig, "--out", self.out))
        stats = self.stats()
        self.assertEqual(self.query('SELECT "frames_per_second.system", "pci.busy_clocks" FROM points'),
                         [(stats["frames_per_second"]["system"], stats["pci"]["busy_clocks"])])

    def test_is_for_images_of_its_size(self):
        small = self.plan_of(self.rig, "small.yaml", PLAN + "zip:\n  - {image.width: [640, 320], image.height: [480, 240]}\n")
        said = self.succeeds(self.sweep(plan=small))
        self.assertIn(f"{2 * POINTS} points: {POINTS - MISSING} ok, {POINTS + MISSING} impossible, 0 failed", said)
        rule = "image size = 640x480: must be that of the board's images, 320x240"
        self.assertIn(f"  {POINTS} impossible: run.calibration: {rule}\n", said)
        self.store.unlink()
        process = self.sweep("--board", "fpl2003-qvga")
        self.refused_in_one_line(process, f"{self.plan}:3:39: run.calibration '{self.rig}': {rule}")
        self.refused_in_one_line(self.sweep("--board", "fpl2003-qvga", "--calibration", self.rig),
                                 f"--calibration '{self.rig}': {rule}")
        self.assertFalse(self.store.exists())

    def test_that_is_damaged_is_refused(self):
        table = self.folder / "rig_left.lut"
        table.write_bytes(bytes(4) + table.read_bytes()[4:])
        process = self.sweep()
        self.refused_in_one_line(process, f"{self.plan}:3:39: run.calibration '{table}': SHA-256 ", "must be the table that")
        self.refused_in_one_line(self.sweep("--calibration", ""), "--calibration: empty")


if __name__ == "__main__":
    program.main()
