"""What all figures share: size, fonts, axes, legend. The bytes of a figure depend only on the data."""

import csv
import io
import re
import textwrap
import warnings

import matplotlib
from matplotlib import font_manager
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator, LogLocator, MaxNLocator, NullLocator, ScalarFormatter

WIDTH = 7.2  # inches
DPI = 200
LINE = 0.146  # inches: a line of the legend
NOTE_LINE = 0.14
NOTE_CHARACTERS = 132
CHARACTER, HANDLE = 0.071, 0.6  # inches: widths in the legend
INK = "#222222"
QUIET = "#666666"
# Marks of points that do not fit the FPGA, or whose pictures are not complete.
MARK = {"color": "#000000", "linestyle": "", "zorder": 3.5}
TOO_LARGE = {**MARK, "marker": "x", "markersize": 4.5, "label": "more area than the FPGA has"}
LOSES_PIXELS = {**MARK, "marker": "+", "markersize": 6.5, "label": "loses pixels"}

FONT = "DejaVu Sans"

# A bound is a wide pale line behind the simulated figures, so that it is visible where both are equal.
BOUND_WIDTH = 5.5

SETTINGS = {
    "font.family": "sans-serif", "font.sans-serif": [FONT], "font.size": 9, "axes.labelsize": 9.5,
    "xtick.labelsize": 9, "ytick.labelsize": 9, "legend.fontsize": 8.5,
    "axes.edgecolor": QUIET, "axes.labelcolor": INK, "text.color": INK, "xtick.color": INK, "ytick.color": INK,
    "axes.linewidth": 0.8, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.axisbelow": True, "grid.color": "#DDDDDD", "grid.linewidth": 0.6,
    "lines.linewidth": 1.4, "lines.markersize": 5,
    "text.parse_math": False, "svg.fonttype": "none", "svg.hashsalt": "stereotlm",
}

UNITS = [("_percent", "%"), ("_mhz", "MHz"), ("_hz", "Hz"), ("megabytes_per_second", "MB/s"), ("_us", "us")]
MEANINGS = {
    "frames_per_second.core": "core, frames/s",
    "frames_per_second.steady": "whole computer, steady frames/s",
    "frames_per_second.system": "whole computer from power-up, frames/s",
    "bound.core": "bound of the core, frames/s",
    "bound.system": "bound of the whole computer, frames/s",
    "matcher.window": "window n, pixels (of n x n)",
    "matcher.disparities": "disparities D",
    "area.slices": "area, slices",
    "area.slices_percent": "area, % of the slices",
    "area.luts": "area, LUTs",
    "area.flip_flops": "area, flip-flops",
    "area.block_rams": "block RAMs",
    "area.block_rams_percent": "block RAMs, % of the FPGA's",
    "area.multipliers": "multipliers",
    "area.multipliers_percent": "multipliers, % of the FPGA's",
    "banks_used": "banks used by the allocation",
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
        self.files = {".png": sheet.png(), ".svg": sheet.svg(), ".csv": table(header, rows)}
        self.said = said
        self.boxed = sheet.boxed()  # see there


def table(header, rows):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(["" if value is None else value for value in row] for row in rows)
    return text.getvalue().encode()


class Sheet:
    """The page of a figure: panels with sizes in inches, and below them the legend, a list and notes.

    legend(), list_entry() and note() must be called before rows() or columns(), which create the panels.
    """

    def __init__(self):
        matplotlib.rcdefaults()  # so that settings of the user have no effect
        matplotlib.rcParams.update(SETTINGS)
        self.figure = Figure()
        FigureCanvasAgg(self.figure)
        self.panels = []
        self._legends = []
        self._list = []
        self._notes = []

    def legend(self, handles):
        """Adds a group to the legend. handles: (artist, text) of each entry."""
        if handles:
            self._legends.append(handles)

    def note(self, text):
        if text:
            self._notes += textwrap.wrap(text, NOTE_CHARACTERS)

    def list_entry(self, number, text):
        """Adds an entry to the list between the legend and the notes."""
        self._list += textwrap.wrap(f"{number}  {text}", NOTE_CHARACTERS, subsequent_indent=" " * 6)

    def rows(self, heights, left=0.75, gap=0.15, bottom=0.5):
        """Creates and returns panels above each other, from the top, which share their x axis."""
        inside = sum(heights) + gap * (len(heights) - 1)
        total = self._begin(inside, 0.12, bottom)
        at = total - 0.12
        for height in heights:
            at -= height
            axes = self.figure.add_axes([left / WIDTH, at / total, (WIDTH - left - 0.15) / WIDTH, height / total],
                                        sharex=self.panels[0] if self.panels else None)
            self.panels.append(axes)
            at -= gap
        for axes in self.panels[:-1]:
            axes.tick_params(labelbottom=False)
        return self.panels

    def columns(self, count, height, left, top=0.3, gap=0.1, bottom=0.5, right=0.15):
        """Creates and returns panels side by side, from the left, which share their y axis."""
        total = self._begin(height, top, bottom)
        width = (WIDTH - left - right - gap * (count - 1)) / count
        for number in range(count):
            axes = self.figure.add_axes(
                [(left + number * (width + gap)) / WIDTH, (total - top - height) / total, width / WIDTH,
                 height / total],
                sharey=self.panels[0] if self.panels else None)
            self.panels.append(axes)
            if number:
                axes.tick_params(labelleft=False)
        return self.panels

    def below(self, text):
        """Writes the name of the x axis of all columns below them."""
        boxes = [axes.get_position() for axes in self.panels]
        self.figure.text((boxes[0].x0 + boxes[-1].x1) / 2, boxes[0].y0 - 0.38 / self.figure.get_size_inches()[1], text,
                         ha="center", va="center", fontsize=9.5)

    def _begin(self, inside, top, bottom):
        """Draws legend, list and notes, and sets the size of the figure. Returns its height in inches."""
        columns = [legend_columns([text for _, text in group]) for group in self._legends]
        lines = [-(-len(group) // count) for group, count in zip(self._legends, columns)]
        legend = sum(lines) * LINE + (0.06 if lines else 0)
        below = [*self._list, *self._notes]
        notes = len(below) * NOTE_LINE + (0.1 if below else 0)
        total = top + inside + bottom + legend + notes + 0.05
        self.figure.set_size_inches(WIDTH, total)
        at = notes + legend + 0.05
        for group, count, height in zip(self._legends, columns, lines):
            handles, texts = zip(*group)
            self.figure.legend(handles, texts, loc="upper center", ncol=count, frameon=False, borderpad=0,
                               borderaxespad=0, labelspacing=0.25, columnspacing=1.6, handlelength=2.6,
                               bbox_to_anchor=(0.5, at / total))
            at -= height * LINE
        for number, line in enumerate(reversed(below)):
            is_note = number < len(self._notes)
            self.figure.text(0.1 / WIDTH, (0.06 + number * NOTE_LINE) / total, line, fontsize=7, va="bottom",
                             color=QUIET if is_note else INK)
        return total

    def png(self):
        return self._bytes("png", {"Software": None})

    def svg(self):
        return self._bytes("svg", {"Date": None})

    def _bytes(self, kind, metadata):
        out = io.BytesIO()
        with warnings.catch_warnings():
            for message in (r"Glyph \d+ ", "Matplotlib currently does not support"):  # see boxed()
                warnings.filterwarnings("ignore", message)
            self.figure.savefig(out, format=kind, dpi=DPI, metadata=metadata)
        return out.getvalue()

    def boxed(self):
        """The parts of its texts for which the font has no characters. A PNG shows boxes for them."""
        known = font_manager.get_font(font_manager.findfont(FONT)).get_charmap()
        texts = {text.get_text() for text in self.figure.findobj(Text)}
        unknown = re.escape("".join({each for text in texts for each in text if ord(each) not in known} - {"\n"}))
        return {part for text in texts for part in re.findall(f"[{unknown}]+", text)} if unknown else set()


def legend_columns(texts):
    """The number of columns of the legend: as many as have room, and none that would be empty."""
    room = int(WIDTH / (max(map(len, texts)) * CHARACTER + HANDLE))
    lines = -(-len(texts) // max(1, room))
    return -(-len(texts) // lines)


def line_handle(color, marker, dashes="-", **look):
    return Line2D([], [], color=color, marker=marker, linestyle=dashes, **look)


def mark_handle(mark):
    return (Line2D([], [], **mark), mark["label"])


def ticks_at(axis, values):
    """Sets the ticks of the axis to the values of the points, if there is room for that."""
    if len(values) <= 14:
        axis.set_major_locator(FixedLocator(values))
        axis.set_minor_locator(NullLocator())
    else:
        axis.set_major_locator(MaxNLocator(integer=True))


def pale(color):
    """The color of the bound of a line with this color."""
    return tuple(0.3 * part + 0.7 for part in to_rgb(color))


def scale(axes, which, label, values, *remarks):
    """Sets scale and label of an axis. The scale is logarithmic if the values differ much, else it begins at zero.

    which: "x" or "y". remarks: added to the label in brackets.
    """
    values = [value for value in values if value is not None]
    if values and min(values) > 0 and max(values) > 6 * min(values):
        axis = getattr(axes, which + "axis")
        getattr(axes, f"set_{which}scale")("log")
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_minor_locator(NullLocator())
        formatter = ScalarFormatter()
        formatter.set_scientific(False)
        axis.set_major_formatter(formatter)
        getattr(axes, f"set_{which}lim")(min(values) / 1.25, max(values) * 1.25)
        remarks = ("log scale", *remarks)
    elif values and min(values) >= 0 and max(values) > 0:
        getattr(axes, f"set_{which}lim")(0, max(values) * 1.08)
    getattr(axes, f"set_{which}label")(label + (f" ({', '.join(remarks)})" if remarks else ""))
