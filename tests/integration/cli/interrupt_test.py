"""The progress line, and runs that are interrupted."""

import signal

import program
from pictures import pgm
from program import CYCLE, PRELOADED, RESULT_FILES, ProgramTest, sets
from terminal import PROGRESS, Terminal

MOST = "18446744073709551615"


class ProgressLine(ProgramTest):
    def start_slow(self, **options):
        """At a terminal, a run of a thousand frames that takes a while."""
        return Terminal(self.run_arguments(*CYCLE, "--frames", "1000"), **options)

    def test_shows_rate_and_remaining_time_and_is_erased(self):
        terminal = self.start_slow()
        done, total, percent, _, rate, left = terminal.read_until(PROGRESS)[0]
        status, out = terminal.finish()
        self.assertEqual(status, 0, terminal.text)
        self.assertIn("1000 frames", out)
        self.assertEqual(total, "1000")
        self.assertAlmostEqual(float(percent), float(done) / 10, delta=0.1)
        self.assertGreater(float(rate), 0)
        self.assertRegex(left, r"^\d+:\d\d$")
        self.assertEqual(terminal.shown(), [""])

    def test_fits_into_a_narrow_terminal_where_a_signal_that_the_caller_ignores_changes_nothing(self):
        ignore = lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)
        terminal = self.start_slow(columns=20, preexec_fn=ignore)
        status, out = terminal.interrupt(r"/1000 fra", signal.SIGINT)
        self.assertLess(max(len(part) for part in terminal.text.split("\r")), 20)
        self.assertEqual(status, 0)
        self.assertIn("1000 frames", out)

    def test_is_not_there_without_a_terminal(self):
        process = self.run_small("--frames", "1000")
        self.assertEqual((process.returncode, process.stderr), (0, ""))


class Interrupted(ProgramTest):
    def interrupt(self, *arguments, number=signal.SIGINT):
        """An endless run that this signal ends: the terminal, and the table that it prints."""
        terminal = Terminal(self.run_arguments("--frames", MOST, *arguments))
        status, out = terminal.interrupt(PROGRESS, number)
        self.assertEqual(status, 130)
        return terminal, out

    def test_has_the_result_of_a_whole_run_of_the_frames_that_were_finished(self):
        terminal, out = self.interrupt("--out", self.out)
        self.is_in(self.out, *RESULT_FILES)
        stats = self.stats()
        frames = stats["frames"]
        self.assertGreater(frames, 0)
        self.assertEqual(len(stats["frame_cycles"]), frames)
        self.assertNotIn("failed", stats)
        self.assertIn(f"{frames} frame", out)
        note = f"stereotlm: note: interrupted after {frames} of {MOST} frames"
        self.assertIn(note, terminal.shown()[0])
        whole = self.folder / "whole"
        self.succeeds(self.run_small("--out", whole, "--frames", frames))
        self.assertTrue(self.result() == self.result(whole))

    def test_prints_the_table_without_out_too(self):
        self.assertIn("worst stall", self.interrupt(number=signal.SIGTERM)[1])

    def test_before_the_first_frame_is_finished_leaves_the_earlier_result(self):
        self.succeeds(self.run_small("--out", self.out))
        size = 2048
        big = self.file("big.pgm", pgm(size, size, bytes(size * size)))
        board = sets(f"image.width={size}", f"image.height={size}", "matcher.window=31",
                     "ssram.default.words=4194304")
        with self.unchanged(self.out):
            pair = ["--left", big, "--right", big]
            terminal = Terminal(["run", "fpl2003", *PRELOADED, *CYCLE, *pair, *board, "--out", self.out])
            self.assertEqual(terminal.interrupt(PROGRESS, signal.SIGINT), (130, ""))
            self.assertIn("interrupted after 0 of 1 frames: there is no result", terminal.text)


if __name__ == "__main__":
    program.main()
