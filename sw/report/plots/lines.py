"""Figures of frame rates as lines over one column."""

from drawing import (BOUND_WIDTH, LOSES_PIXELS, Drawing, Sheet, bound_of, line_handle, mark_handle, pale, scale, ticks_at,
                     title)
from families import GRAY, Families
from points import LOST_PIXELS, counted, natural

RATE_HEIGHT = 2.7
MORE_HEIGHT = 2.1


class Panel:
    """One column over x, with its bound behind it.

    beside: another column, drawn thin and dotted; None: no other.
    limit: (value, text) of a line that is drawn if the column comes near to the value; None: no line.
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


def draw(points, x, x_keys, panels, best=False):
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
    sheet = Sheet()
    for group in families.legend:
        sheet.legend([(line_handle(look.color, look.marker, look.dashes), text) for text, look in group])
    sheet.legend([*handles(families, panels, best), *([mark_handle(LOSES_PIXELS)] if losing else [])])
    for text in (families.note, points.pixels_note(places), above_note(points, places, panels), points.size_note(places),
                 points.note(len(places))):
        sheet.note(text)
    for axes, panel in zip(sheet.rows([panel.height for panel in panels]), panels):
        for family in families.all:
            FamilyDrawing(points, family, xs, panel, families.as_points, set(losing) if best else None).draw(axes)
        if panel.bound:
            mark(axes, [(xs[place], points.column(panel.column)[place]) for place in losing])
        values = [points.column(each)[place] for each in panel.drawn() for place in places]
        scale(axes, "y", title(panel.column), values)
        draw_limit(axes, panel, values)
    ticks_at(sheet.panels[-1].xaxis, sorted({xs[place] for place in places}))
    sheet.panels[-1].set_xlabel(title(x))
    listed = [each for panel in panels for each in panel.listed]
    columns = list(dict.fromkeys(["hash", *points.varied, x, *drawn, *listed]))
    places.sort(key=lambda place: ([natural(points.column(key)[place]) for key in families.keys], xs[place]))
    rows = [[points.column(each)[place] for each in columns] for place in places]
    lines = "without lines" if families.as_points else counted(len(families.all), 'line')
    return Drawing(sheet, columns, rows, f"{counted(len(places), 'point')}, {lines}")


def handles(families, panels, best):
    """The entries of the legend that apply to all families."""
    entries = []
    color = GRAY if families.legend else families.all[0].look.color
    if families.as_points:
        entries.append((line_handle(color, "o", "", markersize=4, alpha=0.55), "simulated"))
    elif best:
        entries.append((line_handle(color, None if families.legend else "o"), "best allocation"))
        entries.append((line_handle(color, "o", "", markersize=3, alpha=0.5), "every allocation"))
    elif not families.legend:
        entries.append((line_handle(color, "o"), "simulated"))
    if any(panel.bound for panel in panels):
        entries.append((line_handle(pale(color), None, linewidth=BOUND_WIDTH), "bound"))
    if any(panel.beside for panel in panels) and not families.as_points:
        entries.append((line_handle(color, "o", ":", linewidth=0.8, markersize=3.5, markerfacecolor="white"),
                        "from power-up, tables included"))
    return entries


def above_note(points, places, panels):
    """A note if rates exceed their bounds, which hold for long runs and not for few frames; otherwise empty."""
    for panel in panels:
        if panel.bound == "bound.system":
            values, bounds = points.column(panel.column), points.column(panel.bound)
            above = [place for place in places if values[place] is not None and values[place] > bounds[place]]
            if above:
                frames = points.frames()
                return (f"{len(above)} steady rates are above their bounds, which hold for long runs: they are of "
                        f"{min(frames[place] for place in above)} frames, from the first delivered to the last.")
    return ""


def mark(axes, points):
    points = [point for point in points if None not in point]
    if points:
        axes.plot(*zip(*points), **LOSES_PIXELS)


def draw_limit(axes, panel, values):
    values = [value for value in values if value is not None]
    if panel.limit and values and max(values) > 0.9 * panel.limit[0]:
        axes.axhline(panel.limit[0], color="#222222", linewidth=0.9, linestyle=(0, (6, 3)), zorder=1.4)
        axes.annotate(panel.limit[1], (0, panel.limit[0]), (4, 2), ("axes fraction", "data"), "offset points",
                      fontsize=7.5)


class FamilyDrawing:
    """Draws one family in one panel.

    not_best: the line goes through the best point at each x, except these places; None: through all points.
    """

    def __init__(self, points, family, xs, panel, as_points, not_best):
        self.values = points.column(panel.column)
        self.bounds = points.column(panel.bound) if panel.bound else None
        self.beside = points.column(panel.beside) if panel.beside else None
        self.xs, self.look, self.as_points, self.not_best = xs, family.look, as_points, not_best
        self.places = sorted((place for place in family.places if self.values[place] is not None),
                             key=lambda place: xs[place])

    def draw(self, axes):
        if self.as_points:
            self._dots(axes, 4)
            if self.bounds:
                self._ticks(axes, self.places)
            return
        if self.not_best is not None:
            self._dots(axes, 3)
        if self.bounds:
            places = self._line_places(self.bounds, self.places)
            self._plot(axes, places, self.bounds, color=pale(self.look.color), linewidth=BOUND_WIDTH,
                       solid_capstyle="butt", zorder=1.5)
            if len(places) == 1:
                self._ticks(axes, places)
        places = self._line_places(self.values, [each for each in self.places if each not in (self.not_best or ())])
        if self.beside:
            self._plot(axes, places, self.beside, color=self.look.color, linewidth=0.8, linestyle=":",
                       marker=self.look.marker, markersize=3.5, markerfacecolor="white", zorder=2)
        self._plot(axes, places, self.values, color=self.look.color, marker=self.look.marker,
                   linestyle=self.look.dashes, markeredgecolor="white", markeredgewidth=0.6, zorder=3)

    def _plot(self, axes, places, values, **look):
        axes.plot([self.xs[place] for place in places], [values[place] for place in places], **look)

    def _dots(self, axes, size):
        self._plot(axes, self.places, self.values, color=self.look.color, marker="o", linestyle="", markersize=size,
                   markeredgewidth=0, alpha=0.5, zorder=2)

    def _ticks(self, axes, places):
        self._plot(axes, places, self.bounds, color=pale(self.look.color), marker="_", linestyle="", markersize=12,
                   markeredgewidth=4, zorder=1.5)

    def _line_places(self, values, places):
        """For each x, from the least: the one of these places with the greatest value."""
        greatest = {}
        for place in places:
            x = self.xs[place]
            if x not in greatest or values[place] > values[greatest[x]]:
                greatest[x] = place
        return [greatest[x] for x in sorted(greatest)]
