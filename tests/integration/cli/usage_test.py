"""Help, and every way to use the command line wrongly."""

import program
from pictures import pgm
from program import PRELOADED, ProgramTest, run

COMMANDS = "run check boards keys bounds explain calibrate sweep merge allocate plot diff paper".split()
UNBUILT_COMMANDS = ["report"]
UNBUILT_OPTION_OF_RUN = ["--trace", "vcd"]
OPTIONS_OF_RUN = (
    "BOARD,--left,--right,--sequence,--video F [F2],--video-layout,--synthetic,--frames,--truth,"
    "--truth-scale,--set,--out,--save-frames,--fidelity fast|cycle,--timing-only,--verify,--trace,default 1"
)
NO_INTEGERS = ("-1", "1.5", "x", "", "18446744073709551616")


class Help(ProgramTest):
    def test_of_the_program_names_every_command_and_the_exit_statuses(self):
        for option in ("--help", "-h"):
            text = self.succeeds(run(option))
            for part in [*COMMANDS, *UNBUILT_COMMANDS, "Exit status: 0"]:
                self.assertIn(part, text)

    def test_of_run_names_its_options_and_defaults(self):
        text = self.succeeds(run("run", "--help"))
        for part in OPTIONS_OF_RUN.split(","):
            self.assertIn(part, text)

    def test_of_each_command_says_how_to_use_it_in_104_columns(self):
        for command in ([], *([command] for command in COMMANDS)):
            text = self.succeeds(run(*command, "--help"))
            self.assertIn(" ".join(["Usage: stereotlm", *command]), text)
            for line in text.splitlines():
                self.assertLessEqual(len(line), 104, line)

    def test_names_the_version(self):
        self.assertRegex(self.succeeds(run("--version")), r"^stereotlm \d+\.\d+\.\d+\n$")


class Refusals(ProgramTest):
    def test_of_commands(self):
        self.all_refused([
            ([], "a command is missing", f"{', '.join(COMMANDS[:-1])} or {COMMANDS[-1]}"),
            ([""], "a command is missing"),
            (["bound", "fpl2003"], "'bound': unknown command; nearest: bounds"),
            (["--bogus"], "'--bogus': a command comes first"),
            (["--"], "'--': a command comes first"),
            (["--frames", "1", "run", "fpl2003"], "'--frames': a command comes first"),
        ])

    def test_of_commands_and_options_that_are_not_in_this_version(self):
        for command in UNBUILT_COMMANDS:
            for rest in ([], ["fpl2003"], ["--help"], ["--out", "a", "b", "--bogus", "3"]):
                self.refused_in_one_line(run(command, *rest), f"error: {command}: not in this version")
        text = "error: --trace: not in this version"
        for arguments in (UNBUILT_OPTION_OF_RUN, UNBUILT_OPTION_OF_RUN[:1]):
            self.refused_in_one_line(run("run", "fpl2003", *arguments), text)
        self.refused_in_one_line(self.run_small(*UNBUILT_OPTION_OF_RUN), text)

    def test_of_unknown_options_name_the_nearest(self):
        for command in COMMANDS:
            self.refused_in_one_line(run(command, "--bogus"), "--bogus", f"stereotlm {command} --help")
        nearest = {"--fames": "--frames", "--rigth": "--right", "--sett": "--set", "--verfy": "--verify"}
        for wrong, right in {**nearest, "--timing-onyl": "--timing-only"}.items():
            text = f"stereotlm: error: {wrong}: unknown option; nearest: {right} (see stereotlm run --help)"
            run_it = ["run", "fpl2003"]
            self.all_refused([([*run_it, wrong, "3"], text), ([*run_it, f"{wrong}=3"], text)])
        lines = self.refused(run("run", "fpl2003", "--fames", "3", "--out", "a", "--verfy"))
        self.assertEqual([line.split()[2] for line in lines], ["--fames:", "--verfy:"])

    def test_of_too_many_arguments_and_options_without_value_or_given_twice(self):
        self.refused_in_one_line(run("check", "fpl2003", "fpl2003-qvga"), "fpl2003-qvga")
        self.refused_in_one_line(run("keys", "fpl2003"), "fpl2003")
        for option in ("--left", "--frames", "--out", "--source", "--set"):
            self.refused_in_one_line(run("run", "fpl2003", option), option)
            if option != "--set":
                self.refused_in_one_line(run("run", "fpl2003", option, "1", option, "1"), option)

    def test_of_boards(self):
        for command in ("run", "check", "bounds"):
            self.refused(run(command), "stereotlm: error: BOARD: missing")
        self.refused_in_one_line(run("check", "keys"), "keys: not a preset")  # nor a command

    def test_of_wrong_values_name_the_rule(self):
        truth = [*self.pair, "--truth", self.left]
        for before, option, rule, *values in (
            (self.pair, "--source", "camera or preloaded", "foo", "Preloaded", ""),
            (self.pair, "--fidelity", "fast or cycle", "foo", "Preloaded", ""),
            (self.pair, "--frames", "an integer, 1 or more", "0", "+1", " 1", "1e3", "0x10", *NO_INTEGERS),
            (truth, "--truth-scale", "a number above 0", "0", "-1", "nan", "inf", "x", "", "1e400", "2x"),
            ([], "--synthetic", "an integer, 0..2^64-1", *NO_INTEGERS),
            (["--video", "a"], "--video-layout", "two, side_by_side or top_bottom", "three", "", "Two"),
        ):
            run_it = ["run", "fpl2003", *before, option]
            self.all_refused(([*run_it, value], f"{option} = {value}: must be {rule}") for value in values)

    def test_of_options_that_do_not_go_together(self):
        one_source = "a run has one source of pictures: --left F"
        no_disparities = "does not go with --timing-only, which has no disparities"
        pair, timing, saved = self.pair, [*self.pair, "--timing-only"], ["--save-frames", "--out", self.out]
        sequence, synthetic = ["--sequence", self.folder], ["--synthetic", "1"]
        video = ["--video", self.left, "--video-layout", "side_by_side"]
        one, two = ["--video", "a", "--video-layout"], ["--video", "a", "b", "--video-layout"]
        self.all_refused([
            (pair + sequence, f"error: --left, --sequence: {one_source}"),
            (pair + synthetic, f"error: --left, --synthetic: {one_source}"),
            (sequence + video, f"error: --sequence, --video: {one_source}"),
            (pair + sequence + video + synthetic, f"--left, --sequence, --video, --synthetic: {one_source}"),
            (one[:2], "--video-layout: missing: goes with --video, one of two, side_"),
            ([*pair, "--video-layout", "two"], "--video-layout: goes with --video F [F2]"),
            ([*one, "two"], "--video 'a': must name two files with --video-layout two"),
            ([*two, "side_by_side"], "--video 'a' 'b': must name one file with --video-layout side_by_side"),
            ([*two, "top_bottom"], "--video 'a' 'b': must name one file with --video-layout top_bottom"),
            ([*pair, "--truth-scale", "2"], "--truth-scale: goes with --truth F"),
            ([*synthetic, "--truth", "t"], "does not go with --synthetic, whose scene is its own truth"),
            ([*timing, "--truth", self.left], f"--truth: {no_disparities}"),
            ([*timing, *saved], f"--save-frames: {no_disparities}"),
            ([*pair, "--save-frames"], "--save-frames: goes with --out DIR"),
        ], self.run_with)
        self.refused(self.run_with("--video", "a", "b", "c", "--video-layout", "two"))
        self.assertFalse(self.out.exists())


class Missing(ProgramTest):
    def missing(self, *arguments):
        """What is said to be missing; the last line shows a complete command."""
        *lines, example = self.refused(run("run", *arguments))
        command = r"stereotlm run fpl2003 .*--left \S+ --right \S+"
        self.assertRegex(example, rf"^stereotlm: note: a complete command: {command}$")
        return [line.split(": ")[2] for line in lines if ": missing: " in line]

    def test_parts_of_a_run_are_named_all_at_once(self):
        left, right = self.pair[:2], self.pair[2:]
        for arguments, missing in (
            ([], ["BOARD", "pictures"]),
            (["fpl2003", *PRELOADED], ["pictures"]),
            (["fpl2003", *PRELOADED, *left], ["--right"]),
            (["fpl2003", *PRELOADED, *right], ["--left"]),
            (["--timing-only"], ["BOARD"]),
            (["fpl2003", "--timing-only", *left], ["--right"]),
        ):
            self.assertEqual(self.missing(*arguments), missing)
        sources = "--left F --right F, --sequence DIR, --video F [F2] or --synthetic SEED"
        self.refused(self.run_with(), f"error: pictures: missing: a run needs {sources}")
        self.assertNotIn("complete command", run("run", "fpl2003", "--left", "a", "--right", "b").stderr)

    def test_the_complete_command_is_one(self):
        example = self.refused(run("run"))[-1].split(": ")[-1].split()
        self.assertEqual(example.pop(0), "stereotlm")
        for name in ("left.png", "right.png"):
            self.file(name, pgm(640, 480, bytes(640 * 480)))
        self.succeeds(run(*example, "--set", "matcher.window=3", cwd=self.folder))


if __name__ == "__main__":
    program.main()
