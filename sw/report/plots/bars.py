"""Figures that have a row for each point: selects and names the points, and draws bars or cells."""

import style
from drawing import HEAD, WIDTH, Drawing, Sheet, in_words, length_of, ticks_of_columns
from matplotlib.patches import Patch
from points import OTHER_CAUSES, PORTS, Unusable, counted, natural, short_names, text_of
from style import SMALL_SIZE

MOST = 16
ROW = 0.2  # inches
LINE = 0.12
CLOSEST = 0.112  # from line to line
NAMES = 0.38  # share of the width that names may take
LEAST_HEIGHT = 0.3  # inches
TEXT_CHANGES = 55  # percent; above it white text is easier to read than black

STATES = {
    "grants": ("granted", style.BLUE),
    "passed_cycles": ("passed without access", style.SKY),
    "stall_cycles": ("waiting", style.VERMILION),
    "blocked_cycles": ("blocked", style.ORANGE),
    "starved_cycles": ("starved", "#999999"),
    "idle_cycles": ("idle", "#DDDDDD"),
}
CAUSES = {by: (by if by in OTHER_CAUSES else f"for {by}", color)
          for by, color in zip([*PORTS, *OTHER_CAUSES],
                               [style.ORANGE, style.SKY, style.BLUE, style.GREEN, style.PINK,
                                                      "#999999", style.BLACK, "#999933", "#882255"])}


class Rows:
    """The points of a figure, from its top, with their names.

    height: in inches; least: the same with all lines as close as they can be.

    Of more than MOST points, MOST are shown: with most_stalled those that wait most, else evenly by rate.
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
        self.edges = [0]  # inches from the top
        for name in self.names:
            self.edges.append(self.edges[-1] + max(ROW, (name.count("\n") + 1) * LINE + 0.06))
        self.centers = [(top + bottom) / 2 for top, bottom in zip(self.edges, self.edges[1:])]
        self.height = self.edges[-1]
        self.least = CLOSEST * sum(name.count("\n") + 1.2 for name in self.names)

    def _names(self, width):
        short = short_names(self.points.varied)
        names = [", ".join(f"{short[key]}={text_of(value)}".replace(" ", "\N{NO-BREAK SPACE}")
                           for key, value in zip(short, values))
                 for values in self.points.rows(short, self.places)]
        if not short:
            names = [text_of(self.points.column("name")[place]) for place in self.places]
        return ["\n".join(style.wrapped(name, SMALL_SIZE, width)) for name in names]

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
    unit: the end of the label of the x axis, behind the factor in words.
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


def states(points, options):
    """What each port does in the cycles of a frame, point by point: granted, passed, waiting, blocked,
    starved or idle."""
    rows = Rows(points, options)
    points.need_numbers([f"ports.{port}.{count}" for port in PORTS for count in ("grants", "stall_cycles")])
    ports = [port for port in PORTS  # those that are granted or stall in one of these points
             if any(points.column(f"ports.{port}.{count}")[place]
                    for place in rows.places for count in ("grants", "stall_cycles"))]
    points.need_numbers([f"ports.{port}.{count}" for port in ports for count in STATES])

    def cycles(place, port, count):
        return points.column(f"ports.{port}.{count}")[place]

    sheet = stacked(points, options, rows, "What each port does in the cycles of a frame", ports, STATES,
                         cycles,
                         "cycles a frame")
    header = ["hash", *points.varied, "frames", "port", *STATES]
    table = [[*of_point, port, *(cycles(place, port, count) for count in STATES)]
             for place, of_point in zip(rows.places, points.rows(header[:-len(STATES) - 1], rows.places))
             for port in ports]
    return Drawing(sheet, header, table,
                   f"{counted(len(rows.places), 'point')}, {counted(len(ports), 'port')}")


def stalls(points, options):
    """The cycles in which each port waits in a frame, point by point, by cause: the port that was granted,
    turnaround, row or refresh. Lanes of a port are one port, with their mean."""
    if not any(points.stall_cycles()):
        raise Unusable("no port waits in any point")
    rows = Rows(points, options, most_stalled=True)
    blame = {place: points.blame(place) for place in rows.places}
    stalled = [port for port in PORTS if any(row[0] == port for each in blame.values() for row in each)]

    def cycles(place, port, by):
        return sum(row[3] for row in blame[place] if (row[0], row[2]) == (port, by))

    sheet = stacked(points, options, rows, "Which port waits, and for whom", stalled, CAUSES, cycles,
                         "cycles a frame in which the port waits")
    header = ["hash", *points.varied, "frames", "port", "bank", "by", "cycles"]
    table = [[*of_point, *row] for place, of_point in zip(rows.places, points.rows(header[:-4], rows.places))
             for row in blame[place]]
    said = f"{counted(len(rows.places), 'point')}, {counted(len(stalled), 'port')} with waits"
    return Drawing(sheet, header, table, said)


def use(points, options):
    """How busy each bank is while the core works on a frame, point by point."""
    rows = Rows(points, options)
    columns = sorted((name
                      for name in points.names
                      if name.startswith("banks.") and name.endswith(".utilization")),
                     key=natural)
    banks = [name.split(".", 1)[1].rpartition(".")[0] for name in columns]
    for name in columns:
        points.need_numbers([name], points.places_with(name))
    sheet = Sheet("How busy each bank is", options.size, options.format)
    percent = [[None if (use := points.column(name)[place]) is None else 100 * use for name in columns]
               for place in rows.places]
    if any(None in row for row in percent):
        sheet.legend([(Patch(color=style.MISSING), "the board has no such bank")])
    rows.note_below(sheet, "Of the cycles in which the core works on a frame, those in which the bank serves "
                           "an access.")
    height, least = (max(each, LEAST_HEIGHT) for each in (rows.height, rows.least))
    (axes,) = sheet.grid([height], 1, rows.left(), 0.3, bottom=0.95, least=least)
    numbers = [[float("nan") if use is None else use for use in row] for row in percent]
    axes.set_facecolor(style.MISSING)
    shown = axes.pcolormesh(range(len(banks) + 1), rows.edges, numbers, cmap=style.SHARES, vmin=0, vmax=100,
                            edgecolors="white", linewidth=1)
    cell = length_of(axes, "x") / len(banks)
    size = style.SMALL_SIZE * min(1, cell / style.text_width(" 100 ", style.SMALL_SIZE))
    for row, center in zip(percent, rows.centers):
        for number, use in enumerate(row):
            if use is not None:
                text = f"{use:.0f}" if use == 0 or use >= 0.5 else "<1"
                axes.text(number + 0.5, center, text, ha="center", va="center_baseline", fontsize=size,
                          color="white" if use > TEXT_CHANGES else "black")
    widest = max(style.text_width(bank, style.SIZE) for bank in banks)
    axes.set_xticks([number + 0.5 for number in range(len(banks))], banks,
                    fontsize=style.SIZE * min(1, max(0.5, 0.92 * cell / widest)))
    axes.tick_params(axis="x", length=0)
    rows.label(axes)
    axes.grid(False)
    for side in axes.spines.values():
        side.set_visible(False)
    sheet.color_bar(shown, "use of the bank, % of cycles", 0.42)
    header = ["hash", *points.varied, *columns]
    return Drawing(sheet, header, points.rows(header, rows.places),
                   f"{counted(len(rows.places), 'point')}, {counted(len(banks), 'bank')}")
