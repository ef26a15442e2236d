"""Figures that have a row for each point: selects and names the points, and draws stacked bars."""

import style
from drawing import HEAD, WIDTH, Sheet, in_words, ticks_of_columns
from matplotlib.patches import Patch
from points import natural, short_names, text_of
from style import SMALL_SIZE

MOST = 16
ROW = 0.2  # inches
LINE = 0.12
CLOSEST = 0.112  # from line to line
NAMES = 0.38  # share of the width that names may take


class Rows:
    """The points of a figure, from its top, with their names.

    height, least: in inches; the second with all lines as close as they can be.

    Of more than MOST points: those with the most stalls (most_stalled), or a selection over all frame rates.
    """

    def __init__(self, points, options, most_stalled=False):
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
                self.left_out = {"with fewer waits": len(rates) - MOST}
                self.note = f"The {MOST} points whose ports wait most in a frame."
            else:
                chosen = [chosen[number * (len(chosen) - 1) // (MOST - 1)] for number in range(MOST)]
        keys = [points.column(key) for key in points.varied]
        self.points = points
        self.places = sorted(chosen, key=lambda place: [natural(column[place]) for column in keys])
        self.names = self._names(NAMES * (options.size or (WIDTH,))[0])
        self.edges = self._lay_out()  # inches from the top
        self.centers = [(top + bottom) / 2 for top, bottom in zip(self.edges, self.edges[1:])]
        self.height = self.edges[-1]
        self.least = CLOSEST * sum(name.count("\n") + 1.2 for name in self.names)

    def _names(self, width):
        short = short_names(self.points.varied)
        names = []
        for place in self.places:
            parts = [f"{short[key]}={text_of(self.points.column(key)[place])}".replace(" ",
                                                                                       "\N{NO-BREAK SPACE}")
                     for key in self.points.varied]
            names.append(", ".join(parts))
        if not self.points.varied:
            names = [text_of(self.points.column("name")[place]) for place in self.places]
        return ["\n".join(style.wrapped(name, SMALL_SIZE, width)) for name in names]

    def _lay_out(self):
        edges = [0]
        for name in self.names:
            edges.append(edges[-1] + max(ROW, (name.count("\n") + 1) * LINE + 0.06))
        return edges

    def left(self):
        """The width of the names in inches."""
        return 0.2 + max(style.text_width(line, SMALL_SIZE) for name in self.names
                         for line in name.split("\n"))

    def note_below(self, sheet, text=""):
        """Writes which points are shown, and `text`, below the figure."""
        for each in (self.note, text, self.points.pixels_note(self.places),
                     self.points.note(len(self.places), self.left_out)):
            sheet.note(each)

    def label(self, axes):
        axes.set_ylim(self.height, 0)
        axes.set_yticks(self.centers, self.names, fontsize=SMALL_SIZE)
        axes.tick_params(axis="y", length=0)
        axes.grid(False, axis="y")


def stacked(points, options, rows, heading, ports, parts, cycles, unit):
    """A sheet with a panel for each port, and in it a bar for each point, stacked from its parts.

    parts: {part: (name, color)}; those without cycles are not shown.
    cycles(place, port, part): of all frames.
    unit: what an axis of cycles a frame says.
    """
    frames = points.frames()
    shares = {(place, port, part): cycles(place, port, part) / frames[place]
              for place in rows.places for port in ports for part in parts}
    shown = [part for part in parts if any(shares[place, port, part] for place in rows.places
                                           for port in ports)]
    most = max(sum(shares[place, port, part] for part in shown) for place in rows.places for port in ports)
    factor, word = in_words(most)
    sheet = Sheet(heading, options.size, options.format)
    sheet.legend([(Patch(color=parts[part][1]), parts[part][0]) for part in shown])
    rows.note_below(sheet)
    panels = sheet.grid([rows.height], len(ports), rows.left(), 0.2, above=HEAD, least=rows.least)
    for axes, port in zip(panels, ports):
        for place, center in zip(rows.places, rows.centers):
            at = 0
            for part in shown:
                width = shares[place, port, part] / factor
                axes.barh(center, width, 0.14, at, color=parts[part][1], linewidth=0)
                at += width
        sheet.head(axes, port)
        rows.label(axes)
    ticks_of_columns(panels, most / factor)
    sheet.below(f"{word}{unit}")
    return sheet
