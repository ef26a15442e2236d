"""Figures of frame rates as lines over one column."""

import style
from drawing import LOSES_PIXELS, Drawing, Sheet, bound_of, mark_handle, scale, ticks_at, title
from families import MOST_DOTS, Families
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from points import LOST_PIXELS, counted, natural
from style import GRAY, bound, bound_handle, line_handle

RATE_HEIGHT = 2.7
MORE_HEIGHT = 2.1
ALL, MIDDLE = 0.16, 0.3  # opacity of an envelope: of all its points, and of their middle half


class Panel:
    """One column over x, with its bound above each point.

    beside: another column, drawn thin and dotted; None: no other.
    limit: (value, text in the legend) of a line that is drawn if the column comes near to the value; None: no line.
    listed: further columns for the table.
    partial: some points have no value in this column.
    """

    def __init__(self, column, height, beside=None, limit=None, listed=(), partial=False):
        self.column, self.height, self.beside, self.limit, self.listed = column, height, beside, limit, listed
        self.partial = partial
        self.bound = bound_of(column)

    def drawn(self):
        return [each for each in (self.column, self.bound, self.beside) if each]

    def need_numbers(self, points, places):
        values = points.column(self.column)
        points.need_numbers(self.drawn(), [place for place in places if not self.partial or values[place] is not None])


def rate_panels(points):
    """Panels with the frame rate of the core and, if the database has it, that of the whole computer."""
    panels = [Panel("frames_per_second.core", RATE_HEIGHT)]
    if any(value is not None for value in points.column("frames_per_second.steady")):
        panels.append(Panel("frames_per_second.steady", RATE_HEIGHT, beside="frames_per_second.system",
                            listed=LOST_PIXELS, partial=True))
    return panels


def of_key(points, options, key, heading, x=None, with_area=False):
    """A figure over a key of the board. x: the column of the x axis, if it is not that of the key."""
    points.need_variation(key)
    panels = rate_panels(points)
    if with_area:
        panels.append(Panel("area.slices_percent", MORE_HEIGHT, limit=(100, "the FPGA is full"), listed=["area.slices"]))
    return draw(points, options, heading, x or key, [key], panels)


def draw(points, options, heading, x, x_keys, panels, best=False):
    """Draws a figure with a line for each family of points.

    x: the column of the x axis; x_keys: the keys on which it depends.
    best: several points of a family have the same x, and its line goes through the best of them. A point that
    loses pixels is not the best.
    """
    xs = points.column(x)
    places = points.places_with(x)
    points.need_numbers([x], places)
    for panel in panels:
        panel.need_numbers(points, places)
    losing = [place for place in points.losing_pixels() if xs[place] is not None]
    drawn = [each for panel in panels for each in panel.drawn()]
    families = Families(points, places, x, x_keys, drawn)
    sheet = Sheet(heading, options.size, options.format)
    with_dots = len(places) <= MOST_DOTS
    for group in families.legend:
        sheet.legend([(line_handle(look.color, look.marker, look.dashes), text) for text, look in group])
    limits = [(Line2D([], [], **style.FAINT_LINE), panel.limit[1]) for panel in panels
              if reaches_limit(points, panel, places)]
    marks = [mark_handle(LOSES_PIXELS)] if losing else []
    sheet.legend([*handles(families, panels, best, with_dots), *limits, *marks])
    for text in (families.note, points.pixels_note(places), above_note(points, places, panels), points.size_note(places),
                 points.note(len(places))):
        sheet.note(text)
    for axes, panel in zip(sheet.rows([panel.height for panel in panels]), panels):
        for group, look in families.envelopes:
            EnvelopeDrawing(points, group, xs, panel).draw(axes, look)
        for family in [] if families.envelopes else families.all:
            not_best = set(losing) if best else None
            FamilyDrawing(points, family, xs, panel, families.as_points, not_best, with_dots).draw(axes)
        if panel.bound:
            mark(axes, [(xs[place], points.column(panel.column)[place]) for place in losing])
        values = [points.column(each)[place] for each in panel.drawn() for place in places]
        scale(axes, "y", title(panel.column), values)
        if reaches_limit(points, panel, places):
            axes.axhline(panel.limit[0], **style.FAINT_LINE)
    ticks_at(sheet.panels[-1], sorted({xs[place] for place in places}))
    sheet.panels[-1].set_xlabel(title(x))
    listed = [each for panel in panels for each in panel.listed]
    columns = list(dict.fromkeys(["hash", *points.varied, x, *drawn, *listed]))
    places.sort(key=lambda place: ([natural(points.column(key)[place]) for key in families.keys], xs[place]))
    rows = [[points.column(each)[place] for each in columns] for place in places]
    if families.envelopes:
        lines = counted(len(families.envelopes), "envelope")
    else:
        lines = "without lines" if families.as_points else counted(len(families.all), "line")
    return Drawing(sheet, columns, rows, f"{counted(len(places), 'point')}, {lines}")


def handles(families, panels, best, with_dots):
    """The entries of the legend that apply to all families."""
    entries = []
    color = GRAY if families.legend else families.all[0].look.color
    if families.envelopes:
        entries += [(Patch(color=color, alpha=ALL, linewidth=0), "all points, from the least to the greatest"),
                    (Patch(color=color, alpha=ALL + MIDDLE, linewidth=0), "the middle half of them"),
                    (line_handle(color, None if families.legend else "o"), "median")]
    elif families.as_points:
        entries.append((line_handle(color, "o", "", markersize=4, alpha=0.55), "simulated"))
    elif best:
        entries.append((line_handle(color, None if families.legend else "o"), "best allocation"))
        dots = line_handle(color, "o", "", markersize=3, alpha=0.5)
        entries.append((dots if with_dots else Patch(color=color, alpha=ALL, linewidth=0), "simulated"))
    elif not families.legend:
        entries.append((line_handle(color, "o"), "simulated"))
    if any(panel.bound for panel in panels):
        entries.append((bound_handle(color), "greatest bound" if families.envelopes else "bound"))
    if any(panel.beside for panel in panels) and not families.as_points:
        entries.append((line_handle(color, "o", ":", linewidth=0.8, markersize=3.5, markerfacecolor="white"),
                        "from power-up, tables included"))
    return entries


def above_note(points, places, panels):
    """A note if rates exceed their bounds, which they do by their uncertainty at most; otherwise empty."""
    for panel in panels:
        if panel.bound == "bound.system":
            values, bounds = points.column(panel.column), points.column(panel.bound)
            above = [place for place in places if values[place] is not None and values[place] > bounds[place]]
            if above:
                return f"Above the bound by no more than the uncertainty: {counted(len(above), 'steady rate')}."
    return ""


def mark(axes, points):
    points = [point for point in points if None not in point]
    if points:
        axes.plot(*zip(*points), **LOSES_PIXELS)


def reaches_limit(points, panel, places):
    values = [value for place in places if (value := points.column(panel.column)[place]) is not None]
    return panel.limit and values and max(values) > 0.9 * panel.limit[0]


def greatest_places(xs, values, places):
    """For each x, from the least: the one of these places with the greatest value."""
    greatest = {}
    for place in places:
        x = xs[place]
        if x not in greatest or values[place] > values[greatest[x]]:
            greatest[x] = place
    return [greatest[x] for x in sorted(greatest)]


def draw_range(axes, xs, lows, highs, color, opacity):
    """A surface between the values at each x; at a single x, or beside it, a bar."""
    look = {"color": color, "alpha": opacity, "linewidth": 0, "zorder": 1.6, "gid": "range"}
    if len(xs) > 1:
        axes.fill_between(xs, lows, highs, **look)
    else:
        axes.bar(xs, [high - low for low, high in zip(lows, highs)], 0.3, lows, **look)


class EnvelopeDrawing:
    """Draws in one panel the range of many points at each x, their middle half, the median and the greatest bound."""

    def __init__(self, points, places, xs, panel):
        values = points.column(panel.column)
        by_x = {}
        for place in places:
            if values[place] is not None:
                by_x.setdefault(xs[place], []).append(values[place])
        self.xs = sorted(by_x)
        self.sorted = [sorted(by_x[x]) for x in self.xs]
        self.bounds = None
        if panel.bound:
            bounds = points.column(panel.bound)
            there = [place for place in places if values[place] is not None]
            self.bounds = [bounds[place] for place in greatest_places(xs, bounds, there)]

    def draw(self, axes, look):
        lows, highs = ([each[end] for each in self.sorted] for end in (0, -1))
        draw_range(axes, self.xs, lows, highs, look.color, ALL)
        quarters = [[each[round(share * (len(each) - 1))] for each in self.sorted] for share in (0.25, 0.5, 0.75)]
        draw_range(axes, self.xs, quarters[0], quarters[2], look.color, MIDDLE)
        for edge in (lows, highs):
            axes.plot(self.xs, edge, color=look.color, linewidth=0.8, zorder=2)
        axes.plot(self.xs, quarters[1], color=look.color, **{**style.POINT, "marker": look.marker}, zorder=3)
        if self.bounds:
            axes.plot(self.xs, self.bounds, **bound(look.color))


class FamilyDrawing:
    """Draws one family in one panel.

    not_best: the line goes through the best point at each x, except these places; None: through all points.
    with_dots: the other points at each x are drawn as dots, else as their range.
    """

    def __init__(self, points, family, xs, panel, as_points, not_best, with_dots):
        self.values = points.column(panel.column)
        self.bounds = points.column(panel.bound) if panel.bound else None
        self.beside = points.column(panel.beside) if panel.beside else None
        self.xs, self.look, self.as_points, self.not_best = xs, family.look, as_points, not_best
        self.with_dots = with_dots
        self.places = sorted((place for place in family.places if self.values[place] is not None),
                             key=lambda place: xs[place])

    def draw(self, axes):
        if self.as_points:
            self._dots(axes, 4)
            if self.bounds:
                self._plot(axes, self.places, self.bounds, **bound(self.look.color))
            return
        if self.not_best is not None and self.with_dots:
            self._dots(axes, 3)
        elif self.not_best is not None:
            self._range(axes)
        if self.bounds:
            places = greatest_places(self.xs, self.bounds, self.places)
            self._plot(axes, places, self.bounds, **bound(self.look.color))
        best = [each for each in self.places if each not in (self.not_best or ())]
        places = greatest_places(self.xs, self.values, best)
        if self.beside:
            self._plot(axes, places, self.beside, color=self.look.color, linewidth=0.8, linestyle=":",
                       marker=self.look.marker, markersize=3.5, markerfacecolor="white", zorder=2)
        self._plot(axes, places, self.values, color=self.look.color, linestyle=self.look.dashes,
                   **{**style.POINT, "marker": self.look.marker}, zorder=3)

    def _plot(self, axes, places, values, **look):
        axes.plot([self.xs[place] for place in places], [values[place] for place in places], **look)

    def _dots(self, axes, size):
        self._plot(axes, self.places, self.values, color=self.look.color, marker="o", linestyle="", markersize=size,
                   markeredgewidth=0, alpha=0.5, zorder=2)

    def _range(self, axes):
        by_x = {}
        for place in self.places:
            by_x.setdefault(self.xs[place], []).append(self.values[place])
        if by_x:
            lows, highs = (list(map(end, by_x.values())) for end in (min, max))
            draw_range(axes, list(by_x), lows, highs, self.look.color, ALL)
