"""The option --json: documents that keep their schemas, with the numbers of the text."""

import json
import os
import pathlib
import re

import jsonschema

import program
from program import PRELOADED, SMALL, ProgramTest, run, sets

SCHEMAS = pathlib.Path(__file__).parents[3] / "sw" / "cli" / "schemas"
SHARED = sets("allocation.left_lut=bank0")


class Json(ProgramTest):
    def both(self, command, *arguments):
        """The document, which keeps its schema, and the text."""
        process = run(command, *arguments, "--json")
        self.assertEqual(process.stderr, "")
        return self.valid(command, self.succeeds(process)), self.succeeds(run(command, *arguments))

    def valid(self, command, text):
        schema = json.loads((SCHEMAS / f"{command}.schema.json").read_text())
        jsonschema.Draft202012Validator.check_schema(schema)
        document = json.loads(text)
        jsonschema.Draft202012Validator(schema).validate(document)
        return document

    def test_names_that_are_not_utf_8_are_shown_with_a_replacement(self):
        self.file(os.fsdecode(b"b\xff.yaml"), "extends: fpl2003\nname: other\n")
        for name, status in ((b"./b\xff.yaml", 0), (b"./none\xff.yaml", 2)):
            process = run("check", os.fsdecode(name), "--json", cwd=self.folder)
            self.assertEqual((process.returncode, process.stderr), (status, ""))
            self.assertEqual(self.valid("check", process.stdout)["board"], name.decode(errors="replace"))

    def test_bounds_has_the_numbers_of_its_text(self):
        for board, *options in (("fpl2003", *SHARED), ("fpl2003-no-calibration",), ("megapixel-pci64",)):
            document, text = self.both("bounds", board, *options)
            lines = []
            for group in document["frames"]:
                for row in group["resources"]:
                    name = f"bank {', '.join(row['banks'])}" if "banks" in row else row["resource"]
                    lines.append(f"{name} {row['cycles']} {row['frames_per_second']:.3f} {row['headroom_percent']:.2f}")
            lines += [f"{row['resource']} {row['frames_per_second']:.3f}" for row in document["computer"]]
            columns = ("name", "count", "luts", "flip_flops", "block_rams", "multipliers")
            area = document["area"]
            lines += [" ".join(str(part[key]) for key in columns) for part in area["parts"]]
            printed = [" ".join(line.split()) for line in text.splitlines() if line.startswith("  ")]
            heads = ("resource ", "parts ", "all ")
            self.assertEqual(lines, [line for line in printed if not line.startswith(heads)])
            bound = document["bound"]
            for of in ("core", "system"):
                self.assertIn(f"bound of the {of}: {bound[of]:.3f} frames/s, limited by {bound[of + '_limited_by']}\n", text)
            self.assertIn(f"core: {area['slices']} of", text)
            self.assertEqual(area["fits"], "does not fit" not in text)

    def test_explain_has_the_numbers_of_its_text(self):
        document, text = self.both("explain", "fpl2003", *SMALL, *PRELOADED, *SHARED)
        now = document["frames_per_second"]
        bound = document["bound"]
        limit = f"bound {bound['frames_per_second']:.3f}, limited by {bound['limited_by']}"
        self.assertIn(f"fpl2003, the core alone: {now:.3f} frames/s ({document['frames']} frames); {limit}\n", text)
        for row in document["resources"]:
            *_, name = row["resource"].split()
            in_frame = f", in frame {row['frame']} of 2" if "frame" in row else ""
            numbers = rf"{row['headroom_percent']:.2f} +{row['frames_per_second']:.3f}"
            self.assertRegex(text, rf"(?m)^ +{numbers}  .*\b{name}\b.*{in_frame}$")
        for row in document["blame"]:
            percent = f"{row['cycles_percent']:.3f}"
            self.assertRegex(text, rf"\n  {row['port']} +on {row['bank']} +for {row['by']} +{percent}\n")
        shown = 0
        for row in document["changes"]:
            saved = {key: row["area"][key] - document["area"][key] for key in row["area"]}
            saves = min(saved[f"{part}_percent"] for part in ("slices", "block_rams", "multipliers")) <= -1
            if abs(row["gained_percent"]) < 0.1 and not saves and row["key"] != "a bank less":
                self.assertNotIn(f"  {row['key']}: {row['from']} -> {row['to']}\n", text)
                continue
            of_slices = f"{saved['slices_percent']:+.2f}" if saved["slices"] else "0"
            price = [of_slices, f"{saved['block_rams']:+}" if saved["block_rams"] else "0"]
            gained = f"{row['gained_frames_per_second']:+.3f} {row['gained_percent']:+.2f}"
            mark = " *" if row["changes_disparities"] else ""
            change = f"{row['key']}{mark}: {row['from']} -> {row['to']}"
            line = f"{row['frames_per_second']:.3f} {gained} {' '.join(price)} {change}"
            self.assertIn(f" {line}", re.sub(" +", " ", text))
            shown += 1
        self.assertGreater(shown, 10)
        self.assertEqual((document["impossible"], document["failed"]), ([], []))

    def test_explain_names_what_is_impossible_and_a_queue_that_is_too_short(self):
        short = sets("matcher.rows=4", "matcher.disparities=4", "fpga.result_fifo_words=4")
        document, text = self.both("explain", "fpl2003", *SMALL, *PRELOADED, *short)
        self.assertIn(f"in {document['result_queue_wait_percent']:.2f} % of the cycles", text)
        change = document["impossible"][0]
        words = f"not possible here: {change['key']}: {change['from']} -> {change['to']}, because {change['reason']}"
        self.assertIn(words, re.sub(r"\n  ", " ", text))

    def test_conflicts_has_the_numbers_of_its_text(self):
        options = [*SMALL, *PRELOADED, *SHARED, "--synthetic", 1, "--frames", 2]
        document, text = self.both("conflicts", "fpl2003", *options)
        self.assertIn(f"core         {document['cycles']} cycles in {document['frames']} frames\n", text)
        self.assertEqual(len(document["waits"]), text.count("\nwaits "))
        for row in document["waits"]:
            wait = f"{row['port']} on {row['bank']} for {row['by']}: {row['cycles']} cycles ({row['cycles_percent']:.2f} %)"
            self.assertIn(f"waits        {wait}", text)
        lines = []
        for row in document["rows"]:
            name = f"{row['first_row']}..{row['last_row']}" if "first_row" in row else "fill"
            banks = [f"{bank['accesses_percent']:.2f}" for bank in row["banks"]]
            lines.append(" ".join([name, f"{row['waits_percent']:.2f}", *banks]))
        printed = text.split("rows  ")[1].splitlines()[1:]
        self.assertEqual(lines, [" ".join(line.split()) for line in printed])

    def test_check_lists_the_problems_with_place_key_value_and_rule(self):
        text = "extends: fpl2003\nname: a\nmatcher:\n  window: 6\n  cost: {census: 4}\nfoo: 1\nimage: {width: [1, 2]}\n"
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

    def test_check_describes_a_board_without_problems(self):
        document, text = self.both("check", "fpl2003", *SMALL)
        image = document["image"]
        board = f"{image['width']}x{image['height']}, window {document['window']}x{document['window']}, "
        core = f"{document['disparities']} disparities, {document['banks']} banks, {document['clock_mhz']} MHz"
        self.assertEqual(text, f"fpl2003: ok: {board}{core}\n")
        self.assertTrue(document["ok"])

    def test_a_refused_command_prints_no_document(self):
        for command in ("bounds", "explain", "conflicts"):
            self.refused(run(command, "fpl2003", "--json", *sets("matcher.window=6")), "matcher.window = 6")
        self.refused(run("check", "--json"), "BOARD: missing")


if __name__ == "__main__":
    program.main()
