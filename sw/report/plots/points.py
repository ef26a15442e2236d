"""Reads the database of stereotlm sweep.

Its table `points` has a column for each key and each figure of stats.json. The table `keys` names the columns
that are keys. The table `blame` has the stalls. Unusable is raised if something cannot be drawn.
"""

import difflib
import os
import re
import sqlite3
import urllib.parse

APPLICATION_ID = 0x53544C4D
LAYOUT = 2

# Columns of `points` that are neither keys nor figures.
ADMINISTRATION = {"hash", "status", "reason", "version", "config"}

MOST_NAMED = 12  # names or values in a message

# Additional columns: the number of distinct banks that the allocation names; the number that matcher.units
# stands for.
BANKS_USED = "banks_used"
UNITS_USED = "units_used"

PORTS = ["left_lut", "right_lut", "left_pixel", "right_pixel", "result", "host"]
LANE_PORTS = PORTS[:4]
OTHER_CAUSES = ["turnaround", "row", "refresh"]
LOST_PIXELS = ["cameras.left.dropped_pixels", "cameras.right.dropped_pixels"]
LARGEST = 1e100  # matplotlib overflows with an axis for greater numbers
NUMBER = f"must be a number from {-LARGEST:g} to {LARGEST:g}"


class Unusable(Exception):
    """The figure or the command cannot be made. lines: the reasons."""

    def __init__(self, *lines):
        super().__init__("; ".join(lines))
        self.lines = lines


def natural(value):
    """The sort key of a value: numbers first, then texts (numbers in them compare by size), None last."""
    if value is None:
        return (2, [])
    if isinstance(value, (int, float)):
        return (0, value)
    parts = re.split(r"(\d+)", str(value))  # those at odd places are numbers
    return (1, [(int(part), "") if place % 2 else (-1, part) for place, part in enumerate(parts)])


def text_of(value):
    if value is None:
        return "absent"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e16:
        return str(int(value))
    return str(value)


def is_number(value):
    return isinstance(value, (int, float)) and abs(value) <= LARGEST


def counted(number, what):
    return f"{number} {what}" + "s" * (number != 1)


def quoted(name):
    return '"' + name.replace('"', '""') + '"'


def mean_of(values):
    """The mean of the values that there are; None without any. Strange values stay as they are."""
    there = [value for value in values if value is not None]
    if len(there) < 2 or not all(map(is_number, there)):
        return there[0] if there else None
    return sum(there) / len(there)


def group_of(name):
    """The port group of a port: "left_lut" of "left_lut.3"."""
    group, _, lane = name.partition(".")
    return group if group in LANE_PORTS and lane.isdigit() else name


def banks_of(allocated):
    """The set of banks in the value of one allocation key: "[bank0, bank1]", "bank6" or "none"."""
    names = re.findall(r"[^\[\], ]+", str(allocated or ""))
    return {name for name in names if name != "none"}


def nearest(word, words):
    """Up to three of `words` that are similar to `word`, in full or from one of their dots on."""
    parts = {}
    for each in words:
        for start in range(each.count(".") + 1):
            parts.setdefault(".".join(each.split(".")[start:]), []).append(each)
    found = [name for part in difflib.get_close_matches(word, parts, 3, 0.5) for name in parts[part]]
    return list(dict.fromkeys(found))[:3]


class Points:
    """The points of a database that have figures, in the order of their hashes.

    All are read in one transaction. A point is identified by its place, the index in this order.
    path: as given.
    total: the number of rows of the table points.
    left_out: {reason: number of rows that are not among these points}.
    names: the names of all columns.
    keys: the names of the columns that are keys of the board or the run.
    hashes: the hashes of these points.
    varied: the keys that differ between these points.
    """

    def __init__(self, path):
        self.path = path
        self.name = os.fsencode(os.path.basename(path)).decode(errors="replace")
        self._database = self._open()
        self.names = [row[0]
                      for row in self._rows("SELECT name FROM pragma_table_info('points') ORDER BY cid")]
        keys = {row[0] for row in self._rows("SELECT name FROM keys")}
        self.keys = [name for name in self.names if name in keys]
        self.total = self._rows("SELECT count(*) FROM points")[0][0]
        self.left_out = dict(self._rows("SELECT status, count(*) FROM points WHERE status <> 'ok' "
                                        "GROUP BY status ORDER BY status DESC"))
        self._select("status = 'ok'", [])

    def _select(self, condition, values):
        self._condition, self._values, self._columns = condition, values, {}
        self.hashes = self.column("hash")
        if not self.hashes:
            raise Unusable(f"{self.path}: no point to draw: {self.left_out_text() or 'it is empty'}")
        self.varied = self._varied()

    def _open(self):
        if os.path.exists(self.path) and not os.path.isfile(self.path) and not os.path.isdir(self.path):
            raise Unusable(f"{self.path}: must be a regular file")  # SQLite would wait for a pipe
        try:
            with open(self.path, "rb"):
                pass
        except OSError as error:
            raise Unusable(f"{self.path}: cannot be opened: {error.strerror}") from None
        try:
            address = urllib.parse.quote(os.fsencode(os.path.abspath(self.path)))
            database = sqlite3.connect(f"file:{address}?mode=ro", uri=True, isolation_level=None, timeout=60)
            database.execute("BEGIN")  # one state of the database, even if a sweep is writing
            application = database.execute("PRAGMA application_id").fetchone()[0]
            layout = database.execute("PRAGMA user_version").fetchone()[0]
        except sqlite3.DatabaseError as error:
            what = "not a database" if "not a database" in str(error) else str(error)
            raise Unusable(f"{self.path}: {what}") from None
        if application != APPLICATION_ID:
            raise Unusable(f"{self.path}: not a database of stereotlm sweep")
        if layout != LAYOUT:
            raise Unusable(f"{self.path}: its layout is {layout}, of another version; this version reads "
                           f"{LAYOUT}")
        return database

    def _rows(self, sql, *values):
        try:
            return self._database.execute(sql, values).fetchall()
        except sqlite3.DatabaseError as error:
            raise Unusable(f"{self.path}: {error}") from None

    def keep(self, only):
        """Leaves out points that do not have all these values, each given as "KEY=VALUE".

        Returns the problems; if there are any, all points are kept.
        """
        problems = []
        condition, values = self._condition, []
        for text in only:
            key, equals, wanted = text.partition("=")
            there = self._rows(f"SELECT DISTINCT {quoted(key)} FROM points") if key in self.keys else []
            same = [value for (value,) in there if text_of(value) == wanted]
            if not equals:
                problems.append(f"--only = {text}: must be KEY=VALUE")
            elif key not in self.keys:
                problems.append(f"--only = {text}: {unknown('key', key, self.keys)}")
            elif not same:
                known = sorted((value for (value,) in there), key=natural)[:MOST_NAMED]
                values_there = ", ".join(map(text_of, known))
                problems.append(f"--only = {text}: no point has that value; there are: {values_there}")
            else:
                condition += f" AND {quoted(key)} IS ?"
                values.append(same[0])
        if only and not problems:
            before = len(self.hashes)
            if not self._rows(f"SELECT 1 FROM points WHERE {condition} LIMIT 1", *values):
                return [f"--only {' '.join(only)}: no point with figures has all these values"]
            self._select(condition, values)
            self.left_out["other than --only " + " ".join(only)] = before - len(self.hashes)
        return problems

    def column(self, name):
        """The values of a column, of BANKS_USED or of UNITS_USED by place; None for a point without value.

        Of a port group "ports.left_lut.grants" has the mean of the lanes.
        """
        if name not in self._columns:
            if name == BANKS_USED:
                allocated = [self.column(key) for key in self.names if key.startswith("allocation.")]
                self._columns[name] = [len(set().union(*map(banks_of, each))) for each in zip(*allocated)]
            elif name == UNITS_USED:
                units = zip(self.column("matcher.units"), self.column("matcher.disparities"))
                self._columns[name] = [disparities if each == "all" else each for each, disparities in units]
            elif lanes := self._lanes(name):
                own = self._column(name) if name in self.names else [None] * len(self.hashes)
                self._columns[name] = [mean_of([value, *others])
                                       for value, *others in zip(own, *map(self._column, lanes))]
            elif name in self.names:
                self._columns[name] = self._column(name)
            else:
                self._columns[name] = [None] * len(self.hashes)
        return self._columns[name]

    def _lanes(self, name):
        """The columns of the lanes of the port group of this column."""
        ports, _, rest = name.partition(".")
        port, _, count = rest.partition(".")
        if ports != "ports" or port not in LANE_PORTS or "." in count:
            return []
        return [each for each in self.names if re.fullmatch(rf"ports\.{port}\.\d+\.{count}", each)]

    def _column(self, name):
        rows = self._rows(f"SELECT {quoted(name)} FROM points WHERE {self._condition} ORDER BY hash",
                          *self._values)
        return [row[0] for row in rows]

    def rows(self, names, places):
        """The values of these columns at these places, a list for each place."""
        columns = [self.column(name) for name in names]
        return [[column[place] for column in columns] for place in places]

    def blame(self, place):
        """The stalls of one point: rows (port, bank, by, cycles). by: the port granted, turnaround, row
        or refresh. Ports are port groups; cycles are the mean of the lanes."""
        rows = self._rows("SELECT port, bank, by, cycles FROM blame WHERE hash = ? ORDER BY port, bank, by",
                          self.hashes[place])
        for port, bank, by, cycles in rows:
            if not is_number(cycles):
                raise Unusable(f"blame of point {self.hashes[place]}: {port}, {bank}, {by}: cycles = "
                               f"{cycles}: {NUMBER}")
        lanes = int(self.column("fpga.lanes")[place] or 1)
        sums = {}
        for port, bank, by, cycles in rows:
            key = (group_of(port), bank, group_of(by))
            sums[key] = sums.get(key, 0) + (cycles / lanes if group_of(port) != port else cycles)
        return [(*key, cycles) for key, cycles in sums.items()]

    def stall_cycles(self):
        """The stall cycles of all ports together, by place."""
        columns = [f"ports.{port}.stall_cycles" for port in PORTS]
        self.need_numbers(columns)
        return [sum(each) for each in zip(*map(self.column, columns))]

    def too_large(self):
        """Places of the points that need more of some resource than the FPGA has."""
        columns = [name for name in self.names if re.fullmatch(r"area\.\w+_percent", name)]
        for name in columns:
            self.need_numbers([name], self.places_with(name))
        return [place for place, shares in enumerate(zip(*map(self.column, columns)))
                if any(share is not None and share > 100 for share in shares)]

    def losing_pixels(self):
        """Places of the points whose captures have lost pixels."""
        return [place for place, values in enumerate(zip(*map(self.column, LOST_PIXELS))) if any(values)]

    def size_note(self, places):
        count = len(set(places) & set(self.too_large()))
        return f"{count} of the points take more area than the FPGA has." if count else ""

    def pixels_note(self, places):
        count = len(set(places) & set(self.losing_pixels()))
        text = f"{count} of the points lose pixels: the pictures that they match are not whole."
        return text if count else ""

    def varies(self, name):
        return len(set(self.column(name))) > 1

    def need_variation(self, name):
        if not self.varies(name):
            raise Unusable(f"all points have {name} = {text_of(self.column(name)[0])}")

    def places_with(self, name):
        """Places of the points that have a value in this column."""
        return [place for place, value in enumerate(self.column(name)) if value is not None]

    def number_problem(self, name):
        """Why the values of a column, as far as present, cannot be drawn as numbers; empty if they can."""
        known = [*self.names, BANKS_USED, UNITS_USED]
        if name not in known:
            return unknown("column", name, [each for each in known if each not in ADMINISTRATION])
        places = self.places_with(name)
        if not places:
            return f"column {name} is empty"
        return next(filter(None, (self._value_problem(name, place) for place in places)), "")

    def need_numbers(self, names, places=None):
        """Raises Unusable unless these columns have numbers at these places, by default at all."""
        for name in names:
            for place in range(len(self.hashes)) if places is None else places:
                problem = self._value_problem(name, place)
                if problem:
                    raise Unusable(problem)

    def _value_problem(self, name, place):
        value = self.column(name)[place]
        return "" if is_number(value) else f"point {self.hashes[place]}: {name} = {text_of(value)}: {NUMBER}"

    def frames(self):
        """The frames of the runs by place. Raises Unusable if a run has none."""
        self.need_numbers(["frames"])
        for place, frames in enumerate(self.column("frames")):
            if frames < 1:
                raise Unusable(f"point {self.hashes[place]}: frames = {text_of(frames)}: must be 1 or more")
        return self.column("frames")

    def left_out_text(self):
        return ", ".join(f"{count} {reason}" for reason, count in self.left_out.items() if count)

    def note(self, shown, more=None):
        """The note below a figure: how many points it shows, and why others are left out.

        more: {reason: number of points}, for reasons of this figure.
        """
        reasons = {**self.left_out, **(more or {})}
        missing = len(self.hashes) - shown - sum((more or {}).values())
        if missing:
            reasons["without these figures"] = missing
        board = self.column("name")[0] if not self.varies("name") else "several boards"
        source = self.column("run.source")[0] if not self.varies("run.source") else "several"
        text = f"{board}, source {source}: {shown} of {self.total} points of {self.name}"
        others = ", ".join(f"{count} {reason}" for reason, count in reasons.items() if count)
        return f"{text}; not shown: {others}." if others else f"{text}."

    def why_left_out(self):
        """The most frequent reasons of points without figures, as rows (status, reason, number of points)."""
        return self._rows("SELECT status, reason, count(*) FROM points WHERE status <> 'ok' "
                          "GROUP BY status, reason ORDER BY 3 DESC, 1, 2 LIMIT 3")

    def _varied(self):
        return self._without_frames(self._one_for_all_banks(list(filter(self.varies, self.keys))))

    def _without_frames(self, varied):
        """Removes run.frames from `varied` if its value follows from the allocation."""
        lists = [self.column(key) for key in varied if key.startswith("allocation.")]
        frames = self.column("run.frames")
        if "run.frames" in varied and len(set(zip(*lists))) == len(set(zip(*lists, frames))):
            varied.remove("run.frames")
        return varied

    def _one_for_all_banks(self, varied):
        """Replaces a key that all banks have, with equal values in each point, by one key for all banks."""
        banks = [name for name in self.names if name.startswith("ssram.banks.")]
        for ending in sorted({name.rsplit(".", 1)[1] for name in banks}):
            ours = [name for name in banks if name.endswith("." + ending)]
            if len(ours) > 1 and set(ours) <= set(varied) and len({tuple(self.column(name))
                                                                   for name in ours}) == 1:
                name = f"ssram.banks.*.{ending}"
                self._columns[name] = self.column(ours[0])
                at = varied.index(ours[0])
                varied = [key for key in varied[:at] if key not in ours] + [name] + [
                    key for key in varied[at:] if key not in ours]
        return varied


def unknown(kind, name, known):
    near = nearest(name, known)
    return f"unknown {kind} {name}" + (f"; nearest: {', '.join(near)}" if near else "")


def short_names(keys):
    """{key: the shortest end of its dotted path that no other key has}."""
    names = {}
    for key in keys:
        parts = key.split(".")
        for length in range(1, len(parts) + 1):
            end = ".".join(parts[-length:])
            if not any(other != key and ("." + other).endswith("." + end) for other in keys):
                break
        names[key] = end
    return names
