"""Groups points to lines, and chooses color, marker and dashes of each line, by which it is distinguished."""

import dataclasses
import math

from points import natural, text_of
from style import COLORS, DASHES, GRAY, MARKERS, shades

MOST_LINES = 28
MOST_SINGLE = 6  # up to so many lines have a color each; of more, the color stands for one key
MOST_MARKERS = 4
NOTHING_TO_SEE = 0.01  # share of the value: a smaller change is not visible in a figure
MOST_DOTS = 300  # of more points that cannot be distinguished, envelopes are drawn
MOST_ENVELOPES = 4
MOST_TEXT = 48


@dataclasses.dataclass
class Look:
    color: str = COLORS[0]
    marker: str = MARKERS[0]
    dashes: object = DASHES[0]


@dataclasses.dataclass
class Family:
    """The points with one combination of values of Families.keys."""

    values: tuple
    places: list  # indices of the points in Points
    look: Look = None


class Families:
    """The points of a figure over column `x`, one family for each combination of the other keys that vary.

    keys: the other keys that vary.
    all: the families.
    told: the keys whose values the looks of the lines distinguish.
    legend: groups of (text, Look).
    as_points: more combinations of `told` than lines that can be distinguished: all families look the same.
    envelopes: of many such points, groups (places, Look) that are drawn as envelopes; else empty.
    note: text about what is not distinguished.
    """

    def __init__(self, points, places, x, x_keys, columns):
        """x_keys: the keys that the x axis stands for; columns: the columns that are drawn."""
        values = {key: points.column(key) for key in points.varied if key not in x_keys}
        self.keys = [key for key, column in values.items() if len({column[place] for place in places}) > 1]
        found = {}
        for place in places:
            found.setdefault(tuple(values[key][place] for key in self.keys), []).append(place)
        self.all = [Family(each, found[each]) for each in sorted(found, key=order)]
        self._drop_what_cannot_be_seen(points, points.column(x), columns)
        combinations = sorted({self._told(family) for family in self.all}, key=order)
        looks, self.legend = self._looks(combinations)
        self.as_points = looks is None
        self.envelopes = []
        if self.as_points:
            if len(places) > MOST_DOTS:
                self._find_envelopes(points, points.column(x), columns[0])
            drawn = "Envelopes" if self.envelopes else "Points without lines"
            self.note = (f"{drawn}: {len(combinations)} combinations of {', '.join(self.told)} are more "
                         "than can be told apart; --only KEY=VALUE draws fewer.")
        for family in self.all:
            family.look = looks[self._told(family)] if looks else Look()

    def _told(self, family):
        return tuple(value for key, value in zip(self.keys, family.values) if key in self.told)

    def _drop_what_cannot_be_seen(self, points, xs, columns):
        """Removes the keys from `told` that change the drawn columns so little that lines coincide."""
        drawn = [self._drawn(points, family, xs, columns) for family in self.all]
        self.told = list(self.keys)
        effect = 0
        for key in self.keys:
            self.told.remove(key)
            change = self._greatest_change(drawn)
            if change > NOTHING_TO_SEE:
                self.told = [each for each in self.keys if each in self.told or each == key]
            else:
                effect = change
        dropped = [key for key in self.keys if key not in self.told]
        self.note = ""
        if dropped:
            change = f"by {100 * effect:.2g} % at most" if effect else "not at all"
            keys = ", ".join(self._with_values(key) for key in dropped)
            self.note = f"Lines that differ only in {keys} look the same: what is drawn changes {change}."

    def _with_values(self, key):
        values = self._values(key)
        return f"{key} ({text_of(values[0])}, {'.., ' * (len(values) > 2)}{text_of(values[-1])})"

    @staticmethod
    def _drawn(points, family, xs, columns):
        """The greatest value of a family by (column, x)."""
        greatest = {}
        for column in columns:
            values = points.column(column)
            for place in family.places:
                if values[place] is not None:
                    at = (column, xs[place])
                    greatest[at] = max(values[place], greatest.get(at, values[place]))
        return greatest

    def _greatest_change(self, drawn):
        """The greatest difference between families that look the same, as a share of the greater value."""
        together = {}
        for family, values in zip(self.all, drawn):
            together.setdefault(self._told(family), []).append(values)
        greatest = 0
        for group in together.values():
            for at in set().union(*group):
                values = [each[at] for each in group if at in each]
                if max(values) != min(values):
                    greatest = max(greatest, (max(values) - min(values)) / max(map(abs, values)))
        return greatest

    def _find_envelopes(self, points, xs, column):
        """Groups all points by the key of `told` within whose values the column ranges least at each x."""
        values = points.column(column)
        best, self.envelopes = math.inf, []
        for key in self.told:
            groups = self._places_by(key)
            colors = colors_of(list(groups)) if len(groups) <= MOST_ENVELOPES else None
            left = sum(left_range(places, xs, values) for places in groups.values())
            if colors and left < best:
                best = left
                looks = [Look(color, MARKERS[number]) for number, color in enumerate(colors)]
                self.envelopes = list(zip(groups.values(), looks))
                self.legend = [list(zip(named([key], list(groups)), looks))]
        if not self.envelopes:
            self.envelopes = [([place for family in self.all for place in family.places], Look())]

    def _places_by(self, key):
        """{(value,): places}, in the order of the values."""
        at = self.keys.index(key)
        groups = {(value,): [] for value in self._values(key)}
        for family in self.all:
            groups[family.values[at],] += family.places
        return groups

    def _looks(self, combinations):
        """({combination: Look}, legend); (None, []) if there are too many combinations of values of
        `told`."""
        if len(combinations) == 1:
            return {combinations[0]: Look()}, []
        by_color = [[key] for key in sorted(self.told, key=lambda each: -len(self._values(each)))]
        if len(combinations) <= MOST_SINGLE or len(self.told) == 1:
            by_color = [self.told]
        for keys in by_color if len(combinations) <= MOST_LINES else []:
            looks, legend = self._looks_by(keys, combinations)
            if looks:
                return looks, legend
        return None, []

    def _values(self, key):
        at = self.keys.index(key)
        return sorted({family.values[at] for family in self.all}, key=natural)

    def _looks_by(self, keys, combinations):
        """The same, with these keys shown by color, and the others by marker and dashes."""
        others = [key for key in self.told if key not in keys]

        def part(combination, wanted):
            return tuple(value for key, value in zip(self.told, combination) if key in wanted)

        colored = sorted({part(each, keys) for each in combinations}, key=order)
        marked = sorted({part(each, others) for each in combinations}, key=order)
        colors = colors_of(colored)
        if colors is None or len(marked) > MOST_MARKERS:
            return None, []
        looks = {}
        for each in combinations:
            number, place = colored.index(part(each, keys)), marked.index(part(each, others))
            marker = MARKERS[place if others else number % len(MARKERS)]
            looks[each] = Look(colors[number], marker, DASHES[place])
        if not others:
            return looks, [list(zip(named(keys, colored), looks.values()))]
        by_color = [(text, Look(color, None)) for text, color in zip(named(keys, colored), colors)]
        by_marker = [(text, Look(GRAY, MARKERS[place], DASHES[place]))
                     for place, text in enumerate(named(others, marked))]
        return looks, [by_color, by_marker]


def order(values):
    return [natural(value) for value in values]


def left_range(places, xs, values):
    """The range of the values at each x, relative to the greatest, in sum."""
    by_x = {}
    for place in places:
        if values[place] is not None:
            by_x.setdefault(xs[place], []).append(values[place])
    return sum((max(each) - min(each)) / (max(map(abs, each)) or 1) for each in by_x.values())


def named(keys, combinations):
    """"key = value, .." of each combination. Long values are shortened, unless this makes texts equal."""
    def texts(shorten):
        return [", ".join(f"{key} = {shorten(text_of(value))}" for key, value in zip(keys, each))
                for each in combinations]

    short = texts(shortened)
    return short if len(set(short)) == len(short) else texts(str)


def shortened(text):
    return text if len(text) <= MOST_TEXT else text[: MOST_TEXT - 2] + ".."


def colors_of(combinations):
    """A color for each combination; shades if these are four or more numbers, one of which may be a word such
    as all.

    None if there are too many.
    """
    words = sum(len(each) > 1 or not isinstance(each[0], (int, float)) for each in combinations)
    if len(combinations) > 3 and words <= 1 and all(len(each) == 1 for each in combinations):
        return shades(len(combinations)) if len(combinations) <= 12 else None
    return COLORS[: len(combinations)] if len(combinations) <= len(COLORS) else None
