"""Help, and every way to use the command line wrongly."""

import program
from program import PRELOADED, ProgramTest, pgm, run

COMMANDS = ["run", "check", "boards", "keys", "bounds", "explain", "calibrate", "sweep", "merge", "allocate", "plot", "diff", "paper"]
UNBUILT_COMMANDS = ["report"]
UNBUILT_RUN_OPTIONS = [["--trace", "vcd"]]


class Help(ProgramTest):
    def test_of_the_program_names_every_command_and_the_exit_statuses(self):
        for option in ("--help", "-h"):
            text = self.succeeds(run(option))
            for command in COMMANDS + UNBUILT_COMMANDS:
                self.assertIn(command, text)
            self.assertIn("Exit status: 0", text)

    def test_of_a_command_names_its_options_and_defaults(self):
        text = self.succeeds(run("run", "--help"))
        for option in ("BOARD", "--left", "--right", "--sequence", "--video F [F2]", "--video-layout", "--synthetic"):
            self.assertIn(option, text)
        for option in ("--frames", "--truth", "--truth-scale", "--set", "--out", "--save-frames", "--fidelity fast|cycle"):
            self.assertIn(option, text)
        for option in ("--timing-only", "--verify"):
            self.assertIn(option, text)
        self.assertIn("default 1", text)
        for option in UNBUILT_RUN_OPTIONS:
            self.assertIn(option[0], text)
        for command in COMMANDS:
            self.assertIn(f"Usage: stereotlm {command}", self.succeeds(run(command, "--help")))

    def test_fits_into_a_hundred_columns(self):
        for arguments in [[]] + [[command] for command in COMMANDS]:
            for line in self.succeeds(run(*arguments, "--help")).splitlines():
                self.assertLessEqual(len(line), 104, line)

    def test_version(self):
        self.assertRegex(self.succeeds(run("--version")), r"^stereotlm \d+\.\d+\.\d+\n$")


class UnknownThings(ProgramTest):
    def test_a_command_is_needed(self):
        self.refused_in_one_line(run(), "a command is missing", f"{', '.join(COMMANDS[:-1])} or {COMMANDS[-1]}")

    def test_an_unknown_command_names_the_nearest(self):
        self.refused_in_one_line(run("bound", "fpl2003"), "'bound': unknown command; nearest: bounds")

    def test_the_command_comes_first(self):
        for arguments in (["--bogus"], ["--"], ["--frames", "1", "run", "fpl2003"]):
            self.refused_in_one_line(run(*arguments), f"'{arguments[0]}': a command comes first")
        self.refused_in_one_line(run(""), "a command is missing")

    def test_unknown_options(self):
        for command in COMMANDS:
            self.refused_in_one_line(run(command, "--bogus"), "--bogus", f"stereotlm {command} --help")

    def test_unknown_options_name_the_nearest(self):
        for typed, nearest in (("--fames", "--frames"), ("--rigth", "--right"), ("--sett", "--set"), ("--verfy", "--verify"), ("--timing-onyl", "--timing-only")):
            for arguments in ([typed, "3"], [f"{typed}=3"]):
                self.refused_in_one_line(
                    run("run", "fpl2003", *arguments),
                    f"stereotlm: error: {typed}: unknown option; nearest: {nearest} (see stereotlm run --help)",
                )
        lines = self.refused(run("run", "fpl2003", "--fames", "3", "--out", "a", "--verfy"))
        self.assertEqual([line.split()[2] for line in lines], ["--fames:", "--verfy:"])

    def test_more_arguments_than_a_command_takes(self):
        self.refused_in_one_line(run("check", "fpl2003", "fpl2003-qvga"), "fpl2003-qvga")
        self.refused_in_one_line(run("keys", "fpl2003"), "fpl2003")

    def test_an_option_without_its_value_or_twice(self):
        for option in ("--left", "--frames", "--out", "--set", "--source"):
            self.refused_in_one_line(run("run", "fpl2003", option), option)
        for option in ("--left", "--frames", "--out", "--source"):
            self.refused_in_one_line(run("run", "fpl2003", option, "1", option, "1"), option)

    def test_a_board_is_needed(self):
        for command in ("run", "check", "bounds"):
            self.refused(run(command), "stereotlm: error: BOARD: missing")

    def test_a_board_that_has_the_name_of_a_command_is_a_board(self):
        self.refused_in_one_line(run("check", "keys"), "keys: not a preset")


class NotInThisVersion(ProgramTest):
    def test_commands(self):
        for command in UNBUILT_COMMANDS:
            for rest in ([], ["fpl2003"], ["--help"], ["--out", "a", "b", "--bogus", "3"]):
                self.refused_in_one_line(run(command, *rest), f"error: {command}: not in this version")

    def test_options_of_run(self):
        for option in UNBUILT_RUN_OPTIONS:
            text = f"error: {option[0]}: not in this version"
            self.refused_in_one_line(self.run_small(*option), text)
            self.refused_in_one_line(run("run", "fpl2003", *option), text)
            self.refused_in_one_line(run("run", "fpl2003", option[0]), text)


class WrongValues(ProgramTest):
    def refused_value(self, process, *texts):
        self.refused_in_one_line(process, *texts)
        self.assertNotIn("not in this version", process.stderr)

    def test_source_and_fidelity_name_their_values(self):
        pair = ["--left", self.left, "--right", self.right]
        for value in ("foo", "Preloaded", ""):
            self.refused_value(
                run("run", "fpl2003", *pair, "--source", value),
                f"--source = {value}: must be camera or preloaded",
            )
            self.refused_value(
                run("run", "fpl2003", *pair, "--source", "preloaded", "--fidelity", value),
                f"--fidelity = {value}: must be fast or cycle",
            )

    def test_frames_are_an_integer_from_one(self):
        for value in ("0", "-1", "1.5", "1e3", "x", "", "+1", " 1", "0x10", "18446744073709551616"):
            self.refused_value(
                self.run_small("--frames", value), f"--frames = {value}: must be an integer, 1 or more"
            )

    def test_the_truth_scale_is_a_positive_number(self):
        for value in ("0", "-1", "nan", "inf", "x", "", "1e400", "2x"):
            self.refused_value(
                self.run_small("--truth", self.left, "--truth-scale", value),
                f"--truth-scale = {value}: must be a number above 0",
            )

    def test_a_truth_scale_needs_a_truth(self):
        self.refused_value(self.run_small("--truth-scale", "2"), "--truth-scale: goes with --truth F")

    def test_a_pair_has_two_pictures(self):
        run_it = ["run", "fpl2003", *PRELOADED]
        for given, path, missing in (("--left", self.left, ["--right"]), ("--right", self.right, ["--left"])):
            self.assertEqual(self.missing(run(*run_it, given, path)), missing)

    def test_a_run_has_pictures(self):
        self.assertEqual(self.missing(run("run", "fpl2003", *PRELOADED)), ["pictures"])
        sources = "--left F --right F, --sequence DIR, --video F [F2] or --synthetic SEED"
        self.refused(run("run", "fpl2003", *PRELOADED), f"error: pictures: missing: a run needs {sources}")

    def test_without_pixels_a_run_needs_no_pictures(self):
        self.assertEqual(self.missing(run("run", "--timing-only")), ["BOARD"])
        self.assertEqual(self.missing(run("run", "fpl2003", "--timing-only", "--left", self.left)), ["--right"])

    def test_a_run_has_pictures_of_one_source(self):
        pair = ["--left", self.left, "--right", self.right]
        sequence = ["--sequence", self.folder]
        video = ["--video", self.left, "--video-layout", "side_by_side"]
        synthetic = ["--synthetic", "1"]
        for given, names in (
            (pair + sequence, "--left, --sequence"),
            (pair + synthetic, "--left, --synthetic"),
            (sequence + video, "--sequence, --video"),
            (pair + sequence + video + synthetic, "--left, --sequence, --video, --synthetic"),
        ):
            self.refused_value(self.run_with(*given), f"error: {names}: a run has one source of pictures: --left F")

    def test_a_video_needs_its_layout(self):
        self.refused_value(self.run_with("--video", "a"), "--video-layout: missing: goes with --video, one of two, side_")
        self.refused_value(self.run_small("--video-layout", "two"), "--video-layout: goes with --video F [F2]")
        for value in ("three", "", "Two"):
            self.refused_value(
                self.run_with("--video", "a", "--video-layout", value),
                f"--video-layout = {value}: must be two, side_by_side or top_bottom",
            )

    def test_a_video_layout_says_how_many_files(self):
        self.refused_value(
            self.run_with("--video", "a", "--video-layout", "two"),
            "--video 'a': must name two files with --video-layout two",
        )
        for layout in ("side_by_side", "top_bottom"):
            self.refused_value(
                self.run_with("--video", "a", "b", "--video-layout", layout),
                f"--video 'a' 'b': must name one file with --video-layout {layout}",
            )
        self.assertEqual(self.run_with("--video", "a", "b", "c", "--video-layout", "two").returncode, 2)

    def test_a_seed_is_an_integer(self):
        for value in ("-1", "1.5", "x", "", "18446744073709551616"):
            self.refused_value(self.run_with("--synthetic", value), f"--synthetic = {value}: must be an integer, 0..2^64-1")

    def test_a_truth_does_not_go_with_a_synthetic_scene(self):
        self.refused_value(
            self.run_with("--synthetic", "1", "--truth", self.left),
            "--truth: does not go with --synthetic, whose scene is its own truth",
        )

    def test_what_needs_disparities_does_not_go_without_pixels(self):
        for option in (["--truth", self.left], ["--save-frames", "--out", self.out]):
            self.refused_value(
                self.run_small("--timing-only", *option),
                f"{option[0]}: does not go with --timing-only, which has no disparities",
            )
        self.assertFalse(self.out.exists())

    def test_saved_frames_need_a_folder(self):
        self.refused_value(self.run_small("--save-frames"), "--save-frames: goes with --out DIR")

    def missing(self, process):
        """What is said to be missing; the last line shows a complete command."""
        *lines, example = self.refused(process)
        self.assertRegex(example, r"^stereotlm: note: a complete command: stereotlm run fpl2003 .*--left \S+ --right \S+$")
        return [line.split(": ")[2] for line in lines if ": missing: " in line]

    def test_a_run_without_anything_is_told_all_at_once(self):
        self.assertEqual(self.missing(run("run")), ["BOARD", "pictures"])
        self.assertNotIn("complete command", run("run", "fpl2003", "--left", "a", "--right", "b").stderr)

    def test_the_complete_command_is_one(self):
        example = self.refused(run("run"))[-1].split(": ")[-1].split()
        self.assertEqual(example.pop(0), "stereotlm")
        for name in ("left.png", "right.png"):
            self.file(name, pgm(640, 480, bytes(640 * 480)))
        self.succeeds(run(*example, "--set", "matcher.window=3", cwd=self.folder))


if __name__ == "__main__":
    program.main()
