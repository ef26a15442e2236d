#!/usr/bin/python3
"""Frames per second against the number of banks that the allocation uses.

Every allocation is a dot, or many of them a range. A line goes through the best allocation for each number of
banks. There is a line for each combination of the other keys that vary.
"""

import command
import lines
from points import BANKS_USED, Unusable


def draw(points, options):
    if not points.varies(BANKS_USED):
        raise Unusable(f"all points use {points.column(BANKS_USED)[0]} banks")
    allocation = [key for key in points.varied if key.startswith("allocation.")]
    heading = "Frame rate against the banks that the allocation uses"
    return lines.draw(points, options, heading, BANKS_USED, allocation, lines.rate_panels(points), best=True)


if __name__ == "__main__":
    command.main(__doc__, {"banks": draw})
