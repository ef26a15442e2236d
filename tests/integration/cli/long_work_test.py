"""Work that takes longer than 5 s: it says so beforehand, shows its progress, and is interrupted."""

import json
import re
import resource
import signal

import program
from program import ProgramTest, Terminal, run, sets
from report_data import data_of

SLOW = ["sdram", *sets("image.width=240", "image.height=180")]  # stepped cycle by cycle
UNEQUAL = sets(*(f"ssram.banks.bank{number}={{words: {2**20 - number}}}" for number in range(8)))


@program.slow
class LongWork(ProgramTest):
    def interrupted(self, *arguments):
        """Once it is announced, and some changes are simulated: standard output, and what is kept."""
        terminal = Terminal(arguments, columns=200)
        status, out = terminal.interrupt(r"(?s)boards are simulated.*\r([3-9]|\d\d)/\d+ boards simulated, ",
                                         signal.SIGINT)
        self.assertEqual(status, 130)
        self.assertRegex(terminal.text, r"\d+ boards are simulated, for at most 42 frames each, cycle by ")
        return out, re.search(r"note: interrupted: (\d+ of \d+ changes were evaluated)", terminal.text)[1]

    def test_explain_and_report_keep_what_is_simulated(self):
        out, kept = self.interrupted("explain", *SLOW)
        self.assertIn(f"\ninterrupted: {kept}\none change at a time: {kept.split()[0]} boards", out)
        out, kept = self.interrupted("explain", *SLOW, "--json")
        self.assertEqual(json.loads(out)["interrupted"], kept)
        self.succeeds(run("run", *SLOW, "--timing-only", "--out", self.out))
        page = self.folder / "page.html"
        _, kept = self.interrupted("report", self.out, "--out", page)
        self.assertEqual(data_of(page)["run"]["knobs"]["interrupted"], kept)

    def end_of_announced(self, text, *arguments):
        process = self.start(*arguments)
        self.assertRegex(process.stderr.readline(), text)
        process.send_signal(signal.SIGINT)
        return f"{process.wait(60)} {process.communicate()[0]}"

    def test_a_sweep_that_leaves_out_most_points(self):
        plan = self.file("plan.yaml", "board: fpl2003\nwhere: [matcher.window < 5]\nvary:\n"
                         "  fpga.clock_mhz: {from: 1, to: 99, step: 0.0001}\n")
        said = r"note: 980001 points are simulated, or left out: \d+/980001 points, [\d:]+ left\n"
        end = self.end_of_announced(said, "sweep", plan, "--out", self.folder / "x.db")
        self.assertRegex(end, r"^130 .* 0 failed, \d+ left out by where, \d+ not begun\n")

    def test_allocate_with_unequal_banks(self):
        command = ["allocate", "fpl2003", *UNEQUAL, "--banks"]
        said = r"note: boards are ruled out by bounds, or simulated: \S+ boards: \d+ open, .*\n"
        self.assertRegex(self.end_of_announced(said, *command, 4), "^130 ")
        limit = lambda: resource.setrlimit(resource.RLIMIT_AS, 2 * (400_000_000,))
        self.refused_in_one_line(run(*command, 8, preexec_fn=limit), "more than 5000000 different")


if __name__ == "__main__":
    program.main()
