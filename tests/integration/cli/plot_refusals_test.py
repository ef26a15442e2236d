"""plot: what is refused, and what an earlier or an interrupted run leaves."""

import os
import pathlib
import shutil
import signal
import subprocess

import program
from pictures import PYTHON
from plots import ALLOCATIONS, WINDOWS, PlotTest, change, figures, make_database
from program import run, wait_until

HEADER = "name run.source matcher.window matcher.fetch frames_per_second.core bound.core pci.clocks".split()
FOLDER = "must be empty or hold only files that plot has written: move it away, or give another folder"
# As an earlier run has written it: what is in the picture is not looked at.
DRAWN = b"\x89PNG" + bytes(29) + b"\0\0\0\x12tEXtSoftware\0stereotlm"
DRAWN_SVG = "\n    <dc:creator>\n     <cc:Agent>\n      <dc:title>stereotlm</dc:title>\n"
SCRIPT = figures.__file__


class Refusals(PlotTest):
    def setUp(self):
        super().setUp()
        rows = [("made", "preloaded", window, kind, 90 / window, 90 / window, None)
                for window, kind in ((3, "column"), (5, "line_buffer"))]
        self.store = make_database(self.folder / "made.db", HEADER, rows)

    def refused_plot(self, store, *options):
        """The lines, without what stands before each."""
        lines = self.refused(run("plot", store, "--out", self.out, *options))
        self.assertFalse(self.out.exists())
        return [line.removeprefix("stereotlm: error: ") for line in lines]

    def test_all_problems_are_named_at_once(self):
        axes = ("must be two or three columns, each with min or max: "
                "area.slices:min,frames_per_second.core:max")
        only = ("matcher.widow=3", "matcher.fetch=row", "frames_per_second.core=3", "b")
        options = [word for each in only for word in ("--only", each)]
        self.assertEqual(
            self.refused_plot(self.store, *options, "--pareto", "a:max", "--format", "jpg", "--size", "7"), [
                "--only = matcher.widow=3: unknown key matcher.widow; nearest: matcher.window, matcher.fetch",
                "--only = matcher.fetch=row: no point has that value; there are: column, line_buffer",
                "--only = frames_per_second.core=3: unknown key frames_per_second.core",
                "--only = b: must be KEY=VALUE",
                f"--pareto = a:max: {axes}",
                "--format = jpg: must be png, svg, pdf, or several with commas",
                "--size = 7: must be WIDTHxHEIGHT in inches, each 2 to 40, such as 7.2x4.5",
            ])
        self.assertEqual(len(self.refused(run("plot"), "DB: missing", "--out: missing")), 2)
        both = ("matcher.window=3", "matcher.fetch=line_buffer")
        self.assertEqual(self.refused_plot(self.store, *(word for each in both for word in ("--only", each))),
                         [f"--only {' '.join(both)}: no point with figures has all these values"])

    def test_wrong_values_of_options(self):
        for text in ("matcher.window", "a:least,b:max", "a:max,a:min", "a:max,b:min,a:max",
                     "a:max,b:max,c:max,d:max"):
            with self.assertRaisesRegex(figures.Unusable, "must be two or three columns"):
                figures.parsed_pareto(text)
        for text in ("", "PDF", "png,", "svg,png,svg"):
            with self.assertRaisesRegex(figures.Unusable, "must be png, svg, pdf"):
                figures.formats(text)
        for text in ("", "7x", "7x4x2", "1.9x5", "5x1.9", "40.1x5", "-7x5", "7 x 5", "1e1x5", "nanx5"):
            with self.assertRaisesRegex(figures.Unusable, "must be WIDTHxHEIGHT"):
                figures.size(text)

    def test_columns_that_cannot_be_drawn(self):
        axes = "frames_per_sec.core:max,matcher.fetch:min"
        self.assertEqual(self.refused_plot(self.store, "--pareto", axes), [
            f"--pareto = {axes}: unknown column frames_per_sec.core; nearest: frames_per_second.core",
            f"--pareto = {axes}: point {0:064}: matcher.fetch = column: must be a number",
        ])
        axes = "pci.clocks:min,matcher.window:min"
        self.assertEqual(self.refused_plot(self.store, "--pareto", axes),
                         [f"--pareto = {axes}: column pci.clocks is empty"])
        self.not_drawn("disparities", self.store, "all points have matcher.disparities = absent")
        self.not_drawn("window", self.store, "--size 2x2: too small for this figure", size=(2, 2))
        for value, text in (("'x'", "x"), ("9e999", "inf")):
            change(self.store, f'UPDATE points SET "bound.core" = {value} WHERE "matcher.window" = 5')
            self.not_drawn("window", self.store, f"point {1:064}: bound.core = {text}: must be a number")

    def test_databases_without_points_of_a_sweep(self):
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
            (early, f"its layout is 1, of another version; this version reads {figures.LAYOUT}"),
            (empty, "no point to draw: it is empty"),
            (failed, "no point to draw: 1 failed"),
        ):
            with self.assertRaises(figures.Unusable) as caught:
                figures.Points(path)
            self.assertEqual(str(caught.exception), f"{path}: {reason}")

    def test_missing_matplotlib_and_script_are_named(self):
        for error, text in (("ImportError", "needs matplotlib and pandas, which ./setup tests installs"),
                            ("ValueError", "matplotlib cannot be loaded")):
            self.file("matplotlib.py", f"raise {error}('no such thing')\n")
            process = subprocess.run([PYTHON, "-B", SCRIPT, self.store, "--out", self.out], text=True,
                                     capture_output=True, timeout=60, check=False,
                                     env={**os.environ, "PYTHONPATH": str(self.folder)})
            self.refused_in_one_line(process, f"stereotlm: error: {text}: no such thing")
        # Variables of Python do not reach the script of the program.
        variables = {"PYTHONPATH": str(self.folder), "MPLBACKEND": "nonsense", "PYTHONHOME": str(self.folder)}
        self.succeeds(run("plot", self.store, "--out", self.out, env={**os.environ, **variables}))
        (self.folder / "bin").mkdir()
        alone = shutil.copy(program.PROGRAM, self.folder / "bin" / "stereotlm")
        process = subprocess.run([alone, "plot", self.store, "--out", self.folder / "new"], text=True,
                                 capture_output=True, timeout=60, check=False)
        self.refused_in_one_line(process, f"'{self.folder}/share/stereotlm/plots/figures.py': not found")


class Folder(PlotTest):
    def test_earlier_files_stay_when_it_is_interrupted(self):
        store = self.sweep(ALLOCATIONS)
        self.file("out/banks.png", DRAWN)
        self.file("out/banks.csv", "earlier")
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start("plot", store, "--out", self.out)
            wait_until((self.out / ".partial" / "new").exists)
            process.send_signal(number)
            self.ends(process, 130, errors="stereotlm: note: interrupted: nothing was written\n")
            self.assertEqual(self.result(), {"banks.png": DRAWN, "banks.csv": b"earlier"})

    @program.slow
    def test_folders_with_files_of_others_are_refused(self):
        def file(path):
            path.write_text("mine")

        def link(path):
            path.symlink_to(self.left)

        store = self.sweep(WINDOWS)
        for make, name in (*((file, name) for name in ("notes.txt", "window.csv", "stalls.png", "stalls.svg",
                                                       "stalls.pdf", "window.ps")),
                           (pathlib.Path.mkdir, "frames"), (pathlib.Path.mkdir, "window.png"),
                           (link, "window.png")):
            given = self.folder / "given"
            given.mkdir()
            make(given / name)
            self.refused_in_one_line(run("plot", store, "--out", given),
                                     f"--out '{given}': holds '{name}': {FOLDER}")
            self.is_in(given, name)
            shutil.rmtree(given)
        database = shutil.copy(store, self.folder / "given.csv")
        self.file("given/window.png", DRAWN)
        os.link(database, self.folder / "given" / "window.csv")
        process = run("plot", self.folder / "given" / "window.csv", "--out", self.folder / "given")
        self.refused_in_one_line(process, "lies in it and would be replaced")
        for out, problem in ((self.left, "not a folder"), ("/proc/none/out", "cannot be written to")):
            self.refused_in_one_line(run("plot", store, "--out", out), f"--out '{out}': {problem}")

    def test_pictures_of_each_format_are_known_by_what_plot_writes_into_them(self):
        store = self.sweep(WINDOWS)
        self.succeeds(run("plot", store, "--out", self.out, "--format", "pdf"))
        for name in ("window.svg", "stalls.svg"):
            self.file(f"out/{name}", DRAWN_SVG)
        self.succeeds(run("plot", store, "--out", self.out, "--format", "svg"))
        self.succeeds(run("plot", store, "--out", self.out, "--format", "png"))
        self.assertFalse(list(self.out.glob("*.svg")))


if __name__ == "__main__":
    program.main()
