#!/usr/bin/python3
"""The figures of stereotlm paper, from its tables: the paper's Tables 1 and 2 and its number of banks."""

import command
import style
from drawing import HEAD, Sheet, ticks_at
from matplotlib.lines import Line2D
from style import QUIET, bound, bound_handle, line_handle

MODEL, PAPER, SECOND = style.BLUE, style.VERMILION, style.GREEN
RULE = "#EEEEEE"  # where the rule holds
PRINTED = {"color": PAPER, "marker": "D", "linestyle": "", "markersize": 5, "markerfacecolor": "white",
           "markeredgewidth": 1.3}


def numbers(rows, column):
    return [float(row[column]) for row in rows]


def image_of(row):
    return f"{row['image.width']}x{row['image.height']}"


def window_of(row):
    return "{0}x{0}".format(row["matcher.window"])


def filter_of(row):
    return "no filter" if row["matcher.filter"] == "none" else f"filter {row['matcher.filter']}"


def model_line(axes, xs, ys):
    axes.plot(xs, ys, color=MODEL, zorder=3, **style.POINT)


def rule_panel(axes, tolerance, most, label, x_label, xs):
    """A panel of differences: the rule, shaded, and a scale of up to `most` on both sides of zero."""
    axes.axhspan(-tolerance, tolerance, color=RULE, zorder=1)
    axes.axhline(0, color=QUIET, linewidth=0.8, zorder=1.4)
    axes.set_ylim(-most, most)
    axes.set_ylabel(label)
    axes.set_xlabel(x_label)
    ticks_at(axes, xs)


def table1(folder, options):
    """Draws frames per second over the window and, below, the deviation from the paper."""
    rows = sorted(command.read_table(folder, "table1"), key=lambda row: int(row["window"]))
    xs = [int(row["window"]) for row in rows]
    board, tolerance = rows[0], float(rows[0]["tolerance_percent"])
    sheet = Sheet("The paper's Table 1: frame rate against the window", options.size, options.format)
    sheet.legend([(Line2D([], [], **PRINTED), "printed in the paper"),
                  (line_handle(MODEL, "o"), "model, the core alone"), (bound_handle(MODEL), "bound")])
    sheet.note(f"Table 1: {image_of(board)}, {board['matcher.disparities']} disparities, "
               f"{filter_of(board)}, {board['fpga.clock_mhz']} MHz. Below: model less paper, with the rule "
               f"({board['rule']}) shaded; the bar is what rounding to the printed digit leaves open.")
    rates, deviations = sheet.grid([2.7, 1.5])
    bounds, values = numbers(rows, "bound_frames_per_second"), numbers(rows, "model_frames_per_second")
    printed = numbers(rows, "paper_frames_per_second")
    rates.plot(xs, bounds, **bound(MODEL))
    model_line(rates, xs, values)
    rates.plot(xs, printed, zorder=4, **PRINTED)
    rates.set_ylim(0, max(printed + bounds) * 1.08)
    rates.set_ylabel("core, frames/s")
    percents = numbers(rows, "deviation_percent")
    halves = [100 * half / value for half, value in zip(numbers(rows, "paper_half_digit"), printed)]
    for x, percent, half, row in zip(xs, percents, halves, rows):
        color = MODEL if row["verdict"] == "confirmed" else PAPER
        deviations.errorbar(x, percent, yerr=half, color=color, marker="o", markersize=5, capsize=3,
                            linewidth=1,
                            zorder=3)
        if row["verdict"] != "confirmed":
            deviations.annotate(f"{round(percent, 2) + 0.0:+.2f} %", (x, percent), (8, -3),
                                textcoords="offset points", fontsize=8)
    most = max(abs(percent) + half for percent, half in zip(percents, halves))
    rule_panel(deviations, tolerance, 1.15 * most, "model less\npaper, %", "window n, pixels (of n x n)", xs)
    return sheet


def table2(folder, options):
    """Draws slices over the disparities and, below, the error. Bars: what rounding in the paper leaves
    open."""
    rows = sorted(command.read_table(folder, "table2"), key=lambda row: int(row["disparities"]))
    xs = [int(row["disparities"]) for row in rows]
    board, tolerance = rows[0], float(rows[0]["size_tolerance_points"])
    printed, values = numbers(rows, "paper_slices_percent"), numbers(rows, "model_slices_percent")
    least, most = numbers(rows, "paper_slices_percent_least"), numbers(rows, "paper_slices_percent_most")
    below = [value - low for value, low in zip(printed, least)]
    above = [high - value for value, high in zip(printed, most)]
    sheet = Sheet("The paper's Table 2: area against the disparities", options.size, options.format)
    sheet.legend([(Line2D([], [], **PRINTED), "printed in the paper"),
                  (line_handle(MODEL, "o"), "model, counted; one constant is fitted to these rows")])
    sheet.note(f"Table 2: window {window_of(board)}, {board['fpga.device'].upper()}. Below: model less "
               f"paper, with the rule ({board['size_rule']}) shaded; the bars are what rounding to whole "
               "percents leaves open.")
    sizes, errors = sheet.grid([2.5, 1.5])
    model_line(sizes, xs, values)
    sizes.errorbar(xs, printed, yerr=[below, above], capsize=3, linewidth=1, zorder=4, **PRINTED)
    sizes.set_ylim(0, max(most + values) * 1.08)
    sizes.set_ylabel("area, % of the slices")
    errors.errorbar(xs, numbers(rows, "error_points"), yerr=[above, below], color=MODEL, linestyle="",
                    marker="o",
                    markersize=5, capsize=3, linewidth=1, zorder=3)
    rule_panel(errors, tolerance, 1.8 * tolerance, "model less paper,\npercentage points", "disparities D",
               xs)
    return sheet


def banks(folder, options):
    """Draws frame rates over the number of banks: the best of the core, and those of runs of the computer."""
    rows = command.read_table(folder, "banks")
    printed = {row["claim"]: row["paper"] for row in command.read_table(folder, "claims")}
    computer = [row for row in rows if row["claim"] == "banks_of_computer"]
    board = rows[0]
    sheet = Sheet("Frame rate against the number of memory banks", options.size, options.format)
    sheet.legend([(line_handle(MODEL, "o"), "the core alone, the best of every allocation"),
                  (bound_handle(MODEL), "bound"),
                  (line_handle(SECOND, "^", ""), "the whole computer, one allocation each"),
                  (line_handle(PAPER, None, (0, (4, 2))), "banks that the paper says are needed")])
    sheet.note(f"{image_of(board)}, {window_of(board)}, {board['matcher.disparities']} disparities, "
               f"{board['fpga.clock_mhz']} MHz. Below each number of banks: how many allocations to so many "
               "fit; the rate of each is known, and none is higher. Triangles need not be the best that "
               "there is.")
    panels = sheet.grid([2.8], 2, 0.75, 0.2, bottom=0.72, above=HEAD)
    for axes, claim, heading in zip(panels, ("banks", "banks_of_matching"),
                                    ("with calibration", "without calibration")):
        every = [row for row in rows if row["claim"] == claim]
        xs = [int(row["banks"]) for row in every]
        axes.plot(xs, numbers(every, "bound_frames_per_second"), **bound(MODEL))
        model_line(axes, xs, numbers(every, "frames_per_second"))
        axes.axvline(float(printed[claim]), color=PAPER, linewidth=1.2, linestyle=(0, (4, 2)), zorder=1.2)
        sheet.head(axes, heading)
        axes.set_xticks(xs, [f"{row['banks']}\n({row['allocations']})" for row in every])
        axes.set_xlim(min(xs) - 0.5, max(xs) + 0.5)
    panels[0].plot([int(row["banks"]) for row in computer], numbers(computer, "frames_per_second"),
                   color=SECOND,
                   marker="^", linestyle="", markersize=5.5, zorder=2.8)
    panels[0].set_ylim(0, max(numbers(rows, "bound_frames_per_second")) * 1.12)
    panels[0].set_ylabel("frames/s")
    sheet.below("banks that the allocation uses (allocations)", 0.52)
    return sheet


FIGURES = {"table1": table1, "table2": table2, "banks": banks}


if __name__ == "__main__":
    command.main_of_tables(__doc__, str, FIGURES)
