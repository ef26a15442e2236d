"""allocate: compared with all allocations, simulated one by one."""

import contextlib
import itertools
import re
import sqlite3

import program
from program import HEIGHT, PRELOADED, WIDTH, ProgramTest, run, sets

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
TOO_MANY = """
extends: fpl2003
name: many
ssram: {{banks: {{{banks}}}}}
allocation: {{left_image: [x0, x1], right_image: [x2, x3], disparity: [x4, x5], left_lut: x6, right_lut: x7}}
""".format(banks=", ".join(f"x{depth}: {{words: {524288 + depth}}}" for depth in range(8)))


def placements():
    """Each allocation once: banks of one kind are taken in their order."""
    for banks in itertools.product("abcde", repeat=len(BUFFERS)):
        taken = dict.fromkeys(banks)
        if all(alike.startswith("".join(filter(alike.__contains__, taken))) for alike in ("abc", "de")):
            yield banks


class Allocate(ProgramTest):
    def setUp(self):
        super().setUp()
        self.store = self.folder / "found.db"

    def board(self, text=BOARD):
        return self.file("board.yaml", text)

    def allocate(self, *more, board=None, banks=5):
        return run("allocate", board or self.board(), "--banks", banks, "--out", self.store, *more)

    def query(self, store, *statements):
        """The rows of the last one."""
        with contextlib.closing(sqlite3.connect(store)) as connection, connection:
            return [connection.execute(sql).fetchall() for sql in statements][-1]

    def rows(self, text):
        """The lines of the table by their number of banks."""
        found = {}
        for line in text.splitlines():
            cells = re.match(r" *(\d+) +(\d+) +(\d+) +([\d.]+) +([\d.]+) +([\d.]+ +)?(\d+)  (\w.*)$", line)
            if cells:
                found[int(cells[1])] = cells
        return found

    def rates_of_all(self, text, source, frames):
        """The rates of all that lose no pixel, simulated as a plan, by number of banks; the number of all."""
        chosen = list(placements())
        lists = (", ".join(banks[place] for banks in chosen) for place in range(len(BUFFERS)))
        keys = ", ".join(f"allocation.{name}: [{banks}]" for name, banks in zip(BUFFERS, lists))
        how = f"run: {{source: {source}, frames: {frames}}}"
        plan = f"board: {self.board(text)}\n{how}\nzip:\n  - {{{keys}}}\n"
        store = self.folder / "all.db"
        self.succeeds(run("sweep", self.file("all.yaml", plan), "--out", store))
        dropped = " + ".join(f'"cameras.{side}.dropped_pixels"' for side in ("left", "right"))
        lost, rate = ("0", "core") if source == "preloaded" else (dropped, "system")
        columns = [lost, f'"frames_per_second.{rate}"', *(f'"allocation.{name}"' for name in BUFFERS)]
        found = self.query(store, f"SELECT {', '.join(columns)} FROM points WHERE status = 'ok'")
        self.assertEqual(len(found), len(chosen))
        rates = {}
        for dropped, rate, *banks in found:
            if dropped == 0:
                rates.setdefault(len({bank.strip("[]") for bank in banks}), []).append(rate)
        return rates, len(chosen)

    def compare(self, text, source, frames):
        """What allocate says of a board is what all its allocations give."""
        expected, count = self.rates_of_all(text, source, frames)
        said = self.succeeds(self.allocate("--source", source, board=self.board(text)))
        self.assertIn(f"in at most 5 of 5 banks: {count} different allocations, {count} of them fit", said)
        rows = self.rows(said)
        self.assertEqual(sorted(rows), sorted(expected))
        best = {banks: max(rates) for banks, rates in expected.items()}
        for banks, rates in expected.items():
            self.assertEqual(rows[banks][4], f"{best[banks]:.3f}")
            self.assertEqual(int(rows[banks][7]), rates.count(best[banks]), banks)
            self.assertGreaterEqual(float(rows[banks][5]), best[banks] - 0.001)
        most = max(best.values())
        top = min(banks for banks in best if best[banks] == most)
        sentence = re.search(r"The best of all is (\d+\.\d+) frames/s, and needs (\d+) banks"
                             r"(?:: the best with fewer gives (\d+\.\d+))?", said)
        self.assertEqual(int(sentence[2]), top)
        fewer = [rate for banks, rate in best.items() if banks < top]
        self.assertEqual(sentence[3] is not None, bool(fewer))
        for text, rate in ((sentence[1], most), (sentence[3], max(fewer, default=0))):
            if text is not None:
                self.assertEqual(text, f"{rate:.{len(text.split('.')[1])}f}")
                self.assertGreaterEqual(len(text.split(".")[1]), 3)
        self.assertNotEqual(sentence[1], sentence[3])
        self.assertIn("are the same, pixel by pixel, in 1 frames.", said)
        return said, rows, best

    def test_finds_the_best_of_all_for_the_core(self):
        said, rows, _ = self.compare(BOARD, "preloaded", 1)
        self.assertIn("boards of one frame are all that has to be simulated", said)
        self.assertEqual([row[2] for row in rows.values()], [row[3] for row in rows.values()])
        for row in rows.values():  # the allocation that is named gives the rate
            named = (f"allocation.{buffer.replace(' ', '=', 1)}" for buffer in row[8].split(", "))
            named = sets(*named)
            self.succeeds(run("run", self.board(), *PRELOADED, "--timing-only", *named, "--out", self.out))
            self.assertEqual(row[4], f"{self.stats()['frames_per_second']['core']:.3f}")
        before = self.store.read_bytes()  # which is continued
        self.succeeds(self.allocate(*PRELOADED))
        self.assertEqual(self.store.read_bytes(), before)

    @program.slow
    def test_rates_that_round_to_the_same_are_told_apart(self):
        shared = sets("fpga.tables=joint", "allocation.right_lut=bank6", "fpga.pixel_cache=word")
        said = self.succeeds(self.allocate(*PRELOADED, *shared, board="fpl2003", banks=3))
        self.assertIn("best of all is 18.5959 frames/s, and needs 3 banks: the best with fewer gives 18.5958.", said)

    def test_finds_the_best_of_all_for_the_core_with_turnaround(self):
        said, _, _ = self.compare(BURST, "preloaded", 1)
        self.assertIn("each allocation is a run of the first turn of its lists", said)

    @program.slow
    def test_finds_the_best_of_all_for_the_computer(self):
        said, rows, best = self.compare(BOARD, "camera", 13)
        rule = "frames/s: 13 frames, from time 0 to the last delivery, without losing a pixel"
        self.assertIn(rule, said)
        self.assertLess(sum(int(row[3]) for row in rows.values()), sum(int(row[2]) for row in rows.values()))
        kept = min(banks for banks in best if best[banks] >= max(best.values()) * 0.7)
        again = self.succeeds(self.allocate("--keep-fps", 70))
        self.assertIn(f"70 % of it is kept with {kept} banks ({best[kept]:.3f} frames/s", again)

    def test_leaves_out_what_does_not_fit_or_needs_more_banks(self):
        said = self.succeeds(self.allocate(*PRELOADED, banks=2))
        self.assertEqual(sorted(self.rows(said)), [1, 2])
        default = f"ssram: {{default: {{words: {WIDTH * HEIGHT}, kind: zbt_pipelined}}, "
        shallow = self.file("shallow.yaml", BOARD.replace("ssram: {", default))
        said = self.succeeds(self.allocate(*PRELOADED, board=shallow))
        self.assertEqual(min(self.rows(said)), 3)
        self.store.unlink()
        process = self.allocate(*PRELOADED, board=shallow, banks=2)
        self.refused_in_one_line(process, "--banks = 2: none of", "fits into so few banks; with 3 some do")
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
            r" 1 +\d+ +\d+ +all lose pixels\n",
            r"and needs 2 banks, the fewest with an allocation that counts\.",
            r"\d+ of those simulated to the end lose pixels, and do not count\.",
            "The disparities of these 1 allocations are the same",
        ):
            self.assertRegex(said, line)
        said = self.succeeds(self.allocate(board=self.board(LOSING), banks=1))
        self.assertIn("No allocation counts.", said)
        self.assertNotIn("are the same", said)

    @program.slow
    def test_what_could_not_be_simulated_does_not_count(self):
        in_a = " AND ".join(f'"allocation.{name}" LIKE \'%a%\'' for name in BUFFERS)
        for source in ("preloaded", "camera"):
            before = self.rows(self.succeeds(self.allocate("--source", source, banks=2)))[1]
            self.query(self.store,
                       f"DELETE FROM blame WHERE hash IN (SELECT hash FROM points WHERE {in_a})",
                       f"UPDATE points SET status = 'failed', reason = 'out of luck' WHERE {in_a}")
            said = self.succeeds(self.allocate("--source", source, banks=2))
            self.assertRegex(said, r" 1 +2 +2 +")
            where = ", ".join(f"{name} a" for name in BUFFERS)
            first = f"1 could not be simulated, and do not count. The first:\n  {where}: out of luck"
            self.assertIn(f"{first}\nTo try again:\n", said)
            again = re.search(r'sqlite3 (\S+) "(.*)"', said)
            self.query(again[1], again[2])
            said = self.succeeds(self.allocate("--source", source, banks=2))
            self.assertEqual(self.rows(said)[1][0], before[0])
            self.store.unlink()


    @program.slow
    def test_too_many_allocations_are_refused(self):
        process = self.allocate(board=self.board(TOO_MANY), banks=8)
        self.refused_in_one_line(process, "--banks = 8: more than 5000000 different allocations")
        self.assertFalse(self.store.exists())

    def test_wrong_values_are_refused(self):
        board = self.board()
        lines = self.refused(run("allocate", board, "--source", "camra", "--keep-fps", "0"))
        wrong = ("--source = camra", "--banks: missing", "--keep-fps = 0: must be", "--out: missing")
        for line, text in zip(lines, wrong, strict=True):
            self.assertIn(text, line)
        for banks in ("0", "x", "2.5"):
            self.refused_in_one_line(self.allocate(banks=banks), f"--banks = {banks}: must be 1 or more")
        process = self.allocate(banks=6)
        rule = "--banks = 6: must be 1..5, the banks of the board; --set 'ssram.banks.NEW={}' gives it one more"
        self.refused_in_one_line(process, rule)
        self.succeeds(self.allocate(*PRELOADED, *sets("ssram.banks.NEW={}"), banks=6))
        self.refused_in_one_line(self.allocate("--keep-fps", "101"), "--keep-fps = 101")
        self.store.write_bytes(b"not a database" * 100)
        self.refused_in_one_line(self.allocate(), f"--out {self.store}")


if __name__ == "__main__":
    program.main()
