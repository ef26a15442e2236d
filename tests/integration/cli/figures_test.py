"""keys --figures and the tables `columns` and `plain` of a database: what each column is."""

import json
import re
import sqlite3

from program import HEIGHT, WIDTH, ProgramTest, run

SIZE = f"image.width: {WIDTH}, image.height: {HEIGHT}"
RUNS = {
    "core": f"board: fpl2003\nrun: {{source: preloaded}}\nset: {{{SIZE}}}\n"
            "vary: {matcher.window: [5, 7], allocation.right_image: [[bank2, bank3], bank3]}\n",
    "computer": f"board: two-banks\nrun: {{source: camera}}\nset: {{{SIZE}, fpga.package: ff1152}}\n"
                "vary: {bridge.posted_words: [32, 64]}\n",
    "proven": f"board: fpl2003\nrun: {{source: camera}}\nset: {{{SIZE}}}\n",
    "sdram": f"board: sdram\nset: {{{SIZE}}}\n",
    "lanes": f"board: eight-banks-four-lanes\nset: {{{SIZE}}}\n",
}
FIRST = ["hash", "status", "reason", "version", "config"]


class Figures(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.listed = {each["figure"]: each for each in
                      json.loads(run("keys", "--figures", "--json").stdout)["figures"]}
        cls.keys = {each["key"]: each for each in json.loads(run("keys", "--json").stdout)["keys"]}

    def setUp(self):
        super().setUp()
        self.databases = {name: self.database(name, plan) for name, plan in RUNS.items()}

    def database(self, name, plan):
        path = self.folder / f"{name}.db"
        self.succeeds(run("sweep", self.file(f"{name}.yaml", plan), "--out", path))
        database = sqlite3.connect(path)
        self.addCleanup(database.close)
        return database

    def listed_name(self, column):
        """The figure of a column; NAME is one part, or that of a lane."""
        found = [name for name in self.listed
                 if re.fullmatch(re.escape(name).replace("NAME", r"[^.]+(\.\d+)?"), column)]
        self.assertEqual(len(found), 1, column)
        return found[0]

    def test_the_list_is_what_runs_produce(self):
        produced = set()
        for name, database in self.databases.items():
            columns = database.execute("SELECT name, unit, meaning, is_key FROM columns").fetchall()
            self.assertCountEqual([column for column, *_ in columns],
                                  [row[1] for row in database.execute("PRAGMA table_info(points)")])
            for column, unit, meaning, is_key in columns:
                self.assertTrue(meaning, column)
                if is_key:
                    key = self.keys.get(re.sub(r"^(ssram\.banks\.)[^.]+", r"\1NAME", column))
                    self.assertTrue(key or column.startswith("run."), column)
                    self.assertEqual((unit, meaning), (key.get("unit", ""), key["meaning"]) if key else
                                     ("", meaning))
                elif column not in FIRST:
                    figure = self.listed[self.listed_name(column)]
                    self.assertEqual((unit, meaning), (figure.get("unit", ""), figure["meaning"]))
                    produced.add(figure["figure"])
            self.assertTrue({"pins", "smallest_device"} < {column for column, *_ in columns}, name)
        self.assertEqual(set(self.listed) - produced, NOT_PRODUCED)

    def test_pins_device_and_lost_pixels_are_those_of_check_and_run(self):
        for name, database in self.databases.items():
            rows = database.execute("SELECT * FROM plain WHERE status = 'ok'")
            names = [column[0] for column in rows.description]
            for row in rows.fetchall():
                point = dict(zip(names, row))
                board = self.file("board.yaml", point["config"])
                said = json.loads(self.succeeds(run("check", board, "--json")))
                self.assertEqual((point["pins"], point["smallest_device"]),
                                 (said["pins"], said["smallest_device"]))
                if name == "computer":
                    self.assertEqual(point["lost_pixels"], point["cameras_left_dropped_pixels"]
                                     + point["cameras_right_dropped_pixels"])
        self.assertEqual(self.listed_name("lost_pixels"), "lost_pixels")

    def test_a_column_is_varied_if_points_differ_in_it(self):
        for database in self.databases.values():
            for column, is_key, varied in database.execute("SELECT name, is_key, varied FROM columns"):
                among = "" if is_key or column in FIRST else "WHERE status = 'ok'"
                values = set(database.execute(f'SELECT "{column}" FROM points {among}'))
                self.assertEqual(varied, int(len(values) > 1), column)

    def test_plain_names_need_no_quotes_and_misspelt_ones_are_errors(self):
        database = self.databases["core"]
        for plain, column in (("matcher_window", "matcher.window"),
                              ("banks_bank0_reads", "banks.bank0.reads"),
                              ("frames_per_second_core", "frames_per_second.core"), ("hash", "hash")):
            self.assertEqual(*(database.execute(f"SELECT {name} FROM {table} ORDER BY hash").fetchall()
                               for name, table in ((plain, "plain"), (f'"{column}"', "points"))))
        with self.assertRaisesRegex(sqlite3.OperationalError, "no such column: matcher_windw"):
            database.execute("SELECT matcher_windw FROM plain")

    def test_an_impossible_point_keeps_what_was_asked_for(self):
        rows = self.databases["core"].execute(
            "SELECT matcher_window, config, pins FROM plain WHERE status = 'impossible'").fetchall()
        self.assertEqual(sorted(window for window, *_ in rows), [5, 7])
        for window, config, pins in rows:
            self.assertIn(f"window: {window}\n", config)
            self.assertIn("right_image: bank3\n", config)
            self.assertIsNone(pins)

    def test_a_word_selects_keys_and_figures(self):
        self.assertRegex(self.succeeds(run("keys", "--figures", "memory_mj")),
                         r"^figure  .*\nenergy\.memory_mj_per_frame +mJ/frame +of all banks for a frame\n$")
        keys = json.loads(self.succeeds(run("keys", "posted_words", "--json")))["keys"]
        self.assertEqual([key["key"] for key in keys], ["bridge.posted_words"])
        self.all_refused([
            (["keys", "--figures", "banks.bank3.raeds"],
             "WORD = banks.bank3.raeds: unknown figure banks.bank3.raeds; nearest: banks.bank3.reads"),
            (["keys", "--figures", "nonsense"], "WORD = nonsense: unknown figure nonsense"),
            (["keys", "matcher.windw"],
             "WORD = matcher.windw: unknown key; nearest known key: matcher.window"),
            (["keys", "--schema", "plan", "--figures"], "--schema: does not go with --figures"),
        ])


NOT_PRODUCED = {"accuracy.bad_1_percent", "accuracy.bad_2_percent", "accuracy.answered_percent"}


if __name__ == "__main__":
    import program
    program.main()
