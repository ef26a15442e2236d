#!/usr/bin/python3
"""The figures of stereotlm conflicts, from its tables: where in the picture and when in a frame ports wait
for banks."""

import csv
import json
import os

import command
import style
from drawing import Drawing, Sheet, in_words, ticks_of_columns
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.patches import Patch

PAINT = LinearSegmentedColormap.from_list("paint", [(0.84, 0.37, 0, 0), (0.84, 0.37, 0, 0.95)])  # vermilion
STALLS = "_stall_cycles"
KINDS = ["core", "capture", "upload", "read_back"]
BANK_COLORS = [style.BLUE, style.GREEN, style.SKY, style.PINK, style.ORANGE, style.BLACK, style.GRAY]


def read(folder, name):
    with open(os.path.join(folder, name), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Recorded:
    """What a run has recorded. tiles: rows of conflicts.csv; sums, frame: rows of rows.csv, the fill
    first."""

    def __init__(self, folder):
        with open(os.path.join(folder, "about.json"), encoding="utf-8") as file:
            self.about = json.load(file)
        self.tiles = read(folder, "conflicts.csv")
        self.sums = read(folder, "sums.csv")
        self.frame = read(folder, "frame.csv")
        self.picture = None
        path = os.path.join(folder, "picture.raw")
        if os.path.exists(path):
            with open(path, "rb") as file:
                pixels = file.read()
            width = self.about["width"]
            self.picture = [list(pixels[at : at + width]) for at in range(0, len(pixels), width)]
        names = list(self.sums[0])
        self.banks = [name[: -len("_core_accesses")] for name in names if name.endswith("_core_accesses")]
        self.banks = [bank for bank in self.banks if sum(map(lambda row: self.accesses(row, bank),
                                                             self.sums))]
        self.waiting = [name
                        for name in names
                        if name.endswith(STALLS) and any(int(row[name]) for row in self.sums)]
        frames = self.about["frames"]
        self.note = f"Board {self.about['board']}; {frames} frame{'s' if frames > 1 else ''}."

    @staticmethod
    def accesses(row, bank):
        return sum(int(row[f"{bank}_{kind}_accesses"]) for kind in KINDS)

    def share(self, row, name):
        """In percent of the cycles of these rows. name: of a bank, or of a column of stalls."""
        cycles = int(row["cycles"])
        part = int(row[name]) if name.endswith(STALLS) else self.accesses(row, name)
        return 100 * part / cycles if cycles else 0

    def causes(self):
        """{(port, bank, by): cycles}"""
        causes = {}
        for row in self.tiles:
            key = row["port"], row["bank"], row["by"]
            causes[key] = causes.get(key, 0) + int(row["cycles"])
        return causes


def name_of(column):
    return column[: -len(STALLS)] + " waits" if column.endswith(STALLS) else column


def bank_rows(recorded, options):
    """The use of the banks, and the stalls, row by row."""
    columns = [*recorded.banks, *recorded.waiting]
    rows = recorded.sums[1:]
    sheet = Sheet("How busy banks are, and who waits, from the top of the picture to its bottom",
                  options.size,
                  options.format)
    sheet.note("Of the cycles of each row of results: accesses of the bank, or waits of the port. " +
               recorded.note)
    (axes,) = sheet.grid([4.2], 1, 0.7, 0.3, bottom=1.5)
    edges = [int(row["first_row"]) for row in rows] + [recorded.about["height"]]
    values = [[recorded.share(row, name) for name in columns] for row in rows]
    shown = axes.pcolormesh(range(len(columns) + 1), edges, values, cmap=style.SCALE, vmin=0, vmax=100,
                            rasterized=True)
    axes.invert_yaxis()
    axes.grid(False)
    axes.set_ylabel("row of the picture")
    axes.set_xticks([number + 0.5 for number in range(len(columns))], [name_of(name) for name in columns],
                    rotation=30, ha="right", fontsize=style.SMALL_SIZE)
    for number in range(1, len(columns)):
        axes.axvline(number, color="white", linewidth=1 if number != len(recorded.banks) else 4)
    sheet.color_bar(shown, "% of the cycles", 0.95)
    table = [[row["first_row"], row["last_row"], row["cycles"], *each] for row, each in zip(rows, values)]
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
    paint = [[0.0] * ((width + 3) // 4) for _ in range(height)]
    for (first_row, last_row, first_column, last_column), (lost, cycles) in tiles.items():
        for row in range(first_row, last_row + 1):
            for group in range(first_column // 4, last_column // 4 + 1):
                paint[row][group] = 100 * lost / cycles
    most = max((max(row) for row in paint), default=0)
    sheet = Sheet("Where in the picture ports wait", options.size, options.format)
    sheet.note("Waits of all ports, of the cycles after which the results of this place leave. "
               "The ports read ahead of the results. " + recorded.note)
    left, right = 0.6, 0.25
    (axes,) = sheet.grid([(sheet.width - left - right) * height / width], 1, left, right, bottom=0.95)
    extent = (0, width, height, 0)
    if recorded.picture:
        axes.imshow(recorded.picture, cmap="gray", vmin=0, vmax=255, extent=extent, aspect="auto")
    shown = axes.imshow(paint, cmap=PAINT, vmin=0, vmax=most or 1, extent=extent, aspect="auto",
                        interpolation="nearest")
    axes.grid(False)
    axes.set_ylabel("row")
    sheet.color_bar(shown, "waits, % of the cycles (two ports that wait count twice)", 0.5)
    header = ["first_row", "last_row", "first_column", "last_column", "stall_cycles", "cycles"]
    return Drawing(sheet, header, [[*place, *each] for place, each in sorted(tiles.items())], "")


def time_line(recorded, options):
    """One frame: the use of the banks, and the stalls, over its time."""
    times = [0]
    for row in recorded.frame:
        times.append(times[-1] + int(row["cycles"]) / recorded.about["clock_mhz"] / 1000)
    sheet = Sheet("A frame of the core: how busy banks are, and who waits, over its time", options.size,
                  options.format)
    colors = {bank: BANK_COLORS[number % len(BANK_COLORS)] for number, bank in enumerate(recorded.banks)}
    waiting = {name: style.COLORS[number % len(style.COLORS)] for number, name in enumerate(recorded.waiting)}
    sheet.legend([(style.line_handle(color, "", style.DASHES[number // len(BANK_COLORS) % 4]), bank)
                  for number, (bank, color) in enumerate(colors.items())])
    sheet.legend([(Patch(color=color), name_of(name)) for name, color in waiting.items()])
    sheet.note(f"Frame {recorded.about['frame']}, the one with the most cycles, by rows of results; the "
               f"first step "
               "is the time before the first results. " + recorded.note)
    panels = sheet.grid([2.0, 1.4] if waiting else [2.0], left=0.8)
    for number, (bank, color) in enumerate(colors.items()):
        panels[0].stairs([recorded.share(row, bank) for row in recorded.frame], times, color=color,
                         baseline=None,
                         linewidth=1.2, linestyle=style.DASHES[number // len(BANK_COLORS) % 4])
    panels[0].set_ylabel("bank busy, %")
    panels[0].set_ylim(0, 105)
    if waiting:
        bottom = [0.0] * len(recorded.frame)
        for name, color in waiting.items():
            top = [low + recorded.share(row, name) for low, row in zip(bottom, recorded.frame)]
            panels[1].stairs(top, times, baseline=bottom, fill=True, color=color, linewidth=0)
            bottom = top
        panels[1].set_ylabel("ports wait, %")
        panels[1].set_ylim(0, 1.05 * max(*bottom, 1e-9))
    panels[-1].set_xlabel("time since the frame began, ms")
    panels[-1].set_xlim(0, times[-1])
    columns = [*recorded.banks, *recorded.waiting]
    table = [[begin, end, row["first_row"], row["last_row"], *(recorded.share(row, name) for name in columns)]
             for begin, end, row in zip(times, times[1:], recorded.frame)]
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
    sheet.legend([(Patch(color=colors[by]), by if by == "turnaround" else f"for {by}") for by in blamed])
    sheet.note(recorded.note)
    widest = max(style.text_width(f"{port} on {bank}", style.SIZE) for bank, port in places)
    panels = sheet.grid([0.3 + 0.3 * len(places)], 1, widest + 0.3, 0.2)
    for number, (bank, port) in enumerate(places):
        at = 0
        for by in blamed:
            width = lost.get((port, bank, by), 0) / frames / factor
            panels[0].barh(number, width, 0.6, at, color=colors[by], linewidth=0)
            at += width
    panels[0].set_yticks(range(len(places)), [f"{port} on {bank}" for bank, port in places])
    panels[0].set_ylim(len(places) - 0.4, -0.6)
    panels[0].grid(False, axis="y")
    ticks_of_columns(panels, most / frames / factor)
    sheet.below(f"{word}cycles of waiting a frame")
    table = [[*key, cycles] for key, cycles in sorted(lost.items())]
    return Drawing(sheet, ["port", "bank", "by", "cycles"], table, "")


FIGURES = {"bank_rows": bank_rows, "picture": picture, "time_line": time_line, "causes": causes}


if __name__ == "__main__":
    command.main_of_tables(__doc__, Recorded, FIGURES)
