"""plot: what is refused, and what an earlier, a failed, an interrupted or a killed run leaves."""

import os
import pathlib
import re
import shutil
import signal
import subprocess

import program
from plots import ALLOCATIONS, LAYOUT, WINDOWS
from plots import PlotTest, change, make_database, reader, script, script_with
from program import run, wait_until

HEADER = "name run.source matcher.window matcher.fetch frames_per_second.core bound.core pci.clocks".split()
FOLDER = "must be empty or hold only files that plot has written: move it away, or give another folder"
# As an earlier run has written it: what is in the picture is not looked at.
DRAWN = b"\x89PNG" + bytes(29) + b"\0\0\0\x12tEXtSoftware\0stereotlm"
DRAWN_SVG = "\n    <dc:creator>\n     <cc:Agent>\n      <dc:title>stereotlm</dc:title>\n"
ALL = "plot_all.py"


class Earlier(PlotTest):
    """Files that are in the folder."""

    def begin(self, **earlier):
        """A process that draws all figures, once it has begun, over earlier figures with these tables."""
        store = self.sweep(ALLOCATIONS)
        for name, text in earlier.items():
            self.file(f"out/{name}.png", DRAWN)
            self.file(f"out/{name}.csv", text)
        process = self.start("plot", store, "--out", self.out)
        wait_until((self.out / ".partial" / "new").exists)
        return process

    def test_earlier_files_stay_when_new_ones_cannot_be_moved_into_place(self):
        process = self.begin(banks="a", states="b", window="c")
        self.file("out/use.png", "mine")
        problem = "the new files cannot be moved into place: use.png: File exists"
        self.ends(process, 1, errors=f"stereotlm: error: --out '{self.out}': {problem}\n")
        texts = {"banks": b"a", "states": b"b", "window": b"c"}
        files = {name + ending: data for name, text in texts.items() for ending, data in ((".png", DRAWN),
                                                                                          (".csv", text))}
        self.assertEqual(self.result(), {**files, "use.png": b"mine"})
        self.is_in(self.out, *files, "use.png")

    def test_earlier_files_stay_when_it_is_interrupted(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.begin(banks="earlier")
            process.send_signal(number)
            self.ends(process, 130, errors="stereotlm: note: interrupted: nothing was written\n")
            self.assertEqual(self.result(), {"banks.png": DRAWN, "banks.csv": b"earlier"})
            self.is_in(self.out, "banks.png", "banks.csv")

    def test_what_a_killed_process_has_moved_away_is_put_back_and_replaced(self):
        self.file("out/.partial/new/window.png", DRAWN)
        self.file("out/.partial/earlier/window.png", DRAWN)
        self.file("out/window.csv")
        with self.unchanged(self.folder):
            self.refused(run("plot", self.folder / "none.db", "--out", self.out / "window.csv"))
        self.succeeds(run("plot", self.sweep(WINDOWS), "--out", self.out))
        self.assertFalse((self.out / ".partial").exists())
        self.assertGreater((self.out / "window.csv").stat().st_size, 0)


class Refusals(PlotTest):
    def setUp(self):
        super().setUp()
        rows = [("made", "preloaded", window, kind, 90 / window, 90 / window, None)
                for window, kind in ((3, "column"), (5, "line_buffer"))]
        self.store = make_database(self.folder / "made.db", HEADER, rows)

    def refused_plot(self, store, *options):
        """The lines, without what stands before each."""
        lines = self.refused(script(ALL, store, "--out", self.out, *options))
        self.assertFalse(self.out.exists())
        return [line.removeprefix("stereotlm: error: ") for line in lines]

    def test_wrong_command_lines_are_refused_at_once(self):
        axes = "must be two columns, each with min or max: area.slices:min,frames_per_second.core:max"
        lines = self.refused(run("plot", "--pareto", "a:max", "--only", "b"))
        self.assertEqual([line.removeprefix("stereotlm: error: ") for line in lines], [
            "DB: missing: a database of stereotlm sweep",
            f"--pareto = a:max: {axes}",
            "--out: missing: the folder of the figures",
        ])
        window = "matcher.window:max"
        for wrong in ("matcher.window", window, "matcher.window:least,bound.core:max",
                      f"{window},matcher.window:min", f"{window},bound.core:max,run.source:min"):
            process = run("plot", self.store, "--out", self.out, "--pareto", wrong)
            self.refused_in_one_line(process, f"--pareto = {wrong}: must be two columns")

    def test_formats_and_sizes_that_cannot_be_are_refused(self):
        kinds = "must be png, svg, pdf, or several with commas"
        size = "must be WIDTHxHEIGHT in inches, each 2 to 40, such as 7.2x4.5"
        for wrong in ("", "jpg", "PDF", "png,", "svg,png,svg"):
            self.assertEqual(self.refused_plot(self.store, "--format", wrong),
                             [f"--format = {wrong}: {kinds}"])
        for wrong in ("", "7", "7x", "7x4x2", "1.9x5", "5x1.9", "40.1x5", "5x40.1", "-7x5", "7 x 5", "1e1x5",
                      "nanx5"):
            self.assertEqual(self.refused_plot(self.store, f"--size={wrong}"), [f"--size = {wrong}: {size}"])
        lines = self.refused(run("plot", self.store, "--out", self.out, "--format", "x", "--size", "y"))
        self.assertEqual(lines,
                         [f"stereotlm: error: --format = x: {kinds}",
                          f"stereotlm: error: --size = y: {size}"])

    def test_figures_for_which_the_size_is_too_small_are_not_drawn(self):
        """The size that is asked for instead is the least that is enough."""
        needs = re.compile(r"window not drawn: --size 4x2: so wide, this figure needs a height of (\d+\.\d) "
                           r"inches$")
        (line,) = self.refused(script("plot_window.py", self.store, "--out", self.out, "--size", "4x2"))
        least = float(needs.search(line)[1])
        self.refused(script("plot_window.py", self.store, "--out", self.out, "--size",
                            f"4x{least - 0.1:.1f}"))
        self.succeeds(script("plot_window.py", self.store, "--out", self.out, "--size", f"4x{least:.1f}"))

    @program.slow
    def test_unknown_keys_and_columns_are_refused_with_the_nearest(self):
        only = ("matcher.widow=3", "matcher.fetch=row", "frames_per_second.core=3")
        options = [word for each in only for word in ("--only", each)]
        axes = "frames_per_sec.core:max,matcher.fetch:min"
        self.assertEqual(self.refused_plot(self.store, *options, "--pareto", axes), [
            "--only = matcher.widow=3: unknown key matcher.widow; nearest: matcher.window, matcher.fetch",
            "--only = matcher.fetch=row: no point has that value; there are: column, line_buffer",
            "--only = frames_per_second.core=3: unknown key frames_per_second.core",
            f"--pareto = {axes}: unknown column frames_per_sec.core; nearest: frames_per_second.core",
            f"--pareto = {axes}: point {0:064}: matcher.fetch = column: {reader.NUMBER}",
        ])
        both = ("matcher.window=3", "matcher.fetch=line_buffer")
        lines = self.refused_plot(self.store, *(word for each in both for word in ("--only", each)))
        self.assertEqual(lines, [f"--only {' '.join(both)}: no point with figures has all these values"])
        axes = "pci.clocks:min,matcher.window:min"
        lines = self.refused_plot(self.store, "--pareto", axes)
        self.assertEqual(lines, [f"--pareto = {axes}: column pci.clocks is empty"])

    @program.slow
    def test_databases_without_points_of_a_sweep_are_refused(self):
        none, foreign = self.folder / "none.db", self.folder / "foreign.db"
        change(foreign, "CREATE TABLE points(a)")
        early = make_database(self.folder / "early.db", HEADER, [])
        change(early, "PRAGMA user_version = 1")
        empty = make_database(self.folder / "empty.db", ["name"], [])
        failed = shutil.copy(empty, self.folder / "failed.db")
        change(failed, "INSERT INTO points VALUES('0', 'failed', 'why', '0.1.0', '', 'a')")
        for path, reason in (
            (none, "cannot be opened: No such file or directory"),
            (self.folder, "cannot be opened: Is a directory"),
            (self.left, "not a database"),
            (foreign, "not a database of stereotlm sweep"),
            (early, f"its layout is 1, of another version; this version reads {LAYOUT}"),
            (empty, "no point to draw: it is empty"),
            (failed, "no point to draw: 1 failed"),
        ):
            self.assertEqual(self.refused_plot(path), [f"{path}: {reason}"])

    @program.slow
    def test_folders_with_files_of_others_are_refused(self):
        def file(path):
            path.write_text("mine")

        def link(path):
            path.symlink_to(self.left)

        folder = pathlib.Path.mkdir
        for make, name in (*((file, name) for name in ("notes.txt", "window.csv", "use.png", "use.svg",
                                                       "use.pdf")),
                           (file, "window.ps"), (folder, "frames"), (folder, "window.png"),
                           (link, "window.png")):
            given = self.folder / "given"
            given.mkdir()
            make(given / name)
            self.refused_in_one_line(run("plot", self.store, "--out", given),
                                     f"--out '{given}': holds '{name}': {FOLDER}")
            self.refused_in_one_line(script("plot_window.py", self.store, "--out", given), "must be empty")
            self.is_in(given, name)
            shutil.rmtree(given)
        database = shutil.copy(self.store, self.folder / "given.csv")
        self.file("given/window.png", DRAWN)
        os.link(database, self.folder / "given" / "window.csv")
        process = run("plot", self.folder / "given" / "window.csv", "--out", self.folder / "given")
        self.refused_in_one_line(process, "lies in it and would be replaced")
        self.file("result/run.json", '{"schema": 1, "command": "run", "version": "0.1.0"}')
        self.refused_in_one_line(script("plot_window.py", self.store, "--out", self.folder / "result/new"),
                                 f"the result folder '{self.folder / 'result'}' of run holds nothing else")
        for out, problem in ((self.left, "not a folder"), ("/proc/none/out", "cannot be written to")):
            self.refused_in_one_line(run("plot", self.store, "--out", out), f"--out '{out}': {problem}")

    def test_pictures_of_each_format_are_known_by_what_plot_writes_into_them(self):
        store = self.sweep(WINDOWS)
        self.succeeds(run("plot", store, "--out", self.out, "--format", "pdf"))
        for name in ("window.svg", "use.svg"):
            self.file(f"out/{name}", DRAWN_SVG)
        self.succeeds(run("plot", store, "--out", self.out, "--format", "svg"))
        self.succeeds(run("plot", store, "--out", self.out, "--format", "png"))
        self.assertFalse(list(self.out.glob("*.svg")))

    def test_figures_that_do_not_apply_are_refused(self):
        process = script("plot_disparities.py", self.store, "--out", self.out)
        reason = "disparities not drawn: all points have matcher.disparities = absent"
        self.refused_in_one_line(process, f"plot_disparities.py: error: {reason}")
        process = script("plot_window.py", self.store, "--out", self.out, "--pareto", "a")
        reason = "unrecognized arguments: --pareto a (see plot_window.py --help)"
        self.refused_in_one_line(process, f"plot_window.py: error: {reason}")
        self.assertFalse(self.out.exists())

    def test_missing_matplotlib_and_scripts_are_named(self):
        for error, text in (("ImportError", "needs matplotlib, which ./setup tests installs"),
                            ("ValueError", "matplotlib cannot be loaded")):
            self.file("matplotlib.py", f"raise {error}('no such thing')\n")
            process = script_with(ALL, self.store, "--out", self.out, PYTHONPATH=str(self.folder))
            self.refused_in_one_line(process, f"stereotlm: error: {text}: no such thing")
        (self.folder / "bin").mkdir()
        alone = shutil.copy(program.PROGRAM, self.folder / "bin" / "stereotlm")
        command = [alone, "plot", self.store, "--out", self.out]
        process = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        self.refused_in_one_line(process, f"'{self.folder}/share/stereotlm/plots/{ALL}': not found")


class Environment(PlotTest):
    @program.slow
    def test_variables_of_python_have_no_effect(self):
        store = self.sweep(WINDOWS)
        self.file("matplotlib.py", "raise ImportError('another one')\n")
        self.succeeds(run("plot", store, "--out", self.out))
        with self.unchanged(self.out):
            for variables in ({"PYTHONPATH": str(self.folder), "MPLBACKEND": "nonsense",
                               "PYTHONSAFEPATH": "1"},
                              {"PYTHONHOME": str(self.folder), "PYTHONOPTIMIZE": "2"}):
                process = run("plot", store, "--quiet", "--out", self.out, env={**os.environ, **variables})
                self.assertEqual((process.returncode, process.stderr), (0, ""), variables)
        self.out = self.folder / "alone"
        self.succeeds(script_with("plot_window.py", store, "--out", self.out, MPLBACKEND="nonsense"))


if __name__ == "__main__":
    program.main()
