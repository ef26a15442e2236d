"""The Pareto front of a sweep."""

import math
import re

import style
from drawing import LOSES_PIXELS, TOO_LARGE, Drawing, Sheet, bound_of, mark_handle, scale, title
from points import BANKS_USED, LOST_PIXELS, UNITS_USED, Unusable, counted, short_names, text_of
from style import bound, bound_handle, line_handle

DEFAULT = "area.slices:min,frames_per_second.core:max"
SENSES = {"min": "less is better", "max": "more is better"}
MOST_NAMED = 16
MANY = 1500  # points; more are small and paler, and are pixels in SVG and PDF
FRONT, OTHER = style.VERMILION, "#7A858E"
NUMBER_SIZE = 8


def parse(text):
    """The value of --pareto as [(column, sense), (column, sense)]; None if it does not have this form."""
    found = [re.fullmatch(r"(.+):(min|max)", part) for part in text.split(",")]
    if len(found) != 2 or not all(found) or found[0][1] == found[1][1]:
        return None
    return [match.groups() for match in found]


def check(points, options):
    """The problems of --pareto. points: None if they cannot be read."""
    if options.pareto is None:
        return []
    axes = parse(options.pareto)
    if axes is None:
        return [f"--pareto = {options.pareto}: must be two columns, each with min or max: {DEFAULT}"]
    problems = [points.number_problem(column) for column, _ in axes] if points else []
    return [f"--pareto = {options.pareto}: {problem}" for problem in problems if problem]


def uncertainty_of(points, column, places):
    """How far the values of a column may be off; None if they are exact."""
    name = f"{column}_uncertainty"
    if name not in points.names:
        return None
    points.need_numbers([name], places)
    return [points.column(name)[place] for place in places]


def front_of(columns, senses, uncertainties):
    """Indices of the points of the Pareto front, from the best x on.

    From one point to the next the exact column (without uncertainty) becomes worse, and the other better by
    more than the sum of both uncertainties. Points that are equal in the exact column, and tie in the other,
    are all on the front.
    columns, senses, uncertainties: of x and y.
    """
    xs, ys = ([value if sense == "min" else -value for value in column]
              for column, sense in zip(columns, senses))
    along, across, doubt = xs, ys, uncertainties[1]
    if uncertainties[0] is not None:
        along, across, doubt = ys, xs, uncertainties[0]
    front, last = [], None  # last: the next point has to beat it
    for place in sorted(range(len(xs)), key=lambda place: (along[place], across[place])):
        loss = -math.inf if last is None else across[place] - across[last]
        both = doubt[place] + doubt[last] if doubt and last is not None else 0
        if loss < -both:
            last = place
        if place == last or (loss <= both and along[place] == along[last]):
            front.append(place)
    return sorted(front, key=lambda place: (xs[place], -ys[place]))


def draw(points, options):
    """Two columns against each other, and their Pareto front: the points that no other point dominates."""
    axes_of = parse(options.pareto or DEFAULT)
    (x, x_sense), (y, y_sense) = axes_of
    if options.pareto is None:
        for column in (x, y):
            points.need_variation(column)
    places = [place for place, pair in enumerate(zip(points.column(x), points.column(y))) if None not in pair]
    if not places:
        raise Unusable(f"no point has both {x} and {y}")
    points.need_numbers([x, y], places)
    xs = [points.column(x)[place] for place in places]
    ys = [points.column(y)[place] for place in places]
    uncertainties = [uncertainty_of(points, column, places) for column in (x, y)]
    front = front_of((xs, ys), (x_sense, y_sense), uncertainties)
    corners = list(dict.fromkeys((xs[place], ys[place]) for place in front))
    bounds = {axis: points.column(bound_of(column)) for axis, column in (("x", x),
                                                                         ("y", y)) if bound_of(column)}
    points.need_numbers(filter(None, (bound_of(x), bound_of(y))), [places[at] for at in front])

    heading = "Pareto front: " + ", ".join(re.sub(", (.*)", r" (\1)", title(column)) for column in (x, y))
    sheet = Sheet(heading, options.size, options.format)
    handles = [(line_handle(FRONT, "o"), "Pareto front"),
               (line_handle(OTHER, "o", "", markersize=4), "other points")]
    if bounds:
        handles.append((bound_handle(FRONT), "bound of a point of the front"))
    marks = [(mark, pairs_with_only(marked, places, xs, ys))
             for mark, marked in ((TOO_LARGE, points.too_large()), (LOSES_PIXELS, points.losing_pixels()))]
    handles += [mark_handle(mark) for mark, pairs in marks if pairs]
    sheet.legend(handles)
    names = [name(points, [places[at] for at in front if (xs[at], ys[at]) == corner]) for corner in corners]
    for number, text in enumerate(names[:MOST_NAMED], 1):
        sheet.note(f"{number}  {text}", style.INK, " " * 6)
    if len(names) > MOST_NAMED:
        sheet.note(f"{len(names) - MOST_NAMED} more of the front are in the table.")
    if any(uncertainties):
        sheet.note("What lies within the uncertainty ties.")
    sheet.note(points.pixels_note(places))
    sheet.note(points.size_note(places))
    sheet.note(points.note(len(places)))
    (axes,) = sheet.grid([3.6])
    is_many = len(xs) > MANY
    axes.plot(*zip(*dict.fromkeys(zip(xs, ys))), "o", color=OTHER, markersize=2 if is_many else 4,
              alpha=0.35 if is_many else 0.6, markeredgewidth=0, zorder=2, rasterized=is_many)
    for mark, pairs in marks:
        if pairs:
            axes.plot(*zip(*pairs), **mark)
    for axis, column in bounds.items():
        limits = [column[places[at]] for at in front]
        others = [(ys if axis == "x" else xs)[at] for at in front]
        axes.plot(*((limits, others) if axis == "x" else (others, limits)), **bound(FRONT, of_x=axis == "x"))
    for which, (column, sense) in zip("xy", axes_of):
        limits = [bounds[which][places[at]] for at in front] if which in bounds else []
        scale(axes, which, title(column), [*(points.column(column)[place] for place in places), *limits],
              SENSES[sense],
              are_counts=column in (*points.keys, BANKS_USED, UNITS_USED))
    draw_front(axes, corners, xs, ys, axes_of)

    of_front = {place: number for number, place in enumerate(front)}
    lost = [each for each in LOST_PIXELS if each in points.names]
    doubts = [f"{column}_uncertainty" for column, doubt in zip((x, y), uncertainties) if doubt]
    columns = list(dict.fromkeys(["hash", *points.varied, x, y, *doubts,
                                  *filter(None, (bound_of(x), bound_of(y))),
                                  *lost]))
    order = sorted(range(len(places)),
                   key=lambda at: (of_front.get(at, len(front)), points.hashes[places[at]]))
    table = points.rows(columns, [places[at] for at in order])
    rows = [[*row, int(at in of_front)] for at, row in zip(order, table)]
    said = f"{counted(len(places), 'point')}, {len(front)} of them on the front"
    return Drawing(sheet, [*columns, "front"], rows, said)


def pairs_with_only(these, places, xs, ys):
    """The pairs (x, y) at which all points are among `these`. places, xs, ys: of all drawn points."""
    these, pairs = set(these), list(zip(xs, ys))
    others = {pair for place, pair in zip(places, pairs) if place not in these}
    return [pair for pair in dict.fromkeys(pairs) if pair not in others]


def draw_front(axes, corners, xs, ys, axes_of):
    """Draws the line that bounds the region dominated by the front, and numbers the points of the front."""
    worse = [max if sense == "min" else min for _, sense in axes_of]
    line = [(corners[0][0], worse[1](ys)), corners[0]]
    for before, after in zip(corners, corners[1:]):
        line += [(worse[0](before[0], after[0]), worse[1](before[1], after[1])), after]
    line.append((worse[0](xs), corners[-1][1]))
    axes.plot(*zip(*line), "-", color=FRONT, linewidth=1.2, zorder=2.5)
    axes.plot(*zip(*corners), color=FRONT, linestyle="", **style.POINT, zorder=3)
    # The numbers stand on the side of the front that has no points.
    side, align = (-1, "right") if axes_of[0][1] == "min" else (1, "left")
    rise, seat = (1, "bottom") if axes_of[1][1] == "max" else (-1, "top")
    for first, last in numbers_apart(axes, corners[:MOST_NAMED]):
        text = str(first + 1) if first == last else f"{first + 1}\N{EN DASH}{last + 1}"
        axes.annotate(text, corners[first], (5 * side, 6 * rise), textcoords="offset points",
                      fontsize=NUMBER_SIZE,
                      ha=align, va=seat, zorder=4)


def numbers_apart(axes, corners):
    """Groups (first, last) of corners, so that the numbers of two groups do not touch: those that do are
    merged."""
    to_inches = axes.transData + axes.figure.dpi_scale_trans.inverted()
    inches = [to_inches.transform(corner) for corner in corners]
    groups = [(number, number) for number in range(len(corners))]

    def box(group):
        digits = len(str(group[0] + 1)) if group[0] == group[1] else len(f"{group[0] + 1}-{group[1] + 1}")
        return inches[group[0]], 0.05 + 0.075 * digits, 0.15

    def touch(one, other):
        (a, width_a, height_a), (b, width_b, height_b) = box(one), box(other)
        return abs(a[0] - b[0]) < max(width_a, width_b) and abs(a[1] - b[1]) < max(height_a, height_b)

    at = 0
    while at + 1 < len(groups):
        if touch(groups[at], groups[at + 1]):
            groups[at : at + 2] = [(groups[at][0], groups[at + 1][1])]
            at = max(0, at - 1)
        else:
            at += 1
    return groups


def name(points, places):
    """The name of a corner of the front: the values of the keys that vary. places: its points."""
    short = short_names(points.varied)
    same = [key for key in points.varied if len({points.column(key)[place] for place in places}) == 1]
    text = ", ".join(f"{short[key]}={text_of(points.column(key)[places[0]])}" for key in same)
    if len(places) == 1:
        return text
    others = ", ".join(short[key] for key in points.varied if key not in same)
    return f"{text}{', ' * bool(text)}{len(places)} points with other {others}"
