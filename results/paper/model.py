"""Simulates the boards of the claims, and compares them with the paper."""
import dataclasses
import functools
import shlex

import stereotlm
from claims import (ACCURACY, BANKS_FOUND, BANKS_PROVED, CONFIRMED, NOT_CONFIRMED, OPEN, PAIR, RATE, SLICES,
                    SPEED_UP, SPREAD, Claim, claims, verdict_of_all)

FRAMES = {False: 2, True: 14}  # of the core: each buffer once; of the computer: a first turn, and six more
MOST_BANKS = 8  # of the paper's boards
ROUNDING = 1e-9  # rates are quotients: a smaller relative difference is rounding
DOUBTFUL = 50  # percent of wrong answers; a scene on which the first run has more does not judge


@dataclasses.dataclass
class Finding:
    """A case that was simulated. runs: the figures of stats.json of its runs, with "banks"."""

    name: str
    printed: float
    of: list
    runs: list
    modelled: float
    verdict: str
    commands: list

    @property
    def camera(self):
        return self.of[0].camera


@dataclasses.dataclass
class Found:
    claim: Claim
    cases: list
    verdict: str
    banks: list  # rows of the table of banks, for a claim about banks

    def confirmed(self):
        return f"{sum(case.verdict == CONFIRMED for case in self.cases)} of {len(self.cases)}"

    def deviation(self, case):
        """From the printed value, in percent of it; None of banks, or if the printed value is 0."""
        if self.claim.quantity in (BANKS_PROVED, BANKS_FOUND) or case.printed == 0:
            return None
        return 100 * (case.modelled / case.printed - 1)

    def clock_mhz(self, case):
        """The least and the most at which the core would reach the printed rate; else (None, None)."""
        if self.claim.quantity != RATE or case.camera:
            return None, None
        of_a_frame = board_of(case.of[0])["fpga.clock_mhz"] / case.modelled
        return tuple((case.printed + half) * of_a_frame for half in (-self.claim.half_digit,
                                                                     self.claim.half_digit))


@functools.cache
def board_of(run):
    return stereotlm.Board(run.preset, list(run.sets))


def allocation_text(board):
    """"left_image bank0 bank1, .., right_lut bank7"."""
    placed = ((name, board[f"allocation.{name}"]) for name in
              ("left_image", "right_image", "disparity", "left_lut", "right_lut"))
    return ", ".join(" ".join([name, *(banks if isinstance(banks, list) else [banks])])
                     for name, banks in placed if banks not in (None, "none"))


class Model:
    """pair: the options of `run` for PAIR. say: called with a text before each simulation."""

    def __init__(self, pair, say):
        self._pair, self._say = pair, say
        self._runs = {}

    def _options(self, run):
        if run.scene == PAIR:
            return {"source": "preloaded", **self._pair}
        if run.scene:
            return {"source": "preloaded", "synthetic": int(run.scene.split()[1])}
        return {**({} if run.camera else {"source": "preloaded"}), "timing_only": True,
                "frames": FRAMES[run.camera]}

    def command_of(self, run):
        options = [[f"--{name.replace('_', '-')}", *([] if value is True else [str(value)])]
                   for name, value in self._options(run).items()]
        return shlex.join(["stereotlm", "run", run.preset, *(word for each in run.sets
                                                            for word in ("--set", each)),
                           *(word for option in options for word in option)])

    def commands_of(self, claim, runs):
        words = shlex.join([runs[0].preset, *(word for each in runs[0].sets for word in ("--set", each))])
        if claim.quantity == SLICES:
            return [f"stereotlm bounds {words}"]
        if claim.quantity == BANKS_PROVED:
            return [f"stereotlm allocate {words} --source preloaded --banks {MOST_BANKS} --out banks.db"]
        judged = {RATE: 1, ACCURACY: 2}.get(claim.quantity, len(runs))
        return [self.command_of(run) for run in runs[:judged]]

    def figures(self, run):
        command = self.command_of(run)
        if command not in self._runs:
            self._say(command)
            figures = board_of(run).run(**self._options(run)).statistics
            if any(camera["dropped_pixels"] for camera in figures.get("cameras", [])):
                raise SystemExit(f"{command}: captures lose pixels")
            figures["banks"] = len(set(allocation_text(board_of(run)).replace(",", "").split()) &
                                   {bank["name"] for bank in figures["banks"]})
            self._runs[command] = figures
        return self._runs[command]

    def searched(self, claim, run):
        """The best allocation of the core for each number of banks: rows of the table of banks."""
        (command,) = self.commands_of(claim, [run])
        self._say(command)
        board = board_of(run)
        document = board.allocate(banks=MOST_BANKS, source="preloaded").attrs["document"]
        if document["state"] != "complete":
            raise SystemExit(f"{command}: the search has not ended")
        rows = []
        for best in document["banks"]:
            one = board.changed(best["sets"])
            bound = one.run(source="preloaded", frames=FRAMES[False]).statistics["bound"]
            rows.append({"claim": claim.name, "banks": best["banks"], "allocations": best["allocations"],
                         "frames_per_second": best["frames_per_second"]["core"], "delivered": None,
                         "bound": bound["core"], "limited_by": bound["core_limited_by"],
                         "reached_by": best["tied"], "allocation": allocation_text(one), "command": command})
        return rows

    def chosen(self, claim, runs):
        rows = []
        for run in reversed(runs):
            figures = self.figures(run)
            rates, bound = figures["frames_per_second"], figures["bound"]
            rows.append({"claim": claim.name, "banks": figures["banks"], "allocations": None,
                         "frames_per_second": rates["steady"], "delivered": rates["system"],
                         "bound": bound["system"], "limited_by": bound["system_limited_by"],
                         "reached_by": None, "allocation": allocation_text(board_of(run)),
                         "command": self.command_of(run)})
        return rows

    def compared(self, claim, case):
        """The rows of the table of banks, and the finding."""
        name, printed, runs = case
        rows = []
        figures = [] if claim.quantity == BANKS_PROVED else [self.figures(run) for run in runs]
        rates = [rate_of(run, each) for run, each in zip(runs, figures)]
        judges = True
        if claim.quantity == BANKS_PROVED:
            rows = self.searched(claim, runs[0])
            modelled = fewest_banks(rows, max(row["frames_per_second"] for row in rows))
        elif claim.quantity == BANKS_FOUND:
            rows = self.chosen(claim, runs)
            modelled = fewest_banks(rows, rates[0])
        elif claim.quantity == ACCURACY:
            modelled = max(map(abs, change(*figures[:2])))
            judges = figures[0]["accuracy"]["bad_1_percent"] <= DOUBTFUL
        else:
            modelled = {RATE: lambda: rates[0], SPREAD: lambda: max(rates) - min(rates),
                        SPEED_UP: lambda: rates[0] / rates[1],
                        SLICES: lambda: figures[0]["area"]["slices_percent"]}[claim.quantity]()
        verdict = CONFIRMED if claim.rule.holds(printed, modelled) else NOT_CONFIRMED
        if not judges or (verdict == CONFIRMED and claim.quantity == BANKS_FOUND):
            verdict = OPEN  # some allocations are no proof
        return rows, Finding(name, printed, runs, figures, modelled, verdict, self.commands_of(claim, runs))

    def compare(self, pair_disparities):
        found = {}
        for claim in claims(pair_disparities):
            compared = [self.compared(claim, case) for case in claim.cases]
            cases = [finding for _, finding in compared]
            found[claim.name] = Found(claim, cases, verdict_of_all([case.verdict for case in cases]),
                                      [row for rows, _ in compared for row in rows])
        return found

    def cost_rows(self, found):
        """The runs of the claim about costs, each once."""
        rows = {}
        for case in found.cases:
            for number, (run, figures) in enumerate(zip(case.of, case.runs)):
                wrong, answered = change(case.runs[0], figures)
                accuracy = figures["accuracy"]
                rows.setdefault(self.command_of(run), {
                    "scene": run.scene,
                    "cost": run.sets[-1].partition("=")[2].strip("{}").replace(":", ""),
                    "wrong_percent": accuracy["bad_1_percent"],
                    "answered_percent": accuracy["answered_percent"],
                    "wrong_change_points": wrong, "answered_change_points": answered,
                    "slices_percent": figures["area"]["slices_percent"],
                    "verdict": case.verdict if number == 1 else None, "command": self.command_of(run)})
        return list(rows.values())


def rate_of(run, figures):
    return figures["frames_per_second"]["steady" if run.camera else "core"]


def change(first, second):
    """Of the shares of wrong answers and of answered pixels, in percentage points."""
    return [second["accuracy"][name] - first["accuracy"][name]
            for name in ("bad_1_percent", "answered_percent")]


def fewest_banks(rows, rate):
    return min(row["banks"] for row in rows if row["frames_per_second"] >= rate * (1 - ROUNDING))
