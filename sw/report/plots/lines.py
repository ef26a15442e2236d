"""Figures of frame rates as lines over one column."""

import dataclasses

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


@dataclasses.dataclass
class Panel:
    """One column over x, with its bound above each point."""

    column: str
    height: float  # inches
    beside: str = None  # another column, drawn thin and dotted
    limit: tuple = None  # (value, text in the legend) of a line that is drawn if the column comes near it
    listed: list = ()  # further columns for the table
    partial: bool = False  # some points have no value in this column

    def __post_init__(self):
        self.bound = bound_of(self.column)

    def drawn(self):
        return [each for each in (self.column, self.bound, self.beside) if each]

    def need_numbers(self, points, places):
        values = points.column(self.column)
        points.need_numbers(self.drawn(),
                            [place for place in places if not self.partial or values[place] is not None])


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
        panels.append(Panel("area.slices_percent", MORE_HEIGHT, limit=(100, "the FPGA is full"),
                            listed=["area.slices"]))
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
    for text in (families.note, points.pixels_note(places), above_note(points, places, panels),
                 points.size_note(places),
                 points.note(len(places))):
        sheet.note(text)
    for axes, panel in zip(sheet.grid([panel.height for panel in panels]), panels):
        for group, look in families.envelopes:
            draw_envelope(axes, points, group, xs, panel, look)
        for family in [] if families.envelopes else families.all:
            not_best = set(losing) if best else None
            draw_family(axes, points, family, xs, panel, families.as_points, not_best, with_dots)
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
    if families.envelopes:
        lines = counted(len(families.envelopes), "envelope")
    else:
        lines = "without lines" if families.as_points else counted(len(families.all), "line")
    return Drawing(sheet, columns, points.rows(columns, places), f"{counted(len(places), 'point')}, {lines}")


def handles(families, panels, best, with_dots):
    """The entries of the legend that apply to all families."""
    entries = []
    color = GRAY if families.legend else families.all[0].look.color
    if families.envelopes:
        entries += [(Patch(color=color, alpha=ALL, linewidth=0),
                     "all points, from the least to the greatest"),
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
    """A note if rates exceed their bounds, which whole pictures do by their uncertainty at most."""
    for panel in panels:
        if panel.bound == "bound.system":
            values, bounds = points.column(panel.column), points.column(panel.bound)
            above = [place for place in set(places) - set(points.losing_pixels())
                     if values[place] is not None and values[place] > bounds[place]]
            if above:
                return (f"Above the bound by no more than the uncertainty: "
                        f"{counted(len(above), 'steady rate')}.")
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


def by_x(places, xs, values):
    """{x: its values, from the least}, from the least x."""
    found = {}
    for place in places:
        found.setdefault(xs[place], []).append(values[place])
    return {x: sorted(found[x]) for x in sorted(found)}


def draw_envelope(axes, points, places, xs, panel, look):
    """The range of many points at each x, their middle half, the median and the greatest bound."""
    values = points.column(panel.column)
    there = [place for place in places if values[place] is not None]
    at = by_x(there, xs, values)
    lows, highs = ([each[end] for each in at.values()] for end in (0, -1))
    draw_range(axes, list(at), lows, highs, look.color, ALL)
    quarters = [[each[round(share * (len(each) - 1))] for each in at.values()] for share in (0.25, 0.5, 0.75)]
    draw_range(axes, list(at), quarters[0], quarters[2], look.color, MIDDLE)
    for edge in (lows, highs):
        axes.plot(list(at), edge, color=look.color, linewidth=0.8, zorder=2)
    axes.plot(list(at), quarters[1], color=look.color, **{**style.POINT, "marker": look.marker}, zorder=3)
    if panel.bound:
        bounds = points.column(panel.bound)
        axes.plot(list(at), [bounds[place] for place in greatest_places(xs, bounds, there)],
                  **bound(look.color))


def draw_family(axes, points, family, xs, panel, as_points, not_best, with_dots):
    """The line of a family.

    not_best: the line goes through the best point at each x, except these places; None: through all points.
    with_dots: the other points at each x are drawn as dots, else as their range.
    """
    values, look = points.column(panel.column), family.look
    there = sorted((place for place in family.places if values[place] is not None),
                   key=lambda place: xs[place])

    def plot(places, column, **more):
        axes.plot([xs[place] for place in places], [column[place] for place in places],
                  **{"color": look.color, **more})

    if as_points or (not_best is not None and with_dots):
        plot(there, values, marker="o", linestyle="", markersize=4 if as_points else 3, markeredgewidth=0,
             alpha=0.5,
             zorder=2)
    elif not_best is not None and there:
        at = by_x(there, xs, values)
        draw_range(axes, list(at), *([each[end] for each in at.values()] for end in (0, -1)), look.color, ALL)
    if panel.bound:
        bounds = points.column(panel.bound)
        plot(there if as_points else greatest_places(xs, bounds, there), bounds, **bound(look.color))
    if as_points:
        return
    best = greatest_places(xs, values, [each for each in there if each not in (not_best or ())])
    if panel.beside:
        plot(best, points.column(panel.beside), linewidth=0.8, linestyle=":", marker=look.marker,
             markersize=3.5,
             markerfacecolor="white", zorder=2)
    plot(best, values, linestyle=look.dashes, **{**style.POINT, "marker": look.marker}, zorder=3)
