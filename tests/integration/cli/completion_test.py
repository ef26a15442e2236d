"""Completion of the program in bash: what it offers at each place, from the files that are installed."""
import pathlib
import subprocess
import tempfile
import unittest

from program import PROGRAM

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "sw/cli/completion.py"


class Completion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run([SCRIPT, PROGRAM, cls.folder.name], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def offers(self, *words):
        """What bash offers for the last of these words."""
        file = pathlib.Path(self.folder.name) / "stereotlm.bash"
        text = """source "$1"; shift
            compopt() { :; }  # exists only while the user types
            COMP_WORDS=(stereotlm "$@"); COMP_CWORD=$#
            _stereotlm
            printf "%s\\n" "${COMPREPLY[@]}" """
        said = subprocess.run(["bash", "-c", text, "bash", str(file), *words], check=True, text=True,
                              cwd=self.folder.name, stdout=subprocess.PIPE).stdout
        return said.split()

    def test_commands(self):
        self.assertEqual(self.offers("r"), ["run", "report", "rtl"])
        self.assertIn("--version", self.offers("--"))

    def test_boards_and_files(self):
        self.assertEqual(self.offers("run", "two-banks"), ["two-banks", "two-banks-four-rows"])
        self.assertEqual(self.offers("run", "stereo"), ["stereotlm.bash", "stereotlm.fish"])

    def test_options_of_the_command(self):
        self.assertEqual(self.offers("run", "fpl2003", "--timing"), ["--timing-only"])
        self.assertEqual(self.offers("merge", "--timing"), [])

    def test_keys(self):
        self.assertIn("matcher.disparities=", self.offers("run", "fpl2003", "--set", "matcher.d"))

    def test_every_shell_has_every_command_and_option(self):
        for name in ("_stereotlm", "stereotlm.fish", "stereotlm.bash"):
            text = (pathlib.Path(self.folder.name) / name).read_text()
            for word in ("allocate", "diagram", "keep-fps", "video-layout", "eight-banks-four-lanes"):
                self.assertIn(word, text, name)


if __name__ == "__main__":
    unittest.main()
