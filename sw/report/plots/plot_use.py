#!/usr/bin/python3
"""How busy each bank is while the core works on a frame, point by point."""

import bars
import command
import style
from drawing import Drawing, Sheet, length_of
from matplotlib.patches import Patch
from points import counted, natural

LEAST_HEIGHT = 0.3  # inches
TEXT_CHANGES = 55  # percent; above it white text is easier to read than black


def draw(points, options):
    rows = bars.Rows(points, options)
    columns = sorted((name
                      for name in points.names
                      if name.startswith("banks.") and name.endswith(".utilization")),
                     key=natural)
    banks = [name.split(".", 1)[1].rpartition(".")[0] for name in columns]
    for name in columns:
        points.need_numbers([name], points.places_with(name))
    sheet = Sheet("How busy each bank is", options.size, options.format)
    percent = [[None if (use := points.column(name)[place]) is None else 100 * use for name in columns]
               for place in rows.places]
    if any(None in row for row in percent):
        sheet.legend([(Patch(color=style.MISSING), "the board has no such bank")])
    rows.note_below(sheet, "Of the cycles in which the core works on a frame, those in which the bank serves "
                           "an access.")
    height, least = (max(each, LEAST_HEIGHT) for each in (rows.height, rows.least))
    (axes,) = sheet.grid([height], 1, rows.left(), 0.3, bottom=0.95, least=least)
    numbers = [[float("nan") if use is None else use for use in row] for row in percent]
    axes.set_facecolor(style.MISSING)
    shown = axes.pcolormesh(range(len(banks) + 1), rows.edges, numbers, cmap=style.SHARES, vmin=0, vmax=100,
                            edgecolors="white", linewidth=1)
    cell = length_of(axes, "x") / len(banks)
    size = style.SMALL_SIZE * min(1, cell / style.text_width(" 100 ", style.SMALL_SIZE))
    for row, center in zip(percent, rows.centers):
        for number, use in enumerate(row):
            if use is not None:
                text = f"{use:.0f}" if use == 0 or use >= 0.5 else "<1"
                axes.text(number + 0.5, center, text, ha="center", va="center_baseline", fontsize=size,
                          color="white" if use > TEXT_CHANGES else "black")
    widest = max(style.text_width(bank, style.SIZE) for bank in banks)
    axes.set_xticks([number + 0.5 for number in range(len(banks))], banks,
                    fontsize=style.SIZE * min(1, max(0.5, 0.92 * cell / widest)))
    axes.tick_params(axis="x", length=0)
    rows.label(axes)
    axes.grid(False)
    for side in axes.spines.values():
        side.set_visible(False)
    sheet.color_bar(shown, "use of the bank, % of cycles", 0.42)
    header = ["hash", *points.varied, *columns]
    table = [[points.column(each)[place] for each in header] for place in rows.places]
    return Drawing(sheet, header, table,
                   f"{counted(len(rows.places), 'point')}, {counted(len(banks), 'bank')}")


if __name__ == "__main__":
    command.main(__doc__, {"use": draw})
