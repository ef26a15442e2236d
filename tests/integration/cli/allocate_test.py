"""allocate: compared with all allocations, simulated one by one."""

import contextlib
import itertools
import json
import os
import pathlib
import re
import shlex
import signal
import sqlite3

import jsonschema

import program
from program import HEIGHT, PRELOADED, WIDTH, ProgramTest, run, sets, wait_until

# A line of the table.
ROW = re.compile(r" *(?P<banks>\d+) +(?P<allocations>\d+) +(?P<rate>[\d.]+( ± [\d.]+)?)"
                 r" +(?P<percent>[\d.]+) +(?P<bound>[\d.]+) +(?P<tied>\d+)  (?P<named>\w.*)$")
BUFFERS = ["left_image", "right_image", "disparity", "left_lut", "right_lut"]
# Five buffers, five banks, of which the last two are of another kind.
BOARD = f"""
extends: fpl2003
name: five
image: {{width: {WIDTH}, height: {HEIGHT}}}
cameras: {{frame_rate_hz: 1000}}
fpga: {{clock_mhz: 3.745}}
ssram: {{banks: {{a: {{}}, b: {{}}, c: {{}}, d: {{kind: zbt_flow_through}}, e: {{kind: zbt_flow_through}}}}}}
allocation: {{left_image: a, right_image: b, disparity: c, left_lut: d, right_lut: e}}
"""
# With turnaround: a frame leaves something behind for the next.
BURST = BOARD.replace("zbt_flow_through", "sync_burst, turnaround_cycles: 2")
# Its search takes some seconds.
LONG = ["fpl2003", *sets("image.width=160", "image.height=120", "fpga.clock_mhz=2.5")]
# In one bank, and in most allocations to two, the captures lose pixels.
LOSING = """
extends: fpl2003
name: losing
image: {width: 64, height: 16}
cameras: {frame_rate_hz: 800}
capture: {fifo_words: 16, fifo_trigger_words: 4}
bridge: {posted_words: 16}
fpga: {clock_mhz: 4, priority: [result, left_pixel, right_pixel, left_lut, right_lut, host]}
ssram: {banks: {A: {}, B: {}, C: {}, D: {}}}
allocation: {left_image: [A, A], right_image: [A, A], disparity: A, left_lut: none, right_lut: none}
matcher: {filter: none, window: 7, disparities: 4}
"""
# Of one bank; its only rate times 100 / 100 is another number.
KEPT = """
extends: fpl2003
name: kept
image: {width: 16, height: 4}
fpga: {pipeline_latency_cycles: 23}
ssram: {banks: {A: {}}}
allocation: {left_image: A, right_image: A, disparity: A, left_lut: A, right_lut: A}
matcher: {filter: none, window: 3, disparities: 4}
"""


def placements():
    """Each allocation once: banks of one kind are taken in their order."""
    for banks in itertools.product("abcde", repeat=len(BUFFERS)):
        taken = dict.fromkeys(banks)
        if all(alike.startswith("".join(filter(alike.__contains__, taken))) for alike in ("abc", "de")):
            yield banks


def children_of(process):
    return pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text()


def rate_text(rates):
    """Rates of stats.json as they are printed."""
    if "steady" not in rates:
        return f"{next(iter(rates.values())):.3f}"
    return f"{rates['steady']:.3f} ± {rates['steady_uncertainty']:.3f}"


class Allocate(ProgramTest):
    def setUp(self):
        super().setUp()
        self.store = self.folder / "found.db"

    def board(self, text=BOARD):
        return self.file("board.yaml", text)

    def allocate(self, *more, board=None, banks=5):
        return run("allocate", board or self.board(), "--banks", banks, *more)

    def found(self, process, status=0):
        """The JSON document of a search, which is all that it prints."""
        self.assertEqual(process.returncode, status, process.stderr)
        document = json.loads(process.stdout)
        schema = json.loads(self.succeeds(run("keys", "--schema", "allocate")))
        jsonschema.Draft202012Validator(schema).validate(document)
        return document

    def rates_of(self, *arguments):
        """The rates of a run of these arguments, as stats.json has them."""
        self.succeeds(run("run", *arguments, "--out", self.out))
        return self.stats()["frames_per_second"]

    def pasted(self, said):
        """The words after `stereotlm run` of the command that the text ends with, as a shell reads them."""
        command = re.search(r"prints (\S.*) frames/s as (?:core|long run|steady):\n  (stereotlm run .*)\n",
                            said)
        return command[1], shlex.split(command[2])[2:]

    def query(self, store, *statements):
        """The rows of the last one."""
        with contextlib.closing(sqlite3.connect(store)) as connection, connection:
            return [connection.execute(sql).fetchall() for sql in statements][-1]

    def rows(self, text):
        """The lines of the table by their number of banks."""
        found = {}
        for line in text.splitlines():
            cells = ROW.match(line)
            if cells:
                found[int(cells["banks"])] = cells
        return found

    def rates_of_all(self, text, source, frames):
        """The least possible, simulated or proven, and most possible rates of all that lose no pixel, by
        number of banks; the number of all. They are simulated as a plan."""
        chosen = list(placements())
        lists = (", ".join(banks[place] for banks in chosen) for place in range(len(BUFFERS)))
        keys = ", ".join(f"allocation.{name}: [{banks}]" for name, banks in zip(BUFFERS, lists))
        how = f"run: {{source: {source}, frames: {frames}}}"
        plan = f"board: {self.board(text)}\n{how}\nzip:\n  - {{{keys}}}\n"
        store = self.folder / "all.db"
        self.succeeds(run("sweep", self.file("all.yaml", plan), "--out", store))
        dropped = " + ".join(f'"cameras.{side}.dropped_pixels"' for side in ("left", "right"))
        names = ("steady", "steady_uncertainty", "exact_least", "exact_most")
        lost, *figures = ["0", '"frames_per_second.core"', "0", "0", "1e9"] if source == "preloaded" else [
            dropped, *(f'"frames_per_second.{name}"' for name in names)]
        columns = [lost, *figures, *(f'"allocation.{name}"' for name in BUFFERS)]
        found = self.query(store, f"SELECT {', '.join(columns)} FROM points WHERE status = 'ok'")
        self.assertEqual(len(found), len(chosen))
        rates = {}
        for dropped, rate, uncertainty, least, most, *banks in found:
            if dropped == 0:
                used = len({bank.strip("[]") for bank in banks})
                most = min(rate + uncertainty, most)
                least = min(max(rate - uncertainty, least), most)
                rates.setdefault(used, []).append((least, least if least == most else rate, most))
        return rates, len(chosen)

    def compare(self, text, source, frames, *more):
        """What allocate says of a board is what all its allocations give."""
        expected, count = self.rates_of_all(text, source, frames)
        document = self.found(self.allocate("--source", source, *more, "--json", board=self.board(text)))
        said = self.succeeds(self.allocate("--source", source, *more, board=self.board(text)))
        self.assertIn(f"in at most 5 of 5 banks: {count} different allocations, ", said)
        self.assertEqual(document["frames"], frames)
        self.assertEqual([row["banks"] for row in document["banks"]], sorted(expected))
        all_rates = [each for rates in expected.values() for each in rates]
        best, is_core = document["best"], source == "preloaded"
        value = lambda rates: next(iter(rates.values()))
        is_among = lambda rate, rates: self.assertLess(min(abs(rate - one) for one in rates), 1e-9 * rate)

        def is_best(found, rates, tied):
            """Bounds may show that a board is slower, where its rate and uncertainty do not."""
            least = max(least for least, _, _ in rates) * (1 - 1e-9)
            ties = [rate for _, rate, most in rates if most >= least]
            self.assertTrue(tied == len(ties) if is_core else 1 <= tied <= len(ties))
            is_among(value(found), ties)
            self.assertGreaterEqual(value(found) + found.get("steady_uncertainty", 0), least)

        for row in document["banks"]:
            is_best(row["frames_per_second"], expected[row["banks"]], row["tied"])
            self.assertGreaterEqual(row["bound_frames_per_second"],
                                    max(least for least, _, _ in expected[row["banks"]]) * (1 - 1e-9))
        is_best(best["highest_frames_per_second"], all_rates, best["tied"])
        least = max(least for least, _, _ in all_rates) * (1 - 1e-9)
        fewest = min(banks for banks, rates in expected.items() if any(most >= least for _, _, most in rates))
        self.assertTrue(best["banks"] == fewest if is_core else best["banks"] >= fewest)
        is_among(value(best["frames_per_second"]), [rate for _, rate, _ in expected[best["banks"]]])
        self.assertLessEqual(best["possible_frames_per_second"],
                             max(most for _, _, most in all_rates) * (1 + 1e-9))
        self.assertIn("are the same, pixel by pixel, in ", said)
        return said, document

    @program.slow
    def test_rates_that_round_to_the_same_are_told_apart(self):
        shared = sets("fpga.tables=joint", "allocation.right_lut=bank6", "fpga.pixel_cache=word")
        said = self.succeeds(self.allocate(*PRELOADED, *shared, board="fpl2003", banks=3))
        self.assertRegex(said, r"The best with these kinds of banks, clocks and priority is 18\.5959 .*\n"
                               r"It needs 3 banks \(18\.5959 frames/s\): "
                               r"the best with fewer gives 18\.5958\.")

    def test_finds_the_best_of_all_for_the_core_with_turnaround(self):
        self.compare(BURST, "preloaded", 3, "--frames", 3)

    @program.slow
    def test_finds_the_best_of_all_for_the_computer(self):
        said, document = self.compare(BOARD, "camera", 13, "--frames", 13)
        rule = ("frames/s: in the long run, where it is proven; else steady, over 12 frames, ± what these "
                "leave open\n(a tenth of it with --frames 121); an allocation that loses a pixel does not "
                "count\n")
        self.assertIn(rule, said)
        self.assertLess(document["simulated"], document["allocations"])
        self.assertGreater(document["best"]["tied"], 1)
        value = lambda rates: next(iter(rates.values()))
        highest = value(document["best"]["highest_frames_per_second"])
        kept = min((row for row in document["banks"] if value(row["frames_per_second"]) >= highest * 0.7),
                   key=lambda row: row["banks"])
        again = self.succeeds(self.allocate("--frames", 13, "--keep-fps", 70))
        self.assertIn(f"70 % of it is kept with {kept['banks']} banks "
                      f"({rate_text(kept['frames_per_second'])} frames/s",
                      again)

    def test_the_command_and_the_file_give_the_rate_of_the_best(self):
        name = self.folder / "it's the best.yaml"
        for source in ("preloaded", "camera"):
            options = ["--source", source, *sets("fpga.lane_fifo_slots=8", "ssram.banks.f={}")]
            text = self.succeeds(self.allocate(*options, "--write", name, banks=3))
            self.assertTrue(text.endswith(f"\n{name}: the board with the best allocation\n"))
            printed, words = self.pasted(text)
            document = self.found(self.allocate(*options, "--json", "--write", name, banks=3))
            best = document["best"]["frames_per_second"]
            self.assertEqual(printed, rate_text(best))
            shown = self.succeeds(run("run", *words))
            self.assertRegex(shown, rf"(?m)^(core|steady|long run) +{printed} "
                                    rf"frames/s ")
            self.assertEqual(document["best"]["command"][2:], words)
            self.assertEqual(document["written"], str(name))
            for run_words in (words,
                              [name, "--source", source, "--timing-only", "--frames", document["frames"]]):
                rates = self.rates_of(*run_words)
                self.assertEqual({key: rates[key] for key in best}, best)
            name.unlink()

    @program.slow
    def test_the_command_has_the_calibration_and_quotes_what_a_shell_would_read(self):
        rig, _ = program.made_rig()
        board = self.file("a board's.yaml", "extends: fpl2003\nname: rig\n")
        options = [*PRELOADED, "--calibration", rig]
        document = self.found(self.allocate(*options, "--json", board=board))
        _, words = self.pasted(self.succeeds(self.allocate(*options, board=board)))
        self.assertEqual(words[:3], [str(board), "--calibration", str(rig)])
        self.assertEqual(self.rates_of(*words)["core"], document["best"]["frames_per_second"]["core"])

    def test_an_interrupt_gives_the_best_so_far_and_what_is_possible(self):
        written = self.folder / "best.yaml"
        command = ["allocate", *LONG, "--banks", 3, "--out", self.store, "--write", written]

        def known():
            with contextlib.suppress(sqlite3.OperationalError):
                return self.query(self.store, "SELECT value FROM results") if self.store.exists() else []
            return []

        process = self.start(*command)
        wait_until(lambda: len(known()) >= 10)
        process.send_signal(signal.SIGINT)
        out, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertTrue(errors.endswith("stereotlm: note: interrupted: run the same command to resume\n"))
        rates = [tuple(map(float, value.split()[3:5])) for value, in known() if value.split()[-1] == "0"]
        found = self.rates_of(written, "--timing-only", "--frames", 122)
        best = {name: found[name] for name in ("steady", "steady_uncertainty")}
        self.assertIn(tuple(best.values()), rates)
        self.assertGreaterEqual(sum(best.values()), max(rate - uncertainty for rate, uncertainty in rates))
        self.assertIn(f"Interrupted. The best so far is {rate_text(best)} frames/s, with ", out)
        self.assertRegex(out, r"\nAt most \d+\.\d\d % better can exist: ")
        self.assertNotIn("are the same, pixel by pixel", out)
        self.assertEqual(self.rates_of(*self.pasted(out)[1]), found)

    def test_without_out_it_prints_the_same_and_keeps_nothing(self):
        command = ["allocate", self.board(BURST), "--banks", 2]
        temporary = self.folder / "temporary"
        temporary.mkdir()
        here = {"cwd": temporary, "env": {**os.environ, "TMPDIR": str(temporary)}}
        for options in (PRELOADED, [*PRELOADED, "--json"]):
            with self.unchanged(self.folder):
                said = self.succeeds(run(*command, *options, **here))
            self.assertEqual(said, self.succeeds(run(*command, *options, "--out", self.store)))
            self.store.unlink()
        for number in (signal.SIGINT, signal.SIGTERM):
            process = self.start("allocate", *LONG, "--banks", 3, **here)
            wait_until(lambda: children_of(process))
            process.send_signal(number)
            out, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130)
            self.assertIn("note: interrupted: nothing is kept: give --out DB to resume later\n", errors)
            self.assertIn("Interrupted", out)
            self.is_in(temporary)

    def test_an_interrupted_search_is_resumed_to_the_same_result(self):
        command = ["allocate", *LONG, "--banks", 2, "--json"]
        whole = json.loads(self.succeeds(run(*command)))
        process = self.start(*command, "--out", self.store)
        wait_until(lambda: len(children_of(process).split()) >= 2)  # the second one simulates
        process.send_signal(signal.SIGINT)
        self.assertEqual(json.loads(process.communicate(timeout=60)[0])["state"], "interrupted")
        for _ in range(2):  # the second time the answer is read
            found = json.loads(self.succeeds(run(*command, "--out", self.store)))
            del found["simulated"]
            self.assertEqual(found, {key: value for key, value in whole.items() if key != "simulated"})

    def test_another_file_is_not_replaced_by_the_best(self):
        board = self.board()
        rule = ("exists, and is not known as a file of this board with another allocation, which alone is "
                "replaced")
        process = self.allocate(*PRELOADED, "--out", self.store, "--write", board, board=board)
        self.refused_in_one_line(process, f"--write '{board}': is the file of BOARD: must be another")
        self.assertFalse(self.store.exists())
        database = self.folder / "found.yaml"
        process = run("allocate", board, "--banks", 2, "--out", database, "--write",
                      f"{self.folder}/./found.yaml")
        self.refused_in_one_line(process, "is the file of --out: must be another")
        self.assertFalse(database.exists())
        best = self.folder / "best.yaml"
        self.succeeds(self.allocate(*PRELOADED, "--write", best))
        first = best.read_text()
        self.succeeds(self.allocate(*PRELOADED, "--write", best, banks=2))
        self.assertNotEqual(best.read_text(), first)
        for change in (lambda text: text + "# mine\n", lambda text: text.replace("window: 7", "window: 5")):
            self.file("best.yaml", change(first))
            with self.unchanged(best):
                self.refused_in_one_line(self.allocate(*PRELOADED, "--write", best), rule)

    def test_leaves_out_what_does_not_fit_or_needs_more_banks(self):
        said = self.succeeds(self.allocate(*PRELOADED, banks=2))
        self.assertEqual(sorted(self.rows(said)), [1, 2])
        default = f"ssram: {{default: {{words: {WIDTH * HEIGHT}, kind: zbt_pipelined}}, "
        shallow = self.file("shallow.yaml", BOARD.replace("ssram: {", default))
        said = self.succeeds(self.allocate(*PRELOADED, board=shallow))
        self.assertEqual(min(self.rows(said)), 3)
        process = self.allocate(*PRELOADED, "--out", self.store, board=shallow, banks=2)
        self.refused_in_one_line(process, "--banks = 2: no allocation fits into so few banks; with 3 some do")
        self.assertFalse(self.store.exists())

    def test_all_of_the_best_rate_is_kept_by_the_best(self):
        kept = r"100 % of it is kept with 1 banks \([\d.]+ frames/s, 100.00 %\), and not with fewer"
        board = self.board(KEPT)
        for pipeline in range(16, 31):
            options = ["--keep-fps", "100", *sets(f"fpga.pipeline_latency_cycles={pipeline}")]
            said = self.succeeds(self.allocate(*PRELOADED, *options, banks=1, board=board))
            self.assertRegex(said, kept)

    @program.slow
    def test_what_loses_pixels_does_not_count(self):
        said = self.succeeds(self.allocate(board=self.board(LOSING), banks=2))
        for line in (
            r" 1 +\d+ +all lose pixels\n",
            r"It needs 2 banks \(.*\), the fewest with an allocation that counts\.",
        ):
            self.assertRegex(said, line)
        self.assertNotIn("The disparities of these", said)  # only one allocation
        written = self.folder / "best.yaml"
        said = self.succeeds(self.allocate("--write", written, board=self.board(LOSING), banks=1))
        self.assertIn("No allocation counts.", said)
        self.assertNotIn("are the same", said)
        self.assertNotIn("stereotlm run", said)
        self.assertFalse(written.exists())
        document = self.found(self.allocate("--json", board=self.board(LOSING), banks=1))
        self.assertEqual(document.keys() & {"best", "keeping", "equal_disparities", "written"}, set())

    def test_stripes_are_refused(self):
        self.refused(run("allocate", "eight-banks-four-lanes", "--banks", "8", "--out", self.folder / "a.db"),
                     *(f"eight-banks-four-lanes: allocation.{buffer} = {{rows: ..}}: must be one bank here: "
                       "allocate places no stripes"
                       for buffer in ("left_image", "right_image", "disparity", "left_lut")))

    def test_wrong_values_are_refused(self):
        board = self.board()
        lines = self.refused(run("allocate", board, "--source", "camra", "--keep-fps", "0"))
        wrong = ("--banks: missing", "--source = camra", "--keep-fps = 0: must be")
        for line, text in zip(lines, wrong, strict=True):
            self.assertIn(text, line)
        for frames, rule in (("0", "1..1000000"), ("x", "1..1000000")):
            self.refused_in_one_line(self.allocate("--frames", frames),
                                     f"--frames = {frames}: must be {rule}")
        rule = "must be a multiple of 2, one turn of the lists of buffers"
        self.refused_in_one_line(self.allocate("--frames", 3, *PRELOADED, board="fpl2003"),
                                 f"--frames = 3: {rule}")
        rule += ", and at least two turns"
        self.refused_in_one_line(self.allocate("--frames", 2, board="fpl2003"), f"--frames = 2: {rule}")
        for banks in ("0", "x", "2.5"):
            self.refused_in_one_line(self.allocate(banks=banks), f"--banks = {banks}: must be 1 or more")
        process = self.allocate(banks=6)
        rule = ("--banks = 6: must be 1..5, the banks of the board; --set 'ssram.banks.NEW={}' gives it one "
                "more")
        self.refused_in_one_line(process, rule)
        self.succeeds(self.allocate(*PRELOADED, *sets("ssram.banks.NEW={}"), banks=6))
        self.refused_in_one_line(self.allocate("--keep-fps", "101"), "--keep-fps = 101")
        self.store.write_bytes(b"not a database" * 100)
        self.refused_in_one_line(self.allocate("--out", self.store), f"--out {self.store}")


if __name__ == "__main__":
    program.main()
