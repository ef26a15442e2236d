"""run --trace: what the files hold, and what is refused."""

import contextlib
import os
import re
import signal
import sqlite3

import program
from program import CAMERA_RATES, PRELOADED, PROGRESS, SMALL, ProgramTest, Terminal, run, sets

CONTENDED = sets("allocation.left_lut=bank0", "allocation.left_image=[bank0, bank0]")
TIMING = ["--timing-only", *CONTENDED]


def trace(*formats):
    """The options that write these traces into the working folder."""
    return [word for form in formats for word in ("--trace", f"{form}:run.{form}")]


class TraceTest(ProgramTest):
    def traced(self, *more, source=(*PRELOADED,), board="fpl2003"):
        """The output of a small run that has written traces into self.folder."""
        return self.succeeds(run("run", board, *SMALL, *source, *TIMING, *more, cwd=self.folder))

    def rows_of(self, query, name="run.sqlite"):
        with contextlib.closing(sqlite3.connect(self.folder / name)) as connection:
            return connection.execute(query).fetchall()


class Files(TraceTest):
    def test_are_written_together_and_change_no_figure(self):
        plain = self.traced("--frames", 3)
        self.assertEqual(self.traced("--frames", 3, *trace("perfetto", "sqlite", "vcd"), "--trace-window",
                                     "frame=1,rows=3..4"), plain)
        self.is_in(self.folder, "left.pgm", "right.pgm", "run.gtkw", "run.perfetto", "run.sqlite", "run.vcd")

    def test_of_a_computer_have_its_buses_and_events(self):
        self.traced("--frames", 3, *trace("sqlite"), "--trace-window", "cycles=0..100000", "--out", self.out,
                    source=CAMERA_RATES)
        self.assertEqual({bus for bus, in self.rows_of("SELECT DISTINCT bus FROM bursts")}, {"pci", "local"})
        kinds = {kind for kind, in self.rows_of("SELECT DISTINCT kind FROM events")}
        self.assertLessEqual({"capture", "upload", "read_back", "frame", "interrupt", "wait"}, kinds)

    def times(self, name="run.vcd"):
        return [int(line[1:])
                for line in (self.folder / name).read_text().splitlines() if line.startswith("#")]

    def test_of_a_window_are_waveforms_of_all_of_it(self):
        tiny = [*sets("image.width=16", "image.height=6", "matcher.window=3", "matcher.disparities=4"),
                *PRELOADED,
                "--timing-only", "--frames", 3, *trace("vcd"), "--trace-window"]
        for first, last in ((740, 800), (5000, 5100)):  # the second one is behind the run
            self.succeeds(run("run", "fpl2003", *tiny, f"cycles={first}..{last}", cwd=self.folder))
            times = self.times()
            self.assertEqual((times[0], times[-1]), (first * 25000, (last + 1) * 25000))

    def test_of_a_window_in_which_nothing_happens_say_so(self):
        process = run("run", "fpl2003", *SMALL, *PRELOADED, *TIMING, *trace("sqlite"), "--trace-window",
                      "frame=0,cycles=999999..1000000", cwd=self.folder)
        self.assertIn("note: --trace-window: has no cycle in which a frame ran", process.stderr)
        self.assertEqual(self.rows_of("SELECT count(*) FROM transactions"), [(0,)])
        process = run("run", "fpl2003", *SMALL, *PRELOADED, "--timing-only", *trace("vcd"), "--trace-window",
                      "frame=0,longest-wait", cwd=self.folder)
        self.assertIn("note: --trace-window: no port waits in it", process.stderr)
        self.assertEqual(self.times(), [0])

    def test_of_an_interrupted_run_are_those_of_the_finished_frames(self):
        command = ["run", "fpl2003", *SMALL, *PRELOADED, *TIMING, "--frames", 10**6, "--out", self.out,
                   "--trace",
                   f"sqlite:{self.folder / 'run.sqlite'}"]
        self.assertEqual(Terminal(command).interrupt(PROGRESS, signal.SIGINT)[0], 130)
        self.assertEqual(self.rows_of("SELECT count(DISTINCT frame) FROM runs"), [(self.stats()["frames"],)])

    def test_of_a_window_have_only_the_rows_of_its_frames(self):
        for window, frames in (("frame=1", [(1,)]), ("frame=2,rows=0..0", [(2,)]), ("cycles=0..0", [(0,)]),
                               ("cycles=0..9999999", [(0,), (1,), (2,)])):
            self.traced("--frames", 3, *trace("sqlite", "perfetto"), "--trace-window", window)
            self.assertEqual(self.rows_of("SELECT DISTINCT frame FROM runs"), frames)
            slices = (self.folder / "run.perfetto").read_bytes()
            self.assertEqual([(frame,) for frame in range(3) if b"frame %d" % frame in slices], frames)


class Sizes(TraceTest):
    def test_that_are_large_are_said_before_the_run(self):
        many, rows, cycles = 10**7, ("perfetto", "sqlite"), ("perfetto", "vcd", "sqlite")
        for source, frames, formats, real, window in (
                (PRELOADED, 64, rows, [], []), (CAMERA_RATES, 64, rows, [], []),
                *((source, 1, cycles, ["--trace-window", "frame=0"],
                   ["--trace-window", f"cycles=0..{10**15}"]) for source in (PRELOADED, CAMERA_RATES))):
            process = self.start("run", "fpl2003", *SMALL, *TIMING, *source, *window, "--frames", many,
                                 *trace(*formats), cwd=self.folder)
            notes = [process.stderr.readline() for _ in formats]
            self.close(process)
            self.traced(*trace(*formats), *real, "--frames", frames, source=source)
            for form, note in zip(formats, notes, strict=True):
                said = re.fullmatch(rf"stereotlm: note: --trace '{form}:run.{form}': will take about (\d+) "
                                    "MB: fewer --frames, or a short --trace-window such as "
                                    "frame=F,rows=A..B, make it smaller\n", note)
                size = (self.folder / f"run.{form}").stat().st_size * many / frames
                self.assertLess(abs(int(said[1]) * 1e6 / size - 1), 0.3, (form, source, frames))

    def test_that_are_not_known_let_the_run_begin(self):
        arguments = self.run_arguments("--trace", f"sqlite:{self.folder / 'run.sqlite'}")
        process = run(*arguments, env={**os.environ, "TMPDIR": "/none"})
        self.assertIn("note: --trace: the size of the traces is not known: ", process.stderr)
        self.assertEqual(process.returncode, 0)


class Refusals(TraceTest):
    def test_of_wrong_options_name_the_rule(self):
        base = ["run", "fpl2003", *SMALL, *PRELOADED, *TIMING]
        a_file = f"perfetto:{self.folder / 'a'}"
        window = ["--trace", a_file, "--trace-window"]
        forms = "must be frame=F, frame=F,rows=A..B, frame=F,cycles=A..B or cycles=A..B"
        self.all_refused([
            ([*base, "--trace", "ftr:a"],
             "--trace 'ftr:a': must be FORMAT:FILE, where FORMAT is perfetto, vcd or sqlite"),
            ([*base, "--trace", "vcd"], "--trace 'vcd': must be FORMAT:FILE"),
            ([*base, "--trace", "vcd:"], "--trace 'vcd:': must be FORMAT:FILE"),
            ([*base, "--trace", "vcd:a"], "--trace 'vcd:a': needs --trace-window"),
            ([*base, "--trace", "vcd:a.gtkw", "--trace-window", "frame=0"],
             "'a.gtkw': must not end in .gtkw"),
            ([*base, "--trace", a_file, "--trace", f"sqlite:{self.folder}/./a"],
             "a' is the file of two traces: each needs its own"),
            ([*base, "--trace", "vcd:a.vcd", "--trace", "vcd:a.fst", "--trace-window", "frame=0"],
             "a.gtkw' is the file of two traces"),
            ([*base, "--trace-window", "frame=0"], "--trace-window: goes with --trace FORMAT:FILE"),
            *(([*base, *window, text], f"--trace-window = '{text}': {forms}")
              for text in ("3", "frame=", "frame=-1", "rows=1..2", "frame=0,rows=2..1", "frame=0,rows=1",
                           "cycles=1..x", "frame=0,frame=0", "frame=0,rows=1..2,cycles=1..2", "lines=1..2",
                           "longest-wait", "longest-wait,frame=0", "frame=0,longest-wait,rows=1..2",
                           "frame=0,longest-wait=1", "frame=0,longest-wait,longest-wait")),
            ([*base, *window, "frame=1"], "frame 1: must be below the frames of the run, 1"),
            ([*base, *window, "frame=0,rows=0..24"], "row 24: must be below the rows of the image, 24"),
            ([*base, "--trace", f"sqlite:{self.folder}/none/a"], "none/a': there is no such folder"),
            ([*base, "--trace", f"perfetto:{self.folder}"], f"'{self.folder}': is no file"),
        ])

    def test_keep_inputs_and_results(self):
        self.refused_in_one_line(self.run_small("--trace", f"perfetto:{self.left}"),
                                 f"--trace '{self.left}': exists, and is not known as a Perfetto trace")
        self.refused_in_one_line(self.run_small("--out", self.out, "--trace", f"perfetto:{self.out / 'a'}"),
                                 "must lie outside the folder of --out")
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    program.main()
