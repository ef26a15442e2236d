"""The accuracy of the points of a sweep: run.pairs and run.synthetic of plans."""

import json
import sqlite3

import program
from pictures import noise, pgm
from program import ProgramTest, run, sets

W, H = 48, 20
BOARD = f"board: fpl2003\nset: {{image.width: {W}, image.height: {H}, matcher.disparities: 16}}\n"
VARY = "vary: {matcher.window: [3, 5], matcher.units: [all, 8]}\n"
NAMES = ["bad_1_percent", "bad_2_percent", "answered_percent"]


class Quality(ProgramTest):
    def made(self, name, seed, shift, width=W, height=H):
        """Noise moved by so many columns, whose truth, in quarters, is wrong in the upper half."""
        left = noise(width, height, seed)
        right = b"".join(left[y * width + shift:(y + 1) * width] + bytes(shift) for y in range(height))
        truth = bytes(4 * shift + 6 * (y < height // 2) for y in range(height) for _ in range(width))
        return {side: self.file(f"{name}_{side}.pgm", pgm(width, height, pixels))
                for side, pixels in (("left", left), ("right", right), ("truth", truth))}

    def plan(self, pairs=None, more="", scale=", scale: 4", vary=VARY):
        text = ", ".join("{" + ", ".join(f"{side}: {path}" for side, path in pair.items()) + scale + "}"
                         for pair in pairs or [])
        listed = f"pairs: [{text}]" if pairs else ""
        return self.file("plan.yaml", BOARD + f"run: {{{listed}{more}}}\n" + vary)

    def points(self, plan, *options):
        """By window: hash and accuracy of each of its points."""
        store = self.folder / "points.db"
        store.unlink(missing_ok=True)
        self.succeeds(run("sweep", plan, "--out", store, *options))
        database = sqlite3.connect(store)
        self.addCleanup(database.close)
        database.row_factory = sqlite3.Row
        found = {}
        for row in map(dict, database.execute("SELECT * FROM plain WHERE status = 'ok'")):
            figures = {name: row.get(f"accuracy_{name}") for name in NAMES}
            found.setdefault(row["matcher_window"], []).append((row["hash"], figures))
        return found

    def accuracy_of_run(self, window, *source):
        document = json.loads(self.succeeds(run(
            "run", "fpl2003", "--source", "preloaded", *sets(
                f"image.width={W}", f"image.height={H}", "matcher.disparities=16",
                f"matcher.window={window}"), "--frames", 1, *source, "--json", "--quiet")))
        return document["accuracy"]

    def test_the_accuracy_of_a_pair_is_that_of_a_run(self):
        pair = self.made("a", 1, 3)
        for source in ("preloaded", "camera"):
            points = self.points(self.plan([pair], f", source: {source}"))
            self.assertEqual(sorted(points), [3, 5])
            for window, of_window in points.items():
                expected = self.accuracy_of_run(window, "--left", pair["left"], "--right", pair["right"],
                                                "--truth", pair["truth"], "--truth-scale", 4)
                self.assertEqual([figures for _, figures in of_window], [expected] * 2)
                self.assertTrue(0 < expected["bad_1_percent"] < 100)
        self.assertNotEqual(*(points[window][0][1] for window in points))

    def test_several_pairs_count_pixel_by_pixel(self):
        good, bad = self.made("a", 1, 3), self.made("b", 2, 5)
        bad["truth"] = good["truth"]  # of another picture
        one, other, both = ({window: figures for window, ((_, figures), *_) in self.points(
            self.plan(pairs)).items()} for pairs in ([good], [bad], [good, bad]))
        for window, figures in both.items():
            # With as many visible pixels in both: the share that is answered is the mean.
            shares = [each[window]["answered_percent"] for each in (one, other)]
            self.assertAlmostEqual(figures["answered_percent"], sum(shares) / 2)
            wrong = sum(each[window]["bad_1_percent"] * share
                        for each, share in zip((one, other), shares)) / sum(shares)
            self.assertAlmostEqual(figures["bad_1_percent"], wrong)

    def test_made_scenes_are_those_of_run(self):
        points = self.points(self.plan(more="synthetic: [7]"))
        for window, of_window in points.items():
            self.assertEqual([figures for _, figures in of_window],
                             [self.accuracy_of_run(window, "--synthetic", 7)] * 2)
        both = self.points(self.plan(more="synthetic: [7, 8]"))
        self.assertNotEqual([both[3][0][1]] * 2, [figures for _, figures in points[3]])

    def test_pictures_and_scales_are_parts_of_a_point(self):
        pair = self.made("a", 1, 3)
        hashes = set()
        for plan in ([], [[pair]], [[pair], "", ""], [[pair, pair]], [[], "synthetic: [1]"],
                     [[], "synthetic: [2]"]):
            found = self.points(self.plan(*plan))
            hashes |= {of_point for points in found.values() for of_point, _ in points}
        self.made("a", 2, 3)  # other pictures in the same files
        hashes |= {of_point for points in self.points(self.plan([pair])).values() for of_point, _ in points}
        self.assertEqual(len(hashes), 7 * 4)

    def test_images_of_another_size_are_impossible(self):
        plan = self.plan([self.made("a", 1, 3)], vary=f"vary: {{image.width: [{W}, 64]}}\n")
        plan.write_text(plan.read_text().replace(f"image.width: {W}, ", "", 1))
        store = self.folder / "sizes.db"
        said = self.succeeds(run("sweep", plan, "--out", store))
        self.assertIn(f"1 impossible: run.pairs: the pictures have {W}x{H} pixels: must be as large as the "
                      f"board's images, 64x{H}", said)

    def test_what_cannot_be_used_is_refused_before_anything_runs(self):
        good, small = self.made("a", 1, 3), self.made("s", 1, 3, 32)
        where = f"{self.folder / 'plan.yaml'}:3:15: run.pairs"
        refusals = [
            ([{**good, "left": "none.pgm"}], "", f"{where}.left 'none.pgm': "),
            ([{**good, "right": small["right"]}], "", f"{where}.right '{small['right']}': 32x{H} pixels: "
             f"must be as large as '{good['left']}', {W}x{H}"),
            ([{**good, "truth": small["truth"]}], "", f"{where}.truth '{small['truth']}': 32x{H} pixels: "),
            ([small], "", f"{where}: the pictures have 32x{H} pixels: must be as large as the "
             "board's images"),
            ([{**good, "other": "x"}], "", "run.pairs[0].other = x: unknown key"),
            ([{"left": "x", "right": "y"}], "", "run.pairs[0].truth: missing: the path of a picture"),
            ([good], ", synthetic: [1]", "run.synthetic: does not go with run.pairs"),
            ([], "synthetic: [-1]", "run.synthetic = -1: "),
            ([], "synthetic: 1", "run.synthetic = 1: a list of seeds"),
        ]
        for pairs, more, text in refusals:
            with self.subTest(text):
                self.refused(run("sweep", self.plan(pairs, more), "--out", self.folder / "x.db"), text)
        # Nothing is said of the size of a picture that cannot be read.
        none = {"left": "l.pgm", "right": "r.pgm", "truth": "t.pgm"}
        errors = run("sweep", self.plan([none, good]), "--out", self.folder / "x.db").stderr
        self.assertEqual([errors.count(text) for text in (".pgm': no such file", "pixels")], [3, 0])
        for options, text, *plan in (([], "run.pairs[0].scale = 0: ", [good], "", ", scale: 0"),
                                     (["--launcher", "slurm"], f"{where}: not with --launcher", [good]),
                                     ([], "run.synthetic: can only be given in `run`", [], "", "",
                                      "vary: {run.synthetic: [1, 2]}\n")):
            self.refused(run("sweep", self.plan(*plan), "--out", self.folder / "x.db", *options), text)
        self.assertFalse((self.folder / "x.db").exists())


if __name__ == "__main__":
    program.main()
