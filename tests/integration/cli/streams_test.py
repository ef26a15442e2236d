"""Notes, progress and colours: what --quiet leaves out, and where there are colours."""

import os
import re

import program
from program import CYCLE, PRELOADED, SMALL, ProgramTest, Terminal, run, sets

SCENE = [*SMALL, *PRELOADED, "--synthetic", "1"]
RED, GREEN, YELLOW, DIM = (f"\x1b[{code}m" for code in ("31", "32", "33", "2"))
END = "\x1b[0m"
WRONG = ["run", "fpl2003", *sets("matcher.window=6")]


def environment(**changes):
    plain = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "TERM")}
    return {**plain, "TERM": "xterm", **changes}


class Quiet(ProgramTest):
    def test_notes_are_left_out_and_results_and_errors_stay(self):
        command = ["run", "fpl2003", *SCENE, "--verify"]
        said, quiet = run(*command), run(*command, "--quiet")
        self.assertIn("note: verified", said.stderr)
        self.assertEqual(quiet.stderr, "")
        self.assertEqual(self.succeeds(quiet), self.succeeds(said))
        self.assertIn("note: a complete command", run(*WRONG).stderr)
        lines = self.refused(run(*WRONG, "--quiet"), "error: pictures: missing", "matcher.window = 6")
        self.assertEqual(len(lines), 2)

    def test_every_command_takes_it(self):
        commands = re.findall(r"(?m)^  ([a-z]+) ", run("--help").stdout.split("Commands:")[1])
        self.assertGreater(len(commands), 10)
        for command in commands:
            self.assertIn("--quiet", run(command, "--help").stdout, command)

    def test_no_progress_is_shown(self):
        for command in (["run", "fpl2003", *SCENE, *CYCLE, "--frames", "100"],
                        ["conflicts", "fpl2003", *SCENE, *CYCLE, "--frames", "100"]):
            terminal = Terminal([*command, "--quiet"], env=environment())
            self.assertEqual(terminal.finish()[0], 0)
            self.assertEqual(terminal.text, "")

    def test_conflicts_shows_its_progress(self):
        terminal = Terminal(["conflicts", "fpl2003", *SCENE, *CYCLE, "--frames", "20000"], env=environment())
        terminal.read_until(r"\d+/20000 frames simulated")
        terminal.process.kill()
        terminal.finish()


class Colours(ProgramTest):
    def shown(self, **variables):
        terminal = Terminal(WRONG, columns=200, env=environment(**variables))
        self.assertEqual(terminal.finish()[0], 2)
        return terminal.text

    def test_the_kind_of_a_message_is_coloured_on_a_terminal(self):
        text = self.shown()
        self.assertIn(f"stereotlm: {RED}error:{END} pictures: missing", text)
        self.assertIn(f"stereotlm: {DIM}note:{END} a complete command", text)
        self.assertEqual(text, self.shown(NO_COLOR=""))

    def test_there_is_none_with_no_color_or_a_dumb_terminal_or_a_pipe(self):
        for variables in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
            text = self.shown(**variables)
            self.assertNotIn("\x1b", text)
            self.assertIn("stereotlm: error: pictures: missing", text)
        self.assertNotIn("\x1b", run(*WRONG, env=environment()).stderr)

    def test_the_sentence_of_diff_is_coloured_on_a_terminal(self):
        folders = [self.folder / name for name in ("a", "b")]
        for folder, *options in zip(folders, ("7", "5")):
            window = sets(f"matcher.window={options[0]}")
            self.succeeds(run("run", "fpl2003", *SCENE, *window, "--out", folder))
        plain = self.succeeds(run("diff", *folders, env=environment()))
        self.assertNotIn("\x1b", plain)
        coloured = self.on_terminal(["diff", *folders], environment())
        self.assertIn(f"B {GREEN}is faster{END} by", coloured)
        self.assertIn(f"{YELLOW}differ.{END}", " ".join(coloured.split()))
        self.assertEqual(re.sub(r"\x1b\[\d+m", "", coloured), plain)
        self.assertEqual(self.on_terminal(["diff", *folders], environment(NO_COLOR="1")), plain)

    def on_terminal(self, arguments, env):
        """What the command writes to standard output that is a terminal."""
        terminal = Terminal(arguments, env=env, stdout_too=True)
        self.assertEqual(terminal.finish()[0], 0)
        return terminal.text.replace("\r\n", "\n")


if __name__ == "__main__":
    program.main()
