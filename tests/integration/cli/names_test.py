"""Banks with the names of parts of the model: outputs are those of a board with the usual names."""

import re
import sqlite3

import program
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run

NAMES = ["matcher", "camera", "pci", "bridge", "Core", "host", "left_lut", "local-bus"]
SCENE = ["--synthetic", 1, "--frames", 2]


def replaced(text, before=""):
    return re.sub(r"\bbank([0-7])\b", lambda found: before + NAMES[int(found[1])], text)


def words(text, for_shell):
    return " ".join(line for line in text.splitlines() if for_shell == ("--set" in line)).split()


class Names(ProgramTest):
    def outputs(self, command, *options):
        """Of a board, and of one with NAMES, which is written into self.folder / "odd"."""
        board = self.succeeds(run("boards", "--show", "fpl2003")).replace("lut: bank6", "lut: bank0")
        both = []
        for folder, text in (("plain", board), ("odd", replaced(board))):
            (self.folder / folder).mkdir(exist_ok=True)
            (self.folder / folder / "board.yaml").write_text(text)
            both.append(self.succeeds(run(command, "board.yaml", *SMALL, *options, cwd=self.folder / folder)))
        return both

    def test_are_told_from_parts_in_texts(self):
        for command, *options in (["run", *PRELOADED, *SCENE], ["run", *CAMERA_RATES, *SCENE], ["bounds"],
                                  ["explain", *PRELOADED], ["conflicts", *PRELOADED, *SCENE],
                                  ["allocate", *PRELOADED, "--banks", 3, "--out", "boards.db"]):
            plain, odd = self.outputs(command, *options)
            self.assertIn("bank0", plain)
            self.assertEqual(words(odd, False), words(replaced(plain, "bank "), False), command)
            self.assertEqual(words(odd, True), words(replaced(plain), True), command)

    def test_stay_in_json_and_databases(self):
        for command, *options in (["run", *PRELOADED, *SCENE], ["bounds"], ["conflicts", *PRELOADED, *SCENE]):
            plain, odd = self.outputs(command, *options, "--json")
            self.assertEqual(odd, replaced(plain), command)
        self.outputs("run", *PRELOADED, "--timing-only", "--trace", "sqlite:run.db")
        waits = sqlite3.connect(self.folder / "odd" / "run.db").execute("SELECT bank FROM runs WHERE by > ''")
        self.assertEqual({bank for bank, in waits}, {"matcher"})

    def test_are_told_from_parts_in_drawings_and_traces(self):
        self.outputs("run", *SCENE, *PRELOADED, "--trace", "perfetto:run.perfetto", "--trace", "vcd:run.vcd",
                     "--trace-window", "frame=0,rows=3..4")
        self.outputs("diagram", "--out", "chart.svg")
        for name, texts in {"run.perfetto": ["for left_pixel on bank matcher", "bank pci use"],
                            "run.vcd": ["sbank_matcher ", "$scope module bank_local-bus "],
                            "chart.svg": [f">bank {bank}</text>" for bank in NAMES[:6]]}.items():
            found = (self.folder / "odd" / name).read_bytes()
            for text in texts:
                self.assertTrue(text.encode() in found, (name, text))


if __name__ == "__main__":
    program.main()
