"""paper: its numbers are those of the other commands, its verdicts follow from them; figures; refusals."""

import csv
import functools
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import time

import program
from pictures import PYTHON, noise, pgm
from program import HEIGHT as HEIGHT_OF_SMALL
from program import WIDTH as WIDTH_OF_SMALL
from program import ProgramTest, Terminal, run, shared_folder, wait_until

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "sw" / "report" / "plots" / "plot_paper.py"
TABLES = ["table1.csv", "table2.csv", "banks.csv", "costs.csv", "claims.csv"]
FIGURES = ["table1", "table2", "banks"]
FILES = ["paper.md", *TABLES, *(name + ending for name in FIGURES for ending in (".png", ".svg"))]


WIDTH, HEIGHT = 640, 480


@functools.cache
def pair_with_truth():
    """The options of a pair with ground truth.

    The right picture is noise, the left one the same 2 columns further right. The truth of the lower half is
    known: grey 3 at 1.5 grey levels a disparity. So a board needs 3 disparities.
    """
    folder = shared_folder() / "pair"
    folder.mkdir()
    rows = [noise(WIDTH + 2, 1, row) for row in range(HEIGHT)]
    known = WIDTH * HEIGHT // 2
    (folder / "left.pgm").write_bytes(pgm(WIDTH, HEIGHT, b"".join(row[:WIDTH] for row in rows)))
    (folder / "right.pgm").write_bytes(pgm(WIDTH, HEIGHT, b"".join(row[2:] for row in rows)))
    (folder / "truth.pgm").write_bytes(pgm(WIDTH, HEIGHT, bytes(known) + b"\3" * known))
    files = [word for name in ("left", "right", "truth") for word in (f"--{name}", folder / f"{name}.pgm")]
    return [*files, "--truth-scale", "1.5"]


class PaperTest(ProgramTest):
    """With one report, on a pair with truth too, for all cases: it takes some seconds."""

    files = None
    said = ""

    def setUp(self):
        super().setUp()
        if PaperTest.files is None:
            # It is written over an earlier one, and leaves other files.
            self.file("out/paper.md", "# The paper's figures beside the model's\n\nWritten by `stereotlm "
                                      "paper`. Old.")
            self.file("out/run", "script")
            PaperTest.said = self.succeeds(run("paper", "--out", self.out, *pair_with_truth()))
            PaperTest.files = self.result()
            self.assertEqual(PaperTest.files.pop("run"), b"script")
            shutil.rmtree(self.out)

    def table(self, name):
        return list(csv.DictReader(self.files[name + ".csv"].decode().splitlines()))

    def claim(self, name):
        rows = [row for row in self.table("claims") if row["claim"] == name]
        self.assertTrue(rows, name)
        return rows

    def rates(self, command):
        """stats.json of a command that the report names."""
        words = shlex.split(command)
        self.assertEqual(words[:2], ["stereotlm", "run"])
        self.succeeds(run(*words[1:], "--out", self.out))
        return self.stats()


class Numbers(PaperTest):
    def test_rates_are_those_of_the_commands(self):
        rows = self.claim("table1")
        for row in [rows[0], rows[4], self.claim("small")[0]]:
            stats = self.rates(row["command"])
            self.assertEqual(float(row["model"]), stats["frames_per_second"]["core"])
            self.assertEqual(float(row["bound"]), stats["bound"]["core"])
            self.assertEqual(row["limited_by"], stats["bound"]["core_limited_by"])
        for row in [self.claim("practice")[2], self.claim("small")[4]]:
            self.assertIn("the whole computer", row["case"])
            stats = self.rates(row["command"])
            self.assertEqual(float(row["model"]), stats["frames_per_second"]["steady"])
            self.assertEqual(float(row["bound"]), stats["bound"]["system"])

    def test_tables_agree_with_the_claims(self):
        for row, claim in zip(self.table("table1"), self.claim("table1")):
            self.assertEqual(row["model_frames_per_second"], claim["model"])
            self.assertEqual(row["verdict"], claim["verdict"])
            self.assertEqual(claim["case"], f"{row['window']}x{row['window']}")
        claims = zip(self.claim("table2_size"), self.claim("table2_rate"))
        for row, (size, rate) in zip(self.table("table2"), claims):
            self.assertEqual(row["model_slices_percent"], size["model"])
            self.assertEqual(row["model_frames_per_second"], rate["model"])
            self.assertEqual(size["case"], f"{row['disparities']} disparities")


class Verdicts(PaperTest):
    def test_table_1_without_a_filter_is_confirmed_but_for_7x7(self):
        for row in self.table("table1"):
            printed, modelled = float(row["paper_frames_per_second"]), float(row["model_frames_per_second"])
            deviation = 100 * (modelled / printed - 1)
            self.assertAlmostEqual(float(row["deviation_percent"]), deviation, 9)
            self.assertIn("matcher.filter=none", row["command"])
            if row["window"] == "7":
                self.assertAlmostEqual(deviation, -1.6, delta=0.05)
                self.assertEqual(row["verdict"], "not confirmed")
            else:
                self.assertLessEqual(abs(deviation), 0.35)
                self.assertEqual(row["verdict"], "confirmed")
        report = self.files["paper.md"].decode()
        self.assertIn("The row of 7x7 deviates by 1.6 %. Reasons to doubt the printed 18.9:", report)


class Report(PaperTest):
    def test_has_every_file_case_command_and_verdict(self):
        self.assertEqual(sorted(self.files), sorted(FILES))
        self.assertRegex(self.said, r"\S+: 12 files\n$")
        report = self.files["paper.md"].decode()
        for row in self.table("claims"):
            self.assertIn(f"| {row['case']} |", report)
            for command in row["command"].split(" && "):
                self.assertIn(f"\n$ {command}\n", report)
            place = re.escape(f"{row['place']}: {row['says']}")
            self.assertRegex(self.said, rf"(?m)^{place} +\d of \d  {row['claim_verdict']}$")
        for name in FIGURES:
            self.assertIn(f"({name}.png)", report)

    def test_its_verdicts_are_coloured_on_a_terminal_and_those_that_are_not_confirmed_come_first(self):
        plain = self.said[: self.said.index("Where the model")]
        verdicts = re.findall(r"(?m)\d of \d  (.*)$", plain)
        order = ["not confirmed", "in part", "open", "confirmed"]
        self.assertEqual(verdicts, sorted(verdicts, key=order.index))
        env = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
        command = ["paper", "--out", self.out, *pair_with_truth()]
        terminal = Terminal(command, stdout_too=True, env={**env, "TERM": "xterm"})
        self.assertEqual(terminal.finish()[0], 0)
        for verdict, code in (("not confirmed", 31), ("in part", 33), ("confirmed", 32)):
            self.assertRegex(terminal.text, rf"\d of \d\x1b\[{code}m  {verdict}\x1b\[0m\r\n")

    def drawn_with(self, **changed):
        """The drawings of tables whose columns have other values in all rows: {table: {column: value}}."""
        shutil.rmtree(self.out, ignore_errors=True)
        for name in TABLES:
            self.file(f"out/{name}", self.files[name])
        for name, columns in changed.items():
            rows = [{**row, **columns} for row in self.table(name)]
            with open(self.out / f"{name}.csv", "w", newline="") as file:
                writer = csv.DictWriter(file, list(rows[0]))
                writer.writeheader()
                writer.writerows(rows)
        command = [PYTHON, "-B", SCRIPT, self.out]
        self.succeeds(subprocess.run(command, capture_output=True, text=True, timeout=300, check=False))
        return {name: (self.out / f"{name}.svg").read_text() for name in FIGURES}

    @program.slow
    def test_has_figures_with_the_numbers_and_boards_of_the_tables(self):
        as_they_are = self.drawn_with()
        for name, text in as_they_are.items():
            self.assertEqual(text, self.files[f"{name}.svg"].decode())
        self.assertIn("640x480, 80 disparities, no filter, 40 MHz.", as_they_are["table1"])
        half_digit = self.drawn_with(table1={"paper_half_digit": 0.5})["table1"]
        tolerance = self.drawn_with(table1={"tolerance_percent": 0.5})["table1"]
        self.assertEqual(len({half_digit, tolerance, as_they_are["table1"]}), 3)
        changed = self.drawn_with(
            table1={"rule": "as it says", "image.width": 320, "matcher.filter": "log7", "fpga.clock_mhz": 41},
            table2={"size_rule": "as it says", "matcher.window": 9, "fpga.device": "xc2v1000"},
            banks={"matcher.window": 9},
        )
        self.assertIn("320x480, 80 disparities, filter log7, 41 MHz.", changed["table1"])
        self.assertIn("window 9x9, XC2V1000.", changed["table2"])
        self.assertIn("640x480, 9x9, 80 disparities, 40 MHz.", changed["banks"])
        for name in ("table1", "table2"):
            self.assertIn("the rule (as it says) shaded", changed[name])


class Meanwhile(PaperTest):
    """What happens while it runs."""

    def begin(self):
        """A process that has begun."""
        process = self.start("paper", "--out", self.out, *pair_with_truth())
        wait_until((self.out / ".partial" / "new").exists)
        return process

    @program.slow
    def test_an_interrupt_leaves_nothing_behind(self):
        process = self.begin()
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        self.ends(process, 130, errors="stereotlm: note: interrupted: nothing was written\n")
        self.assertFalse(self.out.exists())


class Refusals(ProgramTest):
    def test_wrong_arguments_and_folders_are_refused(self):
        table = self.file("out/table1.csv", "mine")
        none = self.folder / "none"
        paper = ["paper", "--out"]
        with self.unchanged(self.folder):
            self.refused(run(*paper, none, "--set", "matcher.window=7"), "--set")
            self.all_refused([
                (["paper"], "error: --out: missing: the folder to write"),
                (["paper", "fpl2003", "--out", none], "fpl2003"),
                ([*paper, self.out], f"--out {self.out}: ", f"holds '{table.name}' but no paper.md"),
                ([*paper, self.left], "not a folder"),
            ])
            place = {**os.environ, "TMPDIR": str(none)}
            rule = f"error: TMPDIR = {none}: must be a folder\n"
            self.refused_in_one_line(run(*paper, self.folder / "new", env=place), rule)
            lines = self.refused(run(*paper, self.left, env=place), "TMPDIR = ", "not a folder")
            self.assertEqual(len(lines), 2)
        self.is_in(self.folder, "out", "left.pgm", "right.pgm")

    def test_a_pair_that_cannot_be_judged_is_refused(self):
        options = {"--out": self.out, **dict(zip(pair_with_truth()[::2], pair_with_truth()[1::2]))}
        small = f"{WIDTH_OF_SMALL}x{HEIGHT_OF_SMALL} pixels: must be as large as the board's images, 640x480"
        unknown = self.file("unknown.pgm", pgm(WIDTH, HEIGHT, bytes(WIDTH * HEIGHT)))
        far = self.file("far.pgm", pgm(WIDTH, HEIGHT, b"\1" * WIDTH * HEIGHT))
        none = self.folder / "none.png"

        def arguments(**changed):
            """With other values of options, and without those that are None."""
            values = {**options, **{"--" + name.replace("_", "-"): value for name, value in changed.items()}}
            given = [(name, value) for name, value in values.items() if value is not None]
            return ["paper", *(word for option in given for word in option)]

        whole = "missing: a pair has --left F, --right F and --truth F"
        number = "must be a number above 0"
        sees = "no pixel that both cameras see has a known disparity"
        needs = "--truth-scale 0.00395: needs 255 disparities: must be 1..254"
        with self.unchanged(self.folder):
            self.all_refused([
                (arguments(left=None), f"error: --left: {whole}"),
                (arguments(right=None), f"error: --right: {whole}"),
                (arguments(truth=None, truth_scale=None), f"error: --truth: {whole}"),
                (["paper", "--out", self.out, "--truth-scale", "2"],
                 "error: --truth-scale: goes with --truth F"),
                (arguments(truth_scale="0"), f"error: --truth-scale = 0: {number}"),
                (arguments(left=self.left), f"error: --left '{self.left}': {small}"),
                (arguments(right=self.right), f"error: --right '{self.right}': {small}"),
                (arguments(truth=self.left), f"error: --truth '{self.left}': {small}"),
                (arguments(truth=none), f"error: --truth '{none}': "),
                (arguments(truth=unknown), f"error: --truth '{unknown}': {sees}"),
                (arguments(truth=far, truth_scale="0.00395"), f"error: --truth '{far}', {needs}"),
                # 254 disparities are not refused: the one line is of the folder.
                (arguments(truth=far, truth_scale="0.00396", out=self.left), f"error: --out {self.left}: "),
            ])
            lines = self.refused(run(*arguments(left=none, right=self.right, out=self.left)), "--out",
                                 "--left")
            self.assertEqual(len(lines), 3)


if __name__ == "__main__":
    program.main()
