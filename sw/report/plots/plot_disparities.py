#!/usr/bin/python3
"""Frames per second and area against the disparities, a line for each combination of the other keys that vary."""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import command
import lines

KEY = "matcher.disparities"


def draw(points, options):
    points.need_variation(KEY)
    panels = [*lines.rate_panels(points), lines.area_panel()]
    return lines.draw(points, options, "Frame rate and area against the disparities", KEY, [KEY], panels)


if __name__ == "__main__":
    command.main(__doc__, {"disparities": draw})
