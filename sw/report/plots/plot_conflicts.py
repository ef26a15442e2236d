#!/usr/bin/python3
"""The figures of stereotlm conflicts, from its tables: where in the picture and when in a frame ports wait
for banks."""

import json
import os
import re
from collections import Counter

import command
import numpy
import style
from drawing import Drawing, Sheet, in_words, ticks_of_columns
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.patches import Patch
from points import OTHER_CAUSES, group_of

PAINT = LinearSegmentedColormap.from_list("paint", [(0.84, 0.37, 0, 0), (0.84, 0.37, 0, 0.95)])  # vermilion
STALLS = "_stall_cycles"
KINDS = ["core", "capture", "upload", "read_back"]
BANK_COLORS = [style.BLUE, style.GREEN, style.SKY, style.PINK, style.ORANGE, style.BLACK, style.GRAY]


class Recorded:
    """What a run has recorded. tiles: rows of conflicts.csv; sums, frame: columns of rows.csv, the fill
    first. The lanes of a port are one port, with their mean."""

    def __init__(self, folder):
        with open(os.path.join(folder, "about.json"), encoding="utf-8") as file:
            self.about = json.load(file)
        self.tiles = command.read_table(folder, "conflicts")
        tables = [command.read_table(folder, name) for name in ("sums", "frame")]
        ports = [name.removesuffix(STALLS) for name in tables[0][0] if name.endswith(STALLS)]
        self._lanes = Counter(map(group_of, ports))
        self.sums, self.frame = map(self._columns, tables)
        path = os.path.join(folder, "picture.raw")
        self.picture = (numpy.fromfile(path, numpy.uint8).reshape(-1, self.about["width"])
                        if os.path.exists(path) else None)
        shares = self.shares(self.sums)
        self.banks = [name for name in shares if not name.endswith(STALLS) and shares[name].any()]
        self.waiting = [name for name in shares if name.endswith(STALLS) and shares[name].any()]
        frames = self.about["frames"]
        self.note = f"Board {self.about['board']}; {frames} frame{'s' if frames > 1 else ''}."

    def _columns(self, rows):
        columns = {}
        for name in rows[0]:
            values = numpy.array([int(row[name] or -1) for row in rows])
            port = name.removesuffix(STALLS)
            if name.endswith(STALLS) and group_of(port) != port:
                name = group_of(port) + STALLS
                values = values / self._lanes[group_of(port)]
            columns[name] = columns[name] + values if name in columns else values
        return columns

    @staticmethod
    def shares(columns):
        """{bank, or column of stalls: percent of the cycles of each row}."""
        amounts = {name: column for name, column in columns.items() if name.endswith(STALLS)}
        for name, column in columns.items():
            for kind in KINDS:
                bank = name.removesuffix(f"_{kind}_accesses")
                if bank != name:
                    amounts[bank] = amounts.get(bank, 0) + column
        return {name: 100 * amount / numpy.maximum(columns["cycles"], 1) for name, amount in amounts.items()}

    @staticmethod
    def bank_text(bank):
        """The name of a bank in a figure, as bank_text() of platform/config/board_keys.h."""
        return bank if re.fullmatch(r"bank\d+", bank) else f"bank {bank}"

    def name_of(self, column):
        """The name in a figure of a column of shares()."""
        return column[: -len(STALLS)] + " waits" if column.endswith(STALLS) else self.bank_text(column)

    def causes(self):
        """{(port, bank, by): cycles}"""
        causes = {}
        for row in self.tiles:
            port = group_of(row["port"])
            key = port, row["bank"], group_of(row["by"])
            cycles = int(row["cycles"])
            causes[key] = causes.get(key, 0) + (cycles / self._lanes[port] if port != row["port"] else cycles)
        return causes


def bank_rows(recorded, options):
    """The use of the banks, and the stalls, row by row."""
    columns = [*recorded.banks, *recorded.waiting]
    first, last, cycles = (recorded.sums[name][1:] for name in ("first_row", "last_row", "cycles"))
    shares = recorded.shares(recorded.sums)
    values = numpy.array([shares[name][1:] for name in columns]).T
    sheet = Sheet("How busy banks are, and who waits, from the top of the picture to its bottom",
                  options.size,
                  options.format)
    sheet.note("Of the cycles of each row of results: accesses of the bank, or waits of the port. " +
               recorded.note)
    (axes,) = sheet.grid([4.2], 1, 0.7, 0.3, bottom=1.5)
    edges = [*first, recorded.about["height"]]
    shown = axes.pcolormesh(range(len(columns) + 1), edges, values, cmap=style.SCALE, vmin=0, vmax=100,
                            rasterized=True)
    axes.invert_yaxis()
    axes.grid(False)
    axes.set_ylabel("row of the picture")
    axes.set_xticks([number + 0.5 for number in range(len(columns))], map(recorded.name_of, columns),
                    rotation=30, ha="right", fontsize=style.SMALL_SIZE)
    for number in range(1, len(columns)):
        axes.axvline(number, color="white", linewidth=1 if number != len(recorded.banks) else 4)
    sheet.color_bar(shown, "% of the cycles", 0.95)
    table = [[*row, *each] for *row, each in zip(first, last, cycles, values.tolist())]
    return Drawing(sheet, ["first_row", "last_row", "cycles", *columns], table, "")


def picture(recorded, options):
    """The waits, over the picture."""
    tiles = {}
    for row in recorded.tiles:
        if row["first_row"]:
            place = tuple(int(row[name]) for name in ("first_row", "last_row", "first_column", "last_column"))
            lost, cycles = tiles.get(place, (0, int(row["tile_cycles"])))
            tiles[place] = lost + int(row["cycles"]), cycles
    width, height = recorded.about["width"], recorded.about["height"]
    paint = numpy.zeros((height, (width + 3) // 4))
    for (first_row, last_row, first_column, last_column), (lost, cycles) in tiles.items():
        paint[first_row : last_row + 1, first_column // 4 : last_column // 4 + 1] = 100 * lost / cycles
    sheet = Sheet("Where in the picture ports wait", options.size, options.format)
    sheet.note("Waits of all ports, of the cycles after which the results of this place leave. "
               "The ports read ahead of the results. " + recorded.note)
    left, right = 0.6, 0.25
    (axes,) = sheet.grid([(sheet.width - left - right) * height / width], 1, left, right, bottom=0.95)
    extent = (0, width, height, 0)
    if recorded.picture is not None:
        axes.imshow(recorded.picture, cmap="gray", vmin=0, vmax=255, extent=extent, aspect="auto")
    shown = axes.imshow(paint, cmap=PAINT, vmin=0, vmax=paint.max() or 1, extent=extent, aspect="auto",
                        interpolation="nearest")
    axes.grid(False)
    axes.set_ylabel("row")
    sheet.color_bar(shown, "waits, % of the cycles (two ports that wait count twice)", 0.5)
    header = ["first_row", "last_row", "first_column", "last_column", "stall_cycles", "cycles"]
    return Drawing(sheet, header, [[*place, *each] for place, each in sorted(tiles.items())], "")


def time_line(recorded, options):
    """One frame: the use of the banks, and the stalls, over its time."""
    times = numpy.cumsum([0, *recorded.frame["cycles"] / recorded.about["clock_mhz"] / 1000])
    shares = recorded.shares(recorded.frame)
    sheet = Sheet("A frame of the core: how busy banks are, and who waits, over its time", options.size,
                  options.format)
    colors = {bank: BANK_COLORS[number % len(BANK_COLORS)] for number, bank in enumerate(recorded.banks)}
    waiting = {name: style.COLORS[number % len(style.COLORS)] for number, name in enumerate(recorded.waiting)}
    sheet.legend([(style.line_handle(color, "", style.DASHES[number // len(BANK_COLORS) % 4]),
                   recorded.bank_text(bank))
                  for number, (bank, color) in enumerate(colors.items())])
    sheet.legend([(Patch(color=color), recorded.name_of(name)) for name, color in waiting.items()])
    sheet.note(f"Frame {recorded.about['frame']}, the one with the most cycles, by rows of results; the "
               f"first step "
               "is the time before the first results. " + recorded.note)
    panels = sheet.grid([2.0, 1.4] if waiting else [2.0], left=0.8)
    for number, (bank, color) in enumerate(colors.items()):
        panels[0].stairs(shares[bank], times, color=color, baseline=None, linewidth=1.2,
                         linestyle=style.DASHES[number // len(BANK_COLORS) % 4])
    panels[0].set_ylabel("bank busy, %")
    panels[0].set_ylim(0, 105)
    if waiting:
        bottom = numpy.zeros(len(times) - 1)
        for name, color in waiting.items():
            panels[1].stairs(bottom + shares[name], times, baseline=bottom, fill=True, color=color,
                             linewidth=0)
            bottom = bottom + shares[name]
        panels[1].set_ylabel("ports wait, %")
        panels[1].set_ylim(0, 1.05 * max(*bottom, 1e-9))
    panels[-1].set_xlabel("time since the frame began, ms")
    panels[-1].set_xlim(0, times[-1])
    columns = [*recorded.banks, *recorded.waiting]
    rows = [["" if row < 0 else row for row in recorded.frame[name]] for name in ("first_row", "last_row")]
    table = list(zip(times, times[1:], *rows, *(shares[name] for name in columns)))
    return Drawing(sheet, ["begin_ms", "end_ms", "first_row", "last_row", *columns], table, "")


def causes(recorded, options):
    """The stalls of each port, by bank and cause; None if no port waits."""
    lost = recorded.causes()
    if not lost:
        return None
    places = sorted({(bank, port) for port, bank, _ in lost})
    blamed = sorted({by for _, _, by in lost})
    colors = dict(zip(blamed, [*style.COLORS, style.GRAY, "#999933", "#882255"]))
    frames = recorded.about["frames"]
    most = max(sum(cycles for (port, bank, _), cycles in lost.items() if (bank, port) == place)
               for place in places)
    factor, word = in_words(most / frames)
    sheet = Sheet("Which port waits at which bank, and for whom", options.size, options.format)
    sheet.legend([(Patch(color=colors[by]), by if by in OTHER_CAUSES else f"for {by}") for by in blamed])
    sheet.note(recorded.note)
    names = [f"{port} on {recorded.bank_text(bank)}" for bank, port in places]
    widest = max(style.text_width(name, style.SIZE) for name in names)
    panels = sheet.grid([0.3 + 0.3 * len(places)], 1, widest + 0.3, 0.2)
    for number, (bank, port) in enumerate(places):
        at = 0
        for by in blamed:
            width = lost.get((port, bank, by), 0) / frames / factor
            panels[0].barh(number, width, 0.6, at, color=colors[by], linewidth=0)
            at += width
    panels[0].set_yticks(range(len(places)), names)
    panels[0].set_ylim(len(places) - 0.4, -0.6)
    panels[0].grid(False, axis="y")
    ticks_of_columns(panels, most / frames / factor)
    sheet.below(f"{word}cycles of waiting a frame")
    table = [[*key, cycles] for key, cycles in sorted(lost.items())]
    return Drawing(sheet, ["port", "bank", "by", "cycles"], table, "")


FIGURES = {"bank_rows": bank_rows, "picture": picture, "time_line": time_line, "causes": causes}


if __name__ == "__main__":
    command.main_of_tables(__doc__, Recorded, FIGURES)
