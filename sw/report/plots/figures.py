#!/usr/bin/python3
"""The figures of a database of stereotlm sweep: a function for each, in FIGURES, and what they share.

usage: figures.py DB --out NEW_DIR [--only KEY=VALUE].. [--pareto X:SENSE,Y:SENSE[,Z:SENSE]] [--format F,..]
                  [--size WxH]
`stereotlm plot` runs it. Equal data give equal bytes, whatever the settings of the user are.
"""

import argparse
import contextlib
import difflib
import io
import math
import os
import pathlib
import re
import sqlite3
import sys
import textwrap
import warnings


def tell(problem):
    print(f"stereotlm: error: {problem}", file=sys.stderr)


def refuse(*problems):
    for problem in problems:
        tell(problem)
    sys.exit(2)


os.environ.pop("MPLBACKEND", None)  # selects a display; matplotlib fails if it does not know the name
try:
    import matplotlib
    import numpy
    import pandas
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch
    from matplotlib.path import Path
    from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator, ScalarFormatter
except ImportError as error:
    refuse(f"needs matplotlib and pandas, which ./setup tests installs: {error}")
except Exception as error:  # of any kind, such as one that a user's matplotlibrc causes
    refuse(f"matplotlib cannot be loaded: {error}")

# Style: settings are in style.mplstyle.

SHEET = matplotlib.rc_params_from_file(pathlib.Path(__file__).with_name("style.mplstyle"),
                                       use_default_template=False)
COLORS = SHEET["axes.prop_cycle"].by_key()["color"]
BLUE, VERMILION, GREEN, PINK, ORANGE, SKY, BLACK = COLORS
GRAY, QUIET = "#808080", "#666666"
MARKERS = ["o", "s", "^", "D", "v", "P", "X"]
DASHES = ["-", (0, (4, 2)), (0, (1, 1.5)), (0, (5, 1.5, 1, 1.5))]
POINT = {"marker": "o", "markeredgecolor": "white", "markeredgewidth": 0.6}
# A bound is a lid on each point: a bar with both ends bent down, visible where point and bound are equal.
LID = Path([(-1, -0.55), (-1, 0), (1, 0), (1, -0.55)])
LID_OF_X = Path([(-0.55, -1), (0, -1), (0, 1), (-0.55, 1)])
SMALL = 7  # points
# Nothing of the time or the release is written. plot_command.cpp knows the files of plot by the maker.
METADATA = {"png": {"Software": "stereotlm"}, "svg": {"Date": None, "Creator": "stereotlm"},
            "pdf": {"Creator": "stereotlm", "Producer": None, "CreationDate": None}}


def use_style():
    matplotlib.rcdefaults()  # so that settings of the user have no effect
    matplotlib.rcParams.update(SHEET)


def bound(color, marker=LID):
    """The look of the bounds of points of this color."""
    return {"color": color, "linestyle": "", "marker": marker, "markersize": 11, "markerfacecolor": "none",
            "markeredgewidth": 1.1, "zorder": 3.2}


def encoded(figure, kind, dpi=200):
    """The bytes of the figure as a file of one of the kinds of METADATA."""
    out = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of characters that the font lacks
        figure.savefig(out, format=kind, dpi=dpi, metadata=METADATA[kind])
    return out.getvalue()


# The points of a database.

APPLICATION_ID, LAYOUT = 0x53544C4D, 3
PORTS = ["left_lut", "right_lut", "left_pixel", "right_pixel", "result", "host"]
LANES = r"((?:left|right)_(?:lut|pixel))\.\d+"  # the name of a lane: "left_lut.3"
LOST = "lost_pixels"
BANKS_USED, UNITS_USED = "banks_used", "units_used"  # columns that are added
MOST_ROWS = 16  # bars, or names of points, in a figure


class Unusable(Exception):
    """The figure or the command cannot be made."""


def text_of(value):
    if value is None:
        return "absent"
    return str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)


def counted(number, what):
    return f"{number} {what}{'s' * (number != 1)}"


def order(value):
    """Numbers first, then texts, None last."""
    return (value is None, isinstance(value, str), 0 if value is None else value)


def unknown(what, name, known):
    near = difflib.get_close_matches(name, known)
    return f"unknown {what} {name}" + (f"; nearest: {', '.join(near)}" if near else "")


class Points:
    """The points of a database that have figures, in the order of their hashes.

    table: a row for each, with the columns of the database, BANKS_USED and UNITS_USED; None: no value.
    blame: hash, port, bank, by, cycles. The lanes of a port are one, with their mean.
    varied: the keys that differ between these points.
    """

    def __init__(self, path):
        self.path = path
        if os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path):
            raise Unusable(f"{path}: must be a regular file")  # SQLite would wait for a pipe
        try:
            with open(path, "rb"):
                pass
            with contextlib.closing(sqlite3.connect(f"{pathlib.Path(path).absolute().as_uri()}?mode=ro",
                                                    uri=True, isolation_level=None, timeout=60)) as database:
                database.execute("BEGIN")  # one state, even if a sweep is writing
                self._read(database)
        except OSError as error:
            raise Unusable(f"{path}: cannot be opened: {error.strerror}") from None
        except sqlite3.Error as error:
            raise Unusable(f"{path}: {'not a database' if 'not a database' in str(error) else error}"
                           ) from None
        self.left_out = self._rows.loc[self._rows.status != "ok", "status"].value_counts().to_dict()
        self._keep(self._rows.status == "ok",
                   f"{path}: no point to draw: {self.left_out_text() or 'it is empty'}")
        self._add_columns()

    def _read(self, database):
        def read(table):
            names = [name for _, name, *_ in database.execute(f"PRAGMA table_info({table})")
                     if name != "config"]  # the board as YAML, which no figure needs
            columns = ", ".join('"' + name.replace('"', '""') + '"' for name in names)
            return pandas.DataFrame(database.execute(f"SELECT {columns} FROM {table}").fetchall(),
                                    columns=names, dtype=object)

        def pragma(name):
            return database.execute(f"PRAGMA {name}").fetchone()[0]

        if pragma("application_id") != APPLICATION_ID:
            raise Unusable(f"{self.path}: not a database of stereotlm sweep")
        if pragma("user_version") != LAYOUT:
            raise Unusable(f"{self.path}: its layout is {pragma('user_version')}, of another version; this "
                           f"version reads {LAYOUT}")
        self._rows = read("points").sort_values("hash", ignore_index=True)
        self.total = len(self._rows)
        self.blame = read("blame")
        known = {name for name, in database.execute("SELECT name FROM columns WHERE is_key")}
        self.keys = [name for name in self._rows if name in known]

    def _keep(self, condition, problem):
        self.table = self._rows[condition].reset_index(drop=True)
        if self.table.empty:
            raise Unusable(problem)
        self.varied = [key for key in self.keys if self.varies(key)]
        self._rows = self.table

    def _add_columns(self):
        table = self.table
        allocated = table[[key for key in self.keys if key.startswith("allocation.")]]
        words = [set(re.findall(r"[^\[\]{}, ]+", " ".join(map(str, row)))) for row in allocated.values]
        table[BANKS_USED] = [len(banks - {"none", "None", "rows:"}) for banks in words]
        if "matcher.units" in table:
            table[UNITS_USED] = table["matcher.units"].where(table["matcher.units"] != "all",
                                                             table.get("matcher.disparities"))
        blame = self.blame
        of_lane = blame.port.astype(str).str.fullmatch(LANES)
        count = blame.hash.map(dict(zip(table.hash, table.get("fpga.lanes", [1] * len(table)))))
        blame["cycles"] = (blame.cycles / count.where(of_lane, 1)).astype(float)
        for column in ("port", "by"):
            blame[column] = blame[column].astype(str).str.replace(f"^{LANES}$", r"\1", regex=True)
        self.blame = blame.groupby(["hash", "port", "bank", "by"], as_index=False).cycles.sum()

    def keep(self, only):
        """Leaves out points that do not have all these values, each given as "KEY=VALUE"."""
        before, keep = len(self.table), pandas.Series(True, self.table.index)
        problems = []
        for text in only:
            key, equals, wanted = text.partition("=")
            values = self.table[key].map(text_of) if key in self.keys else []
            if not equals:
                problems.append(f"--only = {text}: must be KEY=VALUE")
            elif key not in self.keys:
                problems.append(f"--only = {text}: {unknown('key', key, self.keys)}")
            elif wanted not in set(values):
                there = ", ".join(text_of(each) for each in sorted(self.table[key].unique(), key=order)[:12])
                problems.append(f"--only = {text}: no point has that value; there are: {there}")
            else:
                keep &= values == wanted
        if problems:
            raise Unusable(*problems)
        self._keep(keep, f"--only {' '.join(only)}: no point with figures has all these values")
        self.left_out["other than --only " + " ".join(only)] = before - len(self.table)

    def varies(self, name):
        return self.table[name].nunique(dropna=False) > 1

    def need_variation(self, name):
        if name not in self.table or not self.varies(name):
            there = self.table[name][0] if name in self.table else None
            raise Unusable(f"all points have {name} = {text_of(there)}")

    def numbers(self, name):
        """A column as numbers; NaN without a value."""
        if name not in self.table:
            raise Unusable(unknown("column", name, self.table))
        values = self.table[name]
        for point, value in zip(self.table.hash, values):
            if value is not None and not (isinstance(value, (int, float)) and abs(value) < 1e100):
                raise Unusable(f"point {point}: {name} = {text_of(value)}: must be a number")
        if values.isna().all():
            raise Unusable(f"column {name} is empty")
        return pandas.to_numeric(values).astype(float)

    def losing_pixels(self):
        return pandas.to_numeric(self.table.get(LOST, pandas.Series(0, self.table.index))) > 0

    def too_large(self):
        """Whether a point needs more of some resource than the FPGA has."""
        shares = self.table.filter(regex=r"^area\.\w+_percent$").apply(pandas.to_numeric)
        return (shares > 100).any(axis=1)

    def left_out_text(self, more=None):
        return ", ".join(f"{count} {reason}" for reason, count in {**self.left_out, **(more or {})}.items()
                         if count)

    def notes(self, shown, more=None):
        """What stands below a figure of these rows. more: {reason: number}, why others are not shown."""
        board, source = (self.table[name][0] if not self.varies(name) else several
                         for name, several in (("name", "several boards"), ("run.source", "several")))
        missing = self.left_out_text(more)
        notes = []
        for condition, text in (
                (self.losing_pixels(), "lose pixels: the pictures that they match are not whole"),
                (self.too_large(), "take more area than the FPGA has")):
            if condition[shown].any():
                notes.append(f"{condition[shown].sum()} of the points {text}.")
        shown = f"{len(shown)} of {self.total} points of {os.path.basename(self.path)}"
        missing = f"; not shown: {missing}" if missing else ""
        return [*notes, f"{board}, source {source}: {shown}{missing}."]


# What the figures share.

TITLES = {
    "frames_per_second.core": "core, frames/s", "bound.core": "core bound, frames/s",
    "frames_per_second.steady": "whole computer, steady frames/s", "bound.system": "steady bound, frames/s",
    "frames_per_second.system": "whole computer, from power-up, frames/s",
    "matcher.window": "window n, pixels (of n x n)", "matcher.disparities": "disparities D",
    "matcher.rows": "rows of results at once", UNITS_USED: "column and window modules",
    BANKS_USED: "banks used by the allocation", "area.slices": "area, slices",
    "area.slices_percent": "area, % of the slices",
    "energy.memory_mj_per_frame": "energy of the memories, mJ a frame"}
BOUNDS = {"frames_per_second.core": "bound.core", "frames_per_second.steady": "bound.system",
          "frames_per_second.system": "bound.system"}


def sheet(options, heading, heights, columns=1, **shared):
    """A figure with panels below each other, or side by side, and their list. heights: in inches."""
    width, height = options.size or (7.2, sum(heights) + 1)
    figure = Figure(figsize=(width, height), layout="constrained")
    figure.suptitle(textwrap.fill(heading, int(9 * width)), weight="bold")
    axes = figure.subplots(len(heights), columns, squeeze=False, gridspec_kw={"height_ratios": heights},
                           **shared)
    return figure, list(axes.flat)


def finished(options, figure, handles, notes):
    """{ending: bytes} of the figure, with the legend and the notes below its panels.

    Without --size the figure is made higher by them.
    """
    width, height = figure.get_size_inches()
    notes = "\n".join(textwrap.fill(note, int(17.5 * width)) for note in notes if note)
    text = figure.text(0.01, 0, notes, fontsize=SMALL, color=QUIET, va="bottom")
    legend = None
    for columns in range(len(handles), 0, -1):
        if legend:
            legend.remove()
        legend = figure.legend(handles=handles, ncol=columns, loc="lower center", handlelength=2.4)
        if legend.get_window_extent().width < figure.bbox.width:
            break
    of_notes, of_legend = (part.get_window_extent().height / figure.dpi + 0.05 if there else 0
                           for part, there in ((text, notes), (legend, handles)))
    if not options.size:
        height += of_notes + of_legend
        figure.set_size_inches(width, height)
    if legend:
        legend.set_bbox_to_anchor((0.5, of_notes / height))
    below = min((of_notes + of_legend) / height, 0.99)
    figure.get_layout_engine().set(rect=(0, below, 1, 1 - below))
    with warnings.catch_warnings(record=True) as caught:  # also of characters that the font lacks
        warnings.simplefilter("always")
        figure.draw_without_rendering()
    panels = [axes.get_window_extent() for axes in figure.axes if axes.get_label() != "<colorbar>"]
    if (any("collapsed" in str(each.message) for each in caught)
            or min(min(panel.width, panel.height) for panel in panels) < 0.5 * figure.dpi):
        raise Unusable(f"--size {width:g}x{height:g}: too small for this figure")
    return {f".{kind}": encoded(figure, kind) for kind in options.format}


def scale(axes, which, label, values, remark=""):
    """The scale of an axis "x" or "y": from 0, but logarithmic if the largest value is above 6 times the
    least."""
    values = values.dropna()
    if values.min() > 0 and values.max() > 6 * values.min():
        getattr(axes, f"set_{which}scale")("log")
        axis = getattr(axes, f"{which}axis")
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(ScalarFormatter())
        label += " (log scale)"
    elif values.min() >= 0 and values.max() > 0:
        getattr(axes, f"set_{which}lim")(0, 1.08 * values.max())
    getattr(axes, f"set_{which}label")(label + remark)


def csv_of(table, columns):
    return {".csv": table[list(dict.fromkeys(columns))].to_csv(index=False, lineterminator="\n").encode()}


def with_cross(axes, xs, ys, marker, label):
    """Crosses, and their entry of the legend; none without points."""
    look = {"color": "black", "linestyle": "", "marker": marker, "markersize": 6}
    axes.plot(xs, ys, zorder=3.5, **look)
    return [Line2D([], [], label=label, **look)] if len(xs) else []


# Rates, and area, over a column.

def rates_over(x, heading, with_area=False, key=None):
    """The figure of the frame rates over the column x. key: that of the board on which x depends."""
    return lambda points, options: draw_rates(points, options, x, heading, with_area, key or x)


def draw_rates(points, options, x, heading, with_area, key):
    """A line for each combination of the other keys that vary, through its best points."""
    of_banks = x == BANKS_USED
    points.need_variation(key)
    rates = ["frames_per_second.core"]
    if "frames_per_second.steady" in points.table and points.table["frames_per_second.steady"].notna().any():
        rates.append("frames_per_second.steady")
    shown = [*rates, *["area.slices_percent"] * with_area]
    drawn = [*shown, *map(BOUNDS.get, rates)]
    table = points.table.assign(**{column: points.numbers(column) for column in (x, *drawn)})
    losing = points.losing_pixels()
    keys = [each for each in points.varied
            if each != key and not (of_banks and each.startswith(("allocation.", "run.frames")))]
    told = told_keys(table, x, keys, drawn)
    families = families_of(table, told)
    looks, handles = looks_of(told, list(families))
    color = GRAY if handles else BLUE
    figure, panels = sheet(options, heading, [2.7 if column in rates else 2.1 for column in shown],
                           sharex=True)
    for axes, column in zip(panels, shown):
        if looks:
            for values, family in families.items():
                draw_family(axes, family, x, column, looks[values], losing if of_banks else None)
        else:
            draw_range(axes, table, x, column)
        scale(axes, "y", TITLES[column], table[[column, BOUNDS.get(column, column)]].max(axis=1))
        if column in rates:
            crosses = with_cross(axes, table[x][losing], table[column][losing], "+", "loses pixels")
        elif table[column].max() > 90:
            handles.append(axes.axhline(100, color=QUIET, linestyle=DASHES[1], label="the FPGA is full"))
    values = sorted(table[x].dropna().unique())
    if len(values) <= 14:
        panels[-1].set_xticks(values, [f"{value:.10g}" for value in values])
    panels[-1].set_xlabel(TITLES[x])
    notes = []
    if looks is None:
        handles += [Patch(color=BLUE, alpha=0.16, label="all points, from the least to the greatest"),
                    Patch(color=BLUE, alpha=0.46, label="the middle half of them"),
                    Line2D([], [], color=BLUE, label="median")]
        notes.append(f"Envelopes: {len(families)} combinations of {', '.join(told)} are more than can be "
                     "told apart; --only KEY=VALUE draws fewer.")
    elif of_banks or not handles:
        handles.append(Line2D([], [], color=color, marker="o",
                              label="best allocation" if of_banks else "simulated"))
    handles.append(Line2D([], [], label="bound", **bound(color)))
    if len(rates) > 1 and looks:
        handles.append(Line2D([], [], color=color, linestyle=":", linewidth=0.8,
                              label="from power-up, tables included"))
    if len(told) < len(keys):
        others = ", ".join(each for each in keys if each not in told)
        notes.append(f"A line stands for all values of {others}: what is drawn changes by at most 1 %.")
    above = (table[rates[-1]] > table[BOUNDS[rates[-1]]]) & ~losing
    if len(rates) > 1 and above.any():
        notes.append("Above the bound by no more than the uncertainty: "
                     f"{counted(int(above.sum()), 'steady rate')}.")
    files = finished(options, figure, handles + crosses, notes + points.notes(table.index))
    more = ["area.slices"] * with_area + [LOST, "frames_per_second.system"] * (len(rates) > 1)
    columns = ["hash", *points.varied, x, *drawn, *more]
    listed = points.table.loc[table.sort_values(x, kind="stable").index]
    lines = "an envelope" if looks is None else counted(len(families), "line")
    return {**files, **csv_of(listed, [column for column in columns if column in listed])}, \
        f"{counted(len(table), 'point')}, {lines}"


def told_keys(table, x, keys, columns):
    """The keys whose values lines distinguish: without those that change the drawn values by at most 1 %."""
    told = list(keys)
    for key in keys:
        rest = [each for each in told if each != key]
        values = table.groupby([x, *rest], dropna=False)[columns]
        if ((values.max() - values.min()) / values.max().abs()).max().max() <= 0.01:
            told = rest
    return told


def families_of(table, keys):
    """{values of the keys: their points}, in the order of the values."""
    if not keys:
        return {(): table}
    groups = {}
    for values, place in zip(table[keys].itertuples(index=False, name=None), table.index):
        groups.setdefault(values, []).append(place)
    ordered = sorted(groups, key=lambda values: [*map(order, values)])
    return {values: table.loc[groups[values]] for values in ordered}


def looks_of(keys, combinations):
    """({combination: look}, legend). None instead of the looks if there are more than can be told apart.

    Up to seven lines have a color each. Of more, the key with the most values has colors, and the other keys
    have dashes.
    """
    def named(names, values):
        return ", ".join(f"{name} = {text_of(value)}" for name, value in zip(names, values))

    def split(values, wanted):
        return tuple(value for key, value in zip(keys, values) if key in wanted)

    if len(combinations) == 1:
        return {combinations[0]: {"color": BLUE, **POINT}}, []
    by_color, by_dash = keys, []
    if len(combinations) > len(COLORS):
        most = max(keys, key=lambda key: len({values[keys.index(key)] for values in combinations}))
        by_color, by_dash = [most], [key for key in keys if key != most]
    colors = list(dict.fromkeys(split(values, by_color) for values in combinations))
    dashes = list(dict.fromkeys(split(values, by_dash) for values in combinations))
    if len(colors) > 12 or len(dashes) > len(DASHES):
        return None, []
    shades = COLORS if len(colors) <= len(COLORS) else [
        matplotlib.colormaps["viridis"](0.9 * number / (len(colors) - 1)) for number in range(len(colors))]
    color_of, dash_of = dict(zip(colors, shades)), dict(zip(dashes, zip(DASHES, MARKERS)))
    looks = {}
    for number, values in enumerate(combinations):
        dash, marker = dash_of[split(values, by_dash)]
        looks[values] = {**POINT, "color": color_of[split(values, by_color)], "linestyle": dash,
                         "marker": marker if by_dash else MARKERS[number % len(MARKERS)]}
    if not by_dash:
        return looks, [Line2D([], [], label=named(keys, values), **look) for values, look in looks.items()]
    return looks, [
        *(Line2D([], [], color=color, label=named(by_color, each)) for each, color in color_of.items()),
        *(Line2D([], [], color=GRAY, linestyle=dash, marker=marker, label=named(by_dash, each))
          for each, (dash, marker) in dash_of.items())]


def draw_family(axes, family, x, column, look, losing):
    """The line of a family, through the greatest value at each x.

    losing: whether a point is not the best, although it may be the greatest; all points are dots. None: each
    point counts.
    """
    family = family[family[column].notna()]
    if losing is not None:
        axes.plot(family[x], family[column], "o", color=look["color"], markersize=3, alpha=0.5)
        family = family[~losing[family.index]]
    if column in BOUNDS:
        axes.plot(family.groupby(x)[BOUNDS[column]].max(), **bound(look["color"]))
    if column == "frames_per_second.steady":
        axes.plot(family.groupby(x)["frames_per_second.system"].max(), ":", color=look["color"],
                  linewidth=0.8)
    axes.plot(family.groupby(x)[column].max(), zorder=3, **look)


def draw_range(axes, table, x, column):
    values = table.groupby(x)[column]
    low, middle, high = (values.quantile(share) for share in (0.25, 0.5, 0.75))
    axes.fill_between(middle.index, values.min(), values.max(), color=BLUE, alpha=0.16, linewidth=0)
    axes.fill_between(middle.index, low, high, color=BLUE, alpha=0.3, linewidth=0)
    axes.plot(middle, color=BLUE, **POINT)


def short_names(keys):
    """{key: the shortest end of its dotted path that no other key has}."""
    def ends(key):
        parts = key.split(".")
        return [".".join(parts[at:]) for at in range(len(parts) - 1, -1, -1)]

    return {key: next(end for end in ends(key) if sum(end in ends(other) for other in keys) == 1)
            for key in keys}


# Waits.

def stalls(points, options):
    """The cycles in which a port waits in a frame, by cause: a panel for each port, a bar for each point."""
    blame = points.blame[points.blame.hash.isin(points.table.hash) & (points.blame.cycles > 0)]
    if blame.empty:
        raise Unusable("no port waits in any point")
    frames = points.numbers("frames")
    blame = blame.assign(a_frame=blame.cycles / blame.hash.map(dict(zip(points.table.hash, frames))))
    waits = points.table.hash.map(blame.groupby("hash").a_frame.sum()).fillna(0)
    chosen = waits.sort_values(ascending=False, kind="stable").index[:MOST_ROWS]
    table = points.table.loc[sorted(chosen, key=lambda place: [order(points.table[key][place])
                                                               for key in points.varied])]
    blame = blame[blame.hash.isin(table.hash)]
    notes = points.notes(table.index, {"with fewer waits": len(points.table) - len(table)})
    if len(table) < len(points.table):
        notes.insert(0, f"The {MOST_ROWS} points whose ports wait most in a frame.")
    short = short_names(points.varied)
    names = [textwrap.fill(", ".join(f"{short[key]}={text_of(value)}" for key, value in zip(short, row)), 44)
             for row in table[points.varied].values] if short else list(table.name)
    ports = [port for port in PORTS if port in set(blame.port)]
    most = blame.groupby(["hash", "port"]).a_frame.sum().max()
    factor, word = (1e6, "million ") if most >= 2e6 else (1e3, "thousand ") if most >= 2e3 else (1, "")
    height = 0.3 + sum(max(0.2, 0.13 * (name.count("\n") + 1)) for name in names)
    figure, panels = sheet(options, "Which port waits, and for whom", [height], len(ports), sharex=True,
                           sharey=True)
    causes = dict(zip([*PORTS, "turnaround", "row", "refresh"],
                      [ORANGE, SKY, BLUE, GREEN, PINK, "#999999", BLACK, "#999933", "#882255"]))
    for axes, port in zip(panels, ports):
        left = 0
        for by, color in causes.items():
            cycles = blame[(blame.port == port) & (blame.by == by)].groupby("hash").a_frame.sum()
            width = cycles.reindex(table.hash).fillna(0).values / factor
            axes.barh(range(len(table)), width, 0.7, left, color=color)
            left = left + width
        axes.set_title(port, fontsize=SMALL + 1)
        axes.xaxis.set_major_locator(MaxNLocator(3))
        axes.grid(False, axis="y")
    panels[0].set_yticks(range(len(table)), names, fontsize=SMALL)
    panels[0].set(ylim=(len(table) - 0.4, -0.6), xlim=(0, 1.03 * most / factor))
    panels[len(ports) // 2].set_xlabel(f"{word}cycles a frame in which the port waits")
    handles = [Patch(color=color, label=f"for {by}" if by in PORTS else by) for by, color in causes.items()
               if by in set(blame.by)]
    listed = blame[["hash", "port", "bank", "by", "cycles"]].merge(
        table[["hash", *points.varied, "frames"]], on="hash")
    said = f"{counted(len(table), 'point')}, {counted(len(ports), 'port')} with waits"
    return {**finished(options, figure, handles, notes),
            **csv_of(listed, ["hash", *points.varied, "frames", "port", "bank", "by", "cycles"])}, said


# The Pareto front.

PARETO = "area.slices:min,frames_per_second.core:max"
SENSES = {"min": ", less is better", "max": ", more is better"}


def parsed_pareto(text):
    """[(column, sense), ..] of --pareto, two or three."""
    found = [re.fullmatch(r"(.+):(min|max)", part) for part in text.split(",")]
    if len(found) not in (2, 3) or not all(found) or len({match[1] for match in found}) < len(found):
        raise Unusable(f"--pareto = {text}: must be two or three columns, each with min or max: {PARETO}")
    return [match.groups() for match in found]


def front_of(columns, doubts):
    """The places on the front. columns: lists of values that are better the less they are; doubts: of each.

    A place is off the front if one on it is better in a column, and worse in none. Both by more than the sum
    of their doubts. Exact columns decide the order in which places are looked at.
    """
    values, doubt = numpy.array(columns, float).T, numpy.array(doubts, float).T
    order = sorted(range(len(columns)), key=lambda column: doubt[:, column].any())
    front = []
    for place in numpy.lexsort(values.T[order[::-1]]):
        loss, both = values[place] - values[front], doubt[place] + doubt[front]
        if not ((loss > both).any(axis=1) & (loss >= -both).all(axis=1)).any():
            front.append(place)
    return front


def pareto(points, options):
    """Columns against each other, and the points that no other dominates, numbered and named below.

    A third column is the colour of the points of the front.
    """
    (x, x_sense), (y, y_sense), *third = axes_of = parsed_pareto(options.pareto or PARETO)
    names = [column for column, _ in axes_of]
    if options.pareto is None:
        points.need_variation(x)
        points.need_variation(y)
    table = points.table.assign(**{column: points.numbers(column) for column in names})
    table = table[table[names].notna().all(axis=1)]
    if table.empty:
        raise Unusable(f"no point has {'both' if len(names) == 2 else 'all of'} {' and '.join(names)}")
    better = [(table[column] * (1 if sense == "min" else -1)).tolist() for column, sense in axes_of]
    doubts = [points.numbers(f"{column}_uncertainty")[table.index].tolist()
              if f"{column}_uncertainty" in table else [0] * len(table) for column in names]
    places = front_of(better, doubts)
    front = table.iloc[sorted(places, key=lambda place: (better[0][place], -better[1][place]))]
    heading = "Pareto front: " + ", ".join(TITLES.get(column, column) for column in names)
    figure, (axes,) = sheet(options, heading, [3.6])
    axes.plot(table[x], table[y], "o", color="#7A858E", markersize=4, alpha=0.6, markeredgewidth=0,
              rasterized=len(table) > 1500)
    corners = front[names].drop_duplicates()
    for column, sense in third:
        colours = axes.scatter(corners[x], corners[y], 24, corners[column], cmap="viridis", zorder=3,
                               edgecolors="white", linewidths=0.6)
        figure.colorbar(colours, ax=axes, label=TITLES.get(column, column) + SENSES[sense])
    if not third:
        axes.plot(corners[x], corners[y], color=VERMILION, drawstyle="steps-post", **POINT)
    handles = [Line2D([], [], color=VERMILION, label="Pareto front", **POINT),
               Line2D([], [], color="#7A858E", marker="o", linestyle="", label="other points")]
    lid = {x: LID_OF_X, y: LID}
    for column in (x, y):
        if limit := BOUNDS.get(column):
            points.numbers(limit)
            at = {x: front[x], y: front[y], column: front[limit]}
            axes.plot(at[x], at[y], **bound(VERMILION, lid[column]))
            handles.append(Line2D([], [], label="bound of a point of the front", **bound(VERMILION)))
    for which, marker, label in ((points.too_large(), "x", "more area than the FPGA has"),
                                 (points.losing_pixels(), "+", "loses pixels")):
        marked = table[which[table.index]]
        handles += with_cross(axes, marked[x], marked[y], marker, label)
    for which, (column, sense) in zip("xy", axes_of):
        scale(axes, which, TITLES.get(column, column), table[column], SENSES[sense])
    notes = []
    short = short_names(points.varied)
    before = None
    for number, corner in enumerate(corners.head(MOST_ROWS).itertuples(index=False), 1):
        at = axes.transData.transform(corner[:2])
        if before is None or max(abs(at - before)) > 14:  # pixels: numbers would touch
            side = -5 if x_sense == "min" else 5, 5 if y_sense == "max" else -11
            axes.annotate(str(number), corner[:2], side, textcoords="offset points", fontsize=8,
                          ha="right" if x_sense == "min" else "left")
            before = at
        here = front[(front[names] == list(corner)).all(axis=1)]
        same = [f"{short[key]}={text_of(here[key].iloc[0])}" for key in points.varied
                if here[key].nunique(dropna=False) == 1]
        notes.append(f"{number}  {', '.join([*same, *[f'{len(here)} points'] * (len(here) > 1)])}")
    if len(corners) > MOST_ROWS:
        notes.append(f"{len(corners) - MOST_ROWS} more of the front are in the table.")
    if any(map(any, doubts)):
        notes.append("What lies within the uncertainty ties.")
    files = finished(options, figure, handles, notes + points.notes(table.index))
    columns = ["hash", *points.varied, *names, *[f"{column}_uncertainty" for column in names],
               *map(BOUNDS.get, names), LOST]
    rest = table.drop(front.index)
    listed = points.table.loc[[*front.index, *rest.index]].assign(front=[1] * len(front) + [0] * len(rest))
    return {**files, **csv_of(listed, [*(each for each in columns if each in listed), "front"])}, \
        f"{counted(len(table), 'point')}, {len(front)} of them on the front"


FIGURES = {
    "window": rates_over("matcher.window", "Frame rate against the size of the window"),
    "disparities": rates_over("matcher.disparities", "Frame rate and area against the disparities", True),
    "rows": rates_over("matcher.rows", "Frame rate and area against the rows of results at once", True),
    "units": rates_over(UNITS_USED, "Frame rate and area against the number of modules", True,
                        "matcher.units"),
    "banks": rates_over(BANKS_USED, "Frame rate against the banks that the allocation uses"),
    "stalls": stalls,
    "pareto": pareto,
}


# The command line.

def formats(text):
    kinds = text.split(",")
    if not set(kinds) <= set(METADATA) or len(set(kinds)) < len(kinds):
        raise Unusable(f"--format = {text}: must be {', '.join(METADATA)}, or several with commas")
    return kinds


def size(text):
    match = re.fullmatch(r"(\d+(?:\.\d+)?)x(\d+(?:\.\d+)?)", text, re.ASCII)
    if not match or not all(2 <= float(each) <= 40 for each in match.groups()):
        raise Unusable(f"--size = {text}: must be WIDTHxHEIGHT in inches, each 2 to 40, such as 7.2x4.5")
    return tuple(map(float, match.groups()))


def parse():
    parser = argparse.ArgumentParser(description="Draws all figures of a sweep that apply to it.",
                                     allow_abbrev=False)
    parser.add_argument("database", metavar="DB", help="a database of stereotlm sweep")
    parser.add_argument("--out", metavar="DIR", required=True, help="folder of the figures, new or empty")
    parser.add_argument("--only", metavar="KEY=VALUE", action="append", default=[],
                        help="only points whose key has that value; may be given for several keys")
    parser.add_argument("--pareto", metavar="X:SENSE,Y:SENSE[,Z:SENSE]",
                        help=f"two or three columns, each with min or max: what is best; default {PARETO}")
    parser.add_argument("--format", metavar="F,..", default="png,svg",
                        help=f"kinds of files, out of {', '.join(METADATA)}; default png,svg")
    parser.add_argument("--size", metavar="WxH",
                        help="width and height of each figure in inches; default: 7.2, as high as needed")
    return parser.parse_args()


def checked(options):
    """Checks and reads everything. Returns the points, or refuses with all problems."""
    problems = []

    def attempt(check):
        try:
            return check()
        except Unusable as error:
            problems.extend(error.args)
            return None

    points = attempt(lambda: Points(options.database))
    if points and options.only:
        attempt(lambda: points.keep(options.only))
    if options.pareto is not None and (axes := attempt(lambda: parsed_pareto(options.pareto))) and points:
        for column, _ in axes:
            try:
                points.numbers(column)
            except Unusable as error:
                problems.append(f"--pareto = {options.pareto}: {error}")
    options.format = attempt(lambda: formats(options.format))
    options.size = options.size if options.size is None else attempt(lambda: size(options.size))
    if os.path.lexists(options.out) and (not os.path.isdir(options.out) or os.listdir(options.out)):
        problems.append(f"--out {options.out}: must be a new or empty folder")
    if problems:
        refuse(*problems)
    return points


def main():
    options = parse()
    points = checked(options)
    use_style()
    left_out = points.left_out_text()
    left_out = f"; left out: {left_out}" if left_out else ""
    print(f"{points.path}: {len(points.table)} of {points.total} points{left_out}")
    files, problems = {}, []
    for name, draw in FIGURES.items():
        try:
            drawn, said = draw(points, options)
            files.update({name + ending: data for ending, data in drawn.items()})
        except Unusable as error:
            said = f"not drawn: {error}"
            problems.append(f"{name} {said}")
        print(f"{name:<12} {said}")
    if not files:
        refuse(*problems)
    try:
        os.makedirs(options.out, exist_ok=True)
        for name, data in files.items():
            pathlib.Path(options.out, name).write_bytes(data)
    except OSError as error:
        tell(f"--out {options.out}: cannot be written to: {error.strerror}")
        sys.exit(1)


if __name__ == "__main__":
    main()
