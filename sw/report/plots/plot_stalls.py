#!/usr/bin/python3
"""The stall cycles of each port in a frame, point by point, by cause: the port that was granted, or turnaround."""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import bars
import command
from drawing import Drawing, Sheet
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from points import PORTS, TURNAROUND, Unusable, counted

COLORS = dict(zip([*PORTS, TURNAROUND],
                  ["#E69F00", "#56B4E9", "#0072B2", "#009E73", "#CC79A7", "#999999", "#000000"]))


def draw(points, _):
    if not any(points.stall_cycles()):
        raise Unusable("no port stalls in any point")
    rows = bars.Rows(points, most_stalled=True)
    blame = {place: points.blame(place) for place in rows.places}
    stalled = [port for port in PORTS if any(row[0] == port for each in blame.values() for row in each)]
    blamed = [by for by in COLORS if any(row[2] == by for each in blame.values() for row in each)]
    sheet = Sheet()
    sheet.legend([(Patch(color=COLORS[by]), by if by == TURNAROUND else f"lost to {by}") for by in blamed])
    sheet.note(rows.note)
    sheet.note(points.pixels_note(rows.places))
    sheet.note(points.note(len(rows.places), rows.left_out))
    frames = points.frames()
    for axes, port in zip(sheet.columns(len(stalled), rows.height, rows.left()), stalled):
        for place, center in zip(rows.places, rows.centers):
            at = 0
            for by in blamed:
                cycles = sum(row[3] for row in blame[place] if (row[0], row[2]) == (port, by))
                axes.barh(center, cycles / frames[place] / 1e3, 0.14, at, color=COLORS[by], linewidth=0)
                at += cycles / frames[place] / 1e3
        axes.set_title(port, fontsize=9)
        axes.xaxis.set_major_locator(MaxNLocator(2 if len(stalled) > 3 else 4, steps=[1, 2, 5, 10]))
        rows.label(axes)
    most = max(axes.get_xlim()[1] for axes in sheet.panels)
    for axes in sheet.panels:
        axes.set_xlim(0, 1.03 * most)
    sheet.below("thousand stall cycles of the port a frame")
    header = ["hash", *points.varied, "frames", "port", "bank", "by", "cycles"]
    table = [[*(points.column(each)[place] for each in header[:-4]), *row]
             for place in rows.places for row in blame[place]]
    said = f"{counted(len(rows.places), 'point')}, {counted(len(stalled), 'port')} with stalls"
    return Drawing(sheet, header, table, said)


if __name__ == "__main__":
    command.main(__doc__, {"stalls": draw})
