"""The numbers of the paper, where they stand, the boards that are simulated for them, and the rules by which
a modelled value confirms a printed one. To add a claim, add a row to claims()."""
import dataclasses

BOARD, SMALL_BOARD = "fpl2003", "fpl2003-qvga"
NO_FILTER = "matcher.filter=none"

CONFIRMED, NOT_CONFIRMED, IN_PART, OPEN = "confirmed", "not confirmed", "in part", "open"

# What is compared, and its unit.
RATE = "frames/s"  # of the first run: of the core, or of the computer between deliveries
SLICES = "% of the slices"  # of the first run's board
SPREAD = "frames/s, spread"  # the highest rate of the runs minus the lowest
SPEED_UP = "times"  # the rate of the first run divided by that of the second
BANKS_PROVED = "banks, proved"  # the fewest that some allocation of the core needs for the best rate of all
BANKS_FOUND = "banks, found"  # the fewest of the runs that reach the rate of the first: no proof
# The change of the share of wrong answers, or of the share of answered pixels, from the first run to the
# second, whichever is larger. Further runs are shown beside.
ACCURACY = "percentage points"


@dataclasses.dataclass(frozen=True)
class BoardRun:
    """A board, run without pixels; with a scene the core alone is run on one frame of the scene."""

    preset: str
    sets: tuple = ()  # "KEY=VALUE"
    camera: bool = False  # the whole computer; else the core alone
    scene: str = ""  # "", "synthetic 1", or PAIR


@dataclasses.dataclass(frozen=True)
class Rule:
    relation: str  # "within %": of the printed value; "within"; "at least"; "more"
    tolerance: float = 0
    unit: str = ""

    def text(self):
        if self.relation == "within %":
            return f"within {self.tolerance:g} %"
        if self.relation == "within":
            return f"within {self.tolerance:g} {self.unit}"
        less = f" less {self.tolerance:g} {self.unit}" if self.tolerance else ""
        return f"{self.relation}{' than' * (self.relation == 'more')} the printed value{less}"

    def holds(self, printed, modelled):
        if self.relation == "more":
            return modelled > printed
        if self.relation == "at least":
            return printed - modelled <= self.tolerance
        most = self.tolerance * abs(printed) / 100 if self.relation == "within %" else self.tolerance
        return abs(printed - modelled) <= most


@dataclasses.dataclass(frozen=True)
class Claim:
    name: str
    place: str  # in the paper
    says: str
    quantity: str
    rule: Rule
    half_digit: float  # rounding of the printed values: half of the last digit
    cases: list  # (name, printed value, runs)


PAIR = "the given pair"
# Window n of n x n: frames a second at 640x480 with 80 disparities; 40 MHz stands in Table 2.
TABLE_1 = {15: 8.7, 13: 10.0, 11: 11.8, 9: 14.5, 7: 18.9, 5: 26.0}
# Disparities: percent of the slices at 640x480 with 7x7.
TABLE_2 = {80: 21, 160: 43, 200: 54}
TABLE_2_RATE = 18.9  # of all three rows

# The whole computer: for each number of banks the best allocation that `allocate` finds. Buffers that are not
# named keep the board's banks.
CHOSEN = [[],
          ["disparity=[bank4, bank4]", "left_lut=bank5", "right_lut=bank6"],
          ["disparity=[bank1, bank3]", "left_lut=bank4", "right_lut=bank5"],
          ["left_image=[bank0, bank0]", "right_image=[bank1, bank1]", "disparity=[bank2, bank2]",
           "left_lut=bank3", "right_lut=bank4"]]


def window(size):
    return f"matcher.window={size}"


def disparities(number):
    return f"matcher.disparities={number}"


def of_windows(printed, windows, preset, *sets, beside=()):
    """One case for each window, for the core alone and for the whole computer."""
    return [(f"{size}x{size}, {'the whole computer' if camera else 'the core alone'}", printed,
             [BoardRun(each, (window(size), *sets), camera) for each in (preset, *beside)])
            for camera in (False, True) for size in windows]


def costs(scenes):
    """One case for each judged cost on each scene. Census, which the paper does not name, is beside."""
    cases = []
    for scene, sets in scenes.items():
        sad, *others, census = (BoardRun(BOARD, (*sets, f"matcher.cost={cost}"), scene=scene)
                                for cost in ("sad", "ssd", "zncc", "{census: 5}"))
        cases += [(f"{run.sets[-1].partition('=')[2]}, {scene}", 0, [sad, run]) for run in others]
        cases[-1][2].append(census)
    return cases


def claims(pair_disparities=None):
    """All claims. pair_disparities: matcher.disparities that PAIR needs; None leaves the pair out."""
    # All rows of Table 1 but one keep this tolerance; a printed row is rounded by up to 0.57 %.
    rate = Rule("within %", 0.35)
    least = Rule("at least", 0.5, "frames/s")
    more, banks = Rule("more"), Rule("at least")
    point = Rule("within", 1, "percentage point")  # of "almost the same": the paper gives no number
    every = [5, 7, 9]  # where the paper names no window
    sizes = [(f"{number} disparities", percent, [BoardRun(BOARD, (disparities(number),))])
             for number, percent in TABLE_2.items()]
    rates = [(name, TABLE_2_RATE, [BoardRun(BOARD, (*run.sets, NO_FILTER))]) for name, _, (run,) in sizes]
    together = [("80, 160 and 200 disparities", 0, [run for _, _, (run,) in rates])]
    scenes = {f"synthetic {seed}": () for seed in (1, 2, 3)}
    if pair_disparities:
        scenes[PAIR] = (disparities(pair_disparities),)
    chosen = [BoardRun(BOARD, tuple("allocation." + each for each in sets), camera=True) for sets in CHOSEN]
    return [
        Claim("table1", "Table 1", "frames per second against the window, 80 disparities", RATE, rate, 0.05,
              [(f"{size}x{size}", printed,
                [BoardRun(BOARD, (window(size), NO_FILTER)), BoardRun(BOARD, (window(size),))])
               for size, printed in TABLE_1.items()]),
        Claim("table2_size", "Table 2", "circuit size against the disparities, 7x7", SLICES, point, 0.5,
              sizes),
        Claim("table2_rate", "Table 2", "frames per second against the disparities, 7x7", RATE, rate, 0.05,
              rates),
        Claim("table2_constant", "sec. 4", "frames per second do not change with the disparities", SPREAD,
              Rule("within", 0.05, "frames/s"), 0, together),
        Claim("practice", "sec. 4", "20 frames per second in practice, at 7x7 and 9x9", RATE, least, 0.5,
              of_windows(20, [7, 9], BOARD)),
        Claim("any_window", "abstract, sec. 5", "20 frames per second", RATE, least, 0.5,
              of_windows(20, every, BOARD)),
        Claim("more_any_window", "sec. 1", "more than 20 frames per second, with disparities up to 200", RATE,
              more, 0.5, of_windows(20, every, BOARD, disparities(200))),
        Claim("small", "abstract", "80 frames per second at 320x240", RATE, least, 0.5,
              of_windows(80, every, SMALL_BOARD)),
        Claim("more_small", "sec. 1", "more than 80 frames per second at 320x240", RATE, more, 0.5,
              of_windows(80, every, SMALL_BOARD)),
        Claim("small_speed_up", "sec. 4", "four times as fast at 320x240, at 7x7 and 9x9", SPEED_UP, rate, 0,
              of_windows(4, [7, 9], SMALL_BOARD, beside=[BOARD])),
        Claim("banks", "sec. 3.1, 5", "at least eight memory banks, the core alone", BANKS_PROVED, banks, 0,
              [("the core alone, every allocation", 8, [BoardRun(BOARD)])]),
        Claim("banks_of_matching", "sec. 3.1", "six memory banks for matching itself", BANKS_PROVED, banks, 0,
              [("the core alone, every allocation", 6, [BoardRun("fpl2003-no-calibration")])]),
        Claim("banks_of_computer", "sec. 3.1, 5", "at least eight memory banks, the whole computer",
              BANKS_FOUND, banks, 0, [("the whole computer, some allocations", 8, chosen)]),
        Claim("costs", "sec. 2.1", "almost the same results with SAD as with SSD and NCC", ACCURACY, point, 0,
              costs(scenes)),
    ]


def verdict_of_all(cases):
    """The verdict on a claim, from the verdicts on its cases."""
    if len(set(cases)) == 1:
        return cases[0]
    return IN_PART if CONFIRMED in cases else NOT_CONFIRMED
