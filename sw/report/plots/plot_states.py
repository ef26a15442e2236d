#!/usr/bin/python3
"""What each port does in the cycles of a frame, point by point: granted, passed, stalled, blocked, starved or idle."""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import bars
import command
from drawing import Drawing, Sheet
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from points import counted

STATES = [
    ("grants", "granted", "#0072B2"),
    ("passed_cycles", "passed without access", "#56B4E9"),
    ("stall_cycles", "stalled", "#D55E00"),
    ("blocked_cycles", "blocked", "#E69F00"),
    ("starved_cycles", "starved", "#999999"),
    ("idle_cycles", "idle", "#DDDDDD"),
]


def draw(points, _):
    rows = bars.Rows(points)
    ports = bars.used_ports(points, rows.places)
    points.need_numbers([f"ports.{port}.{count}" for port in ports for count, _, _ in STATES])
    sheet = Sheet()
    sheet.legend([(Patch(color=color), name) for _, name, color in STATES])
    sheet.note(rows.note)
    sheet.note(points.pixels_note(rows.places))
    sheet.note(points.note(len(rows.places), rows.left_out))
    frames = points.frames()
    for axes, port in zip(sheet.columns(len(ports), rows.height, rows.left()), ports):
        for place, center in zip(rows.places, rows.centers):
            at = 0
            for count, _, color in STATES:
                width = points.column(f"ports.{port}.{count}")[place] / frames[place] / 1e6
                axes.barh(center, width, 0.14, at, color=color, linewidth=0)
                at += width
        axes.set_title(port, fontsize=9)
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_major_locator(MaxNLocator(2, steps=[1, 2, 5, 10]))
        rows.label(axes)
    sheet.below("million cycles a frame")
    header = ["hash", *points.varied, "frames", "port", *(count for count, _, _ in STATES)]
    table = [[*(points.column(each)[place] for each in header[: len(points.varied) + 2]), port,
              *(points.column(f"ports.{port}.{count}")[place] for count, _, _ in STATES)]
             for place in rows.places for port in ports]
    return Drawing(sheet, header, table, f"{counted(len(rows.places), 'point')}, {counted(len(ports), 'port')}")


if __name__ == "__main__":
    command.main(__doc__, {"states": draw})
