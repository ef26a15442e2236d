"""run --fidelity, --timing-only and --verify: the same figures and pictures however they are made."""

import json
import os
import re
import signal
import time

import program
from avi import avi
from interrupt_test import PROGRESS, Terminal, shown
from program import CAMERA_RATES, CYCLE, HEIGHT, PRELOADED, SMALL, WIDTH, ProgramTest, noise, pgm, run

# Some seconds a frame, cycle by cycle.
SLOW = ["--timing-only", "--set", "image.width=2048", "--set", "image.height=2048"]
SLOW += ["--set", "matcher.window=31", "--set", "ssram.default.words=4194304"]
CAMERA = ["--source", "camera", *CAMERA_RATES]
SOURCES = {"preloaded": PRELOADED, "camera": CAMERA}
BOARDS = {
    "alone": [],
    "shared": ["--set", "allocation.left_image=[bank0, bank0]", "--set", "allocation.left_lut=bank0"],
    "line_buffer": ["--set", "matcher.fetch=line_buffer", "--set", "fpga.arbitration=round_robin"],
    "turnaround": ["--set", "ssram.default.kind=sync_burst", "--set", "ssram.default.turnaround_cycles=3"]
    + ["--set", "allocation.disparity=[bank0, bank0]"],
}


class FidelityTest(ProgramTest):
    def run_it(self, *options):
        """A small run."""
        return run("run", "fpl2003", *SMALL, *options)

    def files_of(self, *options):
        """The files that it writes, without run.json."""
        self.succeeds(self.run_it(*options, "--out", self.out))
        files = self.result()
        del files["run.json"]
        return files


class Fidelities(FidelityTest):
    def test_write_the_same_bytes_but_for_their_names(self):
        sequence = ["--sequence", self.sequence(3), "--frames", "5", "--save-frames"]
        for name, source in SOURCES.items():
            for board, options in BOARDS.items():
                with self.subTest(source=name, board=board):
                    fast = self.files_of(*source, *options, *sequence)
                    cycle = self.files_of(*source, *options, *sequence, *CYCLE)
                    stats = fast["stats.json"].replace(b'"fidelity": "fast"', b'"fidelity": "cycle"')
                    self.assertNotEqual(fast["stats.json"], stats)
                    self.assertEqual(fast | {"stats.json": stats}, cycle)

    def test_print_the_same_table(self):
        options = [*CAMERA, "--synthetic", "1", "--frames", "3"]
        self.assertEqual(self.succeeds(self.run_it(*options)), self.succeeds(self.run_it(*options, *CYCLE)))


class TimingOnly(FidelityTest):
    def test_has_the_figures_of_a_run_with_pixels(self):
        for name, source in SOURCES.items():
            with self.subTest(source=name):
                whole = self.files_of(*source, "--synthetic", "1", "--frames", "4")
                without = self.files_of(*source, "--timing-only", "--frames", "4")
                self.assertEqual(without, {name: whole[name] for name in ("config.yaml", "stats.json")})

    def test_writes_no_pictures(self):
        self.succeeds(self.run_it("--timing-only", "--out", self.out))
        self.assertEqual(sorted(os.listdir(self.out)), ["config.yaml", "run.json", "stats.json"])

    def test_is_named_in_run_json(self):
        self.succeeds(self.run_it("--timing-only", "--frames", "2", "--out", self.out))
        told = json.loads((self.out / "run.json").read_text())
        self.assertEqual((told["timing_only"], told["fidelity"], told["frames"]), (True, "fast", 2))
        for name in ("verify", "left", "right", "synthetic"):
            self.assertNotIn(name, told)

    def test_goes_with_pictures_that_are_checked(self):
        pair = ["--left", self.left, "--right", self.right]
        self.succeeds(self.run_it("--timing-only", *pair, "--out", self.out))
        told = json.loads((self.out / "run.json").read_text())
        self.assertEqual(told["left"]["path"], str(self.left))
        none = self.folder / "none.pgm"
        self.refused_in_one_line(
            self.run_it("--timing-only", "--left", none, "--right", self.right), f"--left '{none}': no such file"
        )

    def test_takes_as_many_frames_as_a_sequence_has_pairs(self):
        self.succeeds(self.run_it("--timing-only", "--sequence", self.sequence(3), "--out", self.out))
        self.assertEqual(self.stats()["frames"], 3)

    def test_goes_cycle_by_cycle_too(self):
        for source in SOURCES.values():
            fast = self.files_of(*source, "--timing-only", "--frames", "2")
            cycle = self.files_of(*source, "--timing-only", "--frames", "2", *CYCLE)
            self.assertEqual(fast["stats.json"].replace(b'"fast"', b'"cycle"'), cycle["stats.json"])


class Verify(FidelityTest):
    def verified(self, *options, frames, what="figure, time and pixel"):
        process = self.run_it(*options, "--verify")
        self.succeeds(process)
        text = f"verified: fast and cycle agree in every {what} of {frames}"
        self.assertEqual(process.stderr, f"stereotlm: note: {text}\n")

    def test_of_both_sources_says_that_they_agree(self):
        for source in SOURCES.values():
            for fidelity in ([], CYCLE):
                self.verified(*source, *fidelity, "--synthetic", "1", "--frames", "3", frames="3 frames")
            self.verified(*source, "--left", self.left, "--right", self.right, frames="1 frame")

    def test_of_a_run_without_pixels(self):
        for source in SOURCES.values():
            options = [*source, "--timing-only", "--frames", "3"]
            self.verified(*options, frames="3 frames", what="figure and time")

    def test_of_a_sequence(self):
        sequence = self.sequence(3)
        for source in SOURCES.values():
            self.verified(*source, "--sequence", sequence, "--frames", "5", frames="5 frames")

    def test_of_a_video(self):
        frames = [noise(2 * WIDTH, HEIGHT, seed) for seed in range(3)]
        video = self.file("v.avi", avi(2 * WIDTH, HEIGHT, frames))
        self.verified(*CAMERA, "--video", video, "--video-layout", "side_by_side", frames="3 frames")

    def test_changes_no_result(self):
        options = [*CAMERA, "--synthetic", "1", "--frames", "2"]
        self.assertEqual(self.files_of(*options, "--verify"), self.files_of(*options))

    def test_is_named_in_run_json(self):
        self.succeeds(self.run_it("--timing-only", "--verify", "--out", self.out))
        self.assertIs(json.loads((self.out / "run.json").read_text())["verify"], True)

    def start(self, *options):
        """A run with --verify at a terminal that has begun, and the process of its second run."""
        terminal = Terminal(self.run_arguments("--verify", *options, "--out", self.out))
        terminal.read_until(PROGRESS)
        return terminal, self.child_of(terminal)

    def child_of(self, terminal):
        with open(f"/proc/{terminal.process.pid}/task/{terminal.process.pid}/children") as children:
            (child,) = (int(number) for number in children.read().split())
        return child

    def gone(self, child):
        """Whether the process ends soon."""
        end = time.monotonic() + 30
        while time.monotonic() < end:
            try:
                os.kill(child, 0)
            except ProcessLookupError:
                return True
            time.sleep(0.01)
        return False

    def test_of_an_interrupted_run_compares_nothing(self):
        terminal, child = self.start("--frames", "1000000000")
        terminal.process.send_signal(signal.SIGINT)
        status, _ = terminal.finish()
        self.assertEqual(status, 130)
        self.assertIn("note: --verify: interrupted: nothing is compared", terminal.text)
        self.assertNotIn("verified", terminal.text)
        self.assertGreater(self.stats()["frames"], 0)
        self.assertNotIn("verify", json.loads((self.out / "run.json").read_text()))
        self.assertTrue(self.gone(child))

    @program.slow
    def test_shows_how_far_the_comparison_is(self):
        frames = ["--timing-only", "--frames", "12"]
        terminal = Terminal(["run", "fpl2003", *PRELOADED, *frames, "--verify"])
        terminal.read_until(re.compile(r"verifying: [1-9]\d*/12 frames"))
        status, out = terminal.finish()
        self.assertEqual(status, 0, terminal.text)
        self.assertIn("12 frames", out)
        text = "stereotlm: note: verified: fast and cycle agree in every figure and time of 12 frames"
        self.assertEqual(shown(terminal.text), [text, ""])
        self.assertNotIn("nan", terminal.text)

    def start_comparison(self):
        """A run at a terminal that waits for its second run, which takes long, and that one's process."""
        terminal = Terminal(["run", "fpl2003", *PRELOADED, *SLOW, "--verify", "--frames", "2", "--out", self.out])
        terminal.read_until(re.compile("verifying: 0/2 frames"))
        return terminal, self.child_of(terminal)

    def test_that_is_interrupted_compares_nothing(self):
        terminal, child = self.start_comparison()
        terminal.process.send_signal(signal.SIGINT)
        status, out = terminal.finish()
        self.assertEqual(status, 130)
        self.assertIn("2 frames", out)
        self.assertEqual(shown(terminal.text), ["stereotlm: note: --verify: interrupted: nothing is compared", ""])
        self.assertEqual(self.stats()["frames"], 2)
        self.assertNotIn("failed", self.stats())
        self.assertNotIn("verify", json.loads((self.out / "run.json").read_text()))
        self.assertTrue(self.gone(child))

    def test_of_a_run_that_is_killed_leaves_no_process(self):
        terminal, child = self.start("--frames", "1000000000")
        terminal.process.kill()
        terminal.finish()
        self.assertTrue(self.gone(child))

    @program.slow
    def test_says_what_became_of_a_second_run_that_was_killed(self):
        terminal, child = self.start(*CYCLE, "--frames", "2000")
        os.kill(child, signal.SIGKILL)
        status, _ = terminal.finish()
        self.assertEqual(status, 1)
        text = "--verify: the run at fidelity fast: the process was ended by signal 9 (Killed)"
        self.assertIn(f"error: {text}\n", terminal.text.replace("\r\n", "\n"))
        self.assertEqual(self.stats()["failed"], [text])
        self.assertIs(json.loads((self.out / "run.json").read_text())["verify"], True)


if __name__ == "__main__":
    program.main()
