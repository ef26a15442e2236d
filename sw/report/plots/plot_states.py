#!/usr/bin/python3
"""What each port does in the cycles of a frame, point by point: granted, passed, waiting, blocked, starved or idle."""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import bars
import command
import style
from drawing import Drawing, Sheet, in_words, ticks_of_columns
from matplotlib.patches import Patch
from points import counted

STATES = [
    ("grants", "granted", style.BLUE),
    ("passed_cycles", "passed without access", style.SKY),
    ("stall_cycles", "waiting", style.VERMILION),
    ("blocked_cycles", "blocked", style.ORANGE),
    ("starved_cycles", "starved", "#999999"),
    ("idle_cycles", "idle", "#DDDDDD"),
]


def draw(points, options):
    rows = bars.Rows(points, options)
    ports = bars.used_ports(points, rows.places)
    points.need_numbers([f"ports.{port}.{count}" for port in ports for count, _, _ in STATES])
    frames = points.frames()

    def cycles(place, port, count):
        return points.column(f"ports.{port}.{count}")[place] / frames[place]

    shown = [state for state in STATES if any(cycles(place, port, state[0]) for place in rows.places for port in ports)]
    most = max(sum(cycles(place, port, count) for count, _, _ in shown) for place in rows.places for port in ports)
    factor, word = in_words(most)
    sheet = Sheet("What each port does in the cycles of a frame", options.size, options.format)
    sheet.legend([(Patch(color=color), name) for _, name, color in shown])
    sheet.note(rows.note)
    sheet.note(points.pixels_note(rows.places))
    sheet.note(points.note(len(rows.places), rows.left_out))
    panels = sheet.columns(len(ports), rows.height, rows.left(), rows.least)
    for axes, port in zip(panels, ports):
        for place, center in zip(rows.places, rows.centers):
            at = 0
            for count, _, color in shown:
                width = cycles(place, port, count) / factor
                axes.barh(center, width, 0.14, at, color=color, linewidth=0)
                at += width
        sheet.head(axes, port)
        rows.label(axes)
    ticks_of_columns(panels, most / factor)
    sheet.below(f"{word}cycles a frame")
    header = ["hash", *points.varied, "frames", "port", *(count for count, _, _ in STATES)]
    table = [[*(points.column(each)[place] for each in header[: len(points.varied) + 2]), port,
              *(points.column(f"ports.{port}.{count}")[place] for count, _, _ in STATES)]
             for place in rows.places for port in ports]
    return Drawing(sheet, header, table, f"{counted(len(rows.places), 'point')}, {counted(len(ports), 'port')}")


if __name__ == "__main__":
    command.main(__doc__, {"states": draw})
