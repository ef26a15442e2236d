"""The module stereotlm of Python, and the worker behind it."""

import concurrent.futures
import contextlib
import copy
import decimal
import json
import os
import pathlib
import pickle
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
import unittest.mock
import warnings

import numpy
import pandas

import program
from pictures import pgm
from program import HEIGHT, PRELOADED, PROGRAM, SMALL, WIDTH, ProgramTest, run, sets

SOURCES = pathlib.Path(__file__).resolve().parents[3]
os.environ["STEREOTLM_PROGRAM"] = PROGRAM
sys.path.insert(0, str(SOURCES / "sw" / "python"))
import stereotlm  # noqa: E402
from stereotlm import worker  # noqa: E402

SMALL_SETS = {"image.width": WIDTH, "image.height": HEIGHT}
ALONE = {"source": "preloaded"}


def small_board(**sections):
    """A board with small images. A key is section__key."""
    return stereotlm.Board(sets={**SMALL_SETS, **{name.replace("__", "."): value
                                                  for name, value in sections.items()}})


def read_pfm(path):
    """Disparities of a result folder."""
    head, size, _, data = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    assert head == b"Pf"
    found = numpy.frombuffer(data, "<f4").reshape(height, width)[::-1]
    return numpy.where(numpy.isinf(found), 255, found)


class PythonTest(ProgramTest):
    def setUp(self):
        super().setUp()
        pixels = (path.read_bytes()[-WIDTH * HEIGHT:] for path in (self.left, self.right))
        self.arrays = [numpy.frombuffer(side, numpy.uint8).reshape(HEIGHT, WIDTH) for side in pixels]

    def refusal(self, action):
        with self.assertRaises(stereotlm.Refused) as refused:
            action()
        return refused.exception


class Boards(PythonTest):
    def test_keys_are_attributes_and_items(self):
        board = stereotlm.Board("fpl2003")
        self.assertEqual((board.matcher.window, board["matcher.window"]), (7, 7))
        self.assertEqual(board.allocation.left_image, ["bank0", "bank1"])
        self.assertEqual(board.ssram.banks.bank3.kind, "zbt_pipelined")
        board.matcher.window = numpy.int64(9)
        board.fpga.clock_mhz = 0.000125 * 8000
        board.allocation.left_image = ["bank1", "bank0"]
        board.matcher.cost = {"census": 5}
        self.assertEqual(board.values["matcher.window"], 9)
        self.assertEqual((board.fpga.clock_mhz, board.matcher.cost), (1, {"census": 5}))
        self.assertEqual(board.allocation.left_image, ["bank1", "bank0"])
        self.assertIn("window", dir(board.matcher))
        self.assertIn("matcher", dir(board))
        self.assertIn("matcher.window: 9", repr(board.matcher))
        board.name = "é: x 😀"
        self.assertEqual(board.values["name"], "é: x 😀")
        for long in ("x" * 60, {"kernel": [[1] * 7] * 7, "shift": 3}, ["none"] * 20):
            with self.assertRaises(stereotlm.Refused):
                board.matcher.filter = long
        with self.assertRaisesRegex(AttributeError, "matcher.windw: not a key"):
            board.matcher.windw  # noqa: B018

    def test_a_value_is_refused_with_place_value_and_rule(self):
        board = stereotlm.Board("fpl2003")
        for key, value, text in (("matcher.window", 6, "matcher.window = 6: 3..31, odd"),
                                 ("matcher.windw", 5, "unknown key; nearest known key: matcher.window"),
                                 ("matcher.window", "seven", 'matcher.window = "seven": not an integer')):
            before = board.values
            error = self.refusal(lambda: board.__setitem__(key, value))  # noqa: B023
            self.assertIn(text, str(error))
            self.assertEqual(error.problems[0].place, f"--set {key}")
            self.assertEqual((board.values, board.sets), (before, []))
        self.assertEqual((error.problems[0].value, error.problems[0].rule[-10:]), ('"seven"', "3..31, odd"))
        self.assertIn("nope: not a preset", str(self.refusal(lambda: stereotlm.Board("nope"))))

    def test_keys_that_contradict_each_other_are_refused_by_commands(self):
        board = stereotlm.Board("fpl2003")
        board.allocation.left_lut = "bank5"
        board.ssram.banks = {f"bank{i}": {} for i in range(5)}  # without bank5 .. bank7
        problems = self.refusal(lambda: board.run(**ALONE)).problems
        self.assertIn("allocation.left_lut", [problem.key for problem in problems])
        self.assertEqual(board.allocation.left_lut, "bank5")
        board.allocation.left_lut = board.allocation.right_lut = "bank4"
        board.allocation.disparity = ["bank3", "bank3"]
        board.fpga.tables = "joint"
        board.check()
        self.assertGreater(board.run(**ALONE).frames_per_second["core"], 5)

    def test_a_value_takes_the_place_of_those_below_it(self):
        board = stereotlm.Board("fpl2003")
        board.pci.load.burst_words = 100  # refused by check(): the rest of pci.load is missing
        self.assertIn("pci.load.interval_us: missing", str(self.refusal(board.check)))
        board.pci.load = "none"
        board.check()
        self.assertEqual(board.sets, ['pci.load="none"'])

    def test_boards_and_sections_are_maps(self):
        board = small_board()
        self.assertIn("matcher.window", board)
        self.assertNotIn("matcher", board)
        self.assertEqual(list(board)[:2], ["name", "image.width"])
        self.assertEqual((board["matcher"]["window"], board.ssram["banks"].bank1.words), (7, 524288))
        self.assertEqual(dict(board.fpga)["lanes"], 1)
        self.assertEqual(list(board.ssram.banks), [f"bank{i}" for i in range(8)])
        board.matcher["window"] = 5
        self.assertNotEqual(board, small_board())
        self.assertEqual(board, small_board(matcher__window=5))
        with self.assertRaisesRegex(KeyError, "nope: not a key"):
            board["nope"]  # noqa: B018

    def test_charts(self):
        for shown in (small_board(), small_board().run(*self.arrays)):
            self.assertIn("<svg", shown._repr_html_())
        self.assertIn("from power-up", repr(small_board().run()))
        of_set = small_board().run(**ALONE, set=["matcher.window=5"])
        self.assertNotEqual(of_set.chart(), small_board().run(**ALONE).chart())


class Files(PythonTest):
    """What a board is made of is read once, when it is made."""

    def answers(self, board):
        """What each command says about a board, and all points of a sweep."""
        return [board.values, board.bounds(), board.run(**ALONE).statistics,
                board.explain(**ALONE).attrs["document"], board.conflicts(**ALONE).attrs["document"],
                board.allocate(3, **ALONE).attrs["document"], board.chart(), board.run(**ALONE).chart(),
                board.sweep({"matcher.rows": [1, 2]}).to_json()]

    def test_a_board_file_that_is_changed_and_a_change_of_the_folder_have_no_effect(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        text = f"extends: fpl2003\nimage: {{width: {WIDTH}, height: {HEIGHT}}}\nmatcher: {{window: 5}}\n"
        path = self.file("b.yaml", text)
        board = stereotlm.Board("./b.yaml", {"matcher.disparities": 40})
        before = self.answers(board)
        path.write_text(text.replace("5}", "9}"))
        (self.folder / "other").mkdir()
        os.chdir("other")
        self.assertEqual(self.answers(board), before)
        path.unlink()
        self.assertEqual(self.answers(pickle.loads(pickle.dumps(board))), before)
        board.matcher.rows = 2
        self.assertEqual((board.matcher.window, board.changed({"fpga.lanes": 4}).matcher.window), (5, 5))
        self.assertEqual(board.run(synthetic=1, out=self.out, **ALONE).board, board)
        self.assertIn("window: 5", (self.out / "config.yaml").read_text())
        self.assertEqual(board.board, str(path))

    def test_a_calibration_that_is_changed_has_no_effect(self):
        self.addCleanup(os.chdir, os.getcwd())
        rig = self.copy_of_rig()
        os.chdir(self.folder)
        board = stereotlm.Board(calibration="rig.yaml")
        disparity = board.run(synthetic=1, **ALONE).disparity
        for path in (rig, self.folder / "rig_left.lut", self.folder / "rig_right.lut"):
            path.write_bytes(b"damaged")
        os.chdir("/")
        run = board.run(synthetic=1, out=self.out, **ALONE)
        self.assertTrue((run.disparity == disparity).all())
        self.assertEqual(self.run_json()["calibration"]["path"], str(rig))
        self.assertEqual(list(board.sweep({"fpga.clock_mhz": [20]}, frames=1).status), ["ok"])
        self.assertEqual(board, board.changed({"name": "fpl2003"}))
        self.assertNotEqual(board, stereotlm.Board())
        for again in (lambda: board.changed({}, calibration=rig), lambda: board.run(calibration=rig)):
            self.assertIn("rig.yaml", str(self.refusal(again)))

    def test_a_board_shows_what_it_runs(self):
        board = small_board()
        board.allocation.left_image.append("bank7")
        board.values["matcher.cost"] = "zncc"
        self.assertEqual((board.allocation.left_image, board.matcher.cost), (["bank0", "bank1"], "sad"))
        run = board.run(set=["matcher.window=5"], **ALONE)
        self.assertEqual((run.board, run.board.matcher.window), (small_board(matcher__window=5), 5))
        self.assertEqual(run.statistics, run.board.run(**ALONE).statistics)

    def test_a_change_by_another_thread_is_no_part_of_a_run(self):
        board = small_board()
        runs = []
        thread = threading.Thread(target=lambda: runs.extend(board.run(**ALONE) for _ in range(20)))
        thread.start()
        while thread.is_alive():
            board.matcher.window = 3 if board.matcher.window == 9 else 9
        thread.join()
        self.assertEqual(len(runs), 20)
        for run in runs:
            self.assertEqual(run.board.run(**ALONE).statistics, run.statistics)

    def test_a_board_is_saved_as_a_file_that_gives_it_again(self):
        board = small_board(matcher__cost={"census": 5}, name="é: x", pci__load={"burst_words": 64,
                                                                                "interval_us": 2.5})
        for path in (self.folder / "board.yaml", os.fsencode(self.folder) + b"/\xff.yaml"):
            board.save(path)
            again = stereotlm.Board(path)
            self.assertEqual((again, again.sets), (board, []))
        board.save(self.folder / "board.yaml")  # the same bytes
        board.matcher.window = 5
        with self.unchanged(self.folder / "board.yaml"):
            for its, path, text in ((board, self.folder / "board.yaml", "exists, and is not known as a"),
                                    (again, again.board, "is the file of BOARD: must be another"),
                                    (board, self.left, "must end in .yaml"), (board, "", "--write")):
                self.assertIn(text, str(self.refusal(lambda: its.save(path))))  # noqa: B023

    def test_pipes_and_devices_are_refused(self):
        os.mkfifo(self.folder / "pipe.yaml")
        pipe = str(self.folder / "pipe.yaml")
        for make in (lambda: stereotlm.Board("/dev/stdin"), lambda: stereotlm.Board(pipe),
                     lambda: stereotlm.Board(calibration=pipe), lambda: small_board().run(pipe, pipe),
                     lambda: stereotlm.execute("sweep", pipe, "--out", self.out),
                     lambda: small_board().sweep({}, board=pipe),
                     lambda: small_board().sweep({}, known=pipe),
                     lambda: stereotlm.execute("merge", self.out, pipe),
                     lambda: stereotlm.execute("plot", pipe, "--out", self.out)):
            self.assertIn("must be a regular file", str(self.refusal(make)))

    def test_a_folder_whose_name_is_not_utf_8(self):
        self.addCleanup(os.chdir, os.getcwd())
        before = small_board().run(*self.arrays, **ALONE).statistics
        folder = os.fsencode(self.folder) + b"/\xff\xc3"
        os.mkdir(folder)
        os.chdir(folder)
        pathlib.Path("b.yaml").write_text(f"extends: fpl2003\nimage: {{width: {WIDTH}, height: {HEIGHT}}}\n")
        for path in ("./b.yaml", os.fsdecode(folder + b"/b.yaml"), folder + b"/b.yaml",
                     pathlib.Path("b.yaml")):
            board = stereotlm.Board(path)
            self.assertEqual(board.run(*self.arrays, **ALONE).statistics, before)
        self.answers(board)
        board.run(synthetic=1, out="out")
        self.assertEqual(len(board.sweep({"matcher.window": [5, 7]}, out="points.db")), 2)
        pair = [shutil.copy(side, ".") for side in (self.left, self.right)]
        self.assertEqual(board.run(*pair, **ALONE).statistics, before)
        self.assertIn("run.json cannot name it", str(self.refusal(lambda: board.run(*pair, out="out"))))
        self.assertEqual(len(os.listdir(b".")), 5)


class Runs(PythonTest):
    def test_a_run_is_that_of_the_command(self):
        for options in ([], PRELOADED):
            self.succeeds(run("run", "fpl2003", *SMALL, *options, *self.pair, "--out", self.out))
            found = small_board().run(*self.arrays, **(ALONE if options else {}))
            stats = self.stats()
            self.assertEqual({key: found.statistics[key] for key in stats}, stats)
            self.assertTrue((found.disparity == read_pfm(self.out / "disparity.pfm")).all())
            self.assertIsNone(found.disparities)

    def test_pairs_of_arrays_are_verified(self):
        found = small_board().run(*[numpy.stack([side, side[::-1]]) for side in self.arrays], verify=True)
        self.assertIn("agree in every figure, time and pixel of 2 frames", found.messages[-1])

    def test_a_run_of_arrays_keeps_a_result_folder(self):
        board = small_board(cameras__frame_rate_hz=1000, fpga__clock_mhz=4)
        for pairs, pictures in ((1, self.arrays), (3, [numpy.stack([side] * 3) for side in self.arrays])):
            out = self.folder / f"kept{pairs}"
            found = board.run(*pictures, frames=4, out=out)
            again = board.run(sequence=out / "pictures", frames=4, out=self.out, save_frames=pairs > 1)
            self.assertEqual(len(os.listdir(out / "pictures")), 2 * pairs)
            self.assertEqual(found.statistics, again.statistics)
            self.assertEqual(found.frame_numbers, again.frame_numbers)
            self.assertTrue((found.disparity == again.disparity).all())
            kept = {name: data for name, data in self.result(out).items() if "pictures/" not in name}
            self.assertEqual(kept, self.result())
            self.succeeds(run("diff", out, self.out))
            with self.unchanged(out):
                self.refused(run("run", "fpl2003", *SMALL, "--sequence", out / "pictures", "--out", out))

    def test_truth_is_an_array_or_a_file(self):
        board = small_board()
        levels = numpy.tile(numpy.arange(WIDTH), (HEIGHT, 1)).astype(numpy.uint8)
        file = self.file("truth.pgm", pgm(WIDTH, HEIGHT, levels.tobytes()))
        unknown = numpy.where(levels, levels, numpy.nan) / 3

        def accuracy(truth, **options):
            return board.run(*self.arrays, truth=truth, **ALONE, **options).statistics["accuracy"]

        expected = accuracy(file, truth_scale=3)
        for truth in (levels, levels.astype(numpy.uint16), levels.astype(float), levels.tolist()):
            self.assertEqual(accuracy(truth, truth_scale=3), expected)
        for truth in (levels.astype(float), levels.astype(int)):
            self.assertEqual(accuracy(truth), accuracy(file))
        infinite = numpy.nan_to_num(unknown, nan=numpy.inf)
        self.assertEqual(accuracy(unknown, out=self.out), accuracy(infinite))
        self.succeeds(run("diff", self.out, self.out))  # repeats the run with the truth that it has kept
        self.assertIn("must be as large as", str(self.refusal(lambda: accuracy(levels[1:]))))
        for error, truth in ((ValueError, levels.astype("u2")), (TypeError, levels[0]), (TypeError, ["a"])):
            with self.assertRaises(error):
                accuracy(truth)

    def test_a_stack_is_a_sequence(self):
        pairs = [numpy.stack([numpy.roll(side, shift, 1) for shift in range(3)]) for side in self.arrays]
        board = small_board()
        found = board.run(*pairs, **ALONE)
        self.assertEqual((found.disparities.shape, found.frame_numbers), ((3, HEIGHT, WIDTH), [0, 1, 2]))
        for i in range(3):
            one = board.run(pairs[0][i], pairs[1][i], **ALONE)
            self.assertTrue((found.disparities[i] == one.disparity).all())
        slow = small_board(fpga__clock_mhz=1, cameras__frame_rate_hz=1000)
        dropped = slow.run(*pairs, frames=4)
        self.assertEqual(len(dropped.disparities), 4)
        self.assertGreater(dropped.frame_numbers[-1], 3)  # the cameras were faster

    def test_tables(self):
        found = small_board(allocation__left_lut="bank0").run(**ALONE)
        self.assertEqual(list(found.banks.name), [f"bank{i}" for i in range(8)])
        self.assertEqual(found.banks.reads.sum(), sum(bank["reads"] for bank in found.statistics["banks"]))
        self.assertEqual((found.blame.port[0], found.blame.by[0]), ("left_lut", "left_pixel"))
        self.assertEqual(found.ports.stall_cycles[0], found.blame.cycles[0])
        self.assertEqual(list(small_board().run(**ALONE).blame.columns), ["port", "bank", "by", "cycles"])

    def test_arrays_that_do_not_fit(self):
        board = small_board()
        left, right = self.arrays
        for pair, text in (((left[:, 1:], right), "shapes (24, 31) and (24, 32): must be equal"),
                           ((left[1:], right[1:]), "shape (23, 32): must be (24, 32) or (pairs, 24, 32)"),
                           ((left, None), "must both be there"),
                           ((left[None, None], right[None, None]), "shape (1, 1, 24, 32)"),
                           ((left[0], right[0]), "shape (32)"),
                           ((numpy.uint8(1), numpy.uint8(1)), "shape ()"),
                           ((left[None][:0], right[None][:0]), "shape (0, 24, 32)")):
            self.assertIn(text, str(self.refusal(lambda: board.run(*pair))))  # noqa: B023
        with self.assertRaisesRegex(TypeError, "left: float64: must be an array of uint8"):
            board.run(left / 2, right)
        with self.assertRaisesRegex(TypeError, "truth: uint8 .1, 24, 32.: must be an array of numbers"):
            board.run(left, right, truth=left[None])
        self.assertIn("arrays, --synthetic: a run has one source",
                      str(self.refusal(lambda: board.run(left, right, synthetic=1))))

    def test_options_that_there_are_not(self):
        self.assertIn("--frams: unknown option; nearest: --frames",
                      str(self.refusal(lambda: small_board().run(frams=1))))
        self.assertEqual(len(self.refusal(lambda: small_board().run(frams=[1, 2])).problems), 1)
        with self.assertRaises(stereotlm.Refused):
            small_board().run(synthetic=True)  # it takes a number

    def test_values_are_no_options(self):
        board = small_board()
        Board = stereotlm.Board
        for action in (lambda: board.run(out=""), lambda: board.run(frames=""), lambda: board.run(set=""),
                       lambda: board.run(timing_only=""), lambda: board.run(calibration=""),
                       lambda: board.run(help=True), lambda: board.run(help=""),
                       lambda: board.explain(help=True), lambda: board.conflicts(help=True),
                       lambda: board.allocate(1, help=True), lambda: board.allocate(1, out=""),
                       lambda: board.allocate("--json"), lambda: board.sweep(help=True),
                       lambda: board.sweep(out=""), lambda: board.__setitem__("--help", 1),
                       lambda: Board("--help"), lambda: Board("-h"), lambda: Board(""),
                       lambda: Board("fpl2003", {"--help": 1}), lambda: Board("fpl2003", ""),
                       lambda: Board("fpl2003", {}, ""), lambda: Board("fpl2003", {}, "--json")):
            self.refusal(action)
        self.file("-board.yaml", (SOURCES / "platform/boards/fpl2003.yaml").read_text())
        with contextlib.chdir(self.folder):
            self.assertEqual(Board("-board.yaml").values, Board().values)

    def test_warnings_are_warnings(self):
        board = small_board(cameras__frame_rate_hz=1000, fpga__clock_mhz=3.745, capture__fifo_words=4,
                            capture__fifo_trigger_words=2,
                            pci__load={"burst_words": 1, "interval_us": 0, "access_us": 50})
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            board.run(frames=3)
        self.assertIn("pixels", str(caught[0].message))


class Commands(PythonTest):
    def test_explain_conflicts_and_bounds_are_those_of_the_commands(self):
        shared = {"allocation__left_lut": "bank0"}
        board = small_board(**shared)
        words = [*SMALL, *sets("allocation.left_lut=bank0")]
        document = json.loads(self.succeeds(run("explain", "fpl2003", *words, *PRELOADED, "--json")))
        found = board.explain(**ALONE)
        self.assertEqual(found.attrs["document"], document)
        self.assertEqual(list(found.key), [change["key"] for change in document["changes"]])
        best = board.changed(found.sets[0])
        self.assertEqual(best.run(frames=6, **ALONE).frames_per_second["core"], found.frames_per_second[0])
        document = json.loads(self.succeeds(run("conflicts", "fpl2003", *words, *self.pair, "--json")))
        self.assertEqual(board.conflicts(*self.arrays).attrs["document"], document)
        self.assertEqual(list(board.conflicts().cycles), [wait["cycles"] for wait in document["waits"]])
        self.assertEqual(list(small_board().conflicts(**ALONE).cycles), [])
        self.assertEqual(board.conflicts(self.left, self.right).attrs["document"],
                         board.conflicts(*self.arrays).attrs["document"])
        self.assertIn("must both be there", str(self.refusal(lambda: board.conflicts(right=self.arrays[1]))))
        document = json.loads(self.succeeds(run("bounds", "fpl2003", *words, "--json")))
        self.assertEqual(board.bounds(), document)

    def test_allocate(self):
        database = self.folder / "boards.db"
        found = small_board().allocate(4, out=database, frames=2, **ALONE)
        self.assertEqual(list(found.banks), [1, 2, 3, 4])
        best = small_board().changed(found.sets[3]).run(frames=2, **ALONE)
        self.assertEqual(best.frames_per_second["core"], found["frames_per_second.core"][3])
        self.assertTrue(database.is_file())
        self.assertTrue(small_board().allocate(4, frames=2, **ALONE).equals(found))
        self.assertIn("--banks = 9", str(self.refusal(lambda: small_board().allocate(9))))

    def test_sweep(self):
        board = small_board(matcher__window=9)
        found = board.sweep({"matcher.window": [7, 5], "fpga.clock_mhz": range(20, 41, 20)},
                            where=["matcher.window < 7 OR fpga.clock_mhz < 30"],
                            out=self.folder / "points.db")
        self.assertEqual(list(found.columns[:5]), ["matcher.window", "fpga.clock_mhz", "status", "reason",
                                                   "frames_per_second.core"])
        self.assertEqual(list(found["matcher.window"]), [5, 5, 7])
        self.assertEqual(list(found["fpga.clock_mhz"]), [20, 40, 20])
        board.matcher.window = 5
        board.fpga.clock_mhz = 40
        rate = board.run(frames=2, **ALONE).frames_per_second["core"]
        self.assertEqual(found["frames_per_second.core"][1], rate)
        self.assertEqual(len(board.sweep(zip=[{"matcher.window": [5, 7], "matcher.rows": [1, 2]}])), 2)
        self.assertRegex(str(self.refusal(lambda: board.sweep({"matcher.window": [6]}))),
                         "^the plan:3:.*: matcher.window = 6: 3..31, odd$")

    def test_values_of_other_libraries(self):
        board = small_board()
        table = board.sweep({"matcher.window": [5, 7], "matcher.rows": [1, 2]})
        for values in (table["matcher.window"], pandas.Index([5, 7]), {7, 5}, {7: 0, 5: 0}.keys(),
                       [decimal.Decimal("5"), numpy.uint8(7)], numpy.array([5, 7]), (w for w in (5, 7))):
            self.assertEqual(list(board.sweep({"matcher.window": values})["matcher.window"]), [5, 7])
        clocks = board.sweep({"fpga.clock_mhz": [decimal.Decimal("39.9"), decimal.Decimal("1E+2")]})
        self.assertEqual(list(clocks["fpga.clock_mhz"]), [39.9, 100])
        both = table[["matcher.window", "matcher.rows"]]
        where = pandas.Series(["matcher.rows < 2"])
        self.assertEqual(len(board.sweep(zip=[both.iloc[[0, 3]]], where=where)), 1)
        board.matcher.window = table["matcher.window"][3]
        self.assertEqual(board.matcher.window, 7)
        with self.assertRaisesRegex(TypeError, "vary.matcher.window = b'5': must be a number, a text"):
            board.sweep({"matcher.window": [b"5"]})
        with self.assertRaisesRegex(TypeError, "ssram.banks.b = <.*: must be a number"):
            board.ssram.banks = {"b": object()}
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        for name in (":memory:", "file:x?mode=memory"):
            self.assertEqual(len(board.sweep({"matcher.window": [5, 7]}, out=name)), 2)
            self.assertTrue((self.folder / name).is_file())

    def test_tables_without_pandas(self):
        with unittest.mock.patch.dict(sys.modules, {"pandas": None}):
            banks = small_board(allocation__left_lut="bank0").run(**ALONE)
            table = banks.banks
            self.assertIsInstance(table, numpy.ndarray)
            self.assertEqual(list(table["name"]), [f"bank{i}" for i in range(8)])
            self.assertEqual(table["reads"].dtype.kind, "i")
            *names, _ = banks.statistics["banks"][0]
            self.assertEqual(list(table.dtype.names)[:len(names)], names)
            self.assertEqual(sum(filter(None, table["energy.energy_pj"])), banks.energy["memory_pj"])
            self.assertEqual(len(small_board().run(**ALONE).blame), 0)
            explained = small_board().explain(**ALONE)
            self.assertEqual(explained.attrs["document"]["board"], "fpl2003")
            self.assertEqual(list(explained["key"])[0], explained.attrs["document"]["changes"][0]["key"])
            for same in (copy.copy(explained), copy.deepcopy(explained), explained.copy(), explained[:],
                         pickle.loads(pickle.dumps(explained))):
                self.assertEqual((same.attrs, list(same)), (explained.attrs, list(explained)))
            self.assertEqual(banks.banks.attrs, {"document": None})
        self.assertIsInstance(small_board().run(**ALONE).banks, pandas.DataFrame)

    def test_progress_is_shown_by_tqdm(self):
        bars = []

        class Bar:
            def __init__(self, **_):
                self.total, self.n, self.shown, self.closed = None, 0, [], False
                bars.append(self)

            def set_description_str(self, text):
                self.shown.append((self.n, self.total, text))

            def close(self):
                self.closed = True

        fake = types.SimpleNamespace(tqdm=Bar)
        with unittest.mock.patch.dict(sys.modules, {"tqdm": fake, "tqdm.auto": fake}):
            stereotlm.Board("fpl2003").run(frames=6, fidelity="cycle", **ALONE)
        self.assertTrue(bars[0].closed)
        done, of, text = bars[0].shown[-1]
        self.assertEqual(of, 6)
        self.assertRegex(text, r"/6 frames .* M cycles/s")
        self.assertEqual(sorted(bars[0].shown), bars[0].shown)
        with unittest.mock.patch.dict(sys.modules, {"tqdm": None, "tqdm.auto": None}):
            self.assertEqual(small_board().run(frames=3, **ALONE).statistics["frames"], 3)


class Workers(PythonTest):
    def setUp(self):
        super().setUp()
        self.worker = stereotlm.Worker()
        self.addCleanup(self.worker.close)

    def while_it_works(self, action):
        """Calls action(pid of the worker) while a command is executed; what the command has raised."""
        raised = []
        long = ["run", "fpl2003", *PRELOADED, "--synthetic", 1, "--fidelity", "cycle", "--frames", 1000]

        def work():
            try:
                self.worker.execute(*long, progress=False)
            except Exception as error:  # noqa: BLE001
                raised.append(error)

        thread = threading.Thread(target=work)
        thread.start()
        busy = lambda pid: int((program.stat(pid) or [0] * 12)[11]) > 20  # 0.2 s
        program.wait_until(lambda: self.worker.pid and any(map(busy, program.descendants(self.worker.pid))))
        action(self.worker.pid)
        thread.join()
        return raised[0]

    def works(self):
        self.assertEqual(self.worker.execute("boards", "--show", "fpl2003").output[0], "#")

    def test_one_that_is_killed_is_an_exception_and_the_next_command_works(self):
        self.works()
        error = self.while_it_works(lambda pid: os.kill(pid, signal.SIGKILL))
        self.assertIsInstance(error, stereotlm.WorkerDied)
        self.assertIn("ended by signal 9", str(error))
        self.works()
        os.kill(self.worker.pid, signal.SIGKILL)
        program.wait_until(lambda: self.worker._process.poll() is not None)
        self.works()  # no command is lost

    def test_a_command_that_is_killed_is_an_exception_and_the_worker_works_on(self):
        self.works()
        pid = self.worker.pid
        error = self.while_it_works(lambda pid: os.kill(program.descendants(pid)[0], signal.SIGKILL))
        self.assertIsInstance(error, stereotlm.Failed)
        self.assertIn("signal 9 (Killed)", str(error))
        self.works()
        self.assertEqual(self.worker.pid, pid)

    def test_runs_without_pixels_keep_their_process_which_is_warm(self):
        run = ["run", "fpl2003", *SMALL, "--timing-only", "--frames", "2", "--page-data"]
        self.worker.execute("boards")
        first = program.descendants(self.worker.pid)
        for more in ("--source=preloaded", "--source=camera"):
            self.worker.execute(*run, more)
            self.assertEqual(program.descendants(self.worker.pid), first)

    def test_commands_do_not_change_later_ones(self):
        colour = self.file("colour.ppm", b"P6 32 24 255\n" + bytes(2304))
        note = ["run", "fpl2003", *SMALL, *PRELOADED, "--left", colour, "--right", self.right]
        self.assertEqual(self.worker.execute("check", "fpl2003", "--quiet").messages, [])
        self.assertIn("note: --left", self.worker.execute(*note).messages[0])
        self.assertEqual(self.worker.execute(*note, "--quiet").messages, [])
        self.assertIn("note: --left", self.worker.execute(*note).messages[0])

    def test_a_nul_is_refused_and_nothing_is_executed(self):
        for words in (["check", "fpl2003\0"], ["boards\0--show"], ["run", "fpl2003", "--source=camera\0"]):
            with self.assertRaisesRegex(stereotlm.Refused, "^'.*': a NUL character follows: must not be in"):
                self.worker.execute(*words)
        self.works()

    def test_text_that_is_no_text_is_refused_and_nothing_is_sent(self):
        with self.assertRaises(UnicodeEncodeError):
            self.worker.execute("check", "/tmp/\ud8ff.yaml")
        self.works()

    def test_a_forked_process_has_its_own(self):
        board = small_board()
        here = worker._shared.pid
        read, write = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                board.run(**ALONE)
                os.write(write, str(worker._shared.pid).encode())
                worker._shared.close()
            finally:
                os._exit(0)
        os.close(write)
        os.waitpid(child, 0)
        self.assertNotEqual(int(os.read(read, 20)), here)
        self.assertEqual(board.run(**ALONE).statistics["frames"], 1)
        self.assertEqual(worker._shared.pid, here)

    def test_a_failure_is_an_exception(self):
        with self.assertRaisesRegex(stereotlm.Failed, "no space|File too large|full"):
            plan = self.file("plan.yaml", "board: fpl2003\nvary: {matcher.window: [3, 5]}\n")
            self.worker.execute("sweep", plan, "--out", "/dev/full")

    def test_exceptions_keep_their_text_through_copies_and_processes(self):
        refused = self.refusal(lambda: stereotlm.Board("nope"))
        for error in (refused, stereotlm.Failed("it has failed"), stereotlm.WorkerDied("it has died")):
            for same in (copy.copy(error), copy.deepcopy(error), pickle.loads(pickle.dumps(error))):
                self.assertEqual((type(same), str(same), vars(same)), (type(error), str(error), vars(error)))
        self.assertEqual(pickle.loads(pickle.dumps(refused)).problems, refused.problems)
        with concurrent.futures.ProcessPoolExecutor(1) as pool, \
                self.assertRaisesRegex(stereotlm.Refused, "^nope: not a preset"):
            pool.submit(stereotlm.Board, "nope").result()

    def test_the_version_is_that_of_the_program(self):
        self.assertEqual(self.worker.execute("--version").output, f"stereotlm {stereotlm.__version__}\n")

    def test_a_program_that_is_not_there(self):
        with unittest.mock.patch.dict(os.environ, {"PATH": "/", "STEREOTLM_PROGRAM": ""}), \
                unittest.mock.patch.object(worker, "__file__", "/a/b/c/d/e/worker.py"), \
                self.assertRaisesRegex(FileNotFoundError, "STEREOTLM_PROGRAM"):
            stereotlm.Worker().execute("boards")

    def test_a_program_that_is_not_stereotlm(self):
        old = self.file("old", "#!/bin/sh\necho stereotlm 0.0.9\n")
        old.chmod(0o755)
        for path, cause in ((self.folder / "none", "No such file"), (self.left, "Permission denied"),
                            (self.folder, "Permission denied"), ("/bin/true", "it prints 'true"),
                            (old, "it prints 'stereotlm 0.0.9'")):
            rule = f"{path}: .*{cause}.*: must be the program stereotlm {stereotlm.__version__}$"
            with unittest.mock.patch.dict(os.environ, {"STEREOTLM_PROGRAM": str(path)}):
                for made, name in ((None, "STEREOTLM_PROGRAM"), (str(path), "program")):
                    with self.assertRaisesRegex(FileNotFoundError, f"^{name} = {rule}"):
                        stereotlm.Worker(made).execute("boards")


class Protocol(ProgramTest):
    def answers(self, data):
        """Lines of the worker's answers to these bytes, and its exit status."""
        process = subprocess.run([PROGRAM, "worker"], input=data, capture_output=True, check=False,
                                 timeout=60)
        self.assertEqual(process.stderr, b"")
        return [json.loads(line) for line in process.stdout.splitlines()], process.returncode

    def test_requests_follow_each_other(self):
        lines, status = self.answers(b'{"arguments": ["boards", "--show", "sdram"]}\n{"arguments": ["rn"]}\n')
        self.assertEqual([line.get("status") for line in lines], [0, None, 2])
        self.assertIn("unknown command", lines[1]["message"])
        self.assertIn("'rn': unknown command", lines[2]["problems"][0]["message"])
        self.assertEqual(status, 0)

    def test_a_request_that_cannot_be_read_is_the_last(self):
        with_array = lambda array: b'{"arguments": [], "arrays": [%b]}\n' % array
        of_shape = lambda shape: with_array(b'{"name": "left", "shape": %b}' % shape)
        one = b'{"name": "a", "shape": [1]}'
        for request, text in ((b"boards\n", "a request of the worker: not JSON from column 1 on"),
                              (b'{"arguments": [}\n', "not JSON from column 16 on"), (b"\xff\n", "not JSON"),
                              (b"1e999\n", "a number is too large"), (b"[]\n", "must be a JSON object"),
                              (b"{}\n", "arguments: missing: must be a list of texts"),
                              (b'{"arguments": [5]}\n', "arguments = [5]: must be a list of texts"),
                              (b'{"arrays": %b}\n' % (b"[" * 10**5 + b"]" * 10**5), "nested too deeply"),
                              (b'{"arguments": [], "folder": 5}\n', "folder = 5: must be a text"),
                              (b'{"arguments": [], "encoding": "x"}\n', "encoding = x: must be utf-8 or lat"),
                              (b'{"arguments": ["\\u0100"], "encoding": "latin-1"}\n', "must be U+0000 to"),
                              (b'{"arguments": [], "arrays": 5}\n', "arrays = 5: must be a list of arrays"),
                              (with_array(b"5"), "name: missing: must be a text"),
                              (with_array(one + b"," + one) + b"xy", "array a: sent twice"),
                              (of_shape(b"400") + b"xx", "shape = 400: must be a list of integers"),
                              (of_shape(b"[400]") + b"xx", "array left: ends early"),
                              (of_shape(b"[1.5]"), "array left: shape = [1.5]: must be a list of integers"),
                              (of_shape(b"[-1]"), "shape = [-1]: must be a list of integers, 0 or more"),
                              (of_shape(b"[65536,65537]"), "must have at most 4294967296 bytes"),
                              (of_shape(b"[4294967296,4294967296]"), "must have at most 4294967296 bytes"),
                              (of_shape(b"[18446744073709551616]"), "must be a list of integers")):
            lines, status = self.answers(request + b'{"arguments": ["boards"]}\n')
            self.assertEqual([line.get("status") for line in lines], [None, 2], request)
            self.assertIn(text, lines[0]["message"])
            self.assertEqual(status, 0)

    def test_arrays_that_the_command_does_not_take_are_refused_and_the_last_line_needs_no_newline(self):
        request = (b'{"arguments": ["%b"], "arrays": [{"name": "left", "shape": [2]}, '
                   b'{"name": "third", "shape": [0, 5]}]}\nxy')
        lines, status = self.answers(request % b"boards" + request % b'run", "fpl2003' +
                                     b'{"arguments": ["boards"]}')
        self.assertEqual(([line["status"] for line in lines if "status" in line], status), ([2, 2, 0], 0))
        left, third = (f"array {name}: the command takes no array of this name" for name in ("left", "third"))
        problems = [[problem["rule"] for problem in line["problems"]] for line in lines if "problems" in line]
        self.assertEqual(problems, [[left, third], [third], []])

    def test_too_little_memory_is_no_fault_of_the_request(self):
        if program.HAS_ADDRESS_SANITIZER:
            self.skipTest("the sanitizer needs more")
        few = lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 31, 1 << 31))
        request = b'{"arguments": ["run", "fpl2003"], "arrays": [{"name": "left", "shape": [4294967296]}]}\n'
        process = subprocess.run([PROGRAM, "worker"], input=request, capture_output=True, check=False,
                                 preexec_fn=few, timeout=60)
        lines = [json.loads(line) for line in process.stdout.splitlines()]
        self.assertEqual([line.get("message", line.get("status")) for line in lines],
                         ["stereotlm: error: out of memory", 1])

    def test_a_folder_that_is_not_there_and_a_worker_in_a_worker(self):
        lines, status = self.answers(b'{"arguments": ["boards"], "folder": "/none"}\n'
                                     b'{"arguments": ["worker"]}\n')
        self.assertEqual([line.get("status") for line in lines], [None, 2, None, 2])
        self.assertIn("folder '/none': No such file", lines[0]["message"])
        self.assertIn("cannot be a command for a worker", lines[2]["message"])

    def test_a_folder_is_that_of_its_request_alone(self):
        self.file("b.yaml", "extends: fpl2003\nname: b\n")
        there = json.dumps({"arguments": ["bounds", "./b.yaml"], "folder": str(self.folder)}).encode()
        lines, _ = self.answers(there + b'\n{"arguments": ["bounds", "./b.yaml"]}\n' + there + b"\n")
        self.assertEqual([line["status"] for line in lines if "status" in line], [0, 2, 0])

    def test_a_process_that_dies_while_it_reads_arrays_ends_the_worker(self):
        process = subprocess.Popen([PROGRAM, "worker"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        self.addCleanup(self.close, process)
        process.stdin.write(b'{"arguments": ["boards"], "arrays": [{"name": "left", "shape": [9, 9]}]}\nx')
        process.stdin.flush()
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
        program.wait_until(children.read_text)
        time.sleep(0.2)  # it reads
        os.kill(int(children.read_text()), signal.SIGKILL)
        out, _ = process.communicate(b"y" * 80 + b'\n{"arguments": ["boards"]}\n', timeout=60)
        self.assertEqual([json.loads(line).get("status") for line in out.splitlines()], [None, 1])
        self.assertEqual(process.returncode, 1)


class Notebook(unittest.TestCase):
    @program.slow
    def test_it_runs_from_a_fresh_kernel_and_prints_what_it_shows(self):
        import nbclient
        import nbformat
        folder = SOURCES / "results" / "notebook"
        notebook = nbformat.reads((folder / "board.ipynb").read_text(), as_version=4)
        # A kernel may divide what a cell prints.
        texts = lambda: ["".join(output.text for output in cell.outputs if output.get("name") == "stdout")
                         for cell in notebook.cells if cell.cell_type == "code"]
        shown = texts()
        with tempfile.TemporaryDirectory() as scratch, \
                unittest.mock.patch.dict(os.environ, {"JUPYTER_DATA_DIR": scratch, "IPYTHONDIR": scratch,
                                                      "PYTHONPATH": str(SOURCES / "sw" / "python")}):
            nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3",
                                    resources={"metadata": {"path": str(folder)}}).execute()
        self.assertTrue(any(shown))
        self.assertEqual(texts(), shown)


if __name__ == "__main__":
    program.main()
