"""The option --json: documents that keep their schemas, with the figures of runs, of their files and of the
board."""

import json
import os
import re

import jsonschema

import program
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run, sets

SHARED = sets("allocation.left_lut=bank0")


class Json(ProgramTest):
    def document(self, command, *arguments):
        """The document, which keeps its schema."""
        process = run(command, *arguments, "--json", "--quiet")
        self.assertEqual(process.stderr, "")
        return self.valid(command, self.succeeds(process))

    def valid(self, command, text):
        schema = json.loads(self.succeeds(run("keys", "--schema", command)))
        jsonschema.Draft202012Validator.check_schema(schema)
        document = json.loads(text)
        validator = jsonschema.Draft202012Validator(schema)
        validator.validate(document)
        self.assertFalse(validator.is_valid({**document, "more": 1}), command)
        return document

    def test_names_that_are_not_utf_8_are_shown_with_a_replacement(self):
        self.file(os.fsdecode(b"b\xff.yaml"), "extends: fpl2003\nname: other\n")
        for name, status in ((b"./b\xff.yaml", 0), (b"./none\xff.yaml", 2)):
            process = run("check", os.fsdecode(name), "--json", cwd=self.folder)
            self.assertEqual((process.returncode, process.stderr), (status, ""))
            self.assertEqual(self.valid("check", process.stdout)["board"], name.decode(errors="replace"))

    def test_boards_with_lanes_stripes_and_sdram_keep_the_schemas(self):
        shared = sets("allocation.disparity={rows: [bank0, bank5]}")  # results and tables meet there
        for name, options in (("eight-banks-four-lanes", shared), ("sdram", [])):
            self.document("check", name)
            bounds = self.document("bounds", name, *SMALL, *options, *sets("fpga.package=ff1152"))
            self.assertEqual(bounds["area"]["pins"], bounds["pins"]["all"])
            found = [self.document(command, name, *SMALL, *PRELOADED, *options, *more)[list_name]
                     for command, list_name, more in (("explain", "blame", []),
                                                      ("conflicts", "waits", ["--timing-only"]))]
            self.assertTrue(all(found), name)
            document = self.document("run", name, *SMALL, *PRELOADED, *options, "--timing-only")
            self.assertEqual(all("row_cycles" in bank for bank in document["banks"]), name == "sdram")

    def test_explain_names_what_is_impossible_and_a_queue_that_is_too_short(self):
        short = sets("matcher.rows=4", "matcher.disparities=4", "fpga.result_fifo_words=4")
        document = self.document("explain", "fpl2003", *SMALL, *PRELOADED, *short)
        stats = json.loads(self.succeeds(run("run", "fpl2003", *SMALL, *PRELOADED, *short, "--synthetic", 1,
                                             "--json")))
        lost = 100 * (1 - stats["frames_per_second"]["core"] / stats["bound"]["core"])
        self.assertAlmostEqual(document["result_queue_wait_percent"], lost)
        change = document["impossible"][0]
        changed = sets("matcher.rows=4", "matcher.disparities=4", f"{change['key']}={change['to']}")
        refused = self.refused(run("check", "fpl2003", *changed))
        self.assertIn(change["reason"], refused[0])

    def test_run_is_its_stats_json_and_what_the_table_says(self):
        for options in ([*PRELOADED, *SHARED], [*CAMERA_RATES, "--timing-only"]):
            arguments = [*SMALL, "--synthetic", 1, "--frames", 3, *options, "--out", self.out]
            document = self.document("run", "fpl2003", *arguments)
            table = self.succeeds(run("run", "fpl2003", *arguments))
            beside = {key: document.pop(key) for key in set(document) - set(self.stats())}
            self.assertEqual(document, self.stats())
            if "--timing-only" in options:
                self.assertEqual(beside, {})
                continue
            answered = re.search(r"disparities +in (.*) %", table)[1]
            self.assertEqual(f"{beside['disparities_percent']:.2f}", answered)
            self.assertEqual(f"{beside['waitless_frames_per_second']:.3f}",
                             re.search(r"of (.*), which the core", table)[1])
            self.assertEqual(f"{beside['accuracy']['answered_percent']:.2f}",
                             re.search(r"answered: (.*) %", table)[1])

    def test_boards_are_files_that_can_be_run(self):
        boards = self.document("boards")["boards"]
        self.assertEqual([board["name"] for board in boards][0], "fpl2003")
        for board in boards:
            self.assertEqual(board["file"], self.succeeds(run("boards", "--show", board["name"])))
            self.assertEqual(board["file"].splitlines()[0], f"# {board['description']}")
        self.assertEqual(self.document("boards", "--show", "two-banks")["boards"],
                         [board for board in boards if board["name"] == "two-banks"])

    def test_check_lists_the_problems_with_place_key_value_and_rule(self):
        text = ("extends: fpl2003\nname: a\nmatcher:\n  window: 6\n  cost: {census: 4}\nfoo: 1\nimage: "
                "{width: [1, 2]}\n")
        board = self.file("board.yaml", text)
        arguments = ["check", board, *sets("allocation.left_lut=bank9")]
        printed = run(*arguments)
        process = run(*arguments, "--json")
        self.assertEqual((process.returncode, process.stderr), (2, ""))
        document = self.valid("check", process.stdout)
        self.assertFalse(document["ok"])
        lines = [f"{problem['place']}: {problem['message']}" for problem in document["problems"]]
        self.assertEqual(lines, printed.stderr.splitlines())
        problems = {problem.get("key"): problem for problem in document["problems"]}
        expected = {"place": f"{board}:4:11", "key": "matcher.window", "value": "6", "rule": "3..31, odd",
                    "message": "matcher.window = 6: 3..31, odd"}
        self.assertEqual(problems["matcher.window"], expected)
        self.assertEqual(problems["allocation.left_lut"]["place"], "--set allocation.left_lut")

    def test_check_lists_more_problems_than_its_text_and_those_of_other_files(self):
        wrong = [f"ssram.banks.bank{bank}.{key}=0" for bank in range(8) for key in ("words", "kind", "depth")]
        process = run("check", "fpl2003", *sets(*wrong), "--calibration", "none.yaml", "--json")
        self.assertEqual(process.returncode, 2)
        problems = self.valid("check", process.stdout)["problems"]
        self.assertGreater(len(problems), 20)
        self.assertEqual(problems[-1]["place"], "command line")
        self.assertIn("--calibration", problems[-1]["message"])

    def test_a_refused_command_prints_no_document(self):
        for command in ("bounds", "explain", "conflicts", "run"):
            self.refused(run(command, "fpl2003", "--json", *sets("matcher.window=6")), "matcher.window = 6")
        self.refused(run("check", "--json"), "BOARD: missing")


if __name__ == "__main__":
    program.main()
