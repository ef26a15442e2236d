"""rtl: what it writes and refuses, and that its test bench under Verilator agrees with run."""

import os
import shutil
import subprocess
import unittest

import program
from pictures import noise, pgm, read_png
from program import PRELOADED, ProgramTest, run, sets

# Of ./nightly: the paper's board with the photographed pair of this folder.
PICTURES = os.environ.get("STEREOTLM_RTL_PICTURES")
BENCH = unittest.skipUnless(shutil.which("verilator"), "verilator is not installed")
SMALL = sets("image.width=24", "image.height=16", "matcher.window=3", "matcher.disparities=5",
             "ssram.banks.bank1.kind=zbt_flow_through", "ssram.banks.bank4.kind=sync_burst",
             "ssram.banks.bank4.turnaround_cycles=2", "allocation.left_image=[bank1, bank4]",
             "allocation.right_image=[bank0, bank0]", "allocation.disparity=bank4",
             "allocation.right_lut=none", "fpga.result_delay_cycles=9", "fpga.arbitration=age")


class Rtl(ProgramTest):
    def make(self, *target):
        return subprocess.run(["make", "-s", "-C", self.out, *target], capture_output=True, text=True,
                              check=False)

    def is_as_run(self, cycles, *options):
        """The test bench of this board and pair; `cycles`: of its frames."""
        self.succeeds(run("rtl", "fpl2003", *options, "--out", self.out))
        process = self.make()
        said = self.succeeds(process)
        self.assertNotIn("Warning", process.stderr)
        for frame, of_frame in enumerate(cycles):
            self.assertRegex(said, f"frame {frame}: {of_frame} cycles, of run {of_frame}; 0 of ")
        self.assertIn("the core is as run in each disparity and cycle\n", said)
        result = self.folder / "result"
        self.succeeds(run("run", "fpl2003", *options, *PRELOADED, "--frames", len(cycles), "--out", result))
        self.assertEqual(self.stats(result)["frame_cycles"], cycles)
        rows = b"".join(read_png(result / "disparity.png")[3])
        self.assertGreater(len(set(rows)), 2)
        pixels = (self.out / "disparity.pgm").read_text().split()[4:]
        self.assertEqual(bytes(map(int, pixels)), rows)

    @BENCH
    def test_the_bench_is_as_run(self):
        texture = noise(28, 16, 1)
        for name, step in (("left.pgm", 8), ("right.pgm", 4)):
            rows = (texture[28 * y + y // step:][:24] for y in range(16))  # the lower, the nearer
            self.file(name, pgm(24, 16, b"".join(rows)))
        self.is_as_run([1349, 1740], *self.pair, *SMALL)
        for file in ("disparity.hex", "cycles.hex"):
            right = (self.out / file).read_text()
            self.file(self.out / file, right[:-2] + f"{int(right[-2], 16) ^ 1:x}\n")
            process = self.make()
            self.assertNotEqual(process.returncode, 0)
            self.assertIn("the core is NOT as run\n", process.stdout)
            self.file(self.out / file, right)

    @unittest.skipUnless(PICTURES, "only ./nightly has 640x480")
    def test_the_bench_of_the_paper_is_as_run(self):
        pair = [word for side in ("left", "right") for word in (f"--{side}", f"{PICTURES}/{side}01.jpg")]
        self.is_as_run([2151016] * 2, *pair)
        self.assertRegex(self.succeeds(self.make("synthesis")), r"\n +SRL16E +\d+\n")
        shutil.rmtree(self.out)
        shutil.rmtree(self.folder / "result")
        self.is_as_run([2151016] * 2, *pair, *sets("fpga.result_delay_cycles=16",
                                                   "fpga.pipeline_latency_cycles=0"))

    def test_knobs_that_it_does_not_have_are_refused(self):
        scene = ["--synthetic", 1, *program.SMALL, "--out", self.out]
        stripes = "{rows: [bank6, bank7]}"
        self.all_refused([
            (["rtl", "fpl2003", *scene, *sets(f"{key}={value}")], f"error: {key} = {value}: must be {rule}")
            for key, value, rule in (
                ("fpga.lanes", "2", "1: the RTL has one lane on each side"),
                ("fpga.pixel_cache", "word", "none: the RTL keeps no word that it has read"),
                ("ssram.banks.bank0.kind", "qdr", "zbt_pipelined, zbt_flow_through or sync_burst: the RTL"),
                ("matcher.fetch", "line_buffer", "column: the RTL fetches columns"),
                ("matcher.units", "40", "all: the RTL has a module for each disparity"),
                ("matcher.rows", "2", "1: the RTL computes one row of results at once"),
                ("matcher.cost", "zncc", "sad: the RTL adds absolute differences"),
                ("allocation.left_lut", stripes, "a bank for each buffer: the RTL has no stripes"))])
        joint = sets("fpga.tables=joint", "allocation.right_lut=bank6")
        self.refused_in_one_line(run("rtl", "fpl2003", *scene, *joint),
                                 "fpga.tables = joint: must be separate: the RTL reads a table for each side")
        banks = sets(*(f"ssram.banks.b{number}.words=1" for number in range(56)))
        self.refused_in_one_line(run("rtl", "fpl2003", *scene, *banks),
                                 "ssram.banks = 64 banks: must be 63 at most: the RTL has no more")
        self.assertFalse(self.out.exists())
        self.succeeds(run("rtl", "fpl2003", *scene, *sets("matcher.units=80")))

    def test_a_folder_that_is_not_empty_is_refused(self):
        scene = ["rtl", "fpl2003", "--synthetic", 1, *program.SMALL, "--out", self.out]
        self.succeeds(run(*scene))
        with self.unchanged(self.out):
            self.refused_in_one_line(run(*scene), f"--out '{self.out}': holds 'Makefile': must be empty")


if __name__ == "__main__":
    program.main()
