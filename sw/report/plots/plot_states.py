#!/usr/bin/python3
"""What each port does in the cycles of a frame, point by point: granted, passed, waiting, blocked, starved or
idle."""

import bars
import command
import style
from drawing import Drawing
from points import PORTS, counted

STATES = {
    "grants": ("granted", style.BLUE),
    "passed_cycles": ("passed without access", style.SKY),
    "stall_cycles": ("waiting", style.VERMILION),
    "blocked_cycles": ("blocked", style.ORANGE),
    "starved_cycles": ("starved", "#999999"),
    "idle_cycles": ("idle", "#DDDDDD"),
}


def draw(points, options):
    rows = bars.Rows(points, options)
    points.need_numbers([f"ports.{port}.{count}" for port in PORTS for count in ("grants", "stall_cycles")])
    ports = [port for port in PORTS  # those that are granted or stall in one of these points
             if any(points.column(f"ports.{port}.{count}")[place]
                    for place in rows.places for count in ("grants", "stall_cycles"))]
    points.need_numbers([f"ports.{port}.{count}" for port in ports for count in STATES])

    def cycles(place, port, count):
        return points.column(f"ports.{port}.{count}")[place]

    sheet = bars.stacked(points, options, rows, "What each port does in the cycles of a frame", ports, STATES,
                         cycles,
                         "cycles a frame")
    header = ["hash", *points.varied, "frames", "port", *STATES]
    table = [[*(points.column(each)[place] for each in header[: len(points.varied) + 2]), port,
              *(cycles(place, port, count) for count in STATES)]
             for place in rows.places for port in ports]
    return Drawing(sheet, header, table,
                   f"{counted(len(rows.places), 'point')}, {counted(len(ports), 'port')}")


if __name__ == "__main__":
    command.main(__doc__, {"states": draw})
