"""run --trace: what the files hold, and what is refused."""

import collections
import contextlib
import os
import re
import resource
import signal
import sqlite3

import program
from program import (CAMERA_RATES, CYCLE, PRELOADED, PROGRESS, SMALL, ProgramTest, Terminal, run, sets,
                     wait_until)

CONTENDED = sets("allocation.left_lut=bank0", "allocation.left_image=[bank0, bank0]")
TIMING = ["--timing-only", *CONTENDED]


def trace(*formats):
    """The options that write these traces into the working folder."""
    return [word for form in formats for word in ("--trace", f"{form}:run.{form}")]


class TraceTest(ProgramTest):
    def traced(self, *more, source=(*PRELOADED,), board="fpl2003"):
        """The output of a small run that has written traces into self.folder."""
        return self.succeeds(run("run", board, *SMALL, *source, *TIMING, *more, cwd=self.folder))

    @contextlib.contextmanager
    def database(self, name="run.sqlite"):
        with contextlib.closing(sqlite3.connect(self.folder / name)) as connection:
            yield connection

    def rows_of(self, query, name="run.sqlite"):
        with self.database(name) as connection:
            return connection.execute(query).fetchall()

    def changes(self, name="run.vcd"):
        """The signals of a VCD file, by their names: lists of (time, value)."""
        names, scopes, time, values = {}, [], None, collections.defaultdict(list)
        for line in (self.folder / name).read_text().splitlines():
            words = line.split()
            if words[:1] == ["$scope"]:
                scopes.append(words[2])
            elif words[:1] == ["$upscope"]:
                scopes.pop()
            elif words[:1] == ["$var"]:
                names[words[3]] = ".".join([*scopes, words[4]])
            elif line.startswith("#"):
                time = int(line[1:])
            elif time is not None and (change := re.fullmatch(r"(?:([01xz])|[bs](\S*) )(\S+)", line)):
                one, many, code = change.groups()
                values[names[code]].append((time, one if one is not None else many))
        return values


class Files(TraceTest):
    def test_are_written_together_and_change_no_figure(self):
        plain = self.traced("--frames", 3)
        self.assertEqual(self.traced("--frames", 3, *trace("perfetto", "sqlite", "vcd"), "--trace-window",
                                     "frame=1,rows=3..4"), plain)
        self.is_in(self.folder, "left.pgm", "right.pgm", "run.gtkw", "run.perfetto", "run.sqlite", "run.vcd")

    def test_replace_earlier_ones_as_a_whole(self):
        window = ["--trace-window", "frame=0,rows=3..4"]
        formats = ("perfetto", "sqlite", "vcd", "vcd:other.fst")
        options = [word for form in formats for word in ("--trace",
                                                         form if ":" in form else f"{form}:run.{form}")]
        self.traced(*options, *window, "--frames", 3)
        before = self.result(self.folder)
        self.traced(*options, *window)
        after = self.result(self.folder)
        for name in ("run.perfetto", "run.sqlite"):
            self.assertTrue(before[name] != after[name], name)
        self.assertEqual(self.rows_of("SELECT DISTINCT frame FROM runs"), [(0,)])

    def test_of_a_database_add_up_to_the_counters(self):
        self.traced("--frames", 3, *trace("sqlite"), "--out", self.out)
        stats = self.stats()
        grants = dict(self.rows_of("SELECT port, sum(count) FROM runs WHERE kind = 'grant' GROUP BY port"))
        self.assertEqual(grants, {port["name"]: port["grants"] for port in stats["ports"] if port["grants"]})
        waits = self.rows_of("SELECT port, bank, by, sum(count) FROM runs WHERE kind = 'wait' GROUP BY 1, 2, "
                             "3")
        self.assertGreater(len(waits), 0)
        self.assertEqual(sorted(waits), sorted((row["port"], row["bank"], row["by"], row["cycles"])
                                               for row in stats["blame"]))

    def test_of_a_window_of_a_whole_frame_have_each_state_of_each_port(self):
        self.traced(*trace("vcd"), "--trace-window", "frame=0", "--out", self.out)
        changes, stats = self.changes(), self.stats()
        period = 1e6 / 40  # ps
        for port in stats["ports"]:
            states = changes[f"{port['name']}.state"]
            cycles = collections.Counter()
            for (begin, state), (end, _) in zip(states, states[1:]):
                cycles[state] += (end - begin) / period
            for state, name in (("waits", "stall_cycles"), ("passes", "passed_cycles"),
                                ("blocked", "blocked_cycles"), ("starved", "starved_cycles")):
                self.assertEqual(cycles[state], port[name], (port["name"], state))
            self.assertEqual(cycles["reads"] + cycles["writes"], port["grants"], port["name"])

    def test_of_a_window_have_its_accesses(self):
        self.traced(*trace("sqlite", "vcd"), "--trace-window", "cycles=5000..5999")
        accesses = self.rows_of("SELECT cycle, port, address FROM transactions")
        self.assertGreater(len(accesses), 1000)
        self.assertTrue(all(5000 <= cycle <= 5999 for cycle, _, _ in accesses))
        addresses = {port: dict(self.changes()[f"{port}.address"])
                     for port in {port for _, port, _ in accesses}}
        for cycle, port, address in accesses:
            at = [value for time, value in addresses[port].items() if time <= cycle * 25000]
            self.assertEqual(int(at[-1], 2), address, (cycle, port))

    def test_are_the_same_at_each_fidelity(self):
        for source in (PRELOADED, CAMERA_RATES):
            for window in ("frame=1", "frame=1,rows=3..4", "frame=1,cycles=100..900", "cycles=90000..91000"):
                contents = []
                for fidelity in ([], CYCLE):
                    self.traced("--frames", 3, *trace("sqlite", "vcd"), "--trace-window", window, *fidelity,
                                source=source)
                    with self.database() as connection:
                        contents.append(([*connection.iterdump()], (self.folder / "run.vcd").read_text()))
                self.assertTrue(contents[0] == contents[1], (source, window))

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

    def test_around_the_longest_wait_have_sixty_cycles_and_the_marker(self):
        rows = "frame=0,rows=3..4"
        self.traced(*trace("sqlite"), "--trace-window", rows)
        (begin, waited), = self.rows_of(
            "SELECT cycle - waited, waited FROM transactions, (SELECT min(cycle) AS first FROM transactions) "
            "ORDER BY waited DESC, cycle - waited < first + 30, cycle LIMIT 1")
        self.traced(*trace("sqlite", "vcd"), "--trace-window", f"{rows},longest-wait")
        shown = begin - 30
        times = self.times()
        self.assertEqual((times[0], times[-1]), (shown * 25000, (shown + 60 + waited) * 25000))
        accesses = self.rows_of("SELECT min(cycle), max(cycle) FROM transactions")[0]
        self.assertLessEqual(shown, accesses[0])
        self.assertLess(accesses[1], shown + 60 + waited)
        layout = (self.folder / "run.gtkw").read_text()
        self.assertRegex(layout, rf"\n\*-[0-9.]+ {begin * 25000} -1")

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

    def test_of_a_killed_run_are_not_there(self):
        self.traced(*trace("sqlite"))
        earlier = (self.folder / "run.sqlite").read_bytes()
        process = self.start("run", "fpl2003", *SMALL, *PRELOADED, *TIMING, "--frames", 10**6,
                             *trace("perfetto", "sqlite"), cwd=self.folder)
        wait_until(lambda: len(os.listdir(self.folder)) > 4)
        process.kill()
        process.communicate()
        self.assertFalse((self.folder / "run.perfetto").exists())
        self.assertEqual((self.folder / "run.sqlite").read_bytes(), earlier)
        self.traced(*trace("perfetto", "sqlite"))  # removes what the killed run has left
        self.is_in(self.folder, "left.pgm", "right.pgm", "run.perfetto", "run.sqlite")

    def test_of_a_full_disk_are_not_there(self):
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
        for form in ("perfetto", "sqlite", "vcd"):
            process = run("run", "fpl2003", *SMALL, *PRELOADED, *TIMING, "--frames", 20, *trace(form),
                          "--trace-window", "frame=0", cwd=self.folder, preexec_fn=limit)
            self.assertIn(f"run.{form}", process.stderr)
            self.assertNotIn("model", process.stderr)
            self.fails(process)
            self.is_in(self.folder, "left.pgm", "right.pgm")


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
              for text in ("", "3", "frame=", "frame=-1", "rows=1..2", "frame=0,rows=2..1", "frame=0,rows=1",
                           "cycles=1..x", "frame=0,frame=0", "frame=0,rows=1..2,cycles=1..2", "lines=1..2",
                           "longest-wait", "longest-wait,frame=0", "frame=0,longest-wait,rows=1..2",
                           "frame=0,longest-wait=1", "frame=0,longest-wait,longest-wait")),
            ([*base, *window, "frame=1"], "frame 1: must be below the frames of the run, 1"),
            ([*base, *window, "frame=0,rows=0..24"], "row 24: must be below the rows of the image, 24"),
            ([*base, "--trace", f"sqlite:{self.folder}/none/a"], "none/a': there is no such folder"),
            ([*base, "--trace", f"perfetto:{self.folder}"], f"'{self.folder}': is no file"),
        ])

    def test_keep_files_that_are_no_traces(self):
        text = self.file("notes.md", "what I found")
        for form in ("perfetto", "sqlite", "vcd"):
            process = run("run", "fpl2003", *SMALL, *PRELOADED, *TIMING, "--trace", f"{form}:{text}",
                          "--trace-window",
                          "frame=0")
            self.refused_in_one_line(process, "notes.md': exists, and is not known as a ",
                                     "of stereotlm, which alone")
        self.assertEqual(text.read_text(), "what I found")
        self.traced(*trace("sqlite"))
        self.refused_in_one_line(run("run", "fpl2003", *SMALL, *PRELOADED, *TIMING, "--trace",
                                     "perfetto:run.sqlite",
                                     cwd=self.folder), "is not known as a Perfetto trace of stereotlm")

    def test_keep_inputs_and_results(self):
        self.refused_in_one_line(self.run_small("--trace", f"perfetto:{self.left}"),
                                 f"--trace '{self.left}': exists, and is not known as a Perfetto trace")
        self.refused_in_one_line(self.run_small("--out", self.out, "--trace", f"perfetto:{self.out / 'a'}"),
                                 "must lie outside the folder of --out")
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    program.main()
