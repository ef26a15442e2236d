"""The paper's tables and claims beside the model's. Writes paper.md, claims.csv, table1, table2, banks (.csv,
.png, .svg) and costs.csv.

usage: report.py --out DIR [--left F --right F --truth F --truth-scale S --disparities D]
The pair is that of the claim about costs; without it that claim is judged on synthetic scenes only.
"""
import argparse
import csv
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parents[1] / "sw" / "python")]
import study  # noqa: E402
from claims import (ACCURACY, BANKS_FOUND, BANKS_PROVED, CONFIRMED, IN_PART, NOT_CONFIRMED,  # noqa: E402
                    OPEN, PAIR, RATE, SLICES)
from model import DOUBTFUL, Model, board_of, rate_of  # noqa: E402

BOARD_KEYS = ["image.width", "image.height", "matcher.window", "matcher.disparities", "matcher.filter",
              "fpga.clock_mhz", "fpga.device"]


# The tables.

def cell(value):
    if value is None:
        return ""
    return f"{value:.0f}" if isinstance(value, float) and value.is_integer() else str(value)


def write_table(path, rows):
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(rows[0])
        writer.writerows([cell(value) for value in row.values()] for row in rows)


def keys_of(run):
    return {key: board_of(run)[key] for key in BOARD_KEYS}


def claim_rows(found):
    rows = []
    for each in found.values():
        claim = each.claim
        for case in each.cases:
            bound, limited_by = bound_of(case) if claim.quantity == RATE else (None, None)
            least, most = each.clock_mhz(case)
            printed = claim.quantity != ACCURACY
            rows.append({"claim": claim.name, "place": claim.place, "says": claim.says, "case": case.name,
                         "unit": unit(claim), "paper": case.printed if printed else None,
                         "half_digit": claim.half_digit if printed else None, "model": case.modelled,
                         "bound": bound, "limited_by": limited_by, "deviation_percent": each.deviation(case),
                         "rule": claim.rule.text(), "tolerance": claim.rule.tolerance,
                         "verdict": case.verdict, "clock_mhz_least": least, "clock_mhz_most": most,
                         "claim_verdict": each.verdict, "command": " && ".join(case.commands)})
    return rows


def unit(claim):
    return claim.quantity.partition(",")[0]


def bound_of(case):
    bound = case.runs[0]["bound"]
    which = "system" if case.camera else "core"
    return bound[which], bound[f"{which}_limited_by"]


def table_1(found):
    rows = []
    for case in found["table1"].cases:
        claim, (bound, limited_by) = found["table1"].claim, bound_of(case)
        least, most = found["table1"].clock_mhz(case)
        rows.append({"window": case.name.partition("x")[0], "paper_frames_per_second": case.printed,
                     "paper_half_digit": claim.half_digit, "model_frames_per_second": case.modelled,
                     "bound_frames_per_second": bound, "limited_by": limited_by,
                     "deviation_percent": found["table1"].deviation(case), "rule": claim.rule.text(),
                     "tolerance_percent": claim.rule.tolerance, "verdict": case.verdict,
                     "clock_mhz_least": least, "clock_mhz_most": most,
                     "model_log7_frames_per_second": rate_of(case.of[1], case.runs[1]),
                     "command": case.commands[0], **keys_of(case.of[0])})
    return rows


def table_2(found):
    rows = []
    sizes, rates = found["table2_size"], found["table2_rate"]
    for size, rate in zip(sizes.cases, rates.cases):
        bound, limited_by = bound_of(rate)
        half = sizes.claim.half_digit
        rows.append({"disparities": size.name.partition(" ")[0], "paper_slices_percent": size.printed,
                     "paper_slices_percent_least": size.printed - half,
                     "paper_slices_percent_most": size.printed + half, "model_slices_percent": size.modelled,
                     "error_points": size.modelled - size.printed, "size_rule": sizes.claim.rule.text(),
                     "size_tolerance_points": sizes.claim.rule.tolerance, "size_verdict": size.verdict,
                     "paper_frames_per_second": rate.printed, "model_frames_per_second": rate.modelled,
                     "bound_frames_per_second": bound, "limited_by": limited_by,
                     "deviation_percent": rates.deviation(rate), "rate_rule": rates.claim.rule.text(),
                     "rate_verdict": rate.verdict, "size_command": size.commands[0],
                     "rate_command": rate.commands[0], **keys_of(size.of[0])})
    return rows


def bank_rows(found):
    names = {"delivered": "delivered_frames_per_second", "bound": "bound_frames_per_second"}
    return [{**{names.get(name, name): value for name, value in row.items()}, **keys_of(each.cases[0].of[0])}
            for each in found.values() for row in each.banks]


# The figures.

PRINTED = {"color": study.VERMILION, "marker": "D", "linestyle": "", "markersize": 5,
           "markerfacecolor": "white", "markeredgewidth": 1.3, "zorder": 4}
MODEL = {"color": study.BLUE, "marker": "o"}
BAR = {"marker": "o", "linestyle": "", "markersize": 5, "capsize": 3, "elinewidth": 1}


def save(figure, out, name):
    for ending in (".png", ".svg"):
        study.save(figure, out / (name + ending))


def column(rows, name):
    return [float(row[name]) for row in rows]


def with_difference(title, ylabel, xlabel, xs, tolerance):
    """A panel of values, and one of differences below it with the rule shaded."""
    figure, (values, differences) = study.plt.subplots(
        2, 1, figsize=(7.2, 5.4), sharex=True, gridspec_kw={"height_ratios": [2.7, 1.5]})
    values.set(title=title, ylabel=ylabel)
    differences.axhspan(-tolerance, tolerance, color="#EEEEEE", zorder=1)
    differences.axhline(0, color=study.GRAY, linewidth=0.8)
    differences.set(xlabel=xlabel, xticks=xs)
    return figure, values, differences


def draw_table_1(rows, out):
    rows = sorted(rows, key=lambda row: int(row["window"]))
    xs = [int(row["window"]) for row in rows]
    figure, rates, deviations = with_difference(
        "The paper's Table 1: frame rate against the window", "core, frames/s", "window n, pixels (of n x n)",
        xs, rows[0]["tolerance_percent"])
    rates.plot(xs, column(rows, "bound_frames_per_second"), label="bound", **study.bound(study.BLUE))
    rates.plot(xs, column(rows, "model_frames_per_second"), label="model, the core alone", **MODEL)
    rates.plot(xs, column(rows, "paper_frames_per_second"), label="printed in the paper", **PRINTED)
    rates.set_ylim(0)
    study.legend(rates)
    for x, row in zip(xs, rows):
        percent, confirmed = row["deviation_percent"], row["verdict"] == CONFIRMED
        half = 100 * row["paper_half_digit"] / row["paper_frames_per_second"]
        deviations.errorbar(x, percent, half, color=study.BLUE if confirmed else study.VERMILION, **BAR)
        if not confirmed:
            deviations.annotate(f"{percent:+.2f} %", (x, percent), (8, -3), textcoords="offset points")
    deviations.set_ylabel("model less\npaper, %")
    save(figure, out, "table1")


def draw_table_2(rows, out):
    xs, tolerance = column(rows, "disparities"), rows[0]["size_tolerance_points"]
    half = rows[0]["paper_slices_percent_most"] - rows[0]["paper_slices_percent"]
    figure, sizes, errors = with_difference("The paper's Table 2: area against the disparities",
                                            "area, % of the slices", "disparities D", xs, tolerance)
    sizes.plot(xs, column(rows, "model_slices_percent"),
               label="model, counted; one constant is fitted to these rows", **MODEL)
    sizes.errorbar(xs, column(rows, "paper_slices_percent"), half, capsize=3, elinewidth=1,
                   label="printed in the paper", **PRINTED)
    sizes.set_ylim(0)
    study.legend(sizes)
    errors.errorbar(xs, column(rows, "error_points"), half, color=study.BLUE, **BAR)
    errors.set(ylabel="model less paper,\npercentage points", ylim=(-1.8 * tolerance, 1.8 * tolerance))
    save(figure, out, "table2")


def draw_banks(rows, found, out):
    figure, panels = study.panels(2)
    for axes, name, title in zip(panels, ("banks", "banks_of_matching"),
                                 ("with calibration", "without calibration")):
        every = [row for row in rows if row["claim"] == name]
        xs = [row["banks"] for row in every]
        axes.plot(xs, column(every, "bound_frames_per_second"), label="bound", **study.bound(study.BLUE))
        axes.plot(xs, column(every, "frames_per_second"), label="the core alone, best allocation", **MODEL)
        axes.axvline(found[name].cases[0].printed, color=study.VERMILION, linestyle="--",
                     label="banks that the paper says are needed")
        axes.set_xticks(xs, [f"{row['banks']}\n({row['allocations']})" for row in every])
        axes.set(title=title, xlabel="banks that the allocation uses (allocations)")
    computer = [row for row in rows if row["claim"] == "banks_of_computer"]
    panels[0].plot([row["banks"] for row in computer], column(computer, "frames_per_second"), "^",
                   color=study.GREEN, label="the whole computer, one allocation each")
    for axes in panels:
        axes.set_ylim(0, 21)
    panels[0].set_ylabel("frames/s")
    study.legend(panels[1], handles=panels[0].get_legend_handles_labels()[0], loc="lower center")
    save(figure, out, "banks")


# The text.

HEAD = """# The paper's figures beside the model's

Written by `results/paper/run`. The paper: Y. Miyajima and T. Maruyama, "A Real-Time Stereo Vision
System with FPGA", FPL 2003, LNCS 2778, pp. 448-457. `claims.csv` has every row below, `table1.csv`,
`table2.csv` and `banks.csv` what the figures show, `costs.csv` the table of costs, all with every
digit. Claims, boards and rules are rows of `claims.py`.

- *paper* is the printed value, *model* what the simulation (of the area: the count) gives, *bound*
  what the analytic bound allows at most, without a simulation.
- A case is confirmed if its rule holds between both values; a claim if all of its cases are, in part
  if some are. "At least the printed value less 0.5" takes a printed 20 for anything that rounds to it
  or is more.
- *The core alone* is fed by an ideal host; *the whole computer* has free-running cameras at 29.97 Hz,
  capture boards, PCI bus and driver, and its rate is the steady one, without start-up.
- *MHz* is the clock at which the core alone would give what is printed, over the range that is
  printed so; the cycles of a frame do not depend on the clock.
"""

FIGURES = {
    "table1": """
![frames per second against the window](table1.png)

Below: the differences, with the rule shaded; a bar is what rounding to the printed digit leaves open.
""",
    "table2_size": """
![slices against the disparities](table2.png)

Below: the differences, with the rule shaded; the bars are what rounding to whole percents leaves open.
""",
    "banks_of_computer": """
![best frames per second against the banks](banks.png)

Below each number of banks: how many allocations to so many fit; the rate of each is known, and none is
higher. Triangles need not be the best that there is.
"""}


def signed(value, digits):
    return f"{round(value, digits) + 0.0:+.{digits}f}"


def printed_text(claim, case):
    if claim.quantity == ACCURACY:
        return ""  # the paper prints no number
    return f"{case.printed:.{1 if 0 < claim.half_digit < 0.5 else 0}f}"


def modelled_text(claim, case):
    return f"{case.modelled:.{0 if claim.quantity in (BANKS_PROVED, BANKS_FOUND) else 3}f}"


def deviation_text(found, case):
    if found.claim.quantity == SLICES:
        return signed(case.modelled - case.printed, 2) + " points"
    deviation = found.deviation(case)
    return "" if deviation is None else signed(deviation, 2) + " %"


def scene_clauses(found):
    """For the claim about costs: the scenes on which its verdict rests."""
    if found.claim.quantity != ACCURACY:
        return []
    wrong = {case.of[0].scene: case.runs[0]["accuracy"]["bad_1_percent"] for case in found.cases}
    judges = [scene for scene in wrong if wrong[scene] <= DOUBTFUL]
    return [f"on synthetic scenes {'and ' + PAIR if PAIR in judges else 'only'}",
            *(f"not on {scene}, whose cases are open: sad itself is wrong in {wrong[scene]:.2f} % of its "
              "answers" for scene in wrong if scene not in judges)]


def overview(found):
    return study.markdown(
        ["the paper says", "where", "cases confirmed", "verdict"],
        [[each.claim.says, each.claim.place, each.confirmed(),
          f"**{', '.join([each.verdict, *scene_clauses(each)[:1]])}**"] for each in found.values()])


def cases_text(found, model):
    claim = found.claim
    rows = []
    for case in found.cases:
        bound = mhz = []
        if claim.quantity == RATE:
            rate, limited_by = bound_of(case)
            least, most = found.clock_mhz(case)
            bound, mhz = [f"{rate:.3f}, {limited_by}"], [f"{least:.2f} .. {most:.2f}" if least else ""]
        rows.append([case.name, printed_text(claim, case), modelled_text(claim, case), *bound,
                     deviation_text(found, case), *mhz, case.verdict])
    header = ["case", "paper", "model", *["bound, limited by"] * (claim.quantity == RATE), "deviation",
              *["MHz"] * (claim.quantity == RATE), "verdict"]
    commands = [command for case in found.cases for command in
                [*case.commands, *(model.command_of(run) for run in case.of if run.scene)]]
    said = "".join(f"$ {command}\n" for command in dict.fromkeys(commands))
    return (f"\nRule: {claim.rule.text()}. In {unit(claim)}.\n\n{study.markdown(header, rows)}\n\n"
            f"```console\n{said}```\n")


def table_1_remarks(found):
    clocks = [found.clock_mhz(case) for case in found.cases if case.verdict == CONFIRMED]
    least, most = max(least for least, _ in clocks), min(most for _, most in clocks)
    text = f"""
Method: the core alone with its eight banks, 640x480, 80 disparities, no filter, 40 MHz (Table 2
prints that clock). `table1.csv` has the rates with the filter `log7` too.
The rows that agree are those of one clock, {least:.2f} .. {most:.2f} MHz.
"""
    for case in found.cases:
        if case.verdict == CONFIRMED:
            continue
        needs = found.clock_mhz(case)
        rows = int(case.name.partition("x")[0])
        rule = 40e6 / (640 * 480 * rows)
        text += f"""
The row of {case.name} deviates by {abs(found.deviation(case)):.1f} %. Reasons to doubt the printed \
{case.printed:.1f}:

"""
        if needs[0] > most or needs[1] < least:
            text += f"""\
- It needs {needs[0]:.2f} .. {needs[1]:.2f} MHz, which the rows that agree exclude. The table is of one
  circuit, and at their clock it would print {case.modelled:.1f} here.
"""
        if case.printed - found.claim.half_digit > rule:
            text += f"""\
- It is above what the paper's own rule allows at 40 MHz, one pixel a cycle and {rows} reads of each:
  40e6 / (640 * 480 * {rows}) = {rule:.3f}. Table 2 prints the same number beside 40 MHz.
"""
    return text


def table_2_remarks(found):
    worst = max(abs(case.modelled - case.printed) for case in found.cases)
    return f"""
Method: the parts are counted as synthesis makes them of the core in Verilog (`stereotlm bounds --area`
lists them; [results/silicon](../silicon/README.md)). Slices are those at full packing: half of the LUTs, a
lower limit. No constant is fitted. The largest error is {worst:.2f} points; a printed whole percentage
stands for half a point to each side.

From row to row the area grows as printed. All rows are above the print, the smallest by most: the printed
rows leave nothing for what does not grow with the disparities, such as filters and the multiplexers of the
banks. Without filters the synthesized cores are 2.2, 0.9 and 0.1 points above the print. Nothing is placed
or routed.
"""


def camera_hz(found):
    return board_of(found.cases[-1].of[0])["cameras.frame_rate_hz"]


def practice_remarks(found):
    hz = camera_hz(found)
    needs = "".join(f"- {case.name}: "
                    f"{case.printed * board_of(case.of[0])['fpga.clock_mhz'] / case.modelled:.2f} MHz for "
                    f"{case.printed:.0f} frames a second\n" for case in found.cases if not case.camera)
    return f"""
The paper calls the rates of Table 1 calculated, from the clock that CAD reports, and says this of
practice; it gives no other clock. What the core alone would need:

{needs}
With cameras that run freely at {hz:g} Hz and two buffers a side, deliveries lock to a fraction of the
camera's rate: 2 in 3 are {hz * 2 / 3:.2f} a second, 3 in 5 {hz * 3 / 5:.2f}. So the "20" of a
computer of this kind need not be a rate of its circuit.
"""


def window_remarks(found):
    return "\nIt depends on the window, which the paper does not name here.\n" * (found.verdict == IN_PART)


def small_remarks(found):
    hz = camera_hz(found)
    if hz >= found.cases[0].printed:
        return window_remarks(found)
    return window_remarks(found) + f"""\
Of the whole computer the cameras are the limit, whatever the matcher: at {hz:g} Hz they have no more
pictures to give. The paper names no faster ones; the number can only be the circuit's.
"""


def speed_up_remarks(found):
    rates = ((case.name, *map(rate_of, case.of, case.runs)) for case in found.cases)
    return "\nRates, 320x240 and 640x480:\n\n" + "".join(
        f"- {name}: {small:.3f} and {large:.3f} frames/s\n" for name, small, large in rates)


def banks_remarks(found):
    (case,) = found.cases
    fewest, printed = case.modelled, case.printed
    witness = next(row for row in found.banks if row["banks"] == fewest)
    fewer = [row for row in found.banks if row["banks"] < fewest]
    table = study.markdown(
        ["banks", "allocations, all simulated", "best frames/s", "bound", "reached by", "one of them"],
        [[row["banks"], row["allocations"], f"{row['frames_per_second']:.3f}", f"{row['bound']:.3f}",
          row["reached_by"], row["allocation"]] for row in found.banks])
    against = "fewer than" if fewest < printed else "just" if fewest == printed else "more than"
    text = f"""
{table}

- Witness: {fewest} banks give the best rate of all, {witness['frames_per_second']:.3f} frames/s:
  {witness['allocation']}.
"""
    if fewer:
        count, best = sum(row["allocations"] for row in fewer), max(row["frames_per_second"] for row in fewer)
        text += f"""\
- Certificate: none of the {count} allocations to fewer banks that fit gives more than {best:.3f}. Each
  of them is known: a frame leaves nothing behind for the next, every way in which the buffers of one
  frame share banks was simulated, and an allocation is a sum of such frames.
"""
    text += f"- So the frame rate of the core needs {fewest} banks, {against} the paper's {printed}.\n"
    if found.claim.name == "banks":
        text += """
What that leaves out: here pictures appear in their buffers, and results go, in no time; and in the
model host and circuit share a bank cycle by cycle. Where a bank belongs to one of them as a whole
until it is handed over, no buffer that the host fills or empties may lie beside one that the circuit
uses meanwhile. That is a reason for more banks, but not one of the frame rate of the core.
"""
    return text


def computer_remarks(found):
    (case,) = found.cases
    table = study.markdown(
        ["banks", "frames/s between deliveries", "from power-up", "bound", "allocation"],
        [[row["banks"], *(f"{row[name]:.3f}" for name in ("frames_per_second", "delivered", "bound")),
          row["allocation"]] for row in found.banks])
    fewest, printed = case.modelled, case.printed
    said = f"None of these gives with fewer banks what {printed} give: that decides nothing."
    if fewest < printed:
        said = f"{fewest} banks give what {printed} give: so {printed} are not needed; a witness is enough."
    return f"""
{table}

{said}
What was run here, one allocation for each number of banks, is no certificate: how few banks would do,
and what the best with 5 or 6 gives, takes all allocations. They are tried by
`stereotlm allocate fpl2003 --banks 8 --out banks.db`.
"""


def costs_remarks(rows):
    def changes(row):
        return ["" if row["cost"] == "sad" else signed(row[name], 3)
                for name in ("wrong_change_points", "answered_change_points")]

    table = study.markdown(
        ["scene", "cost", "wrong, %", "answered, %", "change of wrong", "of answered", "slices, %",
         "verdict"],
        [[row["scene"], row["cost"], f"{row['wrong_percent']:.3f}", f"{row['answered_percent']:.3f}",
          *changes(row), f"{row['slices_percent']:.2f}",
          "" if row["cost"] == "sad" else row["verdict"] or "not judged"] for row in rows])
    return f"""
The paper gives no figures for "almost same". So the rule is ours: with the other cost neither
the share of wrong answers nor the share of answered pixels changes by more than one point. *Model*
is the larger of the two changes. An answer is wrong if it is off by more than 1 disparity. Only
pixels count whose truth is known and which both cameras see. A pair on which `sad` itself is wrong
in more than {DOUBTFUL} % of its answers does not judge: its cases are open.

{table}

- The paper does not name census; it is shown beside.
- `zncc` subtracts the mean of each window, as most do; the paper does not say whether it does.
- Synthetic scenes have no noise, and both of their cameras see the same grey levels. `zncc` and
  census are made for cameras of different gain, which these scenes do not have.
- *Slices* are those of the board with that cost. What the area model counts for a cost was
  compared with nothing.
"""


def document(found, model):
    remarks = {
        "table1": table_1_remarks, "table2_size": table_2_remarks,
        "table2_rate": lambda _: "\nThe printed value is that of the row 7x7 of Table 1: see there.\n",
        "practice": practice_remarks, "any_window": window_remarks, "more_any_window": window_remarks,
        "small": small_remarks, "more_small": small_remarks, "small_speed_up": speed_up_remarks,
        "banks": banks_remarks, "banks_of_matching": banks_remarks, "banks_of_computer": computer_remarks,
        "costs": lambda each: costs_remarks(model.cost_rows(each))}
    text = f"{HEAD}\n{overview(found)}\n"
    for name, each in found.items():
        says = each.claim.says[0].upper() + each.claim.says[1:]
        clauses = "".join(f";\n{clause}" if number else f",\n{clause}"
                          for number, clause in enumerate(scene_clauses(each)))
        text += f"\n## {says} ({each.claim.place})\n\n"
        text += f"**{each.verdict}** (cases: {each.confirmed()}){clauses}.\n"
        text += cases_text(each, model) + remarks.get(name, lambda _: "")(each) + FIGURES.get(name, "")
    return text


def summary(found):
    """How many claims have which verdict, and a line for each claim, the doubted ones first."""
    order = [NOT_CONFIRMED, IN_PART, OPEN, CONFIRMED]
    counts = {verdict: sum(each.verdict == verdict for each in found.values()) for verdict in order}
    said = ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)
    print(f"{len(found)} claims of the paper: {said}.")
    for each in sorted(found.values(), key=lambda each: order.index(each.verdict)):
        print(f"{each.claim.place + ': ' + each.claim.says:<72} {each.confirmed():>9}  {each.verdict}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0], allow_abbrev=False)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    for name in ("left", "right", "truth", "truth-scale"):
        parser.add_argument(f"--{name}")
    parser.add_argument("--disparities", type=int, help="matcher.disparities that the pair needs")
    options = parser.parse_args()
    pair = {name: getattr(options, name) for name in ("left", "right", "truth", "truth_scale")}
    model = Model(pair, lambda command: print(command, file=sys.stderr))
    found = model.compare(options.disparities)
    tables = {"table1": table_1(found), "table2": table_2(found), "banks": bank_rows(found),
              "costs": model.cost_rows(found["costs"]), "claims": claim_rows(found)}
    options.out.mkdir(exist_ok=True)
    for name, rows in tables.items():
        write_table(options.out / f"{name}.csv", rows)
    draw_table_1(tables["table1"], options.out)
    draw_table_2(tables["table2"], options.out)
    draw_banks(tables["banks"], found, options.out)
    (options.out / "paper.md").write_text(document(found, model))
    summary(found)


main()
