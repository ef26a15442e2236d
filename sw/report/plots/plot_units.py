#!/usr/bin/python3
"""Frames per second and area against the number of column and window modules.

There is a line for each combination of the other keys that vary.
"""

import command
import lines
from points import UNITS_USED


def draw(points, options):
    return lines.of_key(points, options, "matcher.units", "Frame rate and area against the number of modules",
                        x=UNITS_USED, with_area=True)


if __name__ == "__main__":
    command.main(__doc__, {"units": draw})
