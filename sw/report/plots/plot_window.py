#!/usr/bin/python3
"""Frames per second against the size of the window, a line for each combination of the other keys that
vary."""

import command
import lines


def draw(points, options):
    return lines.of_key(points, options, "matcher.window", "Frame rate against the size of the window")


if __name__ == "__main__":
    command.main(__doc__, {"window": draw})
