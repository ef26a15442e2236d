"""paper: its numbers are those of the other commands, its verdicts follow from them; figures, and what is refused."""

import csv
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import time

import program
from program import ProgramTest, run

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "sw" / "report" / "plots" / "plot_paper.py"
TABLES = ["table1.csv", "table2.csv", "banks.csv", "claims.csv"]
FIGURES = ["table1", "table2", "banks"]
FILES = sorted(["paper.md", *TABLES] + [name + ending for name in FIGURES for ending in (".png", ".svg")])


class Paper(ProgramTest):
    """One run for all of them: it takes some seconds."""

    files = None
    said = ""

    def setUp(self):
        super().setUp()
        if Paper.files is None:
            Paper.said = self.succeeds(run("paper", "--out", self.out))
            Paper.files = self.result()

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
        folder = self.folder / "one"
        self.succeeds(run(*words[1:], "--out", folder))
        return json.loads((folder / "stats.json").read_text())

    def test_writes_a_report_its_tables_and_its_figures(self):
        self.assertEqual(sorted(self.files), FILES)
        self.assertRegex(self.said, r"\S+: 11 files\n$")

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
        for row, size, rate in zip(self.table("table2"), self.claim("table2_size"), self.claim("table2_rate")):
            self.assertEqual(row["model_slices_percent"], size["model"])
            self.assertEqual(row["model_frames_per_second"], rate["model"])
            self.assertEqual(size["case"], f"{row['disparities']} disparities")

    def test_areas_are_those_of_bounds(self):
        for row in self.table("table2"):
            said = self.succeeds(run(*shlex.split(row["size_command"])[1:]))
            self.assertIn(f"({float(row['model_slices_percent']):.2f} %)", said)

    @program.slow
    def test_banks_are_those_of_allocate(self):
        for claim in ("banks", "banks_of_matching"):
            rows = [row for row in self.table("banks") if row["claim"] == claim]
            words = shlex.split(rows[0]["command"])
            self.assertEqual(words[:2] + words[-2:], ["stereotlm", "allocate", "--out", "banks.db"])
            said = self.succeeds(run(*words[1:-1], self.folder / f"{claim}.db"))
            for row in rows:
                line = rf"\n +{row['banks']} +{row['allocations']} +\d+ +{float(row['frames_per_second']):.3f} " \
                       rf"+{float(row['bound_frames_per_second']):.3f} +{row['reached_by']}  {row['allocation']}\n"
                self.assertRegex(said, line)

    @program.slow
    def test_a_run_of_the_computer_uses_the_banks_that_it_is_said_to(self):
        rows = [row for row in self.table("banks") if row["claim"] == "banks_of_computer"]
        self.assertEqual([row["banks"] for row in rows], ["5", "6", "7", "8"])
        for row in rows[1:3]:
            stats = self.rates(row["command"])
            self.assertEqual(float(row["frames_per_second"]), stats["frames_per_second"]["steady"])
            self.assertEqual(float(row["delivered_frames_per_second"]), stats["frames_per_second"]["system"])
            self.assertEqual(sum(bank["reads"] + bank["writes"] > 0 for bank in stats["banks"]), int(row["banks"]))

    def test_verdicts_follow_from_the_values(self):
        by_claim = {}
        for row in self.table("claims"):
            printed, modelled, rule = float(row["paper"]), float(row["model"]), row["rule"]
            tolerance = float(row["tolerance"])
            within = re.match(r"within ([\d.]+) (.*)$", rule)
            at_least = re.match(r"at least the printed value(?: less ([\d.]+) .*)?$", rule)
            if within:
                self.assertEqual(float(within[1]), tolerance)
                holds = abs(printed - modelled) <= tolerance * (printed / 100 if within[2] == "%" else 1)
            elif rule == "more than the printed value":
                self.assertEqual(tolerance, 0)
                holds = modelled > printed
            else:
                self.assertTrue(at_least, rule)
                self.assertEqual(float(at_least[1] or 0), tolerance)
                holds = modelled >= printed - tolerance
            self.assertEqual(row["verdict"], "confirmed" if holds else "not confirmed", row)
            by_claim.setdefault(row["claim"], []).append((holds, row["claim_verdict"]))
        for name, cases in by_claim.items():
            held = [holds for holds, _ in cases]
            expected = "confirmed" if all(held) else "in part" if any(held) else "not confirmed"
            self.assertEqual({verdict for _, verdict in cases}, {expected}, name)

    def texts_drawn(self, name, **changed):
        """What the figure of a table says whose first rows have other values in these columns."""
        folder = self.folder / "tables"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for table in TABLES:
            (folder / table).write_bytes(self.files[table])
        rows = [{**row, **changed} for row in self.table(name)]
        with open(folder / f"{name}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)
        script = ["/usr/bin/python3", "-B", str(SCRIPT), str(folder), "--out", str(folder)]
        self.succeeds(subprocess.run(script, capture_output=True, text=True, timeout=300, check=False))
        return (folder / f"{name}.svg").read_text()

    @program.slow
    def test_figures_take_numbers_and_boards_from_the_tables(self):
        self.assertEqual(self.texts_drawn("table1"), self.files["table1.svg"].decode())
        self.assertIn("640x480, 80 disparities, no filter, 40 MHz.", self.texts_drawn("table1"))
        self.assertIn("the rule (as it says) shaded", self.texts_drawn("table1", rule="as it says"))
        self.assertIn("the rule (as it says) shaded", self.texts_drawn("table2", size_rule="as it says"))
        self.assertNotEqual(self.texts_drawn("table1", paper_half_digit=0.5), self.texts_drawn("table1"))
        self.assertNotEqual(self.texts_drawn("table1", tolerance_percent=0.5), self.texts_drawn("table1"))
        self.assertIn("320x480, 80 disparities, filter log7, 41 MHz.", self.texts_drawn("table1", **{
            "image.width": 320, "matcher.filter": "log7", "fpga.clock_mhz": 41}))
        self.assertIn("window 9x9, XC2V1000.", self.texts_drawn("table2", **{
            "matcher.window": 9, "fpga.device": "xc2v1000"}))
        self.assertIn("640x480, 9x9, 80 disparities, 40 MHz.", self.texts_drawn("banks", **{"matcher.window": 9}))

    def test_table_1_without_a_filter_is_met_but_for_7x7(self):
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

    def test_table_2_is_met_within_a_point(self):
        rows = self.table("table2")
        self.assertEqual([row["disparities"] for row in rows], ["80", "160", "200"])
        for row in rows:
            error = float(row["model_slices_percent"]) - float(row["paper_slices_percent"])
            self.assertLessEqual(abs(error), 1)
            self.assertAlmostEqual(float(row["error_points"]), error, 9)
            self.assertEqual(row["size_verdict"], "confirmed")

    def test_eight_banks_are_settled_by_witness_and_certificate(self):
        rows = [row for row in self.table("banks") if row["claim"] == "banks"]
        best = max(float(row["frames_per_second"]) for row in rows)
        fewest = min(int(row["banks"]) for row in rows if float(row["frames_per_second"]) == best)
        self.assertEqual([fewest], [int(row["model"]) for row in self.claim("banks")])
        report = self.files["paper.md"].decode()
        witness = next(row for row in rows if int(row["banks"]) == fewest)
        self.assertIn(f"- Witness: {fewest} banks give the best rate of all, {best:.3f} frames/s: {witness['allocation']}.", report)
        fewer = [row for row in rows if int(row["banks"]) < fewest]
        self.assertIn(f"none of the {sum(int(row['allocations']) for row in fewer)} allocations to fewer banks that fit gives "
                      f"more than {max(float(row['frames_per_second']) for row in fewer):.3f}.", report)

    def test_the_summary_has_the_verdicts_of_the_table(self):
        for row in self.table("claims"):
            self.assertRegex(self.said, rf"(?m)^{re.escape(row['place'] + ': ' + row['says'])} +\d of \d  {row['claim_verdict']}$")

    def test_the_report_names_every_case(self):
        report = self.files["paper.md"].decode()
        for row in self.table("claims"):
            self.assertIn(f"| {row['case']} |", report)
            for command in row["command"].split(" && "):
                self.assertIn(f"\n$ {command}\n", report)
        for name in FIGURES:
            self.assertIn(f"({name}.png)", report)

    def test_figures_are_not_blank(self):
        for name in FIGURES:
            path = self.file(name + ".png", self.files[name + ".png"])
            width, height, _, colors = program.drawn(path)
            self.assertGreater(width, 1000)
            self.assertGreater(colors, 20)
            self.assertGreater(height, 500)
            self.assertIn("</svg>", self.files[name + ".svg"].decode())

    @program.slow
    def test_is_written_again_over_itself_and_leaves_other_files(self):
        self.out.mkdir()
        (self.out / "run").write_text("script")
        (self.out / "paper.md").write_text("old")
        self.succeeds(run("paper", "--out", self.out))
        written = self.result()
        self.assertEqual(written.pop("run"), b"script")
        self.assertEqual(written, self.files)


class Meanwhile(ProgramTest):
    """What happens while it runs."""

    def begin(self):
        """A process that has begun."""
        process = subprocess.Popen([program.PROGRAM, "paper", "--out", self.out], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stderr.close)
        while process.poll() is None and not (self.out / ".partial" / "new").exists():
            time.sleep(0.01)
        return process

    def end(self, process):
        self.addCleanup(process.wait)
        return process.wait(timeout=300), process.stderr.read()

    def test_an_interrupt_leaves_nothing_behind(self):
        process = self.begin()
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.end(process), (130, "stereotlm: note: interrupted: nothing was written\n"))
        self.assertFalse(self.out.exists())

    @program.slow
    def test_a_second_one_into_the_folder_is_refused(self):
        process = self.begin()
        self.refused_in_one_line(run("paper", "--out", self.out), f"'{self.out}': in use by another run")
        self.assertEqual(self.end(process), (0, ""))
        self.assertEqual(sorted(self.result()), FILES)

    @program.slow
    def test_what_comes_into_its_way_leaves_the_earlier_files(self):
        self.out.mkdir()
        for name in ("paper.md", "table1.csv"):
            (self.out / name).write_text("old")
        process = self.begin()
        (self.out / "banks.csv").mkdir()
        status, errors = self.end(process)
        self.assertEqual((status, errors), (1, f"stereotlm: error: folder '{self.out}': holds 'banks.csv', which is no file\n"))
        self.assertEqual(self.result(), {"paper.md": b"old", "table1.csv": b"old"})

    @program.slow
    def test_a_kill_is_cleaned_up_after(self):
        process = self.begin()
        process.kill()
        self.end(process)
        self.assertTrue((self.out / ".partial").exists())
        self.succeeds(run("paper", "--out", self.out))
        self.assertEqual(sorted(self.result()), FILES)


class Refusals(ProgramTest):
    def test_a_folder_is_needed(self):
        self.refused_in_one_line(run("paper"), "error: --out: missing: the folder to write")

    def test_no_board_and_no_other_option(self):
        self.refused_in_one_line(run("paper", "fpl2003", "--out", self.out), "fpl2003")
        self.refused(run("paper", "--out", self.out, "--set", "matcher.window=7"), "--set")
        self.assertFalse(self.out.exists())

    def test_files_of_somebody_else(self):
        self.out.mkdir()
        (self.out / "table1.csv").write_text("mine")
        self.refused_in_one_line(run("paper", "--out", self.out), f"--out {self.out}: ", "holds 'table1.csv' but no paper.md")
        self.assertEqual((self.out / "table1.csv").read_text(), "mine")

    def test_no_place_for_temporary_files(self):
        none = self.folder / "none"
        place = {**os.environ, "TMPDIR": str(none)}
        self.refused_in_one_line(run("paper", "--out", self.out, env=place), f"error: TMPDIR = {none}: must be a folder\n")
        self.assertFalse(self.out.exists())
        self.assertEqual(len(self.refused(run("paper", "--out", self.left, env=place), "TMPDIR = ", "not a folder")), 2)

    def test_what_is_no_folder(self):
        self.refused_in_one_line(run("paper", "--out", self.left), "not a folder")


if __name__ == "__main__":
    program.main()
