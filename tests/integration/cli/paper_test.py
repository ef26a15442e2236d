"""The study results/paper: its numbers and its verdicts are the recorded ones."""

import csv
import os
import shlex
import subprocess

import program
from pictures import PYTHON
from program import PROGRAM, ProgramTest, run
from tracked_files import tracked

STUDY = tracked("results/paper/claims.py")[0].parent
PAIR = "the given pair"  # which needs pictures of another package


def rows(text):
    return list(csv.DictReader(text.splitlines()))


class Study(ProgramTest):
    def test_has_the_recorded_claims_and_figures(self):
        command = [PYTHON, "-B", STUDY / "report.py", "--out", self.out]
        env = {**os.environ, "STEREOTLM_PROGRAM": PROGRAM}
        said = self.succeeds(subprocess.run(command, capture_output=True, text=True, timeout=300, check=False,
                                            env=env))
        self.assertIn("14 claims of the paper: 6 not confirmed, 6 in part, 2 confirmed.\n", said)
        names = [name + ending for name in ("table1", "table2", "banks")
                 for ending in (".csv", ".png", ".svg")]
        self.is_in(self.out, "paper.md", "claims.csv", "costs.csv", *names)
        found = {path.name: path.read_bytes() for path in self.out.iterdir()}
        for name in ("table1.csv", "table2.csv", "banks.csv"):
            self.assertEqual(found[name], (STUDY / name).read_bytes())
        recorded, report = rows((STUDY / "claims.csv").read_text()), found["paper.md"].decode()
        for row, expected in zip(rows(found["claims.csv"].decode()), recorded):
            if row["claim"] == "costs":
                row["claim_verdict"] = expected["claim_verdict"]  # the pair decides it
            self.assertEqual(row, expected)
            for command in row["command"].split(" && "):
                self.assertIn(f"\n$ {command}\n", report)
        self.assertTrue(all(row["case"].endswith(PAIR) for row in recorded[-2:]))

    def test_a_rate_is_that_of_its_command(self):
        recorded = {(row["claim"], row["case"]): row for row in rows((STUDY / "claims.csv").read_text())}
        for case, rate, bound in (("7x7, the core alone", "core", "core"),
                                  ("7x7, the whole computer", "steady", "system")):
            row = recorded["practice", case]
            self.succeeds(run(*shlex.split(row["command"])[1:], "--out", self.folder / rate))
            stats = self.stats(self.folder / rate)
            self.assertEqual(float(row["model"]), stats["frames_per_second"][rate])
            self.assertEqual(float(row["bound"]), stats["bound"][bound])


class Command(ProgramTest):
    def test_is_refused_and_names_the_study(self):
        self.refused_in_one_line(run("paper", "--out", self.out), "is a study now: results/paper/run")


if __name__ == "__main__":
    program.main()
