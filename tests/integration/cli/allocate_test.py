"""allocate: compared with all allocations, simulated one by one."""

import itertools
import re
import sqlite3

import program
from program import HEIGHT, WIDTH, ProgramTest, run

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
# As BOARD, with turnaround: a frame leaves something behind for the next.
# Of one bank, or two, the captures lose pixels.
LOSING = """
extends: fpl2003
name: losing
image: {width: 128, height: 32}
cameras: {frame_rate_hz: 200}
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
BURST = BOARD.replace("zbt_flow_through", "sync_burst, turnaround_cycles: 2")


def placements(most_banks):
    """Each allocation once: banks of one kind are taken in their order."""
    for banks in itertools.product("abcde", repeat=len(BUFFERS)):
        for alike in ("abc", "de"):
            first = [bank for bank in dict.fromkeys(banks) if bank in alike]
            if first != list(alike[: len(first)]):
                break
        else:
            if len(set(banks)) <= most_banks:
                yield banks


class Allocate(ProgramTest):
    def setUp(self):
        super().setUp()
        self.store = self.folder / "found.db"

    def board(self, text=BOARD):
        return self.file("board.yaml", text.encode())

    def allocate(self, *more, board=None, banks=5):
        return run("allocate", board or self.board(), "--banks", banks, "--out", self.store, *more)

    def all_of(self, text, source, frames, most_banks):
        """By number of banks the rates of all allocations that lose no pixel, simulated as a plan."""
        chosen = list(placements(most_banks))
        keys = ", ".join(f"allocation.{name}: [{', '.join(banks[i] for banks in chosen)}]" for i, name in enumerate(BUFFERS))
        plan = self.file("all.yaml", f"board: {self.board(text)}\nrun: {{source: {source}, frames: {frames}}}\nzip:\n  - {{{keys}}}\n".encode())
        self.succeeds(run("sweep", plan, "--out", self.folder / "all.db"))
        rate, lost = {
            "camera": ('"frames_per_second.system"', '"cameras.left.dropped_pixels" + "cameras.right.dropped_pixels"'),
            "preloaded": ('"frames_per_second.core"', "0"),
        }[source]
        columns = ", ".join(f'"allocation.{name}"' for name in BUFFERS)
        connection = sqlite3.connect(self.folder / "all.db")
        rates = {}
        for row in connection.execute(f"SELECT {rate}, {lost}, {columns} FROM points WHERE status = 'ok'"):
            if row[1] == 0:
                rates.setdefault(len({bank.strip('[]') for bank in row[2:]}), []).append(row[0])
        self.assertEqual(connection.execute("SELECT count(*) FROM points WHERE status = 'ok'").fetchone()[0], len(chosen))
        connection.close()
        return len(chosen), rates

    def rows(self, text):
        found = {}
        for line in text.splitlines():
            cells = re.match(r" *(\d+) +(\d+) +(\d+) +([\d.]+) +([\d.]+) +(?:([\d.]+) +)?(\d+)  (\w.*)$", line)
            if cells:
                found[int(cells[1])] = cells
        return found

    def compare(self, text, source, frames, *more):
        count, expected = self.all_of(text, source, frames, 5)
        said = self.succeeds(self.allocate("--source", source, *more, board=self.board(text)))
        self.assertIn(f"five: 5 buffers in at most 5 of 5 banks: {count} different allocations, {count} of them fit", said)
        rows = self.rows(said)
        self.assertEqual(sorted(rows), sorted(expected))
        for banks, rates in expected.items():
            best = max(rates)
            self.assertEqual(rows[banks][4], f"{best:.3f}")
            self.assertEqual(int(rows[banks][7]), rates.count(best), banks)
            self.assertGreaterEqual(float(rows[banks][5]), best - 0.001)
        best = {banks: max(rates) for banks, rates in expected.items()}
        top = min(banks for banks in best if best[banks] == max(best.values()))
        self.assertIn(f"The best of all is {max(best.values()):.3f} frames/s, and needs {top} banks", said)
        self.assertIn("are the same, pixel by pixel, in 1 frames.", said)
        return said, rows, best

    def test_of_the_core_is_the_best_of_all(self):
        said, rows, _ = self.compare(BOARD, "preloaded", 1)
        self.assertIn("boards of one frame are all that has to be simulated", said)
        self.assertEqual([row[2] for row in rows.values()], [row[3] for row in rows.values()])

    def test_of_the_core_with_turnaround_is_the_best_of_all(self):
        said, _, _ = self.compare(BURST, "preloaded", 1)
        self.assertIn("each allocation is a run of the first turn of its lists", said)

    @program.slow
    def test_of_the_computer_is_the_best_of_all(self):
        said, rows, best = self.compare(BOARD, "camera", 13)
        self.assertIn("frames/s: 13 frames, from time 0 to the last delivery, without losing a pixel", said)
        self.assertLess(sum(int(row[3]) for row in rows.values()), sum(int(row[2]) for row in rows.values()))
        kept = min(banks for banks in best if best[banks] >= max(best.values()) * 0.7)
        again = self.succeeds(self.allocate("--keep-fps", 70))
        self.assertIn(f"70 % of it is kept with {kept} banks ({best[kept]:.3f} frames/s", again)

    def test_the_witness_gives_what_is_said(self):
        said = self.succeeds(self.allocate("--source", "preloaded"))
        for row in self.rows(said).values():
            sets = [f"allocation.{buffer.strip().replace(' ', '=', 1)}" for buffer in row[8].split(",")]
            arguments = [part for each in sets for part in ("--set", each)]
            self.succeeds(run("run", self.board(), "--source", "preloaded", "--timing-only", *arguments, "--out", self.out))
            self.assertEqual(row[4], f"{self.stats()['frames_per_second']['core']:.3f}")

    def test_continues_its_database(self):
        self.succeeds(self.allocate("--source", "preloaded"))
        before = self.store.read_bytes()
        self.succeeds(self.allocate("--source", "preloaded"))
        self.assertEqual(self.store.read_bytes(), before)

    def test_leaves_out_what_does_not_fit_or_needs_more_banks(self):
        said = self.succeeds(self.allocate("--source", "preloaded", banks=2))
        self.assertEqual(sorted(self.rows(said)), [1, 2])
        shallow = self.file("shallow.yaml", BOARD.replace("ssram: {", f"ssram: {{default: {{words: {WIDTH * HEIGHT}, kind: zbt_pipelined}}, ").encode())
        said = self.succeeds(self.allocate("--source", "preloaded", board=shallow))
        self.assertEqual(min(self.rows(said)), 3)
        self.store.unlink()
        refused = self.allocate("--source", "preloaded", board=shallow, banks=2)
        self.assertFalse(self.store.exists())
        self.refused_in_one_line(refused, "--banks = 2: none of", "fits into so few banks; with 3 some do")

    def test_all_of_the_best_rate_is_kept_by_the_best(self):
        for pipeline in range(16, 31):
            said = self.succeeds(self.allocate("--source", "preloaded", "--keep-fps", "100", "--set", f"fpga.pipeline_latency_cycles={pipeline}", banks=1, board=self.board(KEPT)))
            self.assertRegex(said, r"100 % of it is kept with 1 banks \([\d.]+ frames/s, 100.00 %\), and not with fewer")

    @program.slow
    def test_what_loses_pixels_does_not_count(self):
        said = self.succeeds(self.allocate(board=self.board(LOSING), banks=2))
        self.assertRegex(said, r" 1 +\d+ +\d+ +all lose pixels\n")
        self.assertIn("and needs 2 banks, the fewest with an allocation that counts.", said)
        self.assertRegex(said, r"\d+ of those simulated to the end lose pixels, and do not count\.")
        self.assertIn("The disparities of these 1 allocations are the same", said)
        said = self.succeeds(self.allocate(board=self.board(LOSING), banks=1))
        self.assertIn("No allocation counts.", said)
        self.assertNotIn("are the same", said)

    @program.slow
    def test_what_could_not_be_simulated_does_not_count(self):
        for source in ("preloaded", "camera"):
            before = self.succeeds(self.allocate("--source", source))
            best = self.rows(before)[1]
            connection = sqlite3.connect(self.store)
            where = " AND ".join(f'"allocation.{name}" LIKE \'%a%\'' for name in BUFFERS)
            connection.execute(f"DELETE FROM blame WHERE hash IN (SELECT hash FROM points WHERE {where})")
            self.assertEqual(connection.execute(f"UPDATE points SET status = 'failed', reason = 'out of luck' WHERE {where}").rowcount, 1)
            connection.commit()
            connection.close()
            said = self.succeeds(self.allocate("--source", source))
            self.assertRegex(said, r" 1 +2 +2 +")
            self.assertIn("1 could not be simulated, and do not count. The first:\n  left_image a, right_image a, disparity a, left_lut a, right_lut a: out of luck\nTo try again:\n", said)
            again = re.search(r'sqlite3 (\S+) "(.*)"', said)
            connection = sqlite3.connect(again[1])
            connection.execute(again[2])
            connection.commit()
            connection.close()
            self.assertEqual(self.rows(self.succeeds(self.allocate("--source", source)))[1][0], best[0])
            self.store.unlink()

    @program.slow
    def test_too_many_allocations_are_refused(self):
        banks = ", ".join(f"x{depth}: {{words: {524288 + depth}}}" for depth in range(8))
        many = self.board("extends: fpl2003\nname: many\nssram: {banks: {" + banks + "}}\n"
                          "allocation: {left_image: [x0, x1], right_image: [x2, x3], disparity: [x4, x5], left_lut: x6, right_lut: x7}\n")
        self.refused_in_one_line(self.allocate(board=many, banks=8), "--banks = 8: more than 5000000 different allocations")
        self.assertFalse(self.store.exists())

    def test_wrong_usage(self):
        board = self.board()
        lines = self.refused(run("allocate", board, "--source", "camra", "--keep-fps", "0"))
        self.assertEqual(len(lines), 4)
        for line, text in zip(lines, ("--source = camra", "--banks: missing", "--keep-fps = 0: must be", "--out: missing")):
            self.assertIn(text, line)
        for wrong in ("0", "x", "2.5"):
            self.refused_in_one_line(self.allocate(banks=wrong), f"--banks = {wrong}: must be 1 or more")
        self.refused_in_one_line(self.allocate(banks=6), "--banks = 6: must be 1..5, the banks of the board")
        self.refused_in_one_line(self.allocate("--keep-fps", "101"), "--keep-fps = 101")
        self.store.write_bytes(b"not a database" * 100)
        self.refused_in_one_line(self.allocate(), f"--out {self.store}")


if __name__ == "__main__":
    program.main()
