#!/usr/bin/env python3
"""Checks what a finished search (`stereotlm optimise PLAN --out DB`) says that it proves. It shares nothing
with the search: combinations, placements and their symmetry, verdicts, bounds and dominance are computed anew
from the plan and the board in DB. Figures of boards come from `stereotlm sweep`, cycles also from a plain
loop.

usage: check_search.py DB PROGRAM [--loops N] [--boards N] [--seed S]
"""
import argparse
import collections
import copy
import decimal
import functools
import itertools
import json
import math
import multiprocessing
import pathlib
import random
import re
import sqlite3
import subprocess
import sys
import tempfile

import yaml

import plain_core

RATE, STEADY, UNCERTAINTY, EXACT, LEAST, MOST = (f"frames_per_second.{name}" for name in (
    "core", "steady", "steady_uncertainty", "exact", "exact_least", "exact_most"))
ENERGY = "energy.memory_mj_per_frame"
TIMING = {"sync_burst": ["turnaround_cycles"],
          "sdram": ["cas_latency", "row_words", "internal_banks", "activate_cycles", "precharge_cycles",
                    "refresh_interval_cycles", "refresh_cycles"]}
yaml.SafeDumper.ignore_aliases = lambda *_: True
MASK = (1 << 64) - 1
NAMES = re.compile(r"'[^']*'|[A-Za-z_][\w.]*")


def number(word):
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            pass
    return word


def read(text):
    """YAML in which the word `off` is no false."""
    def plain(node):
        if isinstance(node, dict):
            return {key: plain(value) for key, value in node.items()}
        return [plain(value) for value in node] if isinstance(node, list) else number(node)
    return plain(yaml.load(text, yaml.BaseLoader))


def put(board, path, value):
    *names, last = path.split(".")
    for name in names:
        board = board.setdefault(name, {})
    board[last] = copy.deepcopy(value)


def values_of(given):
    if isinstance(given, list):
        return given
    first, last, step = (decimal.Decimal(str(given[key])) for key in ("from", "to", "step"))
    return [number(str(first + i * step)) for i in range(int((last - first) // step) + 1)]


def numbers_of(text):
    """Those of "0-4 7"."""
    ends = (part.split("-") for part in text.split())
    return [one for end in ends for one in range(int(end[0]), int(end[-1]) + 1)]


def shuffled(size, seed, place):
    """The number at a place of the shuffled numbers below size: a Feistel network of six rounds permutes
    those of an even number of bits, and is applied again until the result is below size. SplitMix64 mixes."""
    def mixed(value):
        value = (value ^ value >> 30) * 0xBF58476D1CE4E5B9 & MASK
        value = (value ^ value >> 27) * 0x94D049BB133111EB & MASK
        return value ^ value >> 31
    bits = max(1, ((size - 1).bit_length() + 1) // 2)
    keys = [mixed(seed + (turn + 1) * 0x9E3779B97F4A7C15 & MASK) for turn in range(6)]
    while True:
        left, right = divmod(place, 1 << bits)
        for key in keys:
            left, right = right, left ^ mixed(right ^ key) & (1 << bits) - 1
        place = left << bits | right
        if place < size:
            return place


def computed(sql, row, connection=sqlite3.connect(":memory:")):
    """The value of an expression over the names of a row."""
    values = []

    def bound(word):
        if word[0] not in row:
            return word[0]
        values.append(row[word[0]])
        return "?"
    return connection.execute(f"SELECT ({NAMES.sub(bound, sql)})", values).fetchone()[0]


def renamed(placement, kinds):
    """The same with the first banks of each kind, in the order of their use."""
    names = {}
    for bank in itertools.chain(*placement):
        if bank not in names:
            names[bank] = next(other for other, kind in enumerate(kinds)
                               if kind == kinds[bank] and other not in names.values())
    return tuple(tuple(names[bank] for bank in parts) for parts in placement)


class Placements:
    """All different placements of a board's buffers, in the order of the guide."""

    def __init__(self, board, most_banks, most_parts):
        self.names = list(board["ssram"]["banks"])
        banks = [plain_core.bank_of(board, name) for name in self.names]
        energy = board["ssram"]["default"].get("energy", {})
        self.kinds = [json.dumps([[bank.get(key) for key in ("kind", "words", *TIMING.get(bank["kind"], []))],
                                  sorted({**energy, **bank.get("energy", {})}.items())]) for bank in banks]
        lists = plain_core.buffers(board)
        self.is_joint = board["fpga"].get("tables") == "joint"
        if self.is_joint:
            lists["right_lut"] = []
        self.lengths = {name: len(each) for name, each in lists.items()}
        self.turn = math.lcm(self.lengths["left_image"], self.lengths["disparity"])
        own = tuple(tuple(map(self.names.index, parts)) for each in lists.values() for parts in each)
        self.all = [] if most_banks else [own]
        height, width = board["image"]["height"], board["image"]["width"]
        choices = sorted(choice for length in range(1, min(most_parts, height) + 1)
                         for choice in itertools.permutations(range(len(banks)), length)
                         if len({plain_core.read_latency(banks[bank]) for bank in choice}) == 1)
        of_row = [width // (1 if "lut" in name else 4) for name, length in self.lengths.items()
                  for _ in range(length)]

        def extend(placement):
            words = collections.Counter()
            for parts, row in zip(placement, of_row):
                for i, bank in enumerate(parts):
                    words[bank] += plain_core.up(height - i, len(parts)) * row
            if (any(words[bank] > banks[bank]["words"] for bank in words) or len(words) > most_banks
                    or renamed(placement, self.kinds) != placement):
                return
            if len(placement) == len(of_row):
                self.all.append(placement)
                return
            for choice in choices:
                extend((*placement, choice))
        if most_banks:
            extend(())

    def alike(self, placement):
        """What pins and area follow from, and, where frames are independent, the time."""
        used = sorted(self.kinds[bank] for bank in set(itertools.chain(*placement)))
        buffers = list(placement)
        lists = [[buffers.pop(0) for _ in range(length)] for length in self.lengths.values() if length]
        frames = sorted(renamed([each[frame % len(each)] for each in lists], self.kinds)
                        for frame in range(self.turn))
        return tuple(used), tuple(map(len, placement)), tuple(frames)

    def put_into(self, board, at):
        banks = [[self.names[bank] for bank in parts] for parts in self.all[at]]
        buffers = [parts[0] if len(parts) == 1 else {"rows": parts} for parts in banks]
        for name, length in self.lengths.items():
            each = [buffers.pop(0) for _ in range(length)]
            if each:
                board["allocation"][name] = each if length > 1 else each[0]
        if self.is_joint:
            board["allocation"]["right_lut"] = board["allocation"]["left_lut"]


def cycles_in_loop(board, frames, is_waitless=False):
    core = plain_core.Core(board)
    return sum(core.frame_cycles(frame, is_waitless) for frame in range(frames))


class Check:
    def __init__(self, path, program, seed):
        self.program, self.random = program, random.Random(seed)
        self.problems, self.notes = collections.Counter(), collections.Counter()
        database = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
        self.rows = lambda sql: database.execute(sql).fetchall()
        self.asked = dict(self.rows("SELECT name, value FROM search"))
        plan = read(self.asked["plan"])
        self.sample = {name: int(value) for name, value in plan.get("sample", {}).items()}
        self.base, self.run = read(self.asked["board"]), plan.get("run", {})
        self.axes = [{path: values_of(each)} for path, each in plan.get("vary", {}).items()]
        self.axes += [{path: values_of(each) for path, each in axis.items()} for axis in plan.get("zip", [])]
        self.product = math.prod(len(next(iter(axis.values()))) for axis in self.axes)
        where = plan.get("where", [])
        self.where = where if isinstance(where, list) else [where]
        self.most_banks, self.most_parts = map(int, self.asked["goals"].split()[-2:])
        self.goals = [(figure, 1 if aim == "maximise" else -1)
                      for figure, aim in self.rows("SELECT figure, aim FROM goals ORDER BY goal")]
        self.requirements = [text for text, in self.rows("SELECT condition FROM requirements")]
        asked = " ".join([*self.requirements, *(figure for figure, _ in self.goals)])
        has_computer = self.run.get("source") == "camera" or any("run.source" in axis for axis in self.axes)
        self.asks_steady = STEADY in asked
        asks_for_losses = "lost_pixels" in asked or "dropped_pixels" in asked
        self.asks_whole_pictures = has_computer and (self.asks_steady or not asks_for_losses)
        self.front = collections.defaultdict(list)  # of each point, of each goal the least and the most
        for point, *ends in self.rows("SELECT point, least, most FROM front_values ORDER BY point, goal"):
            self.front[point].append(tuple(ends))
        self.placements_of, self.figures = {}, {}

    def wrong(self, what, *details):
        self.problems[what] += 1
        if self.problems[what] <= 3:
            print(f"{what}: {' '.join(map(str, details))}")

    # The space.

    @functools.lru_cache(4096)
    def combination(self, at):
        """The board of a combination with its own placement, its run, and what the plan gives it."""
        board, run, given = copy.deepcopy(self.base), dict(self.run), {}
        if self.sample:
            at = shuffled(self.product, self.sample["seed"], at)
        for axis in reversed(self.axes):
            at, i = divmod(at, len(next(iter(axis.values()))))
            given.update((path, values[i]) for path, values in axis.items())
        for path, value in given.items():
            put({"run": run} if path.startswith("run.") else board, path, value)
        return board, run, given

    def placements(self, at):
        board = self.combination(at)[0]
        key = json.dumps([*map(board.get, ("ssram", "allocation", "image")), board["fpga"].get("tables")])
        if key not in self.placements_of:
            self.placements_of[key] = Placements(board, self.most_banks, self.most_parts)
        return self.placements_of[key]

    def board(self, at, placement):
        board = copy.deepcopy(self.combination(at)[0])
        if self.placements(at).all:
            self.placements(at).put_into(board, placement)
        return board

    def frames(self, at):
        return int(self.combination(at)[1].get("frames", self.placements(at).turn))

    def is_camera(self, at):
        return self.combination(at)[1].get("source") == "camera"

    def sweep(self, asked):
        """Takes the figures of boards, each a combination and a placement, from a sweep."""
        columns = collections.defaultdict(list)
        for at, placement in dict.fromkeys(asked):
            given = {"name": f"c{at}p{placement}", **self.combination(at)[2]}
            given.update((f"allocation.{name}", value)
                         for name, value in self.board(at, placement)["allocation"].items())
            for path, value in given.items():
                columns[path].append(value)
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            plan = {"board": str(folder / "board.yaml"), "run": self.run, "zip": [dict(columns)]}
            for file, content in (("board", self.base), ("plan", plan)):
                (folder / f"{file}.yaml").write_text(yaml.safe_dump(content, sort_keys=False))
            subprocess.run([self.program, "sweep", folder / "plan.yaml", "--out", folder / "points.db"],
                           check=True, stdout=subprocess.DEVNULL)
            points = sqlite3.connect(folder / "points.db")
            self.keys = {name for name, in points.execute("SELECT name FROM columns WHERE is_key")}
            points.row_factory = sqlite3.Row
            for row in map(dict, points.execute("SELECT * FROM points")):
                board = tuple(map(int, row["name"][1:].split("p")))
                buffers = plain_core.buffers(self.board(*board)).values()
                row["banks_used"] = len({bank for each in buffers for parts in each for bank in parts})
                row["all_cycles"] = None
                if row["status"] == "ok" and not self.is_camera(board[0]):
                    row["all_cycles"] = row["cycles"] + row["frames"] * row["fpga.pipeline_latency_cycles"]
                self.figures[board] = row

    # What a board is worth.

    def rates(self, row):
        """The row with the least and with the most that its run leaves open of the rate of a computer."""
        if not self.asks_steady:
            return [row]
        proven = (row.get(LEAST) or 0, row.get(MOST) or math.inf)  # a column may be missing
        measured = (row[STEADY] - (row[UNCERTAINTY] or 0), row[STEADY] + (row[UNCERTAINTY] or 0))
        least, most = max(proven[0], measured[0]), min(proven[1], measured[1])
        if least > most:
            least, most = (most, most) if least - most < 1e-9 * row[STEADY] else proven
        return [{**row, STEADY: rate} for rate in (least, most)]

    def values(self, row):
        """Of each goal the least and the most that it can be."""
        return [(min(of), max(of)) for of in (
            [computed(figure, each) for each in self.rates(row)] for figure, _ in self.goals)]

    def meets(self, row):
        """Whether it is so; None if its run leaves that open."""
        if self.asks_whole_pictures and row["lost_pixels"]:
            return False
        both = {all(computed(text, each) for text in self.requirements) for each in self.rates(row)}
        return both.pop() if len(both) == 1 else None

    def is_dominated(self, values):
        """Whether a point of the front is for certain at least as good in all goals, and better in one."""
        signs = [sign for _, sign in self.goals]
        best = [max(sign * end for end in ends) for sign, ends in zip(signs, values)]
        worst = ([min(sign * end for end in ends) for sign, ends in zip(signs, point)]
                 for point in self.front.values())
        return any(its != best and all(map(float.__ge__, its, map(float, best))) for its in worst)

    def at_best(self, row, cycles):
        """The values with fewer cycles than the row has; None if goals depend on them in another way."""
        fixed = self.keys | {"banks_used", "pins"}
        for figure, _ in self.goals:
            names = {name for name in NAMES.findall(figure) if name in row and not name.startswith("area.")}
            if figure not in ("cycles", RATE) and not names <= fixed:
                return None
        rate = row["fpga.clock_mhz"] * 1e6 * row["frames"] / cycles
        least = cycles - row["frames"] * row["fpga.pipeline_latency_cycles"]
        return self.values({**row, "cycles": least, RATE: rate})

    # What the database says.

    def cover(self):
        """Reads the verdicts and fates, and checks that each combination and each placement has one."""
        self.verdicts, self.fates, ends = {}, [], -1
        for first, last, verdict, _ in self.rows("SELECT * FROM parts ORDER BY first"):
            if first != ends + 1:
                self.wrong("the parts are no cover", first, "behind", ends)
            ends = last
            self.verdicts.update((at, verdict) for at in range(first, last + 1))
        size = self.sample.get("points", self.product)
        if not ends + 1 == size == self.asked["combinations"]:
            self.wrong("the parts are not all combinations", ends + 1, "of", size)
        spaces, covered = collections.defaultdict(list), collections.defaultdict(list)
        for space, numbers in self.rows("SELECT space, placements FROM spaces ORDER BY space, number"):
            spaces[space].append(numbers_of(numbers))
        alike = functools.cache(lambda placements, space: self.check_space(placements, spaces[space]))
        for at, space, of, numbers, *fate in self.rows("SELECT * FROM examined"):
            placements, numbers = self.placements(at), numbers_of(numbers)
            groups = spaces[space] if self.most_banks else [[0]]
            covered[at] += numbers
            if self.most_banks and not alike(placements, space) and of == "groups":
                self.wrong("a group of placements that are not alike", "combination", at)
            if of == "groups":
                kinds = {json.loads(kind)[0][0] for kind in placements.kinds} & {"sync_burst", "sdram"}
                is_round_robin = self.combination(at)[0]["fpga"]["arbitration"] == "round_robin"
                if kinds or is_round_robin or self.frames(at) % placements.turn or self.is_camera(at):
                    self.wrong("frames that depend on each other are taken one by one", "combination", at)
                numbers = [number for group in numbers for number in groups[group]]
            self.fates.append((at, numbers, *fate))
            if sorted(covered[at]) == list(range(len(groups if of == "groups" else placements.all))):
                covered[at] = None
        if {at for at, verdict in self.verdicts.items() if verdict == "examined"} != set(covered):
            self.wrong("other combinations are examined than the parts say")
        for at, left in covered.items():
            if left is not None:
                self.wrong("the fates do not cover the placements", "combination", at, left)
        boards = sum(len(self.placements(at).all) for at, verdict in self.verdicts.items()
                     if verdict not in ("impossible", "excluded"))
        if boards != self.asked["boards"]:
            self.wrong("another number of boards", self.asked["boards"], "expected", boards)

    def check_space(self, placements, groups):
        """Checks that these are all placements. Returns whether those of each group are alike."""
        if sorted(itertools.chain(*groups)) != list(range(len(placements.all))):
            self.wrong("other placements", sum(map(len, groups)), "expected", len(placements.all))
            return True
        return all(len({placements.alike(placements.all[one]) for one in group}) == 1 for group in groups)

    def check_boards(self, most, loops):
        """Checks what is said of boards, at random where there are more."""
        asked = []  # combination, placement, what is said of it
        for verdict in ("impossible", "excluded", "unmet", "bound"):
            them = [at for at, its in self.verdicts.items() if its == verdict]
            for at in self.random.sample(them, min(len(them), most // 10)):
                placements = self.placements(at)
                numbers = self.random.sample(range(len(placements.all)), len(placements.all)) or [0]
                if verdict == "bound":  # one of each use of banks
                    numbers = {placements.alike(placements.all[one])[:2]: one for one in numbers}.values()
                else:
                    numbers = numbers[:1]
                asked += [(at, number, verdict, None, "") for number in numbers]
        for fate in ("unmet", "bound", "dominated", "front"):
            them = [(at, number, fate, *rest) for at, numbers, its, *rest in self.fates if its == fate
                    for number in (numbers if fate == "front" else
                                   self.random.sample(numbers, min(len(numbers), 3)))]
            limit = most if fate == "front" else most // 5
            if len(them) > limit:
                self.notes[f"{fate}, not looked at"] += len(them) - limit
            asked += self.random.sample(them, min(len(them), limit))
        self.sweep([one[:2] for one in asked])
        found = collections.defaultdict(list)
        jobs = []
        for at, placement, fate, least, results in asked:
            row = self.figures[at, placement]
            board = f"{fate}: combination {at}, placement {placement}"
            self.notes[f"{fate}, boards"] += 1
            if (row["status"] == "ok") == (fate == "impossible"):
                if fate != "impossible" or self.placements(at).all:
                    self.wrong("a board that is possible, or is not", board, row["reason"])
                continue
            if fate == "impossible":
                continue
            if all(computed(text, row) for text in self.where) == (fate == "excluded"):
                self.wrong("where says otherwise", board)
            if fate == "excluded":
                continue
            values = self.values(row)
            if fate in ("front", "dominated", "unmet") and self.meets(row) is (fate == "unmet"):
                self.wrong("the requirements say otherwise", board)
            if fate == "bound" and not self.meets(row):
                continue  # ruled out with others, which could meet the requirements
            if fate in ("bound", "dominated") and not self.is_dominated(values):
                if self.is_dominated([(least_, least_) for least_, _ in values]):
                    self.notes["beaten only with the bound of turns, which is not computed anew"] += 1
                else:
                    self.wrong("a board that nothing on the front beats", board, values)
            if fate == "front":
                # The short run of a computer, which is not run anew, may leave less open.
                points = [point for point, ends in self.front.items() if all(
                    its[0] <= end[0] and its[1] >= end[1] for its, end in zip(values, ends))]
                points.sort(key=lambda point, values=values: self.front[point] != values)
                found[points[0] if points else None].append((at, placement))
            cycles, is_core = row["all_cycles"], not self.is_camera(at)
            if least and is_core:
                best = self.at_best(row, least)
                if least > cycles:
                    self.wrong("a bound above the cycles", board, least, cycles)
                elif fate == "bound" and best and not self.is_dominated(best):
                    self.wrong("a bound that nothing on the front beats", board, best)
            if results:
                names = sorted({name for text in (*self.requirements, *(figure for figure, _ in self.goals))
                                for name in NAMES.findall(text) if name in row and name not in self.keys
                                and not name.startswith(("area.", "accuracy."))
                                and name not in ("banks_used", "pins")})
                if self.asks_steady:
                    names = sorted({*names, UNCERTAINTY, EXACT, LEAST, MOST})
                if self.asks_whole_pictures:
                    names = sorted({*names, "lost_pixels"})
                has_sdram = any("sdram" in kind for kind in self.placements(at).kinds)
                is_full = (not is_core or set(names) - {"cycles", RATE, ENERGY}
                           or ENERGY in names and has_sdram)
                expected = [row.get(name) or 0 for name in names] if is_full else [cycles]
                if list(map(float, results.split())) != expected:
                    self.wrong("other results", board, results, expected)
            if not is_core or self.asked["tables"] or row["image.width"] > 64 or row["image.height"] > 48:
                self.notes["not run in the loop: a computer, a rig's tables, or larger than 64x48"] += 1
                continue
            jobs.append((self.board(at, placement), self.frames(at), False, cycles, board, row))
            if fate == "bound" and least is None:
                jobs.append((*jobs[-1][:2], True, *jobs[-1][3:]))
        jobs = self.random.sample(jobs, min(len(jobs), loops))
        with multiprocessing.Pool() as pool:
            ran = pool.starmap(cycles_in_loop, [job[:3] for job in jobs], chunksize=1)
        for (_, _, is_waitless, cycles, board, row), in_loop in zip(jobs, ran):
            self.notes["run in the loop" + ", without waits" * is_waitless] += 1
            if is_waitless:  # the bound of a combination that is ruled out as a whole
                best = self.at_best(row, in_loop)
                if best and not self.is_dominated(best):
                    self.wrong("ruled out by no bound", board, in_loop)
            elif in_loop != cycles:
                self.wrong("the loop takes other cycles", board, in_loop, cycles)
        self.check_front(found)

    def check_front(self, found):
        for point, values in self.front.items():
            if self.is_dominated(values):
                self.wrong("a point of the front is beaten", point)
        if found[None]:
            self.wrong("boards of the front with other values", found[None][:3])
        if "front, not looked at" in self.notes:
            return
        listed = collections.defaultdict(list)
        for point, *board, _ in self.rows("SELECT * FROM front_boards ORDER BY 1, 2, 3"):
            listed[point].append(tuple(board))
        for point, boards, config in self.rows("SELECT * FROM front"):
            if any(least != most for least, most in self.front[point]):
                continue  # its boards may be within another range, too
            if len(found[point]) != boards:
                self.wrong("another number of boards has a point", point, boards, len(found[point]))
            elif listed[point] != sorted(found[point])[:100]:
                self.wrong("other boards are the first", point)
            elif plain_core.buffers(read(config)) != plain_core.buffers(self.board(*listed[point][0])):
                self.wrong("another board is the first", point)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("usage")[0])
    parser.add_argument("database")
    parser.add_argument("program")
    parser.add_argument("--loops", type=int, default=200, help="runs of the plain loop, at most")
    parser.add_argument("--boards", type=int, default=2000, help="boards whose figures are computed, about")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    check = Check(arguments.database, arguments.program, arguments.seed)
    check.cover()
    check.check_boards(arguments.boards, arguments.loops)
    for what, count in sorted(check.notes.items()):
        print(f"{count:8} {what}")
    print(f"{sum(check.problems.values())} problems")
    return 1 if check.problems else 0


if __name__ == "__main__":
    sys.exit(main())
