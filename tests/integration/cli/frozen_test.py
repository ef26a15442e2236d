"""What users and their programs read keeps its form: the keys and values of stats.json, the tables of a run,
the columns and rows of the database of a sweep, the table of keys, and what the commands print. All of it
equals the files in the folder `frozen`.

With STEREOTLM_FREEZE=1 the test writes these files. A change of them is a change of the contract.
"""

import json
import os
import pathlib
import shlex
import sqlite3
import unittest

import jsonschema
from pictures import noise, pgm
from program import PRELOADED, ProgramTest, run, sets

FROZEN = pathlib.Path(__file__).parent / "frozen"

RUNS = {
    "computer": ["fpl2003", *sets("image.width=32", "image.height=24", "cameras.frame_rate_hz=1000",
                                  "pci.load={burst_words: 8, interval_us: 20}"), "--frames", "4"],
    "computer_that_loses_pixels": ["two-banks", *sets("image.width=64", "image.height=16",
                                                      "cameras.frame_rate_hz=1000", "pci.clock_mhz=2",
                                                      "capture.fifo_words=4",
                                                      "capture.fifo_trigger_words=2"),
                                   "--frames", "3", "--timing-only"],
    "core_of_lanes": ["eight-banks-four-lanes", *sets("image.width=32", "image.height=16"), *PRELOADED,
                      "--frames", "2"],
    "core_of_sdram": ["sdram", *sets("image.width=32", "image.height=16"), *PRELOADED, "--frames", "2",
                      "--fidelity", "cycle"],
}

PLANS = {
    "core": """
board: fpl2003
run: {frames: 2}
set: {image.width: 32, image.height: 8, matcher.filter: none}
vary:
  matcher.window: [3, 5, 7]
  matcher.disparities: {from: 4, to: 12, step: 4}
  allocation.left_lut: [bank6, bank0, bank9]
zip:
  - {fpga.lanes: [1, 2], fpga.tables: [separate, joint]}
where: [matcher.window * matcher.disparities < 80]
sample: {points: 30, seed: 7}
""",
    "computer": """
board: two-banks
run: {source: camera, frames: 3}
set: {image.width: 32, image.height: 12, cameras.frame_rate_hz: 900}
vary:
  fpga.arbitration: [fixed_priority, round_robin, age]
  bridge.local_clock_mhz: [33.333, 40]
""",
}

BOUNDS = [
    ["fpl2003"],
    ["fpl2003", *sets("allocation.left_lut=bank0", "allocation.disparity=[bank5, bank5, bank1]")],
    ["fpl2003", *sets("matcher.fetch=line_buffer", "matcher.disparities=254")],
    ["eight-banks-four-lanes"],
    ["sdram"],
]

SMALL = ["fpl2003", *sets("image.width=32", "image.height=24")]
NARROW = ["fpl2003", *sets("image.width=16", "image.height=24")]
SHARED = sets("allocation.left_lut=bank0")
CAMERAS = sets("cameras.frame_rate_hz=1000", "fpga.clock_mhz=3.745")
CAPTURES = [*CAMERAS, *sets("allocation.left_image=[bank0, bank0]", "allocation.disparity=[bank0, bank0]")]
SCENE = ["--synthetic", "1"]
EXPLAINED = [
    [*SMALL, *PRELOADED, *SHARED],
    [*SMALL, *PRELOADED, *sets("matcher.rows=4", "matcher.disparities=4", "fpga.result_fifo_words=4")],
    [*SMALL, *CAMERAS],
]
CONFLICTS = [
    [*SMALL, *PRELOADED, *SCENE],
    [*SMALL, *PRELOADED, *SCENE, *SHARED, "--frames", "3"],
    [*SMALL, *CAPTURES, "--timing-only", "--frames", "3"],
]
LOSING = ["fpl2003", "--timing-only", *sets("image.width=64", "image.height=24", "matcher.window=3",
                                            "cameras.frame_rate_hz=1000", "fpga.clock_mhz=8",
                                            "pci.clock_mhz=1", "capture.fifo_words=16",
                                            "capture.fifo_trigger_words=4")]
# Two runs that differ: in a bank of the paper's board, in frames and rows, in what cameras deliver, in size,
# in their source, in pixels that are lost.
TIMING = ["fpl2003", *PRELOADED, "--timing-only", *sets("matcher.filter=none")]
DIFFERENT = [
    (TIMING, [*TIMING, *SHARED]),
    ([*SMALL, *PRELOADED, *SCENE, "--frames", "3"], [*SMALL, *PRELOADED, *SCENE, *SHARED, "--frames", "4"]),
    ([*SMALL, *CAMERAS, *SCENE, "--frames", "8", "--save-frames"],
     [*SMALL, *CAPTURES, *SCENE, "--frames", "8", "--save-frames"]),
    ([*SMALL, *PRELOADED, *SCENE], [*NARROW, *PRELOADED, "--timing-only"]),
    ([*SMALL, *CAMERAS, *SCENE], [*SMALL, *PRELOADED, *SCENE]),
    ([*LOSING, "--frames", "14"], [*LOSING, "--frames", "20"]),
]


def as_lines(stats):
    """A line for each figure, its path and its value."""
    lines = []

    def walk(path, value):
        if isinstance(value, dict):
            for name, each in value.items():
                walk(f"{path}.{name}", each)
        elif isinstance(value, list):
            for index, each in enumerate(value):
                walk(f"{path}[{index}]", each)
        else:
            lines.append(f"{path[1:]} = {json.dumps(value)}")

    walk("", stats)
    return "\n".join(lines) + "\n"


def table_of(database, table):
    """Its columns, and its rows in the order of their text; without the version of the program."""
    cursor = database.execute(f"SELECT * FROM {table}")
    names = [column[0] for column in cursor.description]
    kept = [index for index, name in enumerate(names) if name != "version"]
    rows = sorted(json.dumps([row[index] for index in kept]) for row in cursor)
    return "\n".join([f"{table}: " + json.dumps([names[index] for index in kept]), *rows]) + "\n"


class Frozen(ProgramTest):
    maxDiff = 4000

    def expect(self, name, text):
        path = FROZEN / f"{name}.txt"
        if os.environ.get("STEREOTLM_FREEZE"):
            FROZEN.mkdir(exist_ok=True)
            path.write_text(text)
            return
        self.assertMultiLineEqual(path.read_text(), text)

    def expect_printed(self, name, *commands):
        text = ""
        for command in commands:
            said = self.succeeds(run(*command, cwd=self.folder))
            if "--json" in command:
                jsonschema.validate(json.loads(said), json.loads(run("keys", "--schema", command[0]).stdout))
            text += f"$ stereotlm {shlex.join(command)}\n{said}"
        self.expect(name, text)

    def test_the_keys_and_values_of_stats_json(self):
        for name, arguments in RUNS.items():
            pictures = []
            if "--timing-only" not in arguments:
                size = [int(word.split("=")[1]) for word in arguments
                        if word.startswith(("image.width", "image.height"))]
                for side, seed in (("left", 1), ("right", 2)):
                    path = self.file(f"{name}_{side}.pgm", pgm(*size, noise(*size, seed)))
                    pictures += [f"--{side}", path]
            said = self.succeeds(run("run", *arguments, *pictures, "--out", self.folder / name))
            self.expect(f"stats_{name}", as_lines(self.stats(self.folder / name)))
            self.expect(f"printed_{name}", said)
        for table in ("timeline", "latency", "rows"):
            self.expect(table, (self.folder / "computer" / f"{table}.csv").read_text())

    def test_the_columns_and_rows_of_a_database(self):
        for name, plan in PLANS.items():
            with self.subTest(name):
                store = self.folder / f"{name}.db"
                self.succeeds(run("sweep", self.file("plan.yaml", plan), "--out", store))
                database = sqlite3.connect(store)
                text = "".join(table_of(database, table) for table in ("points", "columns", "blame"))
                database.close()
                self.expect(f"database_{name}", text)

    def test_what_is_printed_of_boards(self):
        names = [board["name"] for board in json.loads(run("boards", "--json").stdout)["boards"]]
        self.expect_printed("boards", ["boards"], *(["check", name] for name in names))
        self.expect_printed("bounds", *(["bounds", *board, "--area"] for board in BOUNDS))

    def test_what_is_printed_of_simulations(self):
        self.expect_printed("explain", *(["explain", *board] for board in EXPLAINED))
        self.expect_printed("conflicts", *(["conflicts", *board] for board in CONFLICTS))
        for number, pair in enumerate(DIFFERENT):
            for name, command in zip("ab", pair):
                self.succeeds(run("run", *command, "--out", f"{name}{number}", cwd=self.folder))
        pairs = ((f"a{number}", f"b{number}") for number in range(len(DIFFERENT)))
        self.expect_printed("diff", *(["diff", *pair] for pair in pairs))
        shared = [*SMALL, *SHARED]
        self.expect_printed("documents", ["check", *shared, "--json"], ["bounds", *shared, "--json"],
                            ["conflicts", *shared, *PRELOADED, "--timing-only", "--json"],
                            ["diff", "a1", "b1", "--json"], ["diff", "a1", "a1", "--json"])

    def test_the_table_of_keys(self):
        self.expect("keys", run("keys").stdout + run("keys", "--json").stdout)


if __name__ == "__main__":
    unittest.main()
