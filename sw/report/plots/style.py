"""What the house style (style.mplstyle) has besides settings: colors, marks, widths of texts, bytes of files.

Nothing depends on settings of the user: equal figures give equal bytes.
"""

import io
import os
import warnings

import matplotlib
from matplotlib import colormaps, colors, font_manager
from matplotlib.ft2font import LOAD_NO_HINTING
from matplotlib.lines import Line2D
from matplotlib.path import Path

SHEET = matplotlib.rc_params_from_file(os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                                    "style.mplstyle"),
                                       use_default_template=False)
FONT, SCALE = SHEET["font.sans-serif"][0], SHEET["image.cmap"]
SIZE, LABEL_SIZE, TITLE_SIZE, LEGEND_SIZE, SMALL_SIZE = 9, 9.5, 11, 8.5, 7  # points
DPI = 200

INK, QUIET, GRAY, GRID = "#222222", "#666666", "#808080", "#DDDDDD"
MISSING = "#D9D9D9"  # where there is no value: a gray that no map of colors has
COLORS = SHEET["axes.prop_cycle"].by_key()["color"]
BLUE, VERMILION, GREEN, PINK, ORANGE, SKY, BLACK = COLORS
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
DASHES = ["-", (0, (4, 2)), (0, (1, 1.5)), (0, (5, 1.5, 1, 1.5))]
SHARES = "Blues"  # for shares with their number written into them

# A mark that a point of the line has, with a white edge where it crosses others.
POINT = {"marker": "o", "markeredgecolor": "white", "markeredgewidth": 0.6}
# A bound is a lid on each point: a bar with both ends bent down. It is visible where point and bound are
# equal, and no band, which would be read as an interval of confidence.
LID = Path([(-1, -0.55), (-1, 0), (1, 0), (1, -0.55)])
LID_OF_X = Path([(-0.55, -1), (0, -1), (0, 1), (-0.55, 1)])
FAINT_LINE = {"color": QUIET, "linewidth": 0.9, "linestyle": (0, (6, 3)), "zorder": 1.4}

FORMATS = ["png", "svg", "pdf"]
USUAL_FORMATS = ["png", "svg"]
# Nothing of the time or the release is written into the files. `stereotlm plot` (plot_command.cpp) knows its
# own files by the maker.
MAKER = "stereotlm"
METADATA = {"png": {"Software": MAKER}, "svg": {"Date": None, "Creator": MAKER},
            "pdf": {"Creator": MAKER, "Producer": None, "CreationDate": None}}


def use():
    """Sets this style for all figures that are made from now on."""
    matplotlib.rcdefaults()  # so that settings of the user have no effect
    matplotlib.rcParams.update(SHEET)


def encoded(figure, kind, dpi=DPI):
    """The bytes of the figure as a file of one of FORMATS."""
    out = io.BytesIO()
    with warnings.catch_warnings():
        for message in (r"Glyph \d+ ", "Matplotlib currently does not support"):  # see unknown_characters()
            warnings.filterwarnings("ignore", message)
        figure.savefig(out, format=kind, dpi=dpi, metadata=METADATA[kind])
    return out.getvalue()


def _font(bold=False):
    properties = font_manager.FontProperties(family=FONT, weight="bold" if bold else "normal")
    return font_manager.get_font(font_manager.findfont(properties))


def unknown_characters(text):
    """The characters that the font lacks. PNG and PDF show boxes for them."""
    known = _font().get_charmap()
    return {each for each in text if ord(each) not in known} - {"\n"}


def text_width(text, size, bold=False):
    """In inches; size: in points."""
    font = _font(bold)
    font.set_size(size, 72)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        font.set_text(text, 0, flags=LOAD_NO_HINTING)
    return font.get_width_height()[0] / 64 / 72


def wrapped(text, size, width, indent="", bold=False):
    """The lines of a text, broken at blanks; in words that are longer than a line at no-break spaces, or
    anywhere."""
    lines = []
    line = ""
    for word in text.split(" "):
        longer = f"{line} {word}" if line.strip() else line + word
        if text_width(longer, size, bold) <= width:
            line = longer
            continue
        if line.strip():
            lines.append(line)
        line = indent + word if lines else word
        while text_width(line, size, bold) > width and len(line.strip()) > 1:
            fits = next(end for end in range(len(line) - 1, 0, -1)
                        if end == len(indent) + 1 or text_width(line[:end], size, bold) <= width)
            fits = line.rfind("\N{NO-BREAK SPACE}", len(indent), fits) + 1 or fits
            lines.append(line[:fits])
            line = indent + line[fits:]
    return [*lines, line]


def bound(color, of_x=False):
    """The look of the bounds of points that are drawn in this color; of_x: bounds of x, not of y."""
    return {"color": color, "linestyle": "", "marker": LID_OF_X if of_x else LID, "markersize": 11,
            "markerfacecolor": "none", "markeredgewidth": 1.1, "zorder": 3.2, "gid": "bound"}


def line_handle(color, marker, dashes="-", **look):
    return Line2D([], [], color=color, marker=marker, linestyle=dashes, **look)


def bound_handle(color):
    return Line2D([], [], **bound(color))


def shades(count):
    """Colors of SCALE from dark to light, without its light end, which is hardly visible on white."""
    return [colors.to_hex(colormaps[SCALE](0.9 * number / max(1, count - 1))) for number in range(count)]
