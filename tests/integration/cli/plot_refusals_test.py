"""plot: what is refused, and what an earlier or a killed run has left."""

import os
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import time

import program
from plot_test import ALLOCATIONS, ENDINGS, LAYOUT, SMALL_BOARD, PlotTest, make_database, reader
from program import run


class Replaced(PlotTest):
    """The files of an earlier result."""

    def test_stay_when_a_new_one_cannot_be_moved_into_place(self):
        store = self.sweep(ALLOCATIONS)
        self.out.mkdir()
        earlier = {name: name.encode() for name in ("banks.csv", "banks.png", "states.svg", "window.csv")}
        for name, data in earlier.items():
            (self.out / name).write_bytes(data)
        process = subprocess.Popen([program.PROGRAM, "plot", str(store), "--out", str(self.out)], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + 60
        while not (self.out / ".partial" / "new").exists() and time.monotonic() < end:
            time.sleep(0.005)
        (self.out / "use.png").mkdir()
        out, errors = process.communicate(timeout=120)
        self.assertEqual((process.returncode, out), (1, ""))
        self.assertEqual(errors, f"stereotlm: error: --out {self.out}: the figures cannot be moved into place: Is a directory: "
                                 f"'{self.out}/use.png'\n")
        self.assertEqual(self.result(), earlier)
        self.assertEqual(sorted(os.listdir(self.out)), sorted([*earlier, "use.png"]))

    def test_what_a_killed_process_has_left_goes(self):
        store = self.sweep(SMALL_BOARD + "vary: {matcher.window: [3, 5]}\n")
        for name in ("new", "earlier"):
            (self.out / ".partial" / name).mkdir(parents=True)
            (self.out / ".partial" / name / "window.png").write_bytes(b"")
        self.succeeds(self.script("plot_window.py", store, "--out", self.out))
        self.assertEqual(sorted(os.listdir(self.out)), sorted("window" + ending for ending in ENDINGS))


class Refusals(PlotTest):
    def setUp(self):
        super().setUp()
        self.store = self.folder / "made.db"
        header = ["name", "run.source", "matcher.window", "matcher.fetch", "frames_per_second.core", "bound.core",
                  "pci.clocks"]
        make_database(self.store, header, [("made", "preloaded", window, kind, 90 / window, 90 / window, None)
                                           for window, kind in ((3, "column"), (5, "line_buffer"))])

    def refused_at(self, *arguments):
        lines = self.refused(run("plot", *arguments))
        self.assertFalse(self.out.exists())
        return [line.removeprefix("stereotlm: error: ") for line in lines]

    def test_of_everything_at_once(self):
        self.assertEqual(self.refused_at("--pareto", "a:max", "--only", "b"), [
            "DB: missing: a database of stereotlm sweep",
            "--pareto = a:max: must be two columns, each with min or max: area.slices:min,frames_per_second.core:max",
            "--out: missing: the folder of the figures",
        ])

    @program.slow
    def test_of_options_name_the_nearest(self):
        self.assertEqual(
            self.refused_at(self.store, "--out", self.out, "--only", "matcher.widow=3", "--only", "matcher.fetch=row",
                            "--only", "frames_per_second.core=3", "--pareto", "frames_per_sec.core:max,matcher.fetch:min"),
            ["--only = matcher.widow=3: unknown key matcher.widow; nearest: matcher.window, matcher.fetch",
             "--only = matcher.fetch=row: no point has that value; there are: column, line_buffer",
             "--only = frames_per_second.core=3: unknown key frames_per_second.core",
             "--pareto = frames_per_sec.core:max,matcher.fetch:min: unknown column frames_per_sec.core; nearest: "
             "frames_per_second.core",
             f"--pareto = frames_per_sec.core:max,matcher.fetch:min: point {0:064}: matcher.fetch = column: "
             + reader.NUMBER])
        self.assertEqual(
            self.refused_at(self.store, "--out", self.out, "--only", "matcher.window=3", "--only",
                            "matcher.fetch=line_buffer"),
            ["--only matcher.window=3 matcher.fetch=line_buffer: no point with figures has all these values"])
        self.assertEqual(self.refused_at(self.store, "--out", self.out, "--pareto", "pci.clocks:min,matcher.window:min"),
                         ["--pareto = pci.clocks:min,matcher.window:min: column pci.clocks is empty"])
        for wrong in ("matcher.window", "matcher.window:max", "matcher.window:least,bound.core:max", "",
                      "matcher.window:max,matcher.window:min", "matcher.window:max,bound.core:max,run.source:min"):
            (line,) = self.refused_at(self.store, "--out", self.out, "--pareto", wrong)
            self.assertIn(f"--pareto = {wrong}: must be two columns", line)

    @program.slow
    def test_of_databases(self):
        for path, reason in ((self.folder / "none.db", "cannot be opened: No such file or directory"),
                             (self.folder, "cannot be opened: Is a directory"), (self.left, "not a database")):
            self.assertEqual(self.refused_at(path, "--out", self.out), [f"{path}: {reason}"])
        other = self.folder / "other.db"
        connection = sqlite3.connect(other)
        connection.execute("CREATE TABLE points(a)")
        connection.commit()
        self.assertEqual(self.refused_at(other, "--out", self.out), [f"{other}: not a database of stereotlm sweep"])
        connection.execute(f"PRAGMA application_id = {0x53544C4D}")
        connection.execute("PRAGMA user_version = 1")
        connection.close()
        self.assertEqual(self.refused_at(other, "--out", self.out),
                         [f"{other}: its layout is 1, of another version; this version reads {LAYOUT}"])
        empty = self.folder / "empty.db"
        make_database(empty, ["name", "run.source"], [])
        self.assertEqual(self.refused_at(empty, "--out", self.out), [f"{empty}: no point to draw: it is empty"])
        make = sqlite3.connect(empty)
        make.execute("INSERT INTO points VALUES('0', 'failed', 'why', '0.1.0', '', 'a', 'preloaded')")
        make.commit()
        make.close()
        self.assertEqual(self.refused_at(empty, "--out", self.out), [f"{empty}: no point to draw: 1 failed"])

    @program.slow
    def test_of_folders_with_files_that_it_does_not_write(self):
        def file(path):
            path.write_text("mine")

        def link(path):
            path.symlink_to(self.left)

        for make, name in ((file, "notes.txt"), (file, "window.pdf"), (file, ".partial"), (pathlib.Path.mkdir, "window.png"),
                           (pathlib.Path.mkdir, "frames"), (link, "window.png"), (link, ".partial")):
            out = self.folder / "given"
            out.mkdir()
            make(out / name)
            self.refused_in_one_line(run("plot", self.store, "--out", out),
                                     f"--out {out}: holds '{name}': must be empty or hold only files that plot writes")
            self.assertEqual(os.listdir(out), [name])
            shutil.rmtree(out)
        (self.out / ".partial").mkdir(parents=True)
        (self.out / ".partial" / "mine").touch()
        self.refused_in_one_line(run("plot", self.store, "--out", self.out), f"--out {self.out}: holds '.partial/mine'")
        self.refused_in_one_line(run("plot", self.store, "--out", self.left), f"--out {self.left}: not a folder")
        self.refused_in_one_line(run("plot", self.store, "--out", "/proc/none/out"),
                                 "--out /proc/none/out: cannot be written to")

    def test_of_figures_that_do_not_apply(self):
        process = self.script("plot_disparities.py", self.store, "--out", self.out)
        self.refused_in_one_line(process, "plot_disparities.py: error: disparities not drawn: all points have "
                                          "matcher.disparities = absent")
        self.assertFalse(self.out.exists())
        self.refused_in_one_line(self.script("plot_window.py", self.store, "--out", self.out, "--pareto", "a"),
                                 "plot_window.py: error: unrecognized arguments: --pareto a (see plot_window.py --help)")

    def test_without_matplotlib(self):
        self.file("matplotlib.py", b"raise ImportError('not there')\n")
        process = self.script("plot_all.py", self.store, "--out", self.out, PYTHONPATH=str(self.folder))
        self.refused_in_one_line(process, "stereotlm: error: needs matplotlib, which ./setup installs: not there")
        self.file("matplotlib.py", b"raise ValueError('no such setting')\n")
        process = self.script("plot_all.py", self.store, "--out", self.out, PYTHONPATH=str(self.folder))
        self.refused_in_one_line(process, "stereotlm: error: matplotlib cannot be loaded: no such setting")

    def test_without_scripts(self):
        (self.folder / "bin").mkdir()
        alone = shutil.copy(program.PROGRAM, self.folder / "bin" / "stereotlm")
        process = subprocess.run([alone, "plot", str(self.store), "--out", str(self.out)], capture_output=True, text=True,
                                 timeout=60, check=False)
        self.refused_in_one_line(process, f"'{self.folder}/share/stereotlm/plots/plot_all.py': not found")


class Environment(PlotTest):
    @program.slow
    def test_has_no_effect(self):
        store = self.sweep(SMALL_BOARD + "vary: {matcher.window: [3, 5]}\n")
        self.file("matplotlib.py", b"raise ImportError('another one')\n")
        expected = None
        for variables in ({}, {"MPLBACKEND": "nonsense"}, {"PYTHONSAFEPATH": "1"}, {"PYTHONPATH": str(self.folder)},
                          {"PYTHONHOME": str(self.folder)}, {"PYTHONOPTIMIZE": "2"}):
            process = run("plot", store, "--out", self.out, env={**os.environ, **variables})
            self.assertEqual((process.returncode, process.stderr), (0, ""), variables)
            expected = expected or self.result()
            self.assertEqual(self.result(), expected, variables)
        for name in ("plot_window.py", "plot_all.py"):
            self.succeeds(self.script(name, store, "--out", self.out, MPLBACKEND="nonsense", PYTHONSAFEPATH="1"))


class Interrupted(PlotTest):
    def test_leaves_what_was_there(self):
        store = self.sweep(ALLOCATIONS)
        self.out.mkdir()
        (self.out / "banks.csv").write_text("earlier")
        for number in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen([program.PROGRAM, "plot", str(store), "--out", str(self.out)],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            end = time.monotonic() + 60
            while not (self.out / ".partial").exists() and time.monotonic() < end:
                time.sleep(0.005)
            process.send_signal(number)
            out, errors = process.communicate(timeout=60)
            self.assertEqual((process.returncode, out), (130, ""))
            self.assertEqual(errors, "stereotlm: note: interrupted: nothing was written\n")
            self.assertEqual(self.result(), {"banks.csv": b"earlier"})
            self.assertEqual(os.listdir(self.out), ["banks.csv"])


if __name__ == "__main__":
    program.main()
