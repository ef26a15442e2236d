"""JSON Schemas of board files and plans: they say what the program says."""

import copy
import itertools
import json
import os
import re
import sys

import jsonschema
import yaml

import program
from program import PROGRAM, ProgramTest, run, sets
from tracked_files import ROOT, tracked

os.environ["STEREOTLM_PROGRAM"] = PROGRAM
sys.path.insert(0, str(ROOT / "sw" / "python"))
import stereotlm  # noqa: E402
from stereotlm.board import _yaml  # noqa: E402


class Loader(yaml.SafeLoader):
    """YAML 1.2, in which `off` is a text, as in board files and editors."""


Loader.yaml_implicit_resolvers = {
    first: [(tag, form) for tag, form in rules if tag != "tag:yaml.org,2002:bool"]
    for first, rules in yaml.SafeLoader.yaml_implicit_resolvers.items()}

VALUES = [
    -1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 15, 16, 17, 31, 32, 33, 64, 100, 127, 254, 255, 256, 1000, 1001,
    1024, 1025, 2048, 2049, 4096, 4097, 16384, 65536, 65537, 1048576, 2097153, 10**9, 10**10, 0.05, 0.5,
    1.5, 999.5, "", "x", "7", "none", "off", "all", "log7", "sad", "zncc", "bank0", "sdram", "joint",
    "word", "xc2v6000", "ff1152", "9bank", [], ["bank0"], ["bank0", "bank1", "bank2"], ["bank0"] * 4,
    [["bank0"]], {}, {"census": 5}, {"census": 6}, {"rows": ["bank0", "bank1"]}, {"rows": ["bank0",
    "bank0"]}, {"rows": ["bank0"]}, [{"rows": ["bank0", "bank1"]}], {"kernel": [[1, 0, 0], [0, -1, 0], [0,
    0, 0]], "shift": 3}, {"kernel": [[0, 0, 99999]] * 3, "shift": 3}, {"shift": 3}, {"kernel": [[0, 0, 0]]
    * 3, "shift": 33}, {"burst_words": 8, "interval_us": 1.5}, {"burst_words": 8}, {"words": 64, "kind":
    "sdram"}, {"bank0": {}}, {"none": {}}, {"bank0": {"words": -4}}, ["result", "left_pixel",
    "right_pixel", "left_lut", "right_lut", "host"], ["result", "host"],
]


def schema(name):
    return json.loads(run("keys", "--schema", name).stdout)


def nested(paths):
    """{"image.width": 8} as {"image": {"width": 8}}."""
    tree = {}
    for path, value in paths.items():
        *sections, name = path.split(".")
        section = tree
        for each in sections:
            section = section.setdefault(each, {})
        section[name] = value
    return tree


class Schemas(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.schemas = {name: schema(name) for name in ("board", "plan")}
        for each in cls.schemas.values():
            jsonschema.Draft202012Validator.check_schema(each)

    def is_valid(self, name, document):
        return jsonschema.Draft202012Validator(self.schemas[name]).is_valid(document)

    def test_files_of_the_project_are_valid(self):
        files = [("board", path) for path in tracked("platform/boards/*.yaml")]
        files += [("plan", path) for path in tracked("results/*/*.yaml")]
        self.assertGreater(len(files), 30)
        for name, path in files:
            document = yaml.load(path.read_text(), Loader)
            errors = jsonschema.Draft202012Validator(self.schemas[name]).iter_errors(document)
            self.assertEqual([error.message for error in errors], [], path)

    @program.slow
    def test_a_value_is_valid_if_the_program_takes_it(self):
        """Each key with many values: the schema refuses those that break the rule of the key, no other."""
        base = yaml.load(self.succeeds(run("boards", "--show", "fpl2003")), Loader)
        parts = ("extends", "matcher.filter.", "matcher.cost.", "pci.load.")  # of other values
        keys = [key.replace("NAME", "bank3") for key in stereotlm.keys().key if not key.startswith(parts)]
        keys += ["ssram.banks", "ssram.banks.bank3", "image"]
        verdicts = {True: 0, False: 0}
        for key, value in itertools.product(keys, VALUES):
            board = copy.deepcopy(base)
            *sections, name = key.split(".")
            section = board
            for each in sections:
                section = section.setdefault(each, {})
            section[name] = value
            try:
                stereotlm.execute("check", "fpl2003", *sets(f"{key}={_yaml(value, key)}"), "--json")
                problems = []
            except stereotlm.Refused as refused:
                problems = refused.problems
            if any(re.search("sum must be 0|as many as there are rows", each.rule) for each in problems):
                continue  # beyond a schema
            of_key = [problem for problem in problems if not problem.between_keys]
            is_valid = self.is_valid("board", board)
            verdicts[is_valid] += 1
            # That -1 is not the name of a bank is, for the program, a rule between keys.
            self.assertFalse(of_key if is_valid else not problems, (key, value, is_valid, problems))
        self.assertGreater(min(verdicts.values()), 500, verdicts)

    def test_a_board_without_a_preset_must_be_whole(self):
        whole = yaml.load(self.succeeds(run("boards", "--show", "fpl2003")), Loader)
        self.assertTrue(self.is_valid("board", whole))
        self.assertTrue(self.is_valid("board", {"extends": "fpl2003", "matcher": {"window": 5}}))
        self.assertFalse(self.is_valid("board", {"extends": "fpl2004"}))
        self.assertFalse(self.is_valid("board", {"matcher": {"window": 5}}))
        optional = {key["key"] for key in json.loads(self.succeeds(run("keys", "--json")))["keys"]
                    if "optional" in key["meaning"] or "optional" in key["range"]}
        for section, keys in whole.items():
            for key in keys if isinstance(keys, dict) else []:
                less = copy.deepcopy(whole)
                del less[section][key]
                self.assertEqual(self.is_valid("board", less), f"{section}.{key}" in optional, (section, key))
            less = {name: value for name, value in whole.items() if name != section}
            self.assertFalse(self.is_valid("board", less), section)

    def test_plans(self):
        for plan, is_valid in (
                ({"board": "fpl2003", "vary": {"matcher.window": [5, 7]}}, True),
                ({"board": "fpl2003", "vary": {"matcher.window": [5, 6]}}, False),
                ({"board": "fpl2003", "vary": {"matcher.window": {"from": 5, "to": 9, "step": 2}}}, True),
                ({"board": "fpl2003", "vary": {"matcher.window": {"from": 5, "to": 9}}}, False),
                ({"board": "fpl2003", "vary": {"matcher.window": 5}}, False),
                ({"board": "fpl2003", "vary": {"run.source": ["camera"], "run.frames": [4]}}, True),
                ({"board": "fpl2003", "set": {"run.frames": 4}}, False),
                ({"board": "fpl2003", "set": {"ssram.banks.B2.words": 64, "matcher.units": "all"}}, True),
                ({"board": "fpl2003", "set": {"ssram.banks.none.words": 1024}}, False),
                ({"board": "fpl2003", "set": {"matcher.windw": 5}}, False),
                ({"board": "fpl2003", "zip": [{"matcher.window": [5], "matcher.rows": [2]}]}, True),
                ({"board": "fpl2003", "where": "matcher.window < 9"}, True),
                ({"board": "fpl2003", "where": 1}, True),
                ({"board": "fpl2003", "vary": {"image": [{"width": 64, "height": 48}]}}, True),
                ({"board": "fpl2003", "vary": {"image": [{"width": 64}]}}, False),
                ({"board": "fpl2003", "sample": {"points": 5}}, False),
                ({"board": "fpl2003", "run": {"source": "preloaded", "frames": 6}, "where": ["1"]}, True),
                ({"board": "fpl2003", "run": {"source": "cameras"}}, False),
                ({"vary": {"matcher.window": [5]}}, False)):
            self.assertEqual(self.is_valid("plan", plan), is_valid, plan)

    def test_options(self):
        self.all_refused([(["keys", "--schema", "sweep"],
                           "--schema = sweep: must be board, plan, allocate, boards, bounds, check, "
                           "conflicts, diff, explain, keys, optimise or run"),
                          (["keys", "--schema", "plan", "--json"], "--schema: does not go with --json")])


if __name__ == "__main__":
    program.main()
