"""Selects and names the points of figures that have a row for each point."""

import textwrap

from points import PORTS, natural, short_names, text_of

MOST = 16
ROW = 0.2  # inches
LINE = 0.12
NAME_CHARACTERS = 44


class Rows:
    """The points of a figure, from its top, with their names.

    Of more than MOST points: those with the most stalls (most_stalled), or a selection over all frame rates.
    """

    def __init__(self, points, most_stalled=False):
        stalls = [cycles / frames for cycles, frames in zip(points.stall_cycles(), points.frames())]
        points.need_numbers(["frames_per_second.core"])
        rates = points.column("frames_per_second.core")
        chosen = sorted(range(len(rates)), key=lambda place: (rates[place], points.hashes[place]))
        self.note = ""
        self.left_out = {}
        if len(chosen) > MOST:
            self.left_out = {"between them": len(chosen) - MOST}
            self.note = f"{MOST} points, evenly from the lowest core frame rate to the highest."
            if most_stalled:
                chosen = sorted(chosen, key=lambda place: -stalls[place])[:MOST]
                self.left_out = {"with fewer stalls": len(rates) - MOST}
                self.note = f"The {MOST} points with most stall cycles a frame."
            else:
                chosen = [chosen[number * (len(chosen) - 1) // (MOST - 1)] for number in range(MOST)]
        keys = [points.column(key) for key in points.varied]
        self.points = points
        self.places = sorted(chosen, key=lambda place: [natural(column[place]) for column in keys])
        self.names = self._names()
        self.edges = self._lay_out()  # inches from the top
        self.centers = [(top + bottom) / 2 for top, bottom in zip(self.edges, self.edges[1:])]
        self.height = self.edges[-1]

    def _names(self):
        short = short_names(self.points.varied)
        names = []
        for place in self.places:
            parts = [f"{short[key]}={text_of(self.points.column(key)[place])}".replace(" ", "\N{NO-BREAK SPACE}")
                     for key in self.points.varied]
            names.append("\n".join(textwrap.wrap(", ".join(parts), NAME_CHARACTERS, break_long_words=False)))
        return names if self.points.varied else [text_of(self.points.column("name")[place]) for place in self.places]

    def _lay_out(self):
        edges = [0]
        for name in self.names:
            edges.append(edges[-1] + max(ROW, (name.count("\n") + 1) * LINE + 0.06))
        return edges

    def left(self):
        """The width of the names in inches."""
        longest = max(len(line) for name in self.names for line in name.split("\n"))
        return 0.2 + min(longest, 46) * 0.062

    def label(self, axes):
        axes.set_ylim(self.height, 0)
        axes.set_yticks(self.centers, self.names, fontsize=7)
        axes.tick_params(axis="y", length=0)
        axes.grid(False, axis="y")


def used_ports(points, places):
    """The ports that are granted or stall in one of these points."""
    points.need_numbers([f"ports.{port}.{count}" for port in PORTS for count in ("grants", "stall_cycles")])
    return [port for port in PORTS
            if any(points.column(f"ports.{port}.{count}")[place]
                   for place in places for count in ("grants", "stall_cycles"))]
