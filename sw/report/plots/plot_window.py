#!/usr/bin/python3
"""Frames per second against the size of the window, a line for each combination of the other keys that vary."""

import sys

sys.path.insert(0, __file__.rpartition("/")[0] or ".")  # PYTHONSAFEPATH leaves it out

import command
import lines

KEY = "matcher.window"


def draw(points, options):
    points.need_variation(KEY)
    heading = "Frame rate against the size of the window"
    return lines.draw(points, options, heading, KEY, [KEY], lines.rate_panels(points))


if __name__ == "__main__":
    command.main(__doc__, {"window": draw})
