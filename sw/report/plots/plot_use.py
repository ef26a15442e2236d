#!/usr/bin/python3
"""How busy each bank is while the core works on a frame, point by point."""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import bars
import command
from drawing import Drawing, Sheet
from points import counted, natural

TEXT_CHANGES = 55  # percent; above it white text is easier to read than black


def draw(points, _):
    rows = bars.Rows(points)
    columns = sorted((name for name in points.names if name.startswith("banks.") and name.endswith(".utilization")),
                     key=natural)
    banks = [name.split(".")[1] for name in columns]
    for name in columns:
        points.need_numbers([name], points.places_with(name))
    sheet = Sheet()
    sheet.note(rows.note)
    sheet.note("Of the cycles in which the core works on a frame, those in which the bank serves an access.")
    sheet.note(points.pixels_note(rows.places))
    sheet.note(points.note(len(rows.places), rows.left_out))
    (axes,) = sheet.columns(1, rows.height, rows.left(), top=0.1, bottom=0.5, right=0.3)
    percent = [[None if (use := points.column(name)[place]) is None else 100 * use for name in columns]
               for place in rows.places]
    numbers = [[float("nan") if use is None else use for use in row] for row in percent]
    axes.pcolormesh(range(len(banks) + 1), rows.edges, numbers, cmap="Blues", vmin=0, vmax=100, edgecolors="white",
                    linewidth=1)
    for row, center in zip(percent, rows.centers):
        for number, use in enumerate(row):
            if use is not None:
                text = f"{use:.0f}" if use == 0 or use >= 0.5 else "<1"
                axes.text(number + 0.5, center, text, ha="center", va="center_baseline", fontsize=7,
                          color="white" if use > TEXT_CHANGES else "black")
    axes.set_xticks([number + 0.5 for number in range(len(banks))], banks)
    axes.tick_params(axis="x", length=0)
    rows.label(axes)
    axes.grid(False)
    for side in axes.spines.values():
        side.set_visible(False)
    sheet.below("use of the bank, % of cycles")
    header = ["hash", *points.varied, *columns]
    table = [[points.column(each)[place] for each in header] for place in rows.places]
    return Drawing(sheet, header, table, f"{counted(len(rows.places), 'point')}, {counted(len(banks), 'bank')}")


if __name__ == "__main__":
    command.main(__doc__, {"use": draw})
