"""run --fidelity, --timing-only and --verify: the same figures and pictures however they are made."""

import os
import re
import signal

import program
from pictures import avi, noise
from program import CAMERA_RATES, CYCLE, HEIGHT, PRELOADED, PROGRESS, SMALL, WIDTH
from program import ProgramTest, Terminal, descendants, of_process, run, sets, wait_until

# Some seconds a frame, cycle by cycle.
SLOW = ["--timing-only", *sets("image.width=2048", "image.height=2048", "matcher.window=31",
                               "ssram.default.words=4194304")]
CAMERA = ["--source", "camera", *CAMERA_RATES]
SOURCES = {"preloaded": PRELOADED, "camera": CAMERA}


class FidelityTest(ProgramTest):
    def run_it(self, *options):
        """A small run."""
        return run("run", "fpl2003", *SMALL, *options)

    def files_of(self, *options):
        """The files that it writes, without run.json, and what it prints."""
        said = self.succeeds(self.run_it(*options, "--out", self.out))
        files = self.result()
        del files["run.json"]
        return {**files, "said": said}

    def same_at_both(self, *options):
        """But for their names, both fidelities write and print the same."""
        fast = self.files_of(*options)
        cycle = self.files_of(*options, *CYCLE)
        self.assertIn(b'"fidelity": "fast"', fast["stats.json"])
        fast["stats.json"] = fast["stats.json"].replace(b'"fidelity": "fast"', b'"fidelity": "cycle"')
        self.assertTrue(fast == cycle)


class TimingOnly(FidelityTest):
    def test_has_the_figures_of_a_run_with_pixels(self):
        for name, source in SOURCES.items():
            with self.subTest(source=name):
                whole = self.files_of(*source, *self.pair, "--frames", "4")
                whole["said"] = re.sub(r"(?m)^disparities .*\n", "", whole["said"])
                timing = [*source, "--timing-only", "--frames", "4"]
                without = self.files_of(*timing)
                self.assertEqual(without, {name: whole[name] for name in without})
                others = [name for name in without if not name.endswith(".csv")]
                self.assertEqual(sorted(others), ["config.yaml", "said", "stats.json"])
                self.same_at_both(*source, "--timing-only", "--frames", "65")  # more than are recorded

    def test_goes_with_pictures_that_are_checked(self):
        self.succeeds(self.run_it("--timing-only", *self.pair, "--out", self.out))
        self.assertEqual(self.run_json()["left"]["path"], str(self.left))
        none = self.folder / "none.pgm"
        process = self.run_it("--timing-only", "--left", none, "--right", self.right)
        self.refused_in_one_line(process, f"--left '{none}': no such file")
        self.succeeds(self.run_it("--timing-only", "--sequence", self.sequence(3), "--out", self.out))
        self.assertEqual(self.stats()["frames"], 3)


class Verify(FidelityTest):
    def verified(self, *options, frames, what="figure, time and pixel"):
        process = self.run_it(*options, "--verify")
        self.succeeds(process)
        text = f"verified: fast and cycle agree in every {what} of {frames}"
        self.assertEqual(process.stderr, f"stereotlm: note: {text}\n")

    def test_says_that_both_fidelities_agree(self):
        sequence = self.sequence(3)
        for source in SOURCES.values():
            for fidelity in ([], CYCLE):
                self.verified(*source, *fidelity, "--synthetic", "1", "--frames", "3", frames="3 frames")
            self.verified(*source, *self.pair, frames="1 frame")
            self.verified(*source, "--sequence", sequence, "--frames", "5", frames="5 frames")
            timing = [*source, "--timing-only", "--frames", "3"]
            self.verified(*timing, frames="3 frames", what="figure and time")
        frames = [noise(2 * WIDTH, HEIGHT, seed) for seed in range(3)]
        video = self.file("v.avi", avi(2 * WIDTH, HEIGHT, frames))
        self.verified(*CAMERA, "--video", video, "--video-layout", "side_by_side", frames="3 frames")

    def test_changes_no_result_and_is_named_in_run_json(self):
        options = [*CAMERA, "--synthetic", "1", "--frames", "2"]
        without = self.files_of(*options)
        self.assertTrue(self.files_of(*options, "--verify") == without)
        self.assertIs(self.run_json()["verify"], True)


class SecondRun(ProgramTest):
    """What becomes of the run at the other fidelity, which is a process of its own."""

    def start(self, *options):
        """A run with --verify at a terminal that has begun, and the process of its second run."""
        terminal = Terminal(self.run_arguments("--verify", *options, "--out", self.out))
        terminal.read_until(PROGRESS)
        return terminal, self.child_of(terminal)

    def child_of(self, terminal):
        (child,) = (pid for pid in descendants(terminal.process.pid)
                    if of_process(pid, "comm") == "stereotlm\n")
        return child

    def ends(self, child):
        wait_until(lambda: not os.path.exists(f"/proc/{child}"))

    def check_nothing_is_compared(self, terminal, child):
        """After an interrupt."""
        terminal.process.send_signal(signal.SIGINT)
        status, _ = terminal.finish()
        self.assertEqual(status, 130)
        self.assertIn("note: --verify: interrupted: nothing is compared", terminal.text)
        self.assertNotIn("verified", terminal.text)
        self.assertNotIn("failed", self.stats())
        self.assertNotIn("verify", self.run_json())
        self.ends(child)

    def test_an_interrupted_run_is_not_compared(self):
        self.check_nothing_is_compared(*self.start("--frames", "1000000000"))
        self.assertGreater(self.stats()["frames"], 0)

    def test_an_interrupted_second_run_is_not_compared(self):
        options = ["--verify", "--frames", "2", "--out", self.out]
        terminal = Terminal(["run", "fpl2003", *PRELOADED, *SLOW, *options])
        terminal.read_until("verifying: 0/2 frames")
        self.check_nothing_is_compared(terminal, self.child_of(terminal))
        self.assertEqual(self.stats()["frames"], 2)
        note = "stereotlm: note: --verify: interrupted: nothing is compared"
        self.assertEqual(terminal.shown(), [note, ""])

    @program.slow
    def test_the_progress_of_the_second_run_is_shown(self):
        terminal = Terminal(["run", "fpl2003", *PRELOADED, "--timing-only", "--frames", "6", "--verify"])
        terminal.read_until(r"verifying: [1-9]\d*/6 frames")
        status, out = terminal.finish()
        self.assertEqual(status, 0, terminal.text)
        self.assertIn("6 frames", out)
        text = "stereotlm: note: verified: fast and cycle agree in every figure and time of 6 frames"
        self.assertEqual(terminal.shown()[-2:], [text, ""])  # behind a note on long work
        self.assertNotIn("nan", terminal.text)

    @program.slow
    def test_a_killed_second_run_is_an_error(self):
        terminal, child = self.start(*CYCLE, "--frames", "2000")
        os.kill(child, signal.SIGKILL)
        status, _ = terminal.finish()
        self.assertEqual(status, 1)
        text = "--verify: the run at fidelity fast: the process was ended by signal 9 (Killed)"
        self.assertIn(f"error: {text}\n", terminal.text.replace("\r\n", "\n"))
        self.assertEqual(self.stats()["failed"], [text])
        self.assertIs(self.run_json()["verify"], True)


if __name__ == "__main__":
    program.main()
