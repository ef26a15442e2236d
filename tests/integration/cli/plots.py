"""What the tests of plot share: databases of sweeps, and the figures' own scripts."""

import csv
import functools
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import unittest

from pictures import PYTHON
from program import HEIGHT, WIDTH, ProgramTest, run

SCRIPTS = pathlib.Path(__file__).resolve().parents[3] / "sw" / "report" / "plots"
ENDINGS = [".png", ".svg", ".csv"]  # of the files of a figure, without --format
LAYOUT = 2

sys.dont_write_bytecode = True
sys.path.insert(0, str(SCRIPTS))
import points as reader  # noqa: E402: the module of the scripts that needs no matplotlib

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

# The results lie in a bank of the tables too, so that ports wait.
LANES = """
board: eight-banks-four-lanes
run: {source: preloaded}
set: {image.width: 32, image.height: 24, allocation.disparity: {rows: [bank0, bank5]}}
vary: {fpga.lanes: [1, 4]}
"""

# Beginnings of the columns of made databases that are no keys.
FIGURES_OF_RUNS = ("frames", "bound.", "area.", "latency_ms.", "pci.clocks", "cameras.left", "cameras.right",
                   "ports.",
                   "banks.")

# Runs scripts, each in a fork of one process that has loaded matplotlib: that takes longer than most figures.
SERVER = """
import json, os, runpy, sys, tempfile
import matplotlib.backends.backend_agg, matplotlib.backends.backend_svg
import matplotlib.figure, matplotlib.font_manager
for line in sys.stdin:
    outputs = [tempfile.TemporaryFile("w+") for _ in range(2)]
    child = os.fork()
    if child == 0:
        for number, file in enumerate(outputs, 1):
            os.dup2(file.fileno(), number)
        sys.argv = json.loads(line)
        sys.path.insert(0, os.path.dirname(sys.argv[0]))
        runpy.run_path(sys.argv[0], run_name="__main__")
        sys.exit()
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    for file in outputs:
        file.seek(0)
    print(json.dumps([status, *(file.read() for file in outputs)]), flush=True)
"""


@functools.cache
def server():
    command = [PYTHON, "-B", "-c", SERVER]
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    unittest.addModuleCleanup(process.communicate)
    return process


def script(name, *arguments):
    """The finished script of a figure."""
    words = [str(word) for word in (SCRIPTS / name, *arguments)]
    print(json.dumps(words), file=server().stdin, flush=True)
    return subprocess.CompletedProcess(words, *json.loads(server().stdout.readline()))


def script_with(name, *arguments, **variables):
    """The same, in a process of its own with these variables in its environment."""
    command = [PYTHON, "-B", *(str(word) for word in (SCRIPTS / name, *arguments))]
    environment = {**os.environ, **variables}
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, env=environment)


def make_database(path, header, rows):
    """One as sweep makes it, with these columns."""
    connection = sqlite3.connect(path)
    connection.execute(f"PRAGMA application_id = {0x53544C4D}")
    connection.execute(f"PRAGMA user_version = {LAYOUT}")
    columns = ["hash", "status", "reason", "version", "config", *header]
    connection.execute(f"CREATE TABLE points({', '.join(map(reader.quoted, columns))})")
    connection.execute("CREATE TABLE blame(hash, port, bank, by, cycles)")
    connection.execute("CREATE TABLE keys(name)")
    keys = [(column,) for column in header if not column.startswith(FIGURES_OF_RUNS)]
    connection.executemany("INSERT INTO keys VALUES(?)", keys)
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


class PlotTest(ProgramTest):
    def sweep(self, plan, name="points.db"):
        store = self.folder / name
        self.succeeds(run("sweep", self.file(name + ".yaml", plan), "--out", store))
        return store

    def plot(self, name, store, *more):
        """What the script of a figure prints that draws into self.out, which it replaces."""
        shutil.rmtree(self.out, ignore_errors=True)
        return self.succeeds(script(f"plot_{name}.py", store, "--out", self.out, *more))

    def table(self, name):
        with open(self.out / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))
