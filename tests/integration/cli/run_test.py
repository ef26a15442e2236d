"""Runs: what they print and write, saved frames, the progress line, interrupts."""

import os
import re
import signal
import subprocess
import unittest

import program
from pictures import noise, pgm, ppm, read_pfm, read_png
from program import CYCLE, HEIGHT, PRELOADED, PROGRESS, RESULT_FILES, SMALL, WIDTH
from program import ProgramTest, Terminal, run, sets, wait_until

DISPARITY_FILES = ("disparity.png", "disparity.pfm", "disparity_color.png")
MOST = "18446744073709551615"


def frame_names(count):
    return [f"{frame:06}.png" for frame in range(count)]


class ResultFiles(ProgramTest):
    def test_all_files_are_there_and_agree(self):
        self.succeeds(self.run_small("--out", self.out, "--frames", "3", *sets("matcher.disparities=8")))
        self.is_in(self.out, *RESULT_FILES)
        width, height, channels, rows = read_png(self.out / "disparity.png")
        self.assertEqual((width, height, channels), (WIDTH, HEIGHT, 1))
        self.assertTrue(any(d != 255 for row in rows for d in row))
        self.assertTrue(all(d == 255 or d < 8 for row in rows for d in row))
        as_floats = [[float("inf") if d == 255 else float(d) for d in row] for row in rows]
        self.assertEqual(read_pfm(self.out / "disparity.pfm"), (WIDTH, HEIGHT, as_floats))
        width, height, channels, colours = read_png(self.out / "disparity_color.png")
        self.assertEqual((width, height, channels), (WIDTH, HEIGHT, 3))
        for row, colour_row in zip(rows, colours):
            for x, d in enumerate(row):
                self.assertEqual(colour_row[3 * x : 3 * x + 3] == bytes(3), d == 255)

    def test_the_same_run_gives_the_same_bytes(self):
        options = ["--out", self.out, "--truth", self.left, "--truth-scale", "4"]
        self.succeeds(self.run_small(*options))
        with self.unchanged(self.out):
            self.succeeds(self.run_small(*options))
        one = self.result()
        self.succeeds(self.run_small("--out", self.out, "--frames", "3"))
        for name in DISPARITY_FILES:
            self.assertEqual((self.out / name).read_bytes(), one[name])

    def test_config_loads_back(self):
        self.succeeds(self.run_small("--out", self.out, *sets("matcher.lr_tolerance=off")))
        config = self.out / "config.yaml"
        small = self.succeeds(run("check", "fpl2003", *SMALL, *sets("matcher.lr_tolerance=off")))
        self.assertEqual(self.succeeds(run("check", config)), small.replace("fpl2003", str(config)))
        self.assertIn("lr_tolerance: \"off\"", config.read_text())
        again = self.folder / "again"
        self.succeeds(run("run", config, *PRELOADED, *self.pair, "--out", again))
        self.assertEqual(self.result(again), self.result())

    def test_nothing_is_written_without_out(self):
        with self.unchanged(self.folder):
            self.succeeds(run(*self.run_arguments(), cwd=self.folder))

    def test_converts_colour_and_says_so(self):
        left = self.file("colour.ppm", ppm(WIDTH, HEIGHT, noise(3 * WIDTH, HEIGHT, 1)))
        process = self.run_small(left=left)
        self.succeeds(process)
        self.assertEqual(process.stderr, f"stereotlm: note: --left '{left}': colour, converted to grey\n")


class Records(ProgramTest):
    def test_are_of_the_first_60_frames_unless_all_or_none_are_wanted(self):
        options = ["--timing-only", "--frames", "61", "--out", self.out]
        rows = lambda: (self.out / "rows.csv").read_text().split()[1:]
        stats = []
        for more, frames in ((), 60), (["--record"], 61), (["--trace", f"perfetto:{self.folder / 't'}"], 61):
            self.succeeds(self.run_small(*options, *more))
            self.assertEqual(len({line.split(",")[0] for line in rows()}), frames, more)
            stats.append((self.out / "stats.json").read_bytes())
        self.succeeds(self.run_small(*options, "--no-record"))
        self.is_in(self.out, "config.yaml", "run.json", "stats.json")
        stats.append((self.out / "stats.json").read_bytes())
        self.assertEqual(len(set(stats)), 1)
        self.assertTrue(self.run_json()["no_record"])


class Output(ProgramTest):
    def test_a_closed_pipe_does_not_cost_the_results(self):
        read_end, write_end = os.pipe()
        os.close(read_end)
        process = self.start(*self.run_arguments("--out", self.out), stdout=write_end)
        os.close(write_end)
        self.ends(process, 0, out=None)
        self.is_in(self.out, *RESULT_FILES)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full here")
    def test_a_full_disk_behind_standard_output_is_an_error(self):
        with open("/dev/full", "w") as full:
            process = self.start("keys", stdout=full)
        self.ends(process, 1, out=None, errors="stereotlm: error: standard output: No space left on device\n")

    def test_closed_standard_streams_do_not_get_into_the_results(self):
        command = program.words(self.run_arguments("--out", self.out))
        shell = ["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh"]
        process = subprocess.run(shell + command, timeout=60, check=False)
        self.assertEqual(process.returncode, 1, "the table cannot be printed")
        with self.unchanged(self.out):
            self.succeeds(self.run_small("--out", self.out))


class SavingInterrupted(ProgramTest):
    """A run of many frames that has saved some aside."""

    def begin(self, *source):
        command = ["run", "fpl2003", *SMALL, *PRELOADED, *source, "--save-frames", "--out", self.out]
        process = self.start(*command)
        some = self.out / ".partial" / "new" / "frames" / "000010.png"
        wait_until(lambda: some.exists() or process.poll() is not None)
        return process

    def interrupt(self, process):
        """What it says."""
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        return errors

    def test_an_interrupt_keeps_the_frames_that_are_finished(self):
        self.succeeds(self.run_small("--frames", "2", "--save-frames", "--out", self.out))
        earlier = self.result()
        process = self.begin(*self.pair, "--frames", "1000000000")
        now = self.result()
        self.assertEqual({name: now.get(name) for name in earlier}, earlier)  # until the run ends
        done = int(re.search(r"interrupted after (\d+) of", self.interrupt(process))[1])
        self.is_in(self.out / "frames", *frame_names(done))
        self.assertEqual(self.stats()["frames"], done)
        with self.unchanged(self.out):
            self.succeeds(self.run_small("--frames", done, "--save-frames", "--out", self.out))


class ProgressLine(ProgramTest):
    def start_slow(self, **options):
        """At a terminal, a run of a thousand frames that takes a while."""
        return Terminal(self.run_arguments(*CYCLE, "--frames", "1000"), **options)

    @program.slow
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
        self.assertEqual(terminal.shown()[-1], "")

    @program.slow
    def test_fits_into_a_narrow_terminal_and_outlives_a_signal_that_the_caller_ignores(self):
        ignore = lambda: signal.signal(signal.SIGINT, signal.SIG_IGN)
        terminal = self.start_slow(columns=20, preexec_fn=ignore)
        status, out = terminal.interrupt(r"/1000 fra", signal.SIGINT)
        parts = [part for part in terminal.text.split("\r") if "note: " not in part]
        self.assertLess(max(map(len, parts)), 20)
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

    def test_the_table_is_printed_without_out_too(self):
        self.assertIn("waits", self.interrupt(number=signal.SIGTERM)[1])

    def test_an_interrupt_in_the_first_frame_leaves_the_earlier_result(self):
        self.succeeds(self.run_small("--out", self.out))
        size = 2048
        big = self.file("big.pgm", pgm(size, size, bytes(size * size)))
        board = sets(f"image.width={size}", f"image.height={size}", "matcher.window=31",
                     "ssram.default.words=4194304")
        with self.unchanged(self.out):
            pair = ["--left", big, "--right", big]
            terminal = Terminal(["run", "fpl2003", *PRELOADED, *CYCLE, *pair, *board, "--no-record", "--out",
                                 self.out])
            self.assertEqual(terminal.interrupt(PROGRESS, signal.SIGINT), (130, ""))
            self.assertIn("interrupted after 0 of 1 frames: there is no result", terminal.text)


if __name__ == "__main__":
    program.main()
