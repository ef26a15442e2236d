#!/usr/bin/python3
"""Frames per second and area against the rows of results at once.

There is a line for each combination of the other keys that vary.
"""

import command
import lines


def draw(points, options):
    return lines.of_key(points, options, "matcher.rows",
                        "Frame rate and area against the rows of results at once",
                        with_area=True)


if __name__ == "__main__":
    command.main(__doc__, {"rows": draw})
