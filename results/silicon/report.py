"""Writes README.md from cores.csv, blocks.csv and others.csv beside this script."""
import csv
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))
import study  # noqa: E402

SLICES = 33792  # of an XC2V6000
TABLE_2 = {80: 21, 160: 43, 200: 54}  # of the paper: percent
OUTSIDE_MATCHING = ("log_filter", "slot_position", "crossbar", "lane", "stereo_core")


def rows_of(name):
    with open(HERE / name, newline="") as file:
        return [{key: int(value) if value.isdigit() else value for key, value in row.items()}
                for row in csv.DictReader(file)]


def percent(slices):
    return 100 * slices / SLICES


def slices_of(blocks):
    luts = sum(block["luts"] + block["srls"] for block in blocks)
    return max(luts, sum(block["flip_flops"] for block in blocks)) / 2


def by_window(cores, cell):
    disparities = sorted({core["disparities"] for core in cores})
    windows = sorted({core["window"] for core in cores})
    return study.markdown(["window", *(f"{number} disparities" for number in disparities)],
                          [[f"{n}x{n}", *(" ".join(cell(core) for core in cores
                                                   if (core["window"], core["disparities"]) == (n, number))
                                          for number in disparities)] for n in windows])


def table_2(cores, blocks):
    lines = []
    for disparities, printed in TABLE_2.items():
        whole, bare = (percent(study.only(cores, window=7, disparities=disparities, filter=name)["slices"])
                       for name in ("log7", "none"))
        matching = percent(slices_of([block for block in blocks if block["window"] == 7 and
                                      block["disparities"] == disparities and
                                      block["block"] not in OUTSIDE_MATCHING]))
        lines.append([disparities, printed, *(f"{part:.1f} ({part - printed:+.1f})"
                                              for part in (whole, bare, matching))])
    return study.markdown(["disparities", "printed, %", "whole core", "without filters", "matching alone"],
                          lines)


def block_table(blocks):
    keys = ("luts", "srls", "flip_flops", "block_rams", "multipliers", "slices")
    return study.markdown(["block", "count", "LUTs", "SRL16", "flip-flops", "block RAMs", "multipliers",
                           "slices"],
                          [[f"`{block['block']}`", block["count"], *(block[key] for key in keys)]
                           for block in blocks])


def clock_table(cores):
    def cell(core):
        return f"{core['path_from_mhz']}..{core['path_to_mhz']}"
    return by_window(cores, cell)


def limits(cores):
    """The paths that limit cores, each with the cores that it limits."""
    paths = {}
    for core in cores:
        key = (core["filter"], core["path_blocks"])
        paths.setdefault(key, []).append(core)
    lines = []
    for (filter_name, passed), limited in paths.items():
        longest = max(limited, key=lambda core: float(core["path_ns"]))
        lines.append([f"`{filter_name}`", len(limited), passed.replace(" ", ", "), longest["path_ns"],
                      longest["path_luts"], longest["path_carries"], longest["path_multipliers"]])
    return study.markdown(["filter", "cores", "longest path through", "ns in cells", "LUTs", "carry cells",
                           "multipliers"], lines)


def main():
    cores, blocks, others = (rows_of(name) for name in ("cores.csv", "blocks.csv", "others.csv"))
    filtered = [core for core in cores if core["filter"] == "log7"]
    bare = [core for core in cores if core["filter"] == "none"]
    shown = [block for block in blocks if (block["window"], block["disparities"]) == (7, 80)]
    most, least = (study.only(filtered, window=7, disparities=number)["slices"] for number in (200, 80))
    slope = (most - least) / 120
    flattened, free = others
    parts = ("matcher", "slot_position", "log_filter", "window_control", "cost_array", "column_module",
             "window_module", "candidates", "select_min_chain", "select_min_tree", "lr_check")
    separate = slices_of([block for block in shown if block["block"] in parts])
    (HERE / "README.md").write_text(study.page(f"""# Silicon

**Question.** What does the core in Verilog take of an XC2V6000? How fast can its clock be, and what limits
it?

Made by `results/silicon/run` (after `./setup tests`). Yosys 0.23 maps each block of
[models/rtl](../../models/rtl/README.md) to cells of Virtex-II, once for the same parameters, and the core has
it as often as it needs. All cores are for 640x480, with the queues and banks of `fpl2003`, and with registers
in the whole path. A cell that the data sheet DS031 does not have fails the study:
[srl16.v](../../models/rtl/board/srl16.v) cuts shift registers to SRL16E. Slices are those at full packing:
half of the LUTs and SRL16s, or of the flip-flops, whichever is more. All figures: [cores.csv](cores.csv),
[blocks.csv](blocks.csv).

## Area

Slices with filter `log7`, % of 33,792:

{by_window(filtered, lambda core: f"{percent(core['slices']):.1f}")}

Without filter:

{by_window(bare, lambda core: f"{percent(core['slices']):.1f}")}

The paper's Table 2 (7x7) beside it; in brackets the difference in percentage points. No constant is fitted.
"Matching alone" leaves out filters, lanes, bank multiplexers and the registers of the frame.

{table_2(cores, blocks)}

The blocks of the core of the paper (7x7, 80, `log7`):

{block_table(shown)}

- From 80 to 200 disparities each takes {slope:.1f} slices; by the paper's whole percentages 90.1 to 95.7. So
  the modules and units of figures 6 to 8 explain how Table 2 grows, if the paper packed its slices to
  {100 * slope / 95.7:.0f} to {100 * slope / 90.1:.0f} %.
- The paper's rows leave nothing for what does not grow. Here that is {percent(least - 80 * slope):.1f} % of
  the FPGA: filters, lanes, multiplexers, control. That is why the whole core is above the print at 80. The
  core without filters is near all three rows; whether the printed circuits had them is not known.
- The crossbar is that of the paper's board, whose ports reach one or two banks each. One with the ports of
  any board at any of 8 banks, and the policy as an input, takes {percent(free['slices']):.1f} %.
- The matcher of 7x7 and 80 as one flat design takes {flattened['slices']} slices instead of
  {separate:.0f}: {100 * (flattened['slices'] / separate - 1):+.1f} %.

## Clock

f_max in MHz with filter `log7`: from the first figure, if routing takes 60 % of the longest path, to the
second, if it takes 40 %. Both shares are assumed.

{clock_table(filtered)}

Without filter:

{clock_table(bare)}

What limits them:

{limits(cores)}

- The paper's core ran at 40 MHz, and its row for 7x7 in Table 1 implies 40.6. Both lie in the range without
  filter. With it the circuit is too slow: a sum of two pixels, a multiplication and three additions follow
  each other between two registers. A register behind the multiplication would put the address first again: a
  multiplication by the width, two additions and the multiplexer of the bank.
- Neither the window nor the disparities set the clock, as in Table 2, where it is 40 MHz for 80, 160 and 200:
  the chain and the tree have a comparator between two registers.
- "More than 30 frames per second" with 7x7 needs 65 MHz. The paths within the matcher but for the filter
  allow {min(float(core['matcher_from_mhz']) for core in bare):.0f} to
  {max(float(core['matcher_to_mhz']) for core in bare):.0f} MHz (left-right check: its memories are read and
  compared in one cycle). So filter, address and check need a register each.

## Limits

- Nothing is placed or routed. No other design of this family gives its packing here.
- The delays in [synthesis.py](synthesis.py) are those of speed grade -4 as remembered from DS031 and from
  reports of Xilinx's tools. No copy was at hand: check them first. The output of a shift register or of a
  memory of LUTs counts as a flip-flop and a LUT, which is too little.
- Yosys is not the tool of 2003. `-nowidelut` keeps it from making wide functions out of many LUTs for the
  sake of speed; so multiplexers use no MUXF5.
- The local bus, the pins and the registers of the host are not in the Verilog.
"""))


if __name__ == "__main__":
    main()
