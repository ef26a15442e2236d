"""The synthesis of models/rtl (results/silicon) beside the area that the program counts.

usage: silicon_test.py PROGRAM [whole]
Without `whole`, blocks of a small core; with it, every part of two whole cores.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "results" / "silicon"))
import synthesis  # noqa: E402

PROGRAM = sys.argv[1]
# What the parts that the program lists are in models/rtl.
BLOCKS = {
    "slot sequencers": ["lane"], "table entry queues": ["lane"], "source addresses": ["lane"],
    "byte selectors": ["lane"], "pixel queues": ["lane"],
    "filters": ["log_filter"], "filter columns": ["log_filter"], "filter line memories": ["log_filter"],
    "right pixel delays": ["cost_array"], "column modules": ["column_module"],
    "window modules": ["window_module"], "candidate marks": ["candidates"],
    "select-min unit A": ["select_min_chain"], "select-min unit B": ["select_min_tree"],
    "left-right check": ["lr_check"], "result packer": ["result_port"], "result queue": ["result_port"],
    "matcher control": ["match_control", "window_control", "matcher"], "slot positions": ["slot_position"],
    "frame registers": ["stereo_core"], "bank multiplexers": ["crossbar"]}


def counted(window, disparities, filter_name):
    """LUTs, block RAMs and multipliers of the parts that the program counts, by the blocks that they are."""
    sets = (f"matcher.window={window}", f"matcher.disparities={disparities}", f"matcher.filter={filter_name}")
    words = [word for each in sets for word in ("--set", each)]
    text = subprocess.run([PROGRAM, "bounds", "fpl2003", *words, "--area", "--json"], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    found = {}
    for part in json.loads(text)["area"]["parts"]:
        sums = found.setdefault(tuple(BLOCKS[part["name"]]), [0, 0, 0])
        for place, name in enumerate(("luts", "block_rams", "multipliers")):
            sums[place] += part[name]
    return found


def made(cells):
    found = synthesis.resources(cells)
    return [found["luts"] + found["srls"], found["block_rams"], found["multipliers"]]


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.synthesis = synthesis.Synthesis(self.folder.name)

    def near(self, luts, expected, what):
        self.assertLessEqual(abs(luts - expected), max(4, 0.05 * luts), f"{what}: {luts}, counted {expected}")


class Silicon(Case):
    def cells(self, top, parameters):
        return synthesis.cells_of(self.synthesis.block(top, parameters))

    def test_a_block_takes_what_is_counted(self):
        parts = counted(7, 16, "none")
        for top, count, parameters in (("window_module", 16, {}),
                                       ("select_min_chain", 1, {"DISPARITIES": 16})):
            luts = count * made(self.cells(top, parameters))[0]
            self.near(luts, parts[top,][0], top)

    def test_shift_registers_are_cut_to_16(self):
        cells = self.cells("delay_line", {"BITS": 3, "DEPTH": 40})
        self.assertEqual((cells["SRL16E"], cells["FDRE"]), (9, 0))

    def test_refuses_cells_that_the_family_does_not_have(self):
        with self.assertRaisesRegex(SystemExit, "LUT6: Virtex-II has no such cell"):
            synthesis.cells_of({"cells": {"one": {"type": "LUT6"}}})

    def test_the_longest_path_ends_at_registers(self):
        def cell(kind, **pins):
            directions = {pin: "output" if pin in "QO" else "input" for pin in pins}
            return {"type": kind, "connections": {pin: [net] for pin, net in pins.items()},
                    "port_directions": directions}
        # A register, two LUTs, the carry chain and a register; its output goes to a pin.
        netlist = {"ports": {"c": {"direction": "input", "bits": [2]},
                             "q": {"direction": "output", "bits": [8]}},
                   "cells": dict(enumerate((cell("FDRE", C=2, D=8, Q=3), cell("LUT1", I0=3, O=4),
                                            cell("LUT1", I0=4, O=5), cell("MUXCY", S=5, DI="0", CI="0", O=6),
                                            cell("XORCY", LI="0", CI=6, O=7), cell("FDRE", C=2, D=7, Q=8))))}
        path = synthesis.longest_path({"core": netlist}, "core")
        self.assertEqual((path.luts, path.carries, path.blocks), (2, 2, ["core"]))
        self.assertAlmostEqual(path.ns, synthesis.T_CKO + 2 * synthesis.T_ILO + synthesis.T_CARRY_IN +
                               synthesis.T_CARRY_OUT + synthesis.T_DICK)


class Whole(Case):
    def test_each_part_takes_what_is_counted(self):
        for number, (window, disparities, filter_name) in enumerate(((7, 80, "log7"), (11, 40, "none"))):
            parameters = {"WINDOW": window, "DISPARITIES": disparities}
            parameters = synthesis.log7(parameters) if filter_name == "log7" else {**parameters, "HALF": 0}
            stages = (8 if filter_name == "log7" else 5) + (disparities - 1).bit_length()
            netlists = self.synthesis.core(number, {**parameters, "RESULT_DELAY_CYCLES": stages})
            _, cells = synthesis.counted(netlists)
            for blocks, expected in counted(window, disparities, filter_name).items():
                found = [sum(each) for each in zip(*(made(cells[block]) for block in blocks))]
                what = f"{window}x{window}, {disparities}: {' '.join(blocks)}"
                self.near(found[0], expected[0], what)
                self.assertEqual(found[1:], expected[1:], what)


if __name__ == "__main__":
    names = [Whole] if "whole" in sys.argv else [Silicon]
    suite = unittest.TestSuite(unittest.defaultTestLoader.loadTestsFromTestCase(each) for each in names)
    sys.exit(not unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful())
