#!/usr/bin/env python3
"""Verilates models/rtl for one parameter set, and writes the sources of a library with it.

usage: verilate.py SETS NAME RTL OUT     writes OUT/NAME.cpp; SETS is sets.json, RTL the folder of the Verilog
"""
import json
import pathlib
import shutil
import subprocess
import sys

SOURCE = """\
#include "tests/integration/rtl/verilated_core.h"
{includes}
namespace stereotlm::test {{
std::unique_ptr<RtlCore> make_rtl_{name}() {{
  return std::make_unique<VerilatedCore<V{name}>>();
}}
}}  // namespace stereotlm::test
"""


def parameters(wanted):
    """The parameters of stereo_core."""
    kernel = wanted.get("filter") or {"size": 1, "shift": 0, "weights": [0]}
    packed = sum((weight & 0xFFFF) << 16 * place for place, weight in enumerate(kernel["weights"]))
    tolerance = wanted["tolerance"]
    return {
        "WIDTH": wanted["width"], "HEIGHT": wanted["height"], "WINDOW": wanted["window"],
        "DISPARITIES": wanted["disparities"],
        "HALF": kernel["size"] // 2, "SHIFT": kernel["shift"],
        "WEIGHTS": f"{16 * len(kernel['weights'])}'h{packed:x}",
        "HAS_CHECK": int(tolerance is not None), "TOLERANCE": tolerance or 0,
        "LEFT_TABLE": int(wanted["left_table"]), "RIGHT_TABLE": int(wanted["right_table"]),
        "LANE_FIFO_SLOTS": wanted["lane_fifo_slots"], "RESULT_FIFO_WORDS": wanted["result_fifo_words"],
        "RESULT_DELAY_CYCLES": wanted["result_delay_cycles"], "BANKS": 6,
    }


def main():
    sets, name, rtl, out = sys.argv[1:]
    wanted = next(each for each in json.loads(pathlib.Path(sets).read_text()) if each["name"] == name)
    folder = pathlib.Path(out) / name
    shutil.rmtree(folder, ignore_errors=True)  # files of another run have other names
    given = [f"-G{key}={value}" for key, value in parameters(wanted).items()]
    sources = sorted(pathlib.Path(rtl).glob("*.v"))
    options = ["--cc", "-Wall", "-O3", "--x-initial", "unique", f"-I{rtl}", "--top-module", "stereo_core",
               "--prefix", f"V{name}", "--Mdir", folder]
    subprocess.run(["verilator", *options, *given, *sources], check=True)
    includes = "".join(f'#include "{path}"\n' for path in sorted(folder.glob("*.cpp")))
    (pathlib.Path(out) / f"{name}.cpp").write_text(SOURCE.format(name=name, includes=includes))


main()
