"""What the tests of plot share: databases of sweeps, and figures that are drawn here."""

import csv
import pathlib
import sqlite3
import sys
import types

from program import HEIGHT, WIDTH, ProgramTest, run

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "sw" / "report" / "plots"))
import figures  # noqa: E402

figures.use_style()

SMALL_BOARD = f"""
board: fpl2003
run: {{source: preloaded}}
set: {{image.width: {WIDTH}, image.height: {HEIGHT}, matcher.filter: none}}
"""
WINDOWS = SMALL_BOARD + "vary: {matcher.window: [3, 5]}\n"
ALLOCATIONS = SMALL_BOARD + """
vary:
  allocation.left_lut: [bank6, bank0, bank4]
  allocation.right_lut: [bank7, bank2]
  allocation.disparity: [[bank4, bank5], [bank0, bank0]]
  ssram.default.kind: [zbt_pipelined, zbt_flow_through]
"""
# Beginnings of the columns of made databases that are no keys.
FIGURES_OF_RUNS = ("frames", "bound.", "area.", "latency_ms.", "pci.clocks", "lost_pixels")


def quoted(name):
    return '"' + name.replace('"', '""') + '"'


def make_database(path, header, rows):
    """One as sweep makes it, with these columns."""
    connection = sqlite3.connect(path)
    connection.execute(f"PRAGMA application_id = {figures.APPLICATION_ID}")
    connection.execute(f"PRAGMA user_version = {figures.LAYOUT}")
    columns = ["hash", "status", "reason", "version", "config", *header]
    connection.execute(f"CREATE TABLE points({', '.join(map(quoted, columns))})")
    connection.execute("CREATE TABLE blame(hash, port, bank, by, cycles)")
    connection.execute("CREATE TABLE columns(name, unit, meaning, is_key, varied)")
    of_columns = [(column, "", "", not column.startswith(FIGURES_OF_RUNS), 1) for column in header]
    connection.executemany("INSERT INTO columns VALUES(?, ?, ?, ?, ?)", of_columns)
    marks = ", ".join("?" * len(columns))
    for number, row in enumerate(rows):
        values = (f"{number:064}", "ok", "", "0.1.0", "", *row)
        connection.execute(f"INSERT INTO points VALUES({marks})", values)
    connection.commit()
    connection.close()
    return path


def change(store, sql, *values):
    connection = sqlite3.connect(store)
    connection.execute(sql, values)
    connection.commit()
    connection.close()


def draw(name, store, only=(), pareto=None, size=None):
    """The drawing of a figure, its table, and what the command would say about it."""
    points = figures.Points(store)
    if only:
        points.keep(only)
    options = types.SimpleNamespace(format=["svg"], size=size, pareto=pareto)
    files, said = figures.FIGURES[name](points, options)
    return files[".svg"].decode(), list(csv.DictReader(files[".csv"].decode().splitlines())), said


class PlotTest(ProgramTest):
    def sweep(self, plan, name="points.db"):
        store = self.folder / name
        self.succeeds(run("sweep", self.file(name + ".yaml", plan), "--out", store))
        return store

    def draw(self, name, store, **options):
        """What the command would say about the figure. self.svg and self.table are its drawing and data."""
        self.svg, self.table, said = draw(name, store, **options)
        return said

    def not_drawn(self, name, store, reason, **options):
        with self.assertRaises(figures.Unusable) as caught:
            self.draw(name, store, **options)
        self.assertEqual(str(caught.exception), reason)
