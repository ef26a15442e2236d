#!/usr/bin/python3
"""The cycles of a frame in which each port waits, point by point, by cause: the port that was granted, or turnaround."""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import bars
import command
import style
from drawing import Drawing, Sheet, in_words, ticks_of_columns
from matplotlib.patches import Patch
from points import PORTS, TURNAROUND, Unusable, counted

COLORS = dict(zip([*PORTS, TURNAROUND],
                  [style.ORANGE, style.SKY, style.BLUE, style.GREEN, style.PINK, "#999999", style.BLACK]))


def draw(points, options):
    if not any(points.stall_cycles()):
        raise Unusable("no port waits in any point")
    rows = bars.Rows(points, options, most_stalled=True)
    blame = {place: points.blame(place) for place in rows.places}
    stalled = [port for port in PORTS if any(row[0] == port for each in blame.values() for row in each)]
    blamed = [by for by in COLORS if any(row[2] == by for each in blame.values() for row in each)]
    frames = points.frames()

    def cycles(place, port, by):
        return sum(row[3] for row in blame[place] if (row[0], row[2]) == (port, by)) / frames[place]

    most = max(sum(cycles(place, port, by) for by in blamed) for place in rows.places for port in stalled)
    factor, word = in_words(most)
    sheet = Sheet("Which port waits, and for whom", options.size, options.format)
    sheet.legend([(Patch(color=COLORS[by]), by if by == TURNAROUND else f"for {by}") for by in blamed])
    sheet.note(rows.note)
    sheet.note(points.pixels_note(rows.places))
    sheet.note(points.note(len(rows.places), rows.left_out))
    panels = sheet.columns(len(stalled), rows.height, rows.left(), rows.least)
    for axes, port in zip(panels, stalled):
        for place, center in zip(rows.places, rows.centers):
            at = 0
            for by in blamed:
                width = cycles(place, port, by) / factor
                axes.barh(center, width, 0.14, at, color=COLORS[by], linewidth=0)
                at += width
        sheet.head(axes, port)
        rows.label(axes)
    ticks_of_columns(panels, most / factor)
    sheet.below(f"{word}cycles a frame in which the port waits")
    header = ["hash", *points.varied, "frames", "port", "bank", "by", "cycles"]
    table = [[*(points.column(each)[place] for each in header[:-4]), *row]
             for place in rows.places for row in blame[place]]
    said = f"{counted(len(rows.places), 'point')}, {counted(len(stalled), 'port')} that wait{'s' if len(stalled) == 1 else ''}"
    return Drawing(sheet, header, table, said)


if __name__ == "__main__":
    command.main(__doc__, {"stalls": draw})
