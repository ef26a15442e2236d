"""The page of a figure of plot and paper: title, panels, legend, notes, and the axes in them."""

import csv
import io
import math
import re

import numpy
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import (FixedFormatter, FixedLocator, LogLocator, MaxNLocator, NullLocator,
                               ScalarFormatter)

import style
from points import BANKS_USED, UNITS_USED, Unusable
from style import LABEL_SIZE, LEGEND_SIZE, QUIET, SIZE, SMALL_SIZE, TITLE_SIZE

WIDTH = 7.2  # inches, if the user asks for no other size
MARGIN = 0.1  # inches
LINE = 0.148  # inches: a line of the legend
NOTE_LINE = 0.14
TITLE_LINE = 0.2
HANDLE, BETWEEN = 0.42, 0.19  # inches: the sample of an entry of the legend, and the gap between two entries
LEAST_HEIGHT, LEAST_WIDTH = 0.8, 0.5  # inches, of a panel
GAP = 0.12  # inches, between two panels
HEAD = 0.22  # inches: the title of a panel
MOST_TICKS = 14
# Marks of points that do not fit the FPGA, or whose pictures are not complete.
MARK = {"color": "#000000", "linestyle": "", "zorder": 3.5}
TOO_LARGE = {**MARK, "marker": "x", "markersize": 4.5, "label": "more area than the FPGA has"}
LOSES_PIXELS = {**MARK, "marker": "+", "markersize": 6.5, "label": "loses pixels"}

UNITS = [("_percent", "%"), ("_mhz", "MHz"), ("_hz", "Hz"), ("megabytes_per_second", "MB/s"), ("_us", "us"),
         ("_ms", "ms"), ("_cycles", "cycles"), ("clocks", "clocks"), ("_words", "words"), ("_slots", "slots"),
         ("_bytes", "bytes"),
         ("_pixels", "pixels"), ("_frames", "frames"), ("image.width", "pixels"), ("image.height", "pixels")]
MEANINGS = {
    "frames_per_second.core": "core, frames/s",
    "frames_per_second.steady": "whole computer, steady frames/s",
    "frames_per_second.system": "whole computer, from power-up, frames/s",
    "bound.core": "core bound, frames/s",
    "bound.system": "steady bound, frames/s",
    "matcher.window": "window n, pixels (of n x n)",
    "matcher.disparities": "disparities D",
    "matcher.rows": "rows of results at once",
    UNITS_USED: "column and window modules",
    BANKS_USED: "banks used by the allocation",
    "area.slices": "area, slices",
    "area.slices_percent": "area, % of the slices",
    "area.luts": "area, LUTs",
    "area.flip_flops": "area, flip-flops",
    "area.block_rams": "block RAMs",
    "area.block_rams_percent": "block RAMs, % of the FPGA's",
    "area.multipliers": "multipliers",
    "area.multipliers_percent": "multipliers, % of the FPGA's",
}


def title(column):
    """The label of an axis that shows this column, with the unit."""
    if column in MEANINGS:
        return MEANINGS[column]
    if column.startswith("latency_ms."):
        return f"{column[len('latency_ms.'):]}, ms"
    unit = next((unit for ending, unit in UNITS if column.endswith(ending)), "")
    return f"{column}, {unit}" if unit else column


def bound_of(column):
    """The column with the upper bound of this column; None if there is none."""
    return {"frames_per_second.core": "bound.core", "frames_per_second.steady": "bound.system",
            "frames_per_second.system": "bound.system"}.get(column)


class Drawing:
    """A figure that is drawn: its files, and what the command prints about it."""

    def __init__(self, sheet, header, rows, said):
        """header, rows: the table; said: text about the figure, such as the number of its points."""
        self.files = {**sheet.files, ".csv": table(header, rows)}
        self.said = said
        self.boxed = sheet.boxed()  # see there


def table(header, rows):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(["" if value is None else value for value in row] for row in rows)
    return text.getvalue().encode()


class Sheet:
    """The page of a figure: a title, panels with sizes in inches, and below them the legend, a list and
    notes.

    legend() and note() must be called before grid(), which creates the panels.
    width: in inches.
    """

    def __init__(self, heading, size=None, formats=None):
        """size: (width, height) in inches; None: WIDTH, and as high as the content. formats: some of
        style.FORMATS."""
        style.use()
        self.figure = Figure()
        FigureCanvasAgg(self.figure)
        self.width, self.height = size or (WIDTH, None)
        self.panels = []
        self._formats = formats or style.USUAL_FORMATS
        self._heading = style.wrapped(heading, TITLE_SIZE, self._room(), bold=True)
        self._legends = []
        self._below = []  # (line, color) of texts below the legend

    def _room(self):
        return self.width - 2 * MARGIN

    def legend(self, handles):
        """Adds a group to the legend. handles: (artist, text) of each entry."""
        if handles:
            self._legends.append(LegendGroup(handles, self._room()))

    def note(self, text, color=QUIET, indent=""):
        """Adds a text below the legend, if it is not empty. indent: of its further lines."""
        if text:
            self._below += [(line, color) for line in style.wrapped(text, SMALL_SIZE, self._room(), indent)]

    def grid(self, heights, count=1, left=0.85, right=0.25, bottom=0.5, above=0, least=None):
        """Creates and returns panels: one of each height from the top, or `count` side by side from the left.

        Panels above each other share their x axis, panels side by side their y axis.
        left, right, bottom, above: inches around them; least: the least height of all panels together.
        """
        gaps = GAP * (len(heights) - 1)
        total, inside, top = self._begin(sum(heights) + gaps, above, bottom,
                                         least or LEAST_HEIGHT * len(heights) + gaps)
        width = self.width - left - right - GAP * (count - 1)
        if width < LEAST_WIDTH * count:
            raise Unusable(f"--size {self.width:g}x{self.height:g}: this figure needs a width of "
                           f"{rounded_up(self.width - width + LEAST_WIDTH * count)} inches")
        axes = self.figure.subplots(len(heights), count, sharex="col", sharey="row", squeeze=False,
                                    gridspec_kw={
            "left": left / self.width, "right": 1 - right / self.width, "top": 1 - top / total,
            "bottom": 1 - (top + inside) / total, "height_ratios": heights,
            "hspace": GAP * len(heights) / (inside - gaps), "wspace": GAP * count / width})
        self.panels = list(axes.flat)
        return self.panels

    def head(self, axes, text):
        """Writes the title of a column, smaller if the column is narrow."""
        fits = (length_of(axes, "x") + 0.06) / style.text_width(text, SIZE)
        axes.set_title(text, fontsize=SIZE * min(1, max(0.6, fits)), pad=4)

    def below(self, text, distance=0.38):
        """Writes the name of the x axis of all columns below them, at this distance in inches."""
        boxes = [axes.get_position() for axes in self.panels]
        bottom = boxes[0].y0 - distance / self.figure.get_size_inches()[1]
        self.figure.text((boxes[0].x0 + boxes[-1].x1) / 2, bottom, text, ha="center", va="center",
                         fontsize=LABEL_SIZE)

    def color_bar(self, shown, text, below):
        """Draws the scale of the colors of `shown` under the panels, `below` inches from them."""
        box, total = self.panels[0].get_position(), self.figure.get_size_inches()[1]
        width = min(3, length_of(self.panels[0], "x"))
        left = (box.x0 + self.panels[-1].get_position().x1 - width / self.width) / 2
        axes = self.figure.add_axes([left, box.y0 - below / total, width / self.width, 0.1 / total])
        bar = self.figure.colorbar(shown, cax=axes, orientation="horizontal")
        bar.outline.set_visible(False)
        axes.tick_params(labelsize=8)
        axes.set_xlabel(text)
        return axes

    def _begin(self, inside, more_above, bottom, least):
        """Draws title, legend, list and notes, and sets the size of the figure.

        Returns in inches the height of the figure, that of the panels, and how far they are from the top.
        """
        top = MARGIN + TITLE_LINE * len(self._heading) + 0.04 + more_above
        legend = sum(group.lines for group in self._legends) * LINE + (0.06 if self._legends else 0)
        notes = len(self._below) * NOTE_LINE + (0.1 if self._below else 0)
        around = top + bottom + legend + notes + 0.05
        if self.height is not None:
            inside = self.height - around
            if inside < least:
                raise Unusable(f"--size {self.width:g}x{self.height:g}: so wide, this figure needs a height "
                               f"of {rounded_up(around + least)} inches")
        total = around + inside
        self.figure.set_size_inches(self.width, total)
        for number, line in enumerate(self._heading):
            self.figure.text(MARGIN / self.width, 1 - (MARGIN + number * TITLE_LINE) / total, line, va="top",
                             fontsize=TITLE_SIZE, weight="bold")
        at = notes + legend + 0.05
        for group in self._legends:
            group.draw(self.figure, at / total)
            at -= group.lines * LINE
        for number, (line, color) in enumerate(reversed(self._below)):
            self.figure.text(MARGIN / self.width, (0.06 + number * NOTE_LINE) / total, line,
                             fontsize=SMALL_SIZE,
                             va="bottom", color=color)
        return total, inside, top

    @property
    def files(self):
        """{ending: bytes}."""
        return {f".{kind}": style.encoded(self.figure, kind) for kind in self._formats}

    def boxed(self):
        """The parts of its texts for which the font has no characters. PNG and PDF show boxes for them."""
        texts = {text.get_text() for text in self.figure.findobj(Text)}
        unknown = re.escape("".join(set().union(*map(style.unknown_characters, texts))))
        return {part for text in texts for part in re.findall(f"[{unknown}]+", text)} if unknown else set()


def rounded_up(inches):
    return f"{math.ceil(10 * inches - 1e-6) / 10:g}"


class LegendGroup:
    """Entries of the legend, in as many columns as have room, and none that would be empty. lines: its
    height."""

    def __init__(self, handles, room):
        self.artists = [artist for artist, _ in handles]
        lines = [style.wrapped(text, LEGEND_SIZE, room - HANDLE) for _, text in handles]
        self.texts = ["\n".join(each) for each in lines]
        widest = max(style.text_width(line, LEGEND_SIZE) for each in lines for line in each)
        most = max(1, int((room + BETWEEN) / (widest + HANDLE + BETWEEN)))
        rows = -(-len(handles) // most)
        self.columns = -(-len(handles) // rows)
        # matplotlib distributes the entries on the columns as array_split() does.
        parts = numpy.array_split(list(map(len, lines)), self.columns)
        self.lines = max(int(part.sum()) for part in parts)

    def draw(self, figure, top):
        figure.legend(self.artists, self.texts, loc="upper center", ncol=self.columns, borderpad=0,
                      borderaxespad=0,
                      labelspacing=0.25, columnspacing=1.6, handlelength=2.6, bbox_to_anchor=(0.5, top))


def mark_handle(mark):
    return (Line2D([], [], **mark), mark["label"])


def length_of(axes, which):
    """The length of an axis in inches; which: "x" or "y"."""
    box, (width, height) = axes.get_position(), axes.figure.get_size_inches()
    return box.width * width if which == "x" else box.height * height


def ticks_at(axes, values):
    """Sets the ticks of the x axis to the values of the points, if there is room for that, with the labels
    that fit."""
    if len(values) > MOST_TICKS:
        axes.xaxis.set_major_locator(MaxNLocator(integer=all(value == int(value) for value in values)))
        return
    low, high = axes.get_xlim()
    labels = [f"{value:.10g}" for value in values]
    free = -math.inf  # where the label before ends, in inches
    for number, (value, label) in enumerate(zip(values, labels)):
        width = style.text_width(label, SIZE)
        center = (value - low) / (high - low) * length_of(axes, "x")
        if center - width / 2 < free:
            labels[number] = ""
        else:
            free = center + width / 2 + 0.05
    axes.xaxis.set_major_locator(FixedLocator(values))
    axes.xaxis.set_major_formatter(FixedFormatter(labels))
    axes.xaxis.set_minor_locator(NullLocator())


def ticks_of_columns(panels, most):
    """Sets scale and ticks of panels side by side, from 0 to `most`, so that no labels of neighbors touch."""
    length = length_of(panels[0], "x")
    end = 1.03 * most
    for count in (4, 3, 2, 1):
        step = MaxNLocator(count, steps=[1, 2, 5, 10]).tick_values(0, most)[1]
        ticks = [number * step for number in range(int(most / step + 1e-9) + 1)]
        labels = [f"{tick:.10g}" for tick in ticks]
        widths = [style.text_width(label, SIZE) for label in labels]
        places = [tick / end * length for tick in ticks] + [length + GAP]
        widths.append(widths[0])
        if all(places[at + 1] - places[at] > (widths[at] + widths[at + 1]) / 2 + 0.05
               for at in range(len(ticks))):
            break
    else:
        ticks, labels = [0], ["0"]
    for axes in panels:
        axes.set_xlim(0, end)
        axes.set_xticks(ticks, labels)


def in_words(most):
    """(factor, word) with which numbers up to `most` are written."""
    for factor, word in ((1e6, "million "), (1e3, "thousand ")):
        if most >= 2 * factor:
            return factor, word
    return 1, ""


def scale(axes, which, label, values, *remarks, are_counts=False):
    """Sets scale and label of an axis. The scale is logarithmic if all values are positive and the largest is
    above 6 times the least; else it begins at zero if no value is negative.

    which: "x" or "y". remarks: added to the label in brackets. are_counts: an axis of few whole
    numbers, such as banks, does not begin at zero.
    """
    values = [value for value in values if value is not None]
    axis, limit = getattr(axes, which + "axis"), getattr(axes, f"set_{which}lim")
    is_short = values and max(values) - min(values) <= MOST_TICKS
    if are_counts and is_short and all(value == int(value) for value in values):
        limit(min(values) - 0.5, max(values) + 0.5)
        axis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    elif values and min(values) > 0 and max(values) > 6 * min(values):
        getattr(axes, f"set_{which}scale")("log")
        axis.set_major_locator(LogLocator(subs=subs_that_fit(axes, which, min(values), max(values))))
        axis.set_minor_locator(NullLocator())
        formatter = ScalarFormatter()
        formatter.set_scientific(False)
        axis.set_major_formatter(formatter)
        limit(min(values) / 1.25, max(values) * 1.25)
        remarks = ("log scale", *remarks)
    elif values and min(values) >= 0 and max(values) > 0:
        limit(0, max(values) * 1.08)
        axis.set_major_locator(MaxNLocator(max(2, min(9, int(length_of(axes, which) / 0.5)))))
    text = label + (f" ({', '.join(remarks)})" if remarks else "")
    lines = style.wrapped(text, LABEL_SIZE, length_of(axes, which) + 0.2)
    getattr(axes, f"set_{which}label")("\n".join(lines))


def subs_that_fit(axes, which, least, most):
    """The ticks in each decade of a logarithmic axis, as many as have room for their labels."""
    decades = math.log10(most / least) + 2 * math.log10(1.25)
    room = style.text_width(f"{most:.0f}", SIZE) + 0.15 if which == "x" else 0.17
    for subs, closest in (((1, 2, 5), math.log10(2)), ((1, 3), math.log10(3))):
        if length_of(axes, which) * closest / decades > room:
            return subs
    return (1,)
