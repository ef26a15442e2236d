#!/usr/bin/python3
"""Frames per second and area against the number of column and window modules.

There is a line for each combination of the other keys that vary.
"""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import command
import lines
from points import UNITS_USED

KEY = "matcher.units"


def draw(points, options):
    points.need_variation(KEY)
    panels = [*lines.rate_panels(points), lines.area_panel()]
    heading = "Frame rate and area against the number of modules"
    return lines.draw(points, options, heading, UNITS_USED, [KEY], panels)


if __name__ == "__main__":
    command.main(__doc__, {"units": draw})
