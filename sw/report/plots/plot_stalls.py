#!/usr/bin/python3
"""The cycles in which each port waits in a frame, point by point, by cause: the port that was granted, or
turnaround."""

import bars
import command
import style
from drawing import Drawing
from points import PORTS, TURNAROUND, Unusable, counted

CAUSES = {by: (by if by == TURNAROUND else f"for {by}", color)
          for by, color in zip([*PORTS, TURNAROUND],
                               [style.ORANGE, style.SKY, style.BLUE, style.GREEN, style.PINK,
                                                      "#999999", style.BLACK])}


def draw(points, options):
    if not any(points.stall_cycles()):
        raise Unusable("no port waits in any point")
    rows = bars.Rows(points, options, most_stalled=True)
    blame = {place: points.blame(place) for place in rows.places}
    stalled = [port for port in PORTS if any(row[0] == port for each in blame.values() for row in each)]

    def cycles(place, port, by):
        return sum(row[3] for row in blame[place] if (row[0], row[2]) == (port, by))

    sheet = bars.stacked(points, options, rows, "Which port waits, and for whom", stalled, CAUSES, cycles,
                         "cycles a frame in which the port waits")
    header = ["hash", *points.varied, "frames", "port", "bank", "by", "cycles"]
    table = [[*(points.column(each)[place] for each in header[:-4]), *row]
             for place in rows.places for row in blame[place]]
    said = f"{counted(len(rows.places), 'point')}, {counted(len(stalled), 'port')} with waits"
    return Drawing(sheet, header, table, said)


if __name__ == "__main__":
    command.main(__doc__, {"stalls": draw})
