#!/usr/bin/python3
"""Frames per second and area against the disparities, a line for each combination of the other keys that vary."""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import command
import lines

KEY = "matcher.disparities"


def draw(points, _):
    points.need_variation(KEY)
    area = lines.Panel("area.slices_percent", lines.MORE_HEIGHT, limit=(100, "the FPGA is full"),
                       listed=["area.slices"])
    return lines.draw(points, KEY, [KEY], [*lines.rate_panels(points), area])


if __name__ == "__main__":
    command.main(__doc__, {"disparities": draw})
